/** Colours as numbers. */

export type Rgb = [number, number, number];

/** The contrast of two colours as WCAG 2 counts it, from 1 to 21. */
export function contrast(a: Rgb, b: Rgb): number {
  const [low, high] = [luminance(a), luminance(b)].sort((x, y) => x - y) as [number, number];
  return (high + 0.05) / (low + 0.05);
}

function luminance(rgb: Rgb): number {
  const [r, g, b] = rgb.map((channel) => {
    const part = channel / 255;
    return part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4;
  }) as Rgb;
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

/** Red, green and blue from 0 to 255 of `#rgb`, `#rrggbb`, `rgb(…)`, `black`, `white`. */
export function rgbOf(css: string): Rgb | undefined {
  if (css === "black") return [0, 0, 0];
  if (css === "white") return [255, 255, 255];
  const long = /^#([0-9a-f]{2})([0-9a-f]{2})([0-9a-f]{2})$/i.exec(css);
  if (long) return [1, 2, 3].map((i) => parseInt(long[i] ?? "", 16)) as Rgb;
  const brief = /^#([0-9a-f])([0-9a-f])([0-9a-f])$/i.exec(css);
  if (brief) return [1, 2, 3].map((i) => parseInt(`${brief[i]}${brief[i]}`, 16)) as Rgb;
  const call = /^rgba?\(([^)]*)\)$/.exec(css);
  const parts = call?.[1]
    ?.split(/[\s,/]+/)
    .filter(Boolean)
    .map(Number);
  return parts && parts.length >= 3 && parts.slice(0, 3).every(Number.isFinite)
    ? (parts.slice(0, 3) as Rgb)
    : undefined;
}
