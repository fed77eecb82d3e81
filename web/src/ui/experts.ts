/** The experts: switch, tempering, share of the belief, and what each of them adds. */
import { boundsNote, mark } from "../bounds";
import type { Client } from "../client";
import { fillOf } from "../fills";
import { percent, short } from "../format";
import type { TermName } from "../formulas";
import type { Bounds, ExpertMeta, Meta } from "../meta";
import * as names from "../names";
import { type Control, control } from "./control";
import { Keyed, h, setHidden, setText } from "./dom";
import { LatentShares } from "./shares";
import { explained } from "./term";

export class Experts {
  readonly element = h("section", {
    class: "pane experts",
    "data-pane": "experts",
    "aria-label": "Experts",
    tabindex: "0",
  });
  readonly #client: Client;
  readonly #rows = h("ol", { class: "rows" });
  readonly #keyed = new Keyed<ExpertMeta>(this.#rows);
  readonly #made = new Map<Element, Row>();
  readonly #badge = h("span", { class: "badge", ...explained("badge") });
  readonly #bounds = h("p", { class: "readings bounds", ...explained("nisPropagated") });
  readonly #latents = new LatentShares();
  readonly #controls: Control[];
  readonly #empty = h("p", { class: "empty" });

  constructor(client: Client) {
    this.#client = client;
    const scope = control(client, names.SCOPE, { label: "switches reach", term: "scope" });
    const all = control(client, names.ALL_ON);
    this.#controls = [scope, all];
    this.element.append(
      h(
        "header",
        { class: "heads" },
        h("h2", {}, "Experts"),
        this.#badge,
        h("small", explained("shareMean"), "mean"),
        h("small", explained("sharePosition"), "pos"),
      ),
      this.#rows,
      this.#bounds,
      this.#empty,
      h("div", { class: "row scope" }, scope.element, all.element),
      this.#latents.element,
    );
  }

  update(): void {
    const { meta } = this.#client;
    this.#controls.forEach((each) => each.update());
    setText(this.#badge, badgeText(meta));
    this.#badge.dataset["kind"] = meta?.badge.kind ?? "";
    this.#badge.title = meta?.badge.kind === "untrained" ? meta.badge.text : "";
    setText(
      this.#empty,
      meta !== undefined && !meta.model.product ? "This model has no product: nothing to switch." : "",
    );
    const rows = this.#keyed.update(
      meta?.experts ?? [],
      (expert) => expert.name,
      (expert) => {
        const row = new Row(this.#client, expert);
        this.#made.set(row.element, row);
        return row.element;
      },
    );
    for (const element of this.#made.keys()) if (!element.isConnected) this.#made.delete(element);
    const answer = this.#client.answer;
    rows.forEach((element, i) => {
      const expert = meta?.experts[i];
      if (expert !== undefined) this.#made.get(element)?.update(expert);
      element.classList.toggle("chosen", answer?.mode === true && answer.palette === null && answer.expert === i);
    });
    const read = (meta?.experts ?? []).flatMap(({ nis }) => nis ?? []);
    setText(this.#bounds, boundsNote(read));
    setHidden(this.#bounds, read.length === 0);
    this.#latents.update(meta);
  }
}

function badgeText(meta: Meta | undefined): string {
  switch (meta?.badge.kind) {
    case "trained":
      return "✓ trained set";
    case "untrained":
      return "! untrained set";
    case "no-product":
      return "no product";
    default:
      return "";
  }
}

class Row {
  readonly element: HTMLElement;
  readonly #controls: Control[];
  readonly #mean = h("span", { class: "number part", ...explained("shareMean") });
  readonly #position = h("span", { class: "number part", ...explained("sharePosition") });
  readonly #bar = h("span", { class: "fill" });
  readonly #state = h("span", { class: "state" });
  readonly #damaged = h("span", { class: "damaged", role: "img", ...explained("damage") }, "~");
  readonly #readings = h("p", { class: "readings" });
  readonly #nis = h("p", { class: "readings" });

  constructor(client: Client, expert: ExpertMeta) {
    const toggle = control(client, names.switchOf(expert.name), { label: expert.name });
    const alpha = control(client, names.alphaOf(expert.name), { label: "α", term: "alpha" });
    this.#controls = [toggle, alpha];
    const chip = h("span", { class: "chip", "aria-hidden": "true" }, expert.letter);
    const key = h("kbd", { "aria-hidden": "true" }, expert.key);
    this.#bar.dataset["fill"] = fillOf(expert.fill);
    this.element = h(
      "li",
      { class: "expert", "data-expert": expert.name },
      h("div", { class: "head" }, key, chip, toggle.element, this.#damaged, this.#mean, this.#position),
      h("div", { class: "bar", ...explained("share") }, this.#bar),
      h("div", { class: "tail" }, alpha.element, this.#state, this.#readings),
      this.#nis,
    );
    this.element.style.setProperty("--c", expert.color);
  }

  update(expert: ExpertMeta): void {
    this.#controls.forEach((each) => each.update());
    setText(this.#mean, percent(expert.share.length === 0 ? null : expert.share_mean));
    setText(this.#position, percent(expert.share_position));
    this.#bar.style.width = `${(expert.share_mean ?? 0) * 100}%`;
    setText(this.#state, expert.alpha === 0 ? "off, out of the product" : "");
    setHidden(this.#damaged, !expert.damaged);
    this.#damaged.setAttribute("aria-label", `the input of ${expert.name} is damaged`);
    this.element.classList.toggle("off", expert.alpha === 0);
    this.#readings.replaceChildren(...readings(expert));
    setHidden(this.#readings, expert.alpha === 0);
    this.#nis.replaceChildren(...consistency(expert));
    setHidden(this.#nis, expert.nis === null);
  }
}

function readings(expert: ExpertMeta): Node[] {
  const parts: [TermName, string, number | null][] = [
    ["information", "info", expert.information_nats],
    ["pull", "pull", expert.pull_cm === null ? null : Math.hypot(...expert.pull_cm)],
  ];
  return parts.filter(([, , value]) => value !== null).map(([term, name, value]) => reading(term, name, value));
}

/** NIS against both spreads of the prediction, each with its mark. */
function consistency({ nis }: ExpertMeta): Node[] {
  if (nis === null) return [];
  return [
    reading("nisHead", "NIS head", nis.head, nis.bounds),
    reading("nisPropagated", "A P Aᵀ+Q", nis.propagated, nis.bounds),
  ];
}

function reading(term: TermName, name: string, value: number | null, bounds: Bounds | null = null): Node {
  const sign = mark(value, bounds);
  const outside = sign === "▲" ? "above the bounds" : "below the bounds";
  return h(
    "span",
    explained(term),
    `${name} `,
    h("b", { class: "number" }, short(value)),
    sign === "" ? undefined : h("b", { class: "outside", role: "img", "aria-label": outside }, sign),
  );
}
