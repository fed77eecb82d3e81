/** One chart: uPlot for the drawing, a title with a legend that reads the values at the cursor. */
import uPlot from "uplot";
import { fillOf, tile } from "../fills";
import { short } from "../format";
import type { TermName } from "../formulas";
import type { ExpertMeta } from "../meta";
import { rgbOf, themed, token } from "../theme";
import { h, setHidden } from "../ui/dom";
import { explained } from "../ui/term";
import { type Described, type Series, described, shapeOf } from "./options";

export interface ChartView {
  props: Readonly<Record<string, unknown>>;
  /** Where the cursor is on x; nothing where x is not time. */
  now: number | undefined;
  /** x after which the rollout predicts. */
  boundary: number | undefined;
  experts: readonly ExpertMeta[];
}

export interface ChartKind {
  name: string;
  term: TermName;
  title: string;
  /** Whether x is the step, so that a click goes there. */
  time: boolean;
  /** What is drawn as stacked areas with the experts' fills. */
  stacked?: boolean;
  unit: string;
}

const AXIS_FONT = "11px system-ui, sans-serif";

export class Chart {
  readonly element: HTMLElement;
  readonly #kind: ChartKind;
  readonly #onSeek: (x: number) => void;
  readonly #box = h("div", { class: "plot" });
  readonly #legend = h("div", { class: "legend" });
  readonly #empty = h("p", { class: "empty" }, "nothing to draw here");
  #plot: uPlot | undefined;
  #shape = "";
  #props: unknown;
  #chart: Described | undefined;
  #view: ChartView | undefined;
  #hover: number | null = null;

  constructor(kind: ChartKind, onSeek: (x: number) => void) {
    this.#kind = kind;
    this.#onSeek = onSeek;
    const title = h("h3", explained(kind.term), kind.title);
    this.element = h("figure", { class: "chart", id: `chart-${kind.name}` }, h("figcaption", {}, title, this.#legend), this.#box, this.#empty);
    new ResizeObserver(() => this.#resize()).observe(this.#box);
  }

  update(view: ChartView | undefined): void {
    const moved = this.#view?.now !== view?.now || this.#view?.boundary !== view?.boundary;
    this.#view = view;
    if (view === undefined) return this.#clear();
    if (view.props !== this.#props) {
      this.#props = view.props;
      this.#chart = described(view.props);
      if (this.#chart === undefined) return this.#clear();
      this.#draw(this.#chart);
    } else if (moved) {
      this.#plot?.redraw(false, false);
    }
    this.#showLegend();
  }

  /** Draws again in the colours of now. */
  retint(): void {
    this.#shape = "";
    if (this.#chart !== undefined) this.#draw(this.#chart);
    this.#showLegend();
  }

  #clear(): void {
    this.#props = undefined;
    this.#plot?.destroy();
    this.#plot = undefined;
    this.#shape = "";
    this.#legend.replaceChildren();
    setHidden(this.#empty, false);
  }

  #draw(chart: Described): void {
    setHidden(this.#empty, true);
    const shape = shapeOf(chart);
    if (this.#plot !== undefined && shape === this.#shape) {
      this.#plot.setData(chart.data);
      return;
    }
    this.#plot?.destroy();
    this.#shape = shape;
    this.#plot = new uPlot(this.#options(chart), chart.data, this.#box);
  }

  #options(chart: Described): uPlot.Options {
    const { width, height } = this.#size();
    const grid = { stroke: token("--grid"), width: 1 };
    const axis = { stroke: token("--dim"), font: AXIS_FONT, grid, ticks: { ...grid, size: 3 }, gap: 3 };
    const range = (name: string) => chart.ranges[name];
    const y = range("y");
    return {
      width,
      height,
      padding: [4, 6, 0, 0],
      legend: { show: false },
      cursor: { y: false, points: { size: 5 }, drag: { x: false, y: false }, ...(this.#kind.time ? { sync: { key: "steps" } } : {}) },
      scales: {
        x: { time: false, range: (_, low, high) => (high > low ? [low - 0.02 * (high - low), high + 0.02 * (high - low)] : [low - 1, high + 1]) },
        y: y === undefined ? {} : { range: (_, low, high) => [y[0] ?? low, y[1] ?? high] },
      },
      series: chart.series.map((series, i) => (i === 0 ? {} : this.#seriesOptions(series, i))),
      bands: this.#kind.stacked ? [] : chart.bands.map(({ series, fill }) => ({ series, fill: fill ?? token("--wash") })),
      axes: [
        { ...axis, size: 20, space: 36, incrs: [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000] },
        { ...axis, size: 38, space: 24, values: (_, ticks) => ticks.map((tick) => tick.toString().replace("-", "−")) },
      ],
      hooks: {
        drawClear: this.#kind.stacked ? [(plot) => this.#drawStack(plot, chart)] : [],
        draw: [(plot) => this.#drawCursor(plot)],
        setCursor: [(plot) => this.#hovered(plot)],
        ready: [(plot) => plot.over.addEventListener("click", () => this.#clicked(plot))],
      },
    };
  }

  #seriesOptions(series: Series, index: number): uPlot.Series {
    const lone = series.points || this.#kind.name === "latents";
    return {
      label: series.label,
      show: series.show,
      ...(series.stroke === undefined || this.#kind.stacked ? {} : { stroke: themed(series.stroke), width: series.width }),
      ...(series.dash === undefined ? {} : { dash: series.dash }),
      ...(series.fill === undefined || this.#kind.stacked ? {} : { fill: series.fill }),
      points: { show: lone && series.stroke !== undefined, size: index === 1 ? 6 : 4 },
    };
  }

  /** Each expert's part between its line and the one below, in its fill. */
  #drawStack(plot: uPlot, chart: Described): void {
    const { ctx } = plot;
    const ratio = devicePixelRatio;
    const base = plot.valToPos(0, "y", true);
    const xs = chart.data[0];
    ctx.save();
    ctx.beginPath();
    ctx.rect(plot.bbox.left, plot.bbox.top, plot.bbox.width, plot.bbox.height);
    ctx.clip();
    for (let s = 1; s < chart.series.length; s += 1) {
      const expert = this.#expertOf(chart.series[s]);
      const color = expert?.color ?? themed(chart.series[s]?.stroke ?? "#999999");
      const pattern = ctx.createPattern(tile(color, fillOf(expert?.fill ?? "█"), token("--panel"), ratio), "repeat");
      // From the top line down to the next lower one; which that is, the numbers say.
      const top = chart.data[s] ?? [];
      const below = this.#below(chart, s);
      ctx.fillStyle = pattern ?? color;
      runs(top).forEach(([from, to]) => {
        ctx.beginPath();
        for (let i = from; i <= to; i += 1) ctx.lineTo(plot.valToPos(xs[i] ?? 0, "x", true), plot.valToPos(top[i] ?? 0, "y", true));
        for (let i = to; i >= from; i -= 1) {
          const floor = below?.[i];
          ctx.lineTo(plot.valToPos(xs[i] ?? 0, "x", true), typeof floor === "number" ? plot.valToPos(floor, "y", true) : base);
        }
        ctx.fill();
      });
      ctx.strokeStyle = token("--panel");
      ctx.lineWidth = ratio;
      ctx.stroke();
    }
    ctx.restore();
  }

  /** The series that a stacked one stands on: that of the band whose upper edge it is. */
  #below(chart: Described, index: number): ArrayLike<number | null | undefined> | undefined {
    const band = chart.bands.find(({ series }) => series[0] === index);
    return band === undefined ? undefined : chart.data[band.series[1]];
  }

  #expertOf(series: Series | undefined): ExpertMeta | undefined {
    const words = (series?.label ?? "").toLowerCase().split(/\s+/);
    return this.#view?.experts.find(({ name, letter }) => words.includes(name) || words.includes(letter.toLowerCase()));
  }

  #drawCursor(plot: uPlot): void {
    const { now, boundary } = this.#view ?? {};
    const { ctx, bbox } = plot;
    const line = (x: number, color: string, width: number, dash: number[]) => {
      const at = plot.valToPos(x, "x", true);
      if (!(at >= bbox.left - 1 && at <= bbox.left + bbox.width + 1)) return;
      ctx.save();
      ctx.strokeStyle = color;
      ctx.lineWidth = width * devicePixelRatio;
      ctx.setLineDash(dash.map((n) => n * devicePixelRatio));
      ctx.beginPath();
      ctx.moveTo(at, bbox.top);
      ctx.lineTo(at, bbox.top + bbox.height);
      ctx.stroke();
      ctx.restore();
    };
    if (boundary !== undefined) line(boundary, token("--dim"), 1, [2, 3]);
    if (now !== undefined) line(now, token("--ink"), 1.5, []);
  }

  #hovered(plot: uPlot): void {
    const next = plot.cursor.idx ?? null;
    if (next === this.#hover) return;
    this.#hover = next;
    this.#showLegend();
  }

  #clicked(plot: uPlot): void {
    const x = plot.cursor.idx === null || plot.cursor.idx === undefined ? undefined : plot.data[0][plot.cursor.idx];
    if (this.#kind.time && x !== undefined) this.#onSeek(x);
  }

  /** Names with their strokes; values under the pointer, else at the cursor. */
  #showLegend(): void {
    const chart = this.#chart;
    if (chart === undefined || this.#plot === undefined) return;
    const at = this.#hover ?? this.#indexOfNow(chart);
    const shown = chart.series.map((series, i) => ({ series, i })).filter(({ series, i }) => i > 0 && series.label !== "" && this.#named(series));
    const items = shown.map(({ series, i }) => {
      const value = at === undefined ? undefined : this.#valueAt(chart, i, at);
      const swatch = h("i", { class: "swatch", "aria-hidden": "true" });
      const expert = this.#expertOf(series);
      const color = expert?.color ?? (series.stroke === undefined ? (series.fill ?? token("--dim")) : themed(series.stroke));
      swatch.style.setProperty("--c", color);
      if (this.#kind.stacked) swatch.dataset["fill"] = fillOf(expert?.fill ?? "█");
      else swatch.dataset["line"] = series.stroke === undefined ? "band" : series.dash === undefined ? "solid" : "dashed";
      return h("span", {}, swatch, series.label, ...(value === undefined ? [] : [" ", h("b", { class: "number" }, value)]));
    });
    const here = this.#hover === null || at === undefined ? [] : [h("span", { class: "at number" }, `${chart.xLabel || "x"} ${chart.data[0][at] ?? ""}`)];
    this.#legend.replaceChildren(...here, ...items);
    this.#box.setAttribute("role", "img");
    this.#box.setAttribute("aria-label", `${this.#kind.title}: ${items.map((item) => item.textContent).join(", ")}`);
  }

  /** Edges of bands that have no line are named by the band. */
  #named(series: Series): boolean {
    return series.show && (this.#kind.stacked === true || series.stroke !== undefined || series.fill !== undefined || rgbOf(series.label) !== undefined);
  }

  #valueAt(chart: Described, series: number, at: number): string | undefined {
    const value = chart.data[series]?.[at];
    if (typeof value !== "number") return undefined;
    if (!this.#kind.stacked) return `${short(value)}${this.#kind.unit}`;
    const floor = this.#below(chart, series)?.[at];
    return `${Math.round((value - (typeof floor === "number" ? floor : 0)) * 100)} %`;
  }

  #indexOfNow(chart: Described): number | undefined {
    const now = this.#view?.now;
    if (now === undefined) return undefined;
    const at = Array.from(chart.data[0]).indexOf(now);
    return at < 0 ? undefined : at;
  }

  #size(): { width: number; height: number } {
    return { width: Math.max(60, this.#box.clientWidth), height: Math.max(40, this.#box.clientHeight) };
  }

  #resize(): void {
    const size = this.#size();
    if (this.#plot !== undefined && (this.#plot.width !== size.width || this.#plot.height !== size.height)) this.#plot.setSize(size);
  }
}

/** First and last index of each stretch without holes. */
export function runs(values: ArrayLike<number | null | undefined>): [number, number][] {
  const found: [number, number][] = [];
  let from = -1;
  for (let i = 0; i <= values.length; i += 1) {
    const holds = i < values.length && typeof values[i] === "number";
    if (holds && from < 0) from = i;
    if (!holds && from >= 0) {
      found.push([from, i - 1]);
      from = -1;
    }
  }
  return found;
}
