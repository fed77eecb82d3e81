/** From a chart as the server describes it to uPlot's options in this page's colours. Plain data in, plain data out. */
import type uPlot from "uplot";
import { mapOf } from "../state/gui";

/** One line, band edge or point series of a chart. */
export interface Series {
  label: string;
  stroke: string | undefined;
  fill: string | undefined;
  width: number;
  dash: number[] | undefined;
  /** Drawn at all; a band's edge may not be. */
  show: boolean;
  points: boolean;
}

export interface Band {
  series: [number, number];
  fill: string | undefined;
}

export interface Described {
  title: string;
  /** The first is x. */
  series: Series[];
  bands: Band[];
  data: uPlot.AlignedData;
  /** Ranges that the server fixes, by scale. */
  ranges: Record<string, [number | null, number | null]>;
  xLabel: string;
  yLabel: string;
}

/** The server's last series of this name is its own cursor; the page draws one itself. */
const CURSOR_SERIES = "now";

/** Reads the props of a `GuiUplotMessage`; nothing where there are no data to draw. */
export function described(props: Readonly<Record<string, unknown>>): Described | undefined {
  const columns = listOf(props["data"]).map(column);
  const series = listOf(props["series"]).map(seriesOf);
  const kept = series.map((_, i) => i).filter((i) => i === 0 || series[i]?.label !== CURSOR_SERIES);
  const count = columns[0]?.length ?? 0;
  if (series.length < 2 || columns.length !== series.length || count === 0) return undefined;
  if (columns.some((values) => values.length !== count)) return undefined;
  const place = new Map(kept.map((old, now) => [old, now]));
  const bands = listOf(props["bands"]).flatMap((band) => {
    const map = mapOf(band);
    const pair = listOf(map?.["series"]).map((i) => place.get(Number(i)));
    const [upper, lower] = pair;
    return upper === undefined || lower === undefined
      ? []
      : [{ series: [upper, lower] as [number, number], fill: textOf(map?.["fill"]) }];
  });
  const axes = listOf(props["axes"]).map(mapOf);
  return {
    title: textOf(props["title"]) ?? "",
    series: kept.map((i) => series[i] as Series),
    bands,
    data: kept.map((i) => columns[i]) as uPlot.AlignedData,
    ranges: rangesOf(mapOf(props["scales"]) ?? {}),
    xLabel: textOf(axes[0]?.["label"]) ?? "",
    yLabel: textOf(axes[1]?.["label"]) ?? "",
  };
}

/** What makes a new chart necessary; without it new data are enough. */
export function shapeOf({ series, bands, ranges, xLabel, yLabel }: Described): string {
  return JSON.stringify([series, bands, ranges, xLabel, yLabel]);
}

/** Numbers with holes where they are not finite: uPlot draws over NaN, and one infinity blanks a chart. */
function column(value: unknown): (number | null)[] {
  const numbers: ArrayLike<unknown> =
    Array.isArray(value) || ArrayBuffer.isView(value) ? (value as unknown as ArrayLike<unknown>) : [];
  return Array.from(numbers, (n) => (typeof n === "number" && Number.isFinite(n) ? n : null));
}

function seriesOf(value: unknown): Series {
  const map = mapOf(value) ?? {};
  const dash = listOf(map["dash"]).filter((n): n is number => typeof n === "number");
  const stroke = textOf(map["stroke"]);
  return {
    label: textOf(map["label"]) ?? "",
    stroke: stroke === "transparent" ? undefined : stroke,
    fill: textOf(map["fill"]),
    width: typeof map["width"] === "number" ? map["width"] : 1.5,
    dash: dash.length > 0 ? dash : undefined,
    show: map["show"] !== false,
    points: mapOf(map["points"])?.["show"] === true,
  };
}

function rangesOf(scales: Record<string, unknown>): Described["ranges"] {
  return Object.fromEntries(
    Object.entries(scales).flatMap(([name, scale]) => {
      const range = mapOf(scale)?.["range"];
      if (!Array.isArray(range) || range.length !== 2) return [];
      const [low, high] = range.map((n) => (typeof n === "number" ? n : null));
      return [[name, [low ?? null, high ?? null]]];
    }),
  );
}

function listOf(value: unknown): unknown[] {
  return Array.isArray(value) ? value : [];
}

function textOf(value: unknown): string | undefined {
  return typeof value === "string" && value !== "" ? value : undefined;
}
