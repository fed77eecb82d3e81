/** The page's own few signs, drawn here so that they look the same whatever letters a system has. */
import { svg } from "./dom";

const PATHS = {
  play: "M4 2.5v11l9-5.5z",
  pause: "M4 3h3v10H4zM9 3h3v10H9z",
  previous: "M10 3 5 8l5 5",
  next: "m6 3 5 5-5 5",
  commands: "m3 5 4 3-4 3M8 12h5",
  copy: "M6.5 9.5 9.5 6.5M7 5l1.6-1.6a2.6 2.6 0 0 1 3.9 3.7L10.9 8.8M9 11l-1.6 1.6a2.6 2.6 0 0 1-3.9-3.7l1.6-1.7",
  theme: "M8 2.5a5.5 5.5 0 1 0 0 11zM8 2.5a5.5 5.5 0 0 1 0 11",
  help: "M5.8 6a2.2 2.2 0 1 1 3.2 2c-.7.4-1 .8-1 1.6M8 12.2v.1",
  reset: "M3.5 8a4.5 4.5 0 1 0 1.6-3.4M3 2.8l2 2-2.4 1.4",
} as const;

const FILLED = new Set(["play", "pause"]);

export type IconName = keyof typeof PATHS;

export function icon(name: IconName): SVGSVGElement {
  const attributes = FILLED.has(name)
    ? { fill: "currentColor" }
    : {
        fill: "none",
        stroke: "currentColor",
        "stroke-width": "1.5",
        "stroke-linecap": "round",
        "stroke-linejoin": "round",
      };
  const shape = svg("path", { d: PATHS[name], ...attributes });
  const half = name === "theme" ? [svg("path", { d: "M8 2.5a5.5 5.5 0 0 1 0 11z", fill: "currentColor" })] : [];
  return svg(
    "svg",
    { viewBox: "0 0 16 16", width: "16", height: "16", "aria-hidden": "true", class: "icon" },
    shape,
    ...half,
  );
}
