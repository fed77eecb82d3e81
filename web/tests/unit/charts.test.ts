import { describe, expect, it } from "vitest";
import { described, shapeOf } from "../../src/charts/options";
import { below, expertOf, runs } from "../../src/charts/stack";
import type { ExpertMeta } from "../../src/meta";
import { decodeFrame } from "../../src/protocol/frame";
import { Store } from "../../src/state/store";
import { frame } from "./golden";

function chart(...prefixes: string[]) {
  const store = new Store();
  for (const prefix of prefixes) store.apply(decodeFrame(frame(prefix)).messages);
  const [element] = store.gui.values();
  return described(element?.props ?? {});
}

describe("a chart of the real server", () => {
  it("has its series, bands and labels", () => {
    const rich = chart("s2c_026");
    expect(rich?.series.map(({ label }) => label)).toEqual(["t", "mean", "hi", "lo"]);
    expect(rich?.series[2]).toMatchObject({ stroke: undefined, fill: "rgba(31,119,180,0.2)" });
    expect(rich?.bands).toEqual([{ series: [2, 3], fill: "rgba(31,119,180,0.2)" }]);
    expect([rich?.xLabel, rich?.yLabel, rich?.data.length, rich?.data[0].length]).toEqual(["step", "value", 4, 64]);
  });

  it("takes new data without being made anew", () => {
    const [before, after] = [chart("s2c_025"), chart("s2c_025", "s2c_036")];
    expect(after?.data[1]).not.toEqual(before?.data[1]);
    expect(shapeOf(after as NonNullable<typeof after>)).toBe(shapeOf(before as NonNullable<typeof before>));
    expect(before?.ranges).toEqual({ y: [-1.5, 1.5] });
  });

  it("has holes where a number is none", () => {
    const [, values = []] = chart("s2c_025", "s2c_037")?.data ?? [];
    expect(Array.from(values).filter((value) => value === null).length).toBeGreaterThan(0);
  });
});

describe("what a server may say of a chart", () => {
  const props = (more: Record<string, unknown>) => ({
    data: [new Float64Array([1, 2]), [0.5, null], [1, Infinity], [0, 0]],
    series: [{ label: "step" }, { label: "V vision", stroke: "#0072B2" }, { label: "now" }, { label: "D prior" }],
    bands: [{ series: [1, 3] }],
    ...more,
  });

  it("leaves out its own cursor, and finds its bands again", () => {
    const found = described(props({}));
    expect(found?.series.map(({ label }) => label)).toEqual(["step", "V vision", "D prior"]);
    expect(found?.bands).toEqual([{ series: [1, 2], fill: undefined }]);
    expect(found?.data[1]).toEqual([0.5, null]);
  });

  it("draws nothing of columns that do not fit", () => {
    expect(described(props({ data: [[1, 2], [1], [1, 2], [1, 2]] }))).toBeUndefined();
    expect(described(props({ data: [[], [], [], []] }))).toBeUndefined();
    expect(described({})).toBeUndefined();
  });

  it("stacks a series on the lower edge of its band", () => {
    const found = described(props({}));
    if (found === undefined) throw new Error("no chart");
    expect(below(found, 1)).toEqual([0, 0]);
    expect(below(found, 2)).toBeUndefined();
  });

  it("knows an expert by name or letter", () => {
    const experts = [
      { name: "vision", letter: "V" },
      { name: "prior", letter: "D" },
    ] as ExpertMeta[];
    const series = (label: string) => ({ label }) as Parameters<typeof expertOf>[0];
    expect(["V vision", "prior", "D", "belief", ""].map((label) => expertOf(series(label), experts)?.letter)).toEqual([
      "V",
      "D",
      "D",
      undefined,
      undefined,
    ]);
  });

  it("breaks a line at its holes", () => {
    expect(runs([null, 1, 2, null, 3])).toEqual([
      [1, 2],
      [4, 4],
    ]);
    expect(runs([])).toEqual([]);
  });
});
