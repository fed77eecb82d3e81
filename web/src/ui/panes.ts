/** One pane alone, or all of them; the terminal's views are panes here. */

/** Which pane a view of the terminal is about; none shows all. */
const VIEWS: [string, string | undefined][] = [
  ["overview", undefined],
  ["fuse", "charts"],
  ["predict", "frames"],
  ["position", "scene"],
];

export class Panes {
  readonly #main: HTMLElement;

  constructor(main: HTMLElement) {
    this.#main = main;
  }

  get #panes(): HTMLElement[] {
    return [...this.#main.querySelectorAll<HTMLElement>("[data-pane]")];
  }

  /** The pane that has the focus. */
  get #focused(): HTMLElement | undefined {
    return document.activeElement?.closest<HTMLElement>("[data-pane]") ?? undefined;
  }

  /** The focused pane alone, or all again. */
  zoom(): void {
    const { zoomed } = this.#main.dataset;
    const pane = this.#focused?.dataset["pane"];
    // The experts stay beside whatever is alone.
    this.#set(zoomed === undefined && pane !== "experts" ? pane : undefined);
  }

  back(): void {
    this.#set(undefined);
  }

  focusNext(by: 1 | -1): void {
    const panes = this.#panes.filter((pane) => pane.offsetParent !== null);
    const at = this.#focused === undefined ? -1 : panes.indexOf(this.#focused);
    const next = at < 0 ? (by > 0 ? 0 : panes.length - 1) : (at + by + panes.length) % panes.length;
    panes[next]?.focus();
  }

  nextView(): void {
    const at = VIEWS.findIndex(([, pane]) => pane === this.#main.dataset["zoomed"]);
    this.#set(VIEWS[(at + 1) % VIEWS.length]?.[1]);
  }

  /** The pane of a view; false where the browser has none. */
  show(view: string): boolean {
    const found = VIEWS.find(([name]) => name === view);
    if (found === undefined) return false;
    this.#set(found[1]);
    return true;
  }

  #set(pane: string | undefined): void {
    if (pane === undefined) delete this.#main.dataset["zoomed"];
    else this.#main.dataset["zoomed"] = pane;
  }
}
