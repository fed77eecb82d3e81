/** Where a reading lies against the bounds that 95 % of well-specified experts keep: a mark, so that no hue is needed. */
import { fixed } from "./format";
import type { Bounds, NisMeta } from "./meta";

/** `▲` above the bounds, `▼` below them, nothing inside them and where there are none. */
export function mark(value: number | null, bounds: Bounds | null): "" | "▲" | "▼" {
  if (value === null || bounds === null) return "";
  if (value > bounds.high) return "▲";
  return value < bounds.low ? "▼" : "";
}

/** What the marks mean, or why there are none; empty where nothing is read. */
export function boundsNote(read: readonly NisMeta[]): string {
  if (read.length === 0) return "";
  const known = read.find(({ bounds }) => bounds !== null);
  if (known === undefined || known.bounds === null) return "NIS: no bounds where an α is neither 0 nor 1";
  const { low, high } = known.bounds;
  return `NIS ▲▼ outside 95 %: ${fixed(low, 1)}–${fixed(high, 1)}, ${known.dof} dims`;
}
