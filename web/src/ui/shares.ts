/** The share of each expert in each latent dimension: a stacked bar a dimension, the first expert lowest. */
import { type Fill, fillOf } from "../fills";
import { percent } from "../format";
import type { Meta } from "../meta";
import { h, setHidden } from "./dom";
import { explained } from "./term";

export class LatentShares {
  readonly element: HTMLElement;
  readonly #bars = h("div", { class: "latent-bars", role: "img" });
  #columns: HTMLElement[] = [];

  constructor() {
    this.element = h(
      "div",
      { class: "latent-shares" },
      h("div", { class: "title" }, h("span", explained("share"), "share per latent dimension")),
      this.#bars,
    );
  }

  update(meta: Meta | undefined): void {
    const experts = meta?.experts ?? [];
    const count = experts[0]?.share.length ?? 0;
    setHidden(this.element, count === 0);
    if (count !== this.#columns.length || this.#columns[0]?.childElementCount !== experts.length) {
      this.#columns = Array.from({ length: count }, () =>
        h("div", {}, ...experts.map(() => h("span", { class: "fill" }))),
      );
      this.#bars.replaceChildren(...this.#columns);
    }
    this.#columns.forEach((column, d) => {
      column.classList.toggle("inactive", meta?.active[d] === false);
      experts.forEach((expert, i) => {
        const piece = column.children[i] as HTMLElement;
        piece.style.height = `${(expert.share[d] ?? 0) * 100}%`;
        piece.style.setProperty("--c", expert.color);
        const fill: Fill = fillOf(expert.fill);
        if (piece.dataset["fill"] !== fill) piece.dataset["fill"] = fill;
      });
    });
    const active = meta?.active.filter(Boolean).length ?? 0;
    const means = experts.map((expert) => `${expert.name} ${percent(expert.share_mean)}`).join(", ");
    this.#bars.setAttribute("aria-label", `${count} dimensions, ${active} active; mean shares: ${means}`);
  }
}
