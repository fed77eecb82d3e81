/** Controls and what is shown between them, by uuid. */
import type { Message } from "../protocol/frame";

export interface GuiElement {
  uuid: string;
  /** The message's type: `GuiSliderMessage`. */
  type: string;
  /** `root`, or the uuid of a folder, a modal, a tab. */
  container: string;
  value: unknown;
  props: Readonly<Record<string, unknown>>;
}

const NOT_ELEMENTS = new Set([
  "GuiUpdateMessage",
  "GuiRemoveMessage",
  "GuiPanelRemoveMessage",
  "GuiCloseModalMessage",
  "GuiFormSubmitMessage",
  "GuiFormDirtyMessage",
]);

/** Applies a message about a control; returns the control's uuid, or nothing where the message is not about one. */
export function applyGui(elements: Map<string, GuiElement>, message: Message): string | undefined {
  const { type, uuid } = message;
  if (!type.startsWith("Gui") || typeof uuid !== "string") return undefined;
  if (type === "GuiUpdateMessage") return update(elements, uuid, message["updates"]);
  if (type === "GuiRemoveMessage" || type === "GuiCloseModalMessage" || type === "GuiPanelRemoveMessage") {
    elements.delete(uuid);
    return uuid;
  }
  if (NOT_ELEMENTS.has(type) || type.startsWith("GuiSetPanel")) return undefined;
  elements.set(uuid, {
    uuid,
    type,
    container: typeof message["container_uuid"] === "string" ? message["container_uuid"] : "root",
    value: message["value"],
    // A modal has its fields beside its uuid, everything else has them in `props`.
    props: mapOf(message["props"]) ?? message,
  });
  return uuid;
}

function update(elements: Map<string, GuiElement>, uuid: string, updates: unknown): string {
  const element = elements.get(uuid);
  const changed = mapOf(updates);
  if (element !== undefined && changed !== undefined) {
    const { value = element.value, ...props } = changed;
    elements.set(uuid, { ...element, value, props: { ...element.props, ...props } });
  }
  return uuid;
}

export function mapOf(value: unknown): Record<string, unknown> | undefined {
  return typeof value === "object" && value !== null && !Array.isArray(value)
    ? (value as Record<string, unknown>)
    : undefined;
}
