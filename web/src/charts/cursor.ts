/** Upright lines over a chart: where the session's cursor is, and after what the rollout predicts. */
import type uPlot from "uplot";
import { token } from "../theme";

export function drawCursor(plot: uPlot, now: number | undefined, boundary: number | undefined): void {
  if (boundary !== undefined) upright(plot, boundary, token("--dim"), 1, [2, 3]);
  if (now !== undefined) upright(plot, now, token("--ink"), 1.5, []);
}

function upright(plot: uPlot, x: number, color: string, width: number, dash: number[]): void {
  const { ctx, bbox } = plot;
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
}
