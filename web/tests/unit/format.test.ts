import { describe, expect, it } from "vitest";
import { ahead, fixed, percent, short, withUnit } from "../../src/format";

describe("numbers", () => {
  it("have a true minus and no minus zero", () => {
    expect(fixed(-1.25, 1)).toBe("−1.3");
    expect(fixed(-0.01, 1)).toBe("0.0");
  });

  it("say when there is none", () => {
    for (const none of [null, undefined, NaN, Infinity]) {
      expect([fixed(none, 1), short(none), percent(none), withUnit(none, 1, "dB")]).toEqual(["–", "–", "–", "–"]);
    }
  });

  it("have three figures at most", () => {
    expect([0.004, 2.013, 40.42, 804.2, -12.34].map(short)).toEqual(["0.00", "2.01", "40.4", "804", "−12.3"]);
  });

  it("count steps ahead of the rollout's start", () => {
    expect([ahead(8, 3, 11), ahead(3, 3, 11), ahead(0, 3, 11), ahead(15, 3, 11)]).toEqual(["+5", "", "", ""]);
    expect(percent(0.216)).toBe("22 %");
    expect(withUnit(31.24, 1, "dB")).toBe("31.2 dB");
  });
});
