import { describe, expect, it } from "vitest";
import { boundsNote, mark } from "../../src/bounds";

const bounds = { low: 6.91, high: 28.84 };
const nis = { head: 40, propagated: 20, dof: 16, bounds };

describe("bounds", () => {
  it("mark only what lies outside", () => {
    expect([30, 20, 6.91, 1].map((value) => mark(value, bounds))).toEqual(["▲", "", "", "▼"]);
    expect([mark(null, bounds), mark(1e9, null)]).toEqual(["", ""]);
  });

  it("are said once, with their degrees of freedom", () => {
    expect(boundsNote([{ ...nis, bounds: null }, nis])).toBe("NIS ▲▼ outside 95 %: 6.9–28.8, 16 dims");
    expect(boundsNote([{ ...nis, bounds: null }])).toBe("NIS: no bounds where an α is neither 0 nor 1");
    expect(boundsNote([])).toBe("");
  });
});
