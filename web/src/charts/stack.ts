/** Stacked areas: each expert's part between its line and the one it stands on, in its own fill. */
import type uPlot from "uplot";
import { fillOf, tile } from "../fills";
import type { ExpertMeta } from "../meta";
import { themed, token } from "../theme";
import type { Described, Series } from "./options";

export function drawStack(plot: uPlot, chart: Described, experts: readonly ExpertMeta[]): void {
  const { ctx, bbox } = plot;
  const [xs] = chart.data;
  const base = plot.valToPos(0, "y", true);
  const ground = token("--panel");
  const xAt = (i: number) => plot.valToPos(xs[i] ?? 0, "x", true);
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  for (let s = 1; s < chart.series.length; s += 1) {
    const top = chart.data[s] ?? [];
    const floor = below(chart, s);
    const expert = expertOf(chart.series[s], experts);
    const color = expert?.color ?? themed(chart.series[s]?.stroke ?? "#999999");
    ctx.fillStyle =
      ctx.createPattern(tile(color, fillOf(expert?.fill ?? "█"), ground, devicePixelRatio), "repeat") ?? color;
    ctx.strokeStyle = ground;
    ctx.lineWidth = devicePixelRatio;
    for (const [from, to] of runs(top)) {
      ctx.beginPath();
      for (let i = from; i <= to; i += 1) ctx.lineTo(xAt(i), plot.valToPos(top[i] ?? 0, "y", true));
      for (let i = to; i >= from; i -= 1) {
        const under = floor?.[i];
        ctx.lineTo(xAt(i), typeof under === "number" ? plot.valToPos(under, "y", true) : base);
      }
      ctx.fill();
      ctx.stroke();
    }
  }
  ctx.restore();
}

type Column = ArrayLike<number | null | undefined>;

/** What a series stands on: the lower edge of the band whose upper edge it is. */
export function below(chart: Described, index: number): Column | undefined {
  const band = chart.bands.find(({ series }) => series[0] === index);
  return band === undefined ? undefined : chart.data[band.series[1]];
}

/** The expert that a series is about, by its name or its letter among the label's words. */
export function expertOf(series: Series | undefined, experts: readonly ExpertMeta[]): ExpertMeta | undefined {
  const words = (series?.label ?? "").toLowerCase().split(/\s+/);
  return experts.find(({ name, letter }) => words.includes(name) || words.includes(letter.toLowerCase()));
}

/** First and last index of each stretch without holes. */
export function runs(values: Column): [number, number][] {
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
