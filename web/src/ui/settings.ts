/** What is set less often, folded away: prediction, damaged inputs, finding; and whatever else a server offers. */
import type { Client } from "../client";
import type { TermName } from "../formulas";
import * as names from "../names";
import { type Control, control } from "./control";
import { Keyed, h, setHidden, setText } from "./dom";

export class Settings {
  readonly element = h("div", { class: "settings" });
  readonly #client: Client;
  readonly #controls: Control[] = [];
  readonly #notes: { element: HTMLElement; text: () => string }[] = [];
  readonly #more = h("div", { class: "controls" });
  readonly #moreFold: HTMLElement;
  readonly #keyed = new Keyed<string>(this.#more);
  readonly #others = new Map<string, Control>();

  constructor(client: Client) {
    this.#client = client;
    const meta = () => client.meta;
    this.#fold("Prediction", names.ROLLOUT, "context", () => {
      const now = meta();
      return now === undefined
        ? ""
        : `${now.context} seen, ${now.horizon} ahead${now.sampling.shown ? ", a sample" : ""}`;
    });
    this.#fold(
      "Damaged inputs",
      names.DAMAGE,
      "damage",
      () => (meta()?.corruptions ?? []).map(({ modality, damage }) => `${modality} ${damage}`).join(", ") || "none",
    );
    this.#fold("Find, undo", names.FIND, undefined, () => {
      const failure = meta()?.failure;
      const place = failure?.place ?? null;
      return failure === undefined
        ? ""
        : `by ${failure.order}${place === null ? "" : `, ${place + 1} of ${failure.count}`}`;
    });
    this.#moreFold = h("details", { class: "fold" }, h("summary", {}, "More"), this.#more);
    this.element.append(this.#moreFold);
  }

  #fold(title: string, uuids: readonly string[], term: TermName | undefined, note: () => string): void {
    const controls = uuids.map((uuid) => control(this.#client, uuid));
    this.#controls.push(...controls);
    const element = h("span", { class: "note" });
    this.#notes.push({ element, text: note });
    const name = h("span", term === undefined ? {} : { "data-term": term }, title);
    const body = h(
      "div",
      { class: uuids === names.FIND ? "controls pairs" : "controls" },
      ...controls.map((each) => each.element),
    );
    // A high window has the room for all of them.
    const open = innerHeight >= ROOMY_PX && innerWidth >= 1180;
    this.element.append(h("details", { class: "fold", open }, h("summary", {}, name, element), body));
  }

  update(): void {
    this.#controls.forEach((each) => each.update());
    this.#notes.forEach(({ element, text }) => setText(element, text()));
    const unknown = [...this.#client.store.gui.values()]
      .filter(({ uuid, type, props }) => !known(uuid) && SHOWN.has(type) && props["visible"] !== false)
      .map(({ uuid }) => uuid);
    setHidden(this.#moreFold, unknown.length === 0);
    this.#keyed.update(
      unknown,
      (uuid) => uuid,
      (uuid) => {
        const made = control(this.#client, uuid);
        this.#others.set(uuid, made);
        return made.element;
      },
    );
    unknown.forEach((uuid) => this.#others.get(uuid)?.update());
  }
}

const ROOMY_PX = 900;

const SHOWN = new Set([
  "GuiSliderMessage",
  "GuiNumberMessage",
  "GuiCheckboxMessage",
  "GuiDropdownMessage",
  "GuiButtonMessage",
]);

const KNOWN = new Set([
  ...[names.STATUS, names.EPISODE, names.MODEL, names.STEP, names.PLAY, names.SPEED, names.PROGRESS, names.SCOPE],
  ...[names.ALL_ON, names.SHARES, names.KEY, names.LINE, names.STATE, names.KEYS, names.META, names.FACE],
  ...names.ROLLOUT,
  ...names.DAMAGE,
  ...names.FIND,
]);

/** Whether another part of the page shows it. */
function known(uuid: string): boolean {
  return KNOWN.has(uuid) || /^poescope-(switch|alpha|frame|chart|damage|severity)-/.test(uuid);
}
