/** How long to wait before the next attempt: doubling, with a little chance so that sixty viewers do not knock at once. */

const FIRST_MS = 250;
const MOST_MS = 8000;

/** Milliseconds to wait after so many attempts that failed in a row; `chance` is from 0 to 1. */
export function backoffMs(failures: number, chance: number): number {
  const whole = Math.min(MOST_MS, FIRST_MS * 2 ** Math.max(0, failures - 1));
  return Math.round(whole * (0.75 + 0.5 * chance));
}
