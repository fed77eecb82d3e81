/** What is open: episode, model, connection; and the page's own few buttons. */
import type { Client } from "../client";
import * as names from "../names";
import { type Control, control } from "./control";
import { h, setText } from "./dom";
import { type IconName, icon } from "./icons";

export interface Actions {
  help(): void;
  palette(): void;
  theme(): void;
  copy(): void;
}

export class Header {
  readonly element: HTMLElement;
  readonly #client: Client;
  readonly #controls: Control[];
  readonly #turns: HTMLButtonElement[];
  readonly #connection = h("span", { class: "connection", role: "status" });
  readonly #notes = h("span", { class: "notes" });

  constructor(client: Client, actions: Actions) {
    this.#client = client;
    const episode = control(client, names.EPISODE, { label: "episode" });
    const model = control(client, names.MODEL, { label: "model" });
    this.#controls = [episode, model];
    const button = (sign: IconName, hint: string, act: () => void) => {
      const element = h("button", { type: "button", title: hint, "aria-label": hint }, icon(sign));
      element.addEventListener("click", act);
      return element;
    };
    const turn = (sign: IconName, hint: string, key: string) => button(sign, hint, () => client.key(key));
    this.#turns = [turn("previous", "previous episode  [", "["), turn("next", "next episode  ]", "]")];
    this.element = h(
      "header",
      { class: "top" },
      h("h1", {}, "poescope"),
      h("div", { class: "group" }, episode.element, ...this.#turns),
      h("div", { class: "group" }, model.element),
      this.#notes,
      this.#connection,
      h(
        "div",
        { class: "group actions" },
        button("commands", "commands  : or Ctrl+K", actions.palette),
        button("copy", "copy a link to this state  y", actions.copy),
        button("theme", "dark or light", actions.theme),
        button("help", "keys and formulas  ?", actions.help),
      ),
    );
  }

  update(status: string, open: boolean): void {
    this.#controls.forEach((each) => each.update());
    const { meta } = this.#client;
    this.#turns.forEach((each) => (each.disabled = meta?.read_only === true));
    const busy = meta?.busy === true;
    setText(this.#connection, open ? (busy ? "◌ computing" : "● connected") : `○ ${status}`);
    this.#connection.dataset["open"] = String(open);
    const notes: string[] = [];
    if (meta?.read_only) notes.push("read only");
    const flags = meta?.episode?.flags.length ?? 0;
    if (flags > 0) notes.push(`${flags} odd in the recording`);
    if (meta && meta.episode && meta.episode.missing.length > 0) notes.push(`lacks ${meta.episode.missing.join(", ")}`);
    setText(this.#notes, notes.join(" · "));
    this.#notes.title = meta?.episode?.flags.join("\n") ?? "";
  }
}
