/** Time: a slider over the steps, with what happens when drawn under it. */
import type { Client } from "../client";
import { fixed } from "../format";
import type { Meta } from "../meta";
import * as names from "../names";
import { type Control, control } from "./control";
import { h, setText, svg } from "./dom";
import { icon } from "./icons";

/** Height of the drawing in its own units. */
const HEIGHT = 40;
const FORCE_FROM = 12;

export class Timeline {
  readonly element = h("section", { class: "timeline", "data-pane": "timeline", "aria-label": "Time" });
  readonly #client: Client;
  readonly #play = h("button", { type: "button", class: "play" });
  readonly #scrub = h("input", {
    type: "range",
    class: "scrub",
    min: "1",
    step: "1",
    id: names.STEP,
    "aria-label": "step",
  });
  readonly #drawing = svg("svg", { class: "track", preserveAspectRatio: "none", "aria-hidden": "true" });
  readonly #marks = h("div", { class: "marks", "aria-hidden": "true" });
  readonly #where = h("output", { class: "where number", for: names.STEP });
  readonly #legend = h("span", { class: "legend" });
  readonly #speed: Control;
  #drawn = "";

  constructor(client: Client) {
    this.#client = client;
    this.#speed = control(client, names.SPEED, { label: "speed", quiet: true });
    this.#play.addEventListener("click", () => client.press(names.PLAY));
    // The thumb is as wide as a step, so that it stands in the middle of its column.
    new ResizeObserver(() => this.#widen()).observe(this.#scrub);
    this.element.addEventListener("wheel", (event) => this.#wheeled(event), { passive: false });
    this.#scrub.addEventListener("input", () => client.choose(names.STEP, Number(this.#scrub.value)));
    this.element.append(
      h("div", { class: "transport" }, this.#play, this.#speed.element, this.#where),
      h("div", { class: "lane" }, this.#drawing, this.#marks, this.#scrub),
      this.#legend,
    );
  }

  update(): void {
    const { meta } = this.#client;
    const slider = this.#client.element(names.STEP);
    this.#speed.update();
    const steps = meta?.steps ?? 0;
    this.#scrub.max = String(Math.max(steps, 1));
    this.#scrub.disabled = steps === 0 || slider?.props["disabled"] === true;
    const step = Number(slider?.value ?? 1);
    if (Number(this.#scrub.value) !== step) this.#scrub.value = String(step);
    const playing = meta?.playing === true;
    const label = playing ? "pause" : "play";
    if (this.#play.getAttribute("aria-label") !== label) {
      this.#play.setAttribute("aria-label", label);
      this.#play.replaceChildren(icon(label));
    }
    this.#play.disabled = this.#client.element(names.PLAY)?.props["disabled"] === true;
    if (meta === undefined) return;
    const time = meta.secs === null ? "" : ` · ${fixed(meta.secs, 2)} s`;
    setText(this.#where, `step ${meta.step + 1} of ${meta.steps}${time}`);
    this.#scrub.setAttribute("aria-valuetext", this.#where.textContent ?? "");
    this.#draw(meta);
  }

  /** A step a notch, as in the terminal. */
  #wheeled(event: WheelEvent): void {
    if (event.ctrlKey || event.deltaY === 0 || this.#scrub.disabled) return;
    event.preventDefault();
    const step = Number(this.#scrub.value) + Math.sign(event.deltaY);
    if (step >= 1 && step <= Number(this.#scrub.max)) this.#client.choose(names.STEP, step);
  }

  #widen(): void {
    this.#scrub.style.setProperty("--column", `${this.#scrub.clientWidth / Math.max(1, Number(this.#scrub.max))}px`);
  }

  #draw(meta: Meta): void {
    const { steps, start, context, horizon, selection, events, force_over_time: force } = meta;
    const key = JSON.stringify([steps, start, context, horizon, selection, events, force]);
    if (key === this.#drawn || steps === 0) return;
    this.#drawn = key;
    const from = Math.max(0, start - context + 1);
    const end = Math.min(steps - 1, start + horizon);
    const most = Math.max(...force.map((newtons) => newtons ?? 0), 1e-9);
    // A unit a step, and half a one beyond each end, so that a step is a column with its own middle.
    this.#widen();
    this.#drawing.setAttribute("viewBox", `-0.5 0 ${steps} ${HEIGHT}`);
    const column = (cssClass: string, first: number, last: number, y: number, height: number) =>
      svg("rect", {
        class: cssClass,
        x: `${first - 0.5}`,
        width: `${last - first + 1}`,
        y: `${y}`,
        height: `${height}`,
      });
    this.#drawing.replaceChildren(
      ...force.map((newtons, i) => {
        const height = ((newtons ?? 0) / most) * (HEIGHT - FORCE_FROM);
        return column("force", i, i, HEIGHT - height, height);
      }),
      ...(selection === null ? [] : [column("selected", selection[0], selection[1], 0, HEIGHT)]),
      column("context", from, start, 0, 4),
      ...(end > start ? [column("horizon", start + 1, end, 0, 4)] : []),
    );
    const at = (step: number) => `${((step + 0.5) / steps) * 100}%`;
    const mark = (cssClass: string, step: number, text: string) => {
      const element = h("span", { class: cssClass }, text);
      element.style.left = at(step);
      return element;
    };
    this.#marks.replaceChildren(
      mark("start", start + 0.5, ""),
      ...events.map(({ step, kind }) => mark(`event ${kind}`, step, kind === "mark" ? "★" : "▲")),
    );
    const forceText = force.length > 0 ? `force to ${fixed(most, 1)} N · ` : "";
    setText(
      this.#legend,
      `${forceText}▲ contact  ★ mark  ·  context ${context}, then ${horizon} predicted${meta.looping === "off" ? "" : ` · loops ${meta.looping === "all" ? "all" : "the selection"}`}`,
    );
  }
}
