/** Dark or light: as the system says, until somebody chooses; and the colours that drawings need of it. */

export type Theme = "dark" | "light";

const STORED = "poescope-theme";
const system = matchMedia("(prefers-color-scheme: dark)");

type Listener = (theme: Theme) => void;
const listeners: Listener[] = [];

export function theme(): Theme {
  const chosen = stored();
  return chosen ?? (system.matches ? "dark" : "light");
}

export function toggleTheme(): void {
  const next: Theme = theme() === "dark" ? "light" : "dark";
  try {
    // What the system says anyway is not a choice; it may change with the hour.
    if (next === (system.matches ? "dark" : "light")) localStorage.removeItem(STORED);
    else localStorage.setItem(STORED, next);
  } catch {
    // A browser that keeps nothing: the choice holds until the page is closed.
    forced = next;
  }
  apply();
}

export function onTheme(listener: Listener): void {
  listeners.push(listener);
}

let forced: Theme | undefined;

function stored(): Theme | undefined {
  try {
    const value = localStorage.getItem(STORED);
    if (value === "dark" || value === "light") return value;
  } catch {
    // As above.
  }
  return forced;
}

function apply(): void {
  const now = theme();
  document.documentElement.dataset["theme"] = now;
  listeners.forEach((listener) => listener(now));
}

/** To be called once, before anything is drawn. */
export function startTheme(): void {
  system.addEventListener("change", apply);
  apply();
}

/** A custom property of the style sheet: `--ink`. */
export function token(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

/** Whether movement was asked to be kept small. */
export function reducedMotion(): boolean {
  return matchMedia("(prefers-reduced-motion: reduce)").matches;
}

/**
 * A colour of the server in this theme. Near-black and near-white stand for the foreground, whose ink it then is; all
 * others are the modalities' own and stay.
 */
export function themed(css: string): string {
  const rgb = rgbOf(css);
  if (rgb === undefined) return css;
  const [low, high] = [Math.min(...rgb), Math.max(...rgb)];
  const grey = high - low < 24;
  return grey && (high < 64 || low > 216) ? token("--ink") : css;
}

/** Red, green and blue from 0 to 255 of `#rgb`, `#rrggbb`, `rgb(…)`, `black`, `white`. */
export function rgbOf(css: string): [number, number, number] | undefined {
  if (css === "black") return [0, 0, 0];
  if (css === "white") return [255, 255, 255];
  const long = /^#([0-9a-f]{2})([0-9a-f]{2})([0-9a-f]{2})$/i.exec(css);
  if (long) return [1, 2, 3].map((i) => parseInt(long[i] ?? "", 16)) as [number, number, number];
  const brief = /^#([0-9a-f])([0-9a-f])([0-9a-f])$/i.exec(css);
  if (brief) return [1, 2, 3].map((i) => parseInt(`${brief[i]}${brief[i]}`, 16)) as [number, number, number];
  const call = /^rgba?\(([^)]*)\)$/.exec(css);
  const parts = call?.[1]?.split(/[\s,/]+/).filter(Boolean).map(Number);
  return parts && parts.length >= 3 && parts.slice(0, 3).every(Number.isFinite)
    ? (parts.slice(0, 3) as [number, number, number])
    : undefined;
}
