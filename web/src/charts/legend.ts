/** A chart's legend: the strokes with their names, and the values at one place. */
import { fillOf } from "../fills";
import { short } from "../format";
import type { ExpertMeta } from "../meta";
import { themed, token } from "../theme";
import { h } from "../ui/dom";
import type { Described, Series } from "./options";
import { below, expertOf } from "./stack";

export type Drawing = "lines" | "stack" | "dimensions";

/** One element for each series that has a name; `at` is the index whose values are read. */
export function legendItems(
  chart: Described,
  drawing: Drawing,
  experts: readonly ExpertMeta[],
  at: number | undefined,
): HTMLElement[] {
  // Lines first: where there is no room for all, a band can do without its name.
  const order = chart.series
    .map((_, i) => i)
    .sort((a, b) => Number(isBand(chart, a)) - Number(isBand(chart, b)) || a - b);
  return order.flatMap((i) => {
    const series = chart.series[i] as Series;
    const band = chart.bands.find(({ series: [upper] }) => upper === i)?.fill;
    if (i === 0 || !named(series, drawing, band)) return [];
    const expert = expertOf(series, experts);
    const value = at === undefined ? undefined : valueAt(chart, drawing, i, at);
    const number = value === undefined ? [] : [" ", h("b", { class: "number" }, value)];
    return [h("span", {}, swatch(series, drawing, expert, band), series.label, ...number)];
  });
}

function isBand(chart: Described, index: number): boolean {
  return chart.series[index]?.stroke === undefined;
}

/** What is hidden, and the lower edge of a band, has no entry; the upper edge names the band. */
function named(series: Series, drawing: Drawing, band: string | undefined): boolean {
  return (
    series.show &&
    series.label !== "" &&
    (drawing === "stack" ||
      series.stroke !== undefined ||
      series.fill !== undefined ||
      (drawing === "lines" && band !== undefined))
  );
}

function swatch(
  series: Series,
  drawing: Drawing,
  expert: ExpertMeta | undefined,
  band: string | undefined,
): HTMLElement {
  if (drawing === "dimensions" && expert !== undefined) {
    const letter = h("i", { class: "letter", "aria-hidden": "true" });
    letter.style.setProperty("--c", expert.color);
    return letter;
  }
  const element = h("i", { class: "swatch", "aria-hidden": "true" });
  const own = series.stroke === undefined ? (series.fill ?? band ?? token("--dim")) : themed(series.stroke);
  element.style.setProperty("--c", expert?.color ?? own);
  if (drawing === "stack") element.dataset["fill"] = fillOf(expert?.fill ?? "█");
  else element.dataset["line"] = series.stroke === undefined ? "band" : strokeName(series.dash);
  return element;
}

function strokeName(dash: number[] | undefined): string {
  if (dash === undefined) return "solid";
  return dash.length === 2 && (dash[0] ?? 0) <= 3 ? "dotted" : "dashed";
}

function valueAt(chart: Described, drawing: Drawing, series: number, at: number): string | undefined {
  const value = chart.data[series]?.[at];
  if (typeof value !== "number") return undefined;
  if (drawing !== "stack") return short(value);
  const floor = below(chart, series)?.[at];
  return `${Math.round((value - (typeof floor === "number" ? floor : 0)) * 100)} %`;
}
