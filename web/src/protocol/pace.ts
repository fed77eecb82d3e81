/**
 * Does one thing after the other, no faster than the server listens: it ends a connection that says too much
 * (`src/web/server/limits.rs`).
 */

/** Half of what the server allows: what was held up on its way arrives at once. */
const AT_ONCE = 200;
const A_SECOND = 100;

export class Pace {
  #waiting: (() => void)[] = [];
  #left = AT_ONCE;
  #sinceMs = performance.now();
  #timer: ReturnType<typeof setTimeout> | undefined;

  /** At once if nothing waits, else behind what does. */
  push(act: () => void): void {
    this.#waiting.push(act);
    this.#go();
  }

  /** Forgets what waits. */
  clear(): void {
    clearTimeout(this.#timer);
    this.#timer = undefined;
    this.#waiting = [];
  }

  #go(): void {
    const nowMs = performance.now();
    this.#left = Math.min(AT_ONCE, this.#left + ((nowMs - this.#sinceMs) * A_SECOND) / 1000);
    this.#sinceMs = nowMs;
    const due = this.#waiting.splice(0, Math.floor(this.#left));
    this.#left -= due.length;
    due.forEach((act) => act());
    if (this.#waiting.length === 0) return;
    this.#timer ??= setTimeout(() => {
      this.#timer = undefined;
      this.#go();
    }, 1000 / A_SECOND);
  }
}
