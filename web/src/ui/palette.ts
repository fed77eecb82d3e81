/**
 * Every command by name. The server keeps the line and finds what fits; this shows it, and hands on what is typed, also
 * from keyboards that only ever speak of text.
 */
import type { Client } from "../client";
import type { FaceAnswer } from "../meta";
import { h } from "./dom";

type View = NonNullable<FaceAnswer["palette"]>;

export class Palette {
  readonly element: HTMLElement;
  readonly #client: Client;
  readonly #input = h("input", {
    type: "text",
    role: "combobox",
    "aria-label": "command",
    "aria-expanded": "true",
    "aria-controls": "palette-list",
    autocomplete: "off",
    autocapitalize: "off",
    spellcheck: "false",
  });
  readonly #list = h("ul", { role: "listbox", id: "palette-list", "aria-label": "commands" });
  #shown: View | undefined;
  #before: Element | null = null;

  constructor(client: Client) {
    this.#client = client;
    const foot = h("p", { class: "note" }, "Enter does it · Tab completes · Esc closes");
    this.element = h(
      "div",
      { class: "palette", role: "dialog", "aria-label": "Commands", hidden: true },
      this.#input,
      this.#list,
      foot,
    );
    this.#input.addEventListener("beforeinput", (event) => this.#typed(event));
    this.#list.addEventListener("pointerdown", (event) => event.preventDefault());
    this.#list.addEventListener("click", (event) => this.#clicked(event));
    // What is typed comes back from the server; a click elsewhere leaves.
    this.element.addEventListener("focusout", (event) => {
      const inside = event.relatedTarget instanceof Node && this.element.contains(event.relatedTarget);
      if (this.#shown !== undefined && !inside && document.hasFocus()) this.#client.key("<esc>");
    });
  }

  get open(): boolean {
    return this.#shown !== undefined;
  }

  update(view: View | null): void {
    if (view === null) {
      if (this.#shown === undefined) return;
      this.#shown = undefined;
      this.element.hidden = true;
      if (this.#before instanceof HTMLElement) this.#before.focus();
      return;
    }
    const opened = this.#shown === undefined;
    this.#shown = view;
    this.element.hidden = false;
    if (opened) {
      this.#before = document.activeElement;
      this.#input.focus();
    }
    if (this.#input.value !== view.line) this.#input.value = view.line;
    this.#list.replaceChildren(
      ...view.entries.map((entry, i) => {
        const chosen = i === view.chosen;
        const item = h(
          "li",
          { role: "option", id: `palette-${i}`, "aria-selected": String(chosen), "data-entry": String(i) },
          h("span", { class: "name" }, entry.name),
          h("span", { class: "help" }, entry.help),
          ...(entry.keys === ""
            ? []
            : [
                h(
                  "span",
                  { class: "keys" },
                  ...entry.keys.split(" ").map((key) => (key === "…" ? "…" : h("kbd", {}, key))),
                ),
              ]),
        );
        return item;
      }),
    );
    if (view.chosen === null) this.#input.removeAttribute("aria-activedescendant");
    else {
      this.#input.setAttribute("aria-activedescendant", `palette-${view.chosen}`);
      this.#list.children[view.chosen]?.scrollIntoView({ block: "nearest" });
    }
  }

  /** Text that came without keys: a paste, a phone's keyboard. */
  #typed(event: InputEvent): void {
    event.preventDefault();
    if (event.inputType === "deleteContentBackward") return void this.#client.key("<backspace>");
    this.#client.type(event.data ?? event.dataTransfer?.getData("text/plain") ?? "");
  }

  /** Goes to the entry with the arrows, as the keyboard would, and takes it. */
  #clicked(event: MouseEvent): void {
    const item = event.target instanceof Element ? event.target.closest("[data-entry]") : null;
    const view = this.#shown;
    if (item === null || view === undefined) return;
    const wanted = Number(item.getAttribute("data-entry"));
    // From nothing chosen, the first arrow down takes the first one.
    const by = wanted - (view.chosen ?? -1);
    for (let i = 0; i < Math.abs(by); i += 1) this.#client.key(by > 0 ? "<down>" : "<up>");
    this.#client.key("<enter>");
  }
}
