/** A control of the server as an element of the page: slider, check box, menu or button, whatever it is. */
import type { Client } from "../client";
import { fixed } from "../format";
import type { TermName } from "../formulas";
import type { GuiElement } from "../state/gui";
import { Keyed, h, setHidden, setText } from "./dom";
import { explained } from "./term";

export interface Control {
  element: HTMLElement;
  /** Shows what the server says now; hidden where it says nothing. */
  update(): void;
}

interface Options {
  /** In the place of the server's label. */
  label?: string;
  /** The label is for screen readers only. */
  quiet?: boolean;
  term?: TermName;
}

/** A control by uuid, made when the server first speaks of it and again when it changes its kind. */
export function control(client: Client, uuid: string, options: Options = {}): Control {
  const element = h("div", { class: "control" });
  let made: { type: string; update(gui: GuiElement): void } | undefined;
  return {
    element,
    update() {
      const gui = client.element(uuid);
      setHidden(element, gui === undefined || gui.props["visible"] === false);
      if (gui === undefined) return;
      if (made?.type !== gui.type) {
        made = { type: gui.type, update: make(client, uuid, gui.type, element, options) };
      }
      made.update(gui);
    },
  };
}

function make(
  client: Client,
  uuid: string,
  type: string,
  parent: HTMLElement,
  options: Options,
): (gui: GuiElement) => void {
  parent.replaceChildren();
  switch (type) {
    case "GuiSliderMessage":
    case "GuiNumberMessage":
      return slider(client, uuid, parent, options);
    case "GuiCheckboxMessage":
      return checkbox(client, uuid, parent, options);
    case "GuiDropdownMessage":
      return dropdown(client, uuid, parent, options);
    case "GuiButtonMessage":
      return button(client, uuid, parent, options);
    default:
      return () => setHidden(parent, true);
  }
}

function labelOf(gui: GuiElement, options: Options): string {
  return options.label ?? String(gui.props["label"] ?? "");
}

function labelled(uuid: string, options: Options, ...rest: Node[]): [HTMLLabelElement, ...Node[]] {
  const label = h("label", { for: uuid, class: options.quiet ? "unseen" : undefined });
  if (options.term !== undefined) label.setAttribute("data-term", explained(options.term)["data-term"]);
  return [label, ...rest];
}

function slider(client: Client, uuid: string, parent: HTMLElement, options: Options): (gui: GuiElement) => void {
  const input = h("input", { type: "range", id: uuid });
  const output = h("output", { for: uuid });
  const [label] = labelled(uuid, options);
  parent.classList.add("slider");
  parent.append(label, input, output);
  input.addEventListener("input", () => client.choose(uuid, Number(input.value)));
  return (gui) => {
    setText(label, labelOf(gui, options));
    const digits = Number(gui.props["precision"] ?? 0);
    for (const bound of ["min", "max", "step"] as const) {
      const value = String(gui.props[bound] ?? "");
      if (input[bound] !== value) input[bound] = value;
    }
    const value = Number(gui.value);
    if (Number(input.value) !== value) input.value = String(value);
    const low = Number(input.min);
    const part = (value - low) / Math.max(Number(input.max) - low, 1e-9);
    input.style.setProperty("--part", `${Math.min(1, Math.max(0, part)) * 100}%`);
    setText(output, fixed(value, digits));
    input.disabled = gui.props["disabled"] === true;
  };
}

function checkbox(client: Client, uuid: string, parent: HTMLElement, options: Options): (gui: GuiElement) => void {
  const input = h("input", { type: "checkbox", id: uuid, role: "switch" });
  const [label] = labelled(uuid, options);
  parent.classList.add("checkbox");
  parent.append(input, label);
  input.addEventListener("change", () => client.choose(uuid, input.checked));
  return (gui) => {
    setText(label, labelOf(gui, options));
    input.checked = gui.value === true;
    input.disabled = gui.props["disabled"] === true;
  };
}

function dropdown(client: Client, uuid: string, parent: HTMLElement, options: Options): (gui: GuiElement) => void {
  const input = h("select", { id: uuid });
  const [label] = labelled(uuid, options);
  const choices = new Keyed<string>(input);
  let listed: unknown;
  parent.classList.add("dropdown");
  parent.append(label, input);
  input.addEventListener("change", () => client.choose(uuid, input.value));
  return (gui) => {
    setText(label, labelOf(gui, options));
    const names = gui.props["options"];
    if (Array.isArray(names) && names !== listed) {
      listed = names;
      choices.update(
        names.map(String),
        (name) => name,
        (name) => h("option", { value: name }, name),
      );
    }
    if (input.value !== String(gui.value)) input.value = String(gui.value);
    input.disabled = gui.props["disabled"] === true;
  };
}

function button(client: Client, uuid: string, parent: HTMLElement, options: Options): (gui: GuiElement) => void {
  const input = h("button", { type: "button", id: uuid });
  if (options.term !== undefined) input.setAttribute("data-term", options.term);
  parent.append(input);
  input.addEventListener("click", () => client.press(uuid));
  return (gui) => {
    setText(input, labelOf(gui, options));
    input.disabled = gui.props["disabled"] === true;
  };
}
