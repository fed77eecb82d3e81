/** One chart: uPlot for the drawing, a title with a legend that reads the values at the cursor. */
import uPlot from "uplot";
import type { TermName } from "../formulas";
import type { ExpertMeta } from "../meta";
import { themed, token } from "../theme";
import { h, setHidden, setText } from "../ui/dom";
import { explained } from "../ui/term";
import { drawCursor } from "./cursor";
import { drawDimensions } from "./dimensions";
import { type Drawing, legendItems } from "./legend";
import { type Described, type Series, described, shapeOf } from "./options";
import { drawStack } from "./stack";

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
  /** What one value of x is called. */
  x: string;
  /** Whether x is the step, so that a click goes there. */
  time: boolean;
  drawing: Drawing;
}

const AXIS_FONT = "11px system-ui, sans-serif";

export class Chart {
  readonly element: HTMLElement;
  readonly #kind: ChartKind;
  readonly #onSeek: (x: number) => void;
  readonly #box = h("div", { class: "plot", role: "img" });
  readonly #legend = h("div", { class: "legend" });
  readonly #empty = h("p", { class: "empty" }, "nothing to draw here yet");
  #plot: uPlot | undefined;
  #shape = "";
  #props: unknown;
  #chart: Described | undefined;
  #view: ChartView | undefined;
  /** Index of x under the pointer. */
  #hover: number | undefined;

  constructor(kind: ChartKind, onSeek: (x: number) => void) {
    this.#kind = kind;
    this.#onSeek = onSeek;
    const title = h("h3", explained(kind.term), kind.title);
    this.element = h(
      "figure",
      { class: "chart", id: `chart-${kind.name}` },
      h("figcaption", {}, title, this.#legend),
      this.#box,
      this.#empty,
    );
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
    if (this.#chart !== undefined && this.#plot !== undefined) this.#draw(this.#chart);
    this.#showLegend();
  }

  #clear(): void {
    this.#props = undefined;
    this.#chart = undefined;
    this.#plot?.destroy();
    this.#plot = undefined;
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
    const { drawing, time } = this.#kind;
    const grid = { stroke: token("--grid"), width: 1 };
    const axis = { stroke: token("--dim"), font: AXIS_FONT, grid, ticks: { ...grid, size: 3 }, gap: 3 };
    const y = chart.ranges["y"];
    return {
      ...this.#size(),
      padding: [7, 6, 0, 0],
      legend: { show: false },
      cursor: {
        y: false,
        points: { show: drawing === "lines", size: 5 },
        drag: { x: false, y: false },
        ...(time ? { sync: { key: "steps" } } : {}),
      },
      scales: {
        x: {
          time: false,
          range: (_, low, high) => margins(low, high, drawing === "dimensions" ? 1 : 0.02 * (high - low)),
        },
        y:
          y === undefined
            ? {}
            : { range: (_, low, high) => [y[0] ?? low, y[1] ?? high + 0.06 * (high - (y[0] ?? low))] },
      },
      series: chart.series.map((series, i) => (i === 0 ? {} : seriesOptions(series, drawing))),
      bands:
        drawing === "lines" ? chart.bands.map(({ series, fill }) => ({ series, fill: fill ?? token("--wash") })) : [],
      axes: [
        { ...axis, size: 20, space: 36, incrs: [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000] },
        { ...axis, size: 38, space: 24, values: (_, ticks) => ticks.map((tick) => tick.toString().replace("-", "−")) },
      ],
      hooks: {
        // A chart keeps its options while its data change: what is drawn is asked for each time.
        drawAxes: [(plot) => this.#drawUnder(plot)],
        draw: [(plot) => drawCursor(plot, this.#view?.now, this.#view?.boundary)],
        setCursor: [(plot) => this.#hovered(plot)],
        ready: [(plot) => plot.over.addEventListener("click", () => this.#clicked(plot))],
      },
    };
  }

  #drawUnder(plot: uPlot): void {
    const experts = this.#view?.experts ?? [];
    if (this.#chart === undefined) return;
    if (this.#kind.drawing === "stack") drawStack(plot, this.#chart, experts);
    if (this.#kind.drawing === "dimensions") drawDimensions(plot, this.#chart, experts);
  }

  #hovered(plot: uPlot): void {
    const next = plot.cursor.idx ?? undefined;
    if (next === this.#hover) return;
    this.#hover = next;
    this.#showLegend();
  }

  #clicked(plot: uPlot): void {
    const { idx } = plot.cursor;
    const x = idx === null || idx === undefined ? undefined : plot.data[0][idx];
    if (this.#kind.time && x !== undefined) this.#onSeek(x);
  }

  /** Values under the pointer, else at the cursor. */
  #showLegend(): void {
    const chart = this.#chart;
    if (chart === undefined) return;
    const { drawing, title, x } = this.#kind;
    const now = Array.from(chart.data[0]).indexOf(this.#view?.now ?? Number.NaN);
    const at = this.#hover ?? (now < 0 ? undefined : now);
    const items = legendItems(chart, drawing, this.#view?.experts ?? [], at);
    const here =
      this.#hover === undefined ? [] : [h("span", { class: "at number" }, `${x} ${chart.data[0][this.#hover] ?? ""}`)];
    this.#legend.replaceChildren(...here, ...items);
    this.#box.setAttribute("aria-label", `${title}: ${items.map((item) => item.textContent).join(", ")}`);
    setText(this.#empty, "nothing to draw here yet");
  }

  #size(): { width: number; height: number } {
    return { width: Math.max(60, this.#box.clientWidth), height: Math.max(40, this.#box.clientHeight) };
  }

  #resize(): void {
    const size = this.#size();
    if (this.#plot !== undefined && (this.#plot.width !== size.width || this.#plot.height !== size.height))
      this.#plot.setSize(size);
  }
}

function seriesOptions(series: Series, drawing: Drawing): uPlot.Series {
  const drawn = drawing === "lines";
  return {
    label: series.label,
    show: series.show,
    ...(series.stroke === undefined || !drawn ? {} : { stroke: themed(series.stroke), width: series.width }),
    ...(series.fill === undefined || !drawn ? {} : { fill: series.fill }),
    ...(series.dash === undefined ? {} : { dash: series.dash }),
    points: { show: drawn && series.points && series.stroke !== undefined, size: 4 },
  };
}

/** The range with room at both ends. */
function margins(low: number, high: number, room: number): [number, number] {
  return high > low ? [low - room, high + room] : [low - 1, high + 1];
}
