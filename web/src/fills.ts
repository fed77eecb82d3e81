/**
 * The fills that stand for an expert without its colour. The terminal has four blocks of falling density; here they are
 * full, dense strokes, wide strokes and dots.
 */

export type Fill = "solid" | "dense" | "wide" | "dots";

const OF_BLOCK: Record<string, Fill> = { "█": "solid", "▓": "dense", "▒": "wide", "░": "dots" };

export function fillOf(block: string): Fill {
  return OF_BLOCK[block] ?? "solid";
}

/** Edge of the tile in device-independent pixels. */
const TILE = 8;

/** A tile for a canvas, at the given pixels to a pixel. */
export function tile(color: string, fill: Fill, ground: string, ratio: number): HTMLCanvasElement {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = Math.round(TILE * ratio);
  const context = canvas.getContext("2d");
  if (context === null) return canvas;
  context.scale(canvas.width / TILE, canvas.height / TILE);
  context.fillStyle = fill === "solid" || fill === "dense" ? color : ground;
  context.fillRect(0, 0, TILE, TILE);
  if (fill === "dense") strokes(context, ground, 1.4, 1);
  if (fill === "wide") strokes(context, color, 3, -1);
  if (fill === "dots") {
    context.fillStyle = color;
    for (const [x, y] of [
      [2, 2],
      [6, 6],
    ] as const) {
      context.beginPath();
      context.arc(x, y, 1.5, 0, 2 * Math.PI);
      context.fill();
    }
  }
  return canvas;
}

/** Diagonal strokes that meet across the tile's edges; `slope` 1 rises to the right. */
function strokes(context: CanvasRenderingContext2D, color: string, width: number, slope: 1 | -1): void {
  context.strokeStyle = color;
  context.lineWidth = width;
  for (const shift of [-TILE, 0, TILE]) {
    context.beginPath();
    context.moveTo(shift, slope > 0 ? TILE : 0);
    context.lineTo(shift + TILE, slope > 0 ? 0 : TILE);
    context.stroke();
  }
}
