/** Colours of the server as three wants them, in this theme. */
import { Color } from "three";
import { lit } from "../theme";

export function colorOf(value: unknown): Color {
  return ink(Array.isArray(value) ? value.map(Number) : []);
}

/** Bytes of the server in the colours of this theme. */
export function ink([r = 0, g = 0, b = 0]: ArrayLike<number> & Iterable<number>): Color {
  const [red, green, blue] = lit([r, g, b]);
  return new Color(`rgb(${red}, ${green}, ${blue})`);
}
