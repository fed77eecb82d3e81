/** Dark or light: as the system says, until somebody chooses; and the colours that drawings need of it. */
import { type Rgb, contrast, rgbOf } from "./colour";

export type Theme = "dark" | "light";

const STORED = "poescope-theme";
const system = () => matchMedia("(prefers-color-scheme: dark)");

/** What was chosen in a browser that keeps nothing. */
let forced: Theme | undefined;

type Listener = (theme: Theme) => void;
const listeners: Listener[] = [];

export function theme(): Theme {
  const chosen = stored();
  return chosen ?? (system().matches ? "dark" : "light");
}

export function toggleTheme(): void {
  const next: Theme = theme() === "dark" ? "light" : "dark";
  try {
    // What the system says anyway is not a choice; it may change with the hour.
    if (next === (system().matches ? "dark" : "light")) localStorage.removeItem(STORED);
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
  system().addEventListener("change", apply);
  apply();
}

/** A custom property of the style sheet: `--ink`. */
export function token(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

/** The grey that the server gives to what is to be seen on light and on dark: the belief. */
const EITHER = "#7a7a7a";

/** A colour of the server's charts in this theme: what stands for the foreground is ink, all others stay. */
export function themed(css: string): string {
  const rgb = rgbOf(css);
  if (rgb === undefined) return css;
  const [low, high] = [Math.min(...rgb), Math.max(...rgb)];
  const foreground = high - low < 24 && (high < 64 || low > 216);
  return foreground || css.toLowerCase() === EITHER ? token("--ink") : css;
}

/** A colour of the server's scene in this theme: in the dark, greys are turned over, so that the table does not glare. */
export function lit(rgb: Rgb): Rgb {
  const [low, high] = [Math.min(...rgb), Math.max(...rgb)];
  if (theme() === "light" || high - low >= 24) return rgb;
  // Twice the middle on the other side of half: lightness turned over, the tint as it was.
  const shift = 255 - (low + high);
  return rgb.map((channel) => Math.round(channel + shift)) as Rgb;
}

/** A colour for letters: moved towards the ink until it can be read on a panel. */
export function readable(css: string): string {
  const [color, ink, ground] = [css, token("--ink"), token("--panel")].map(rgbOf);
  if (color === undefined || ink === undefined || ground === undefined) return css;
  for (let part = 0; part < 1; part += 0.1) {
    const mixed = color.map((channel, i) => Math.round(channel + ((ink[i] ?? 0) - channel) * part)) as Rgb;
    if (contrast(mixed, ground) >= 4.5) return `rgb(${mixed.join(" ")})`;
  }
  return token("--ink");
}
