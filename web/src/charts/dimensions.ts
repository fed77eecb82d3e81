/** The latent dimensions side by side: the belief with its ±1σ, each expert's mean as its letter. Nothing joins them. */
import type uPlot from "uplot";
import type { ExpertMeta } from "../meta";
import { readable, token } from "../theme";
import type { Described } from "./options";
import { expertOf } from "./stack";

export function drawDimensions(plot: uPlot, chart: Described, experts: readonly ExpertMeta[]): void {
  const { ctx, bbox } = plot;
  const ratio = devicePixelRatio;
  const [xs] = chart.data;
  const [edges] = chart.bands;
  const lettered = chart.series.map((series) => expertOf(series, experts));
  const mean = chart.series.findIndex((series, i) => i > 0 && series.stroke !== undefined && lettered[i] === undefined);
  const yAt = (series: number | undefined, i: number) => {
    const value = series === undefined ? undefined : chart.data[series]?.[i];
    return typeof value === "number" ? plot.valToPos(value, "y", true) : undefined;
  };
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  ctx.textAlign = "center";
  ctx.textBaseline = "middle";
  ctx.font = `600 ${9.5 * ratio}px ui-monospace, "DejaVu Sans Mono", monospace`;
  for (let i = 0; i < xs.length; i += 1) {
    const x = plot.valToPos(xs[i] ?? 0, "x", true);
    const [high, low] = [yAt(edges?.series[0], i), yAt(edges?.series[1], i)];
    const middle = yAt(mean, i);
    ctx.fillStyle = token("--dim");
    if (high !== undefined && low !== undefined) ctx.fillRect(x - ratio, high, 2 * ratio, Math.max(low - high, ratio));
    ctx.fillStyle = token("--ink");
    if (middle !== undefined) ctx.fillRect(x - 5 * ratio, middle - ratio, 10 * ratio, 2 * ratio);
    // Letters stand to the right, one place each, so that they do not cover one another.
    let place = 0;
    lettered.forEach((expert, s) => {
      if (expert === undefined) return;
      place += 1;
      const y = yAt(s, i);
      if (y === undefined) return;
      ctx.fillStyle = readable(expert.color);
      ctx.fillText(expert.letter, x + (2 + place * 6) * ratio, y);
    });
  }
  ctx.restore();
}
