/** Numbers as people read them: a true minus, a thin number of digits, an en dash for what there is not. */

const NONE = "–";

export function fixed(value: number | null | undefined, digits: number): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return NONE;
  const text = value.toFixed(digits);
  return Number(text) === 0 ? (0).toFixed(digits) : text.replace("-", "−");
}

/** Three figures at most: `40.4`, `2.01`, `804`. */
export function short(value: number | null | undefined): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return NONE;
  const size = Math.abs(value);
  return fixed(value, size >= 100 ? 0 : size >= 10 ? 1 : 2);
}

/** A part of one as whole percent. */
export function percent(part: number | null | undefined): string {
  if (part === null || part === undefined || !Number.isFinite(part)) return NONE;
  return `${Math.round(part * 100)} %`;
}

export function withUnit(value: number | null | undefined, digits: number, unit: string): string {
  const text = fixed(value, digits);
  return text === NONE ? text : `${text} ${unit}`;
}

/** How far ahead of the rollout's start a step is; nothing at it and before, and beyond the horizon. */
export function ahead(step: number, start: number, horizon: number): string {
  return step > start && step <= start + horizon ? `+${step - start}` : "";
}
