/** The keys, from the server's own table, and what the numbers mean. */
import type { KeyLine } from "../meta";
import { TERMS, type Term } from "../formulas";
import { h } from "./dom";
import { termElements } from "./term";

/** What the browser keeps for itself, or has no use for. */
const NOT_HERE = new Set(["quit"]);
/** Keys that a page should not take from a browser. */
export const BROWSERS_OWN = new Set(["<c-r>", "<c-c>"]);

export class Help {
  readonly element = h("dialog", { class: "help", "aria-label": "Keys and formulas" });
  readonly #keys = h("div", { class: "keys" });

  constructor() {
    const close = h("button", { type: "button", class: "close", "aria-label": "close" }, "×");
    close.addEventListener("click", () => this.element.close());
    const terms = Object.values(TERMS).map((term: Term) => h("div", { class: "term" }, ...termElements(term)));
    this.element.append(
      h("header", {}, h("h2", {}, "Keys"), close),
      this.#keys,
      h(
        "p",
        { class: "note" },
        "Tab goes through the page's own controls. Ctrl+R stays the browser's; redo is a button, and a command.",
      ),
      h("h2", {}, "What is shown"),
      h("div", { class: "terms" }, ...terms),
    );
    // A click beside it closes it.
    this.element.addEventListener("click", (event) => {
      if (event.target === this.element) this.element.close();
    });
  }

  get open(): boolean {
    return this.element.open;
  }

  toggle(lines: readonly KeyLine[]): void {
    if (this.element.open) return this.element.close();
    this.#keys.replaceChildren(...grouped(lines).map(([group, own]) => section(group, own)));
    this.element.showModal();
  }
}

/** The lines by group, in the table's order. */
export function grouped(lines: readonly KeyLine[]): [string, KeyLine[]][] {
  const groups = new Map<string, KeyLine[]>();
  for (const line of lines) {
    if (line.face !== null && NOT_HERE.has(line.face)) continue;
    groups.set(line.group, [...(groups.get(line.group) ?? []), line]);
  }
  return [...groups];
}

function section(group: string, lines: KeyLine[]): HTMLElement {
  const rows = lines.map((line) => {
    const keys = line.label.split(" ").map((key) => (key === "…" ? "…" : h("kbd", {}, key)));
    return h("div", {}, h("dt", {}, ...keys), h("dd", {}, line.help));
  });
  return h("section", {}, h("h3", {}, group), h("dl", {}, ...rows));
}
