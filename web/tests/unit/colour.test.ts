import { readFileSync } from "node:fs";
import { describe, expect, it } from "vitest";
import { type Rgb, contrast, rgbOf } from "../../src/colour";
import { TERMS, pieces } from "../../src/formulas";

const css = readFileSync(new URL("../../src/style/tokens.css", import.meta.url), "utf8");

/** The tokens of one theme. */
function tokens(selector: string): Record<string, string> {
  const block = css.slice(css.indexOf(`${selector} {`)).split("}")[0] ?? "";
  return Object.fromEntries([...block.matchAll(/(--[\w-]+): ([^;]+);/g)].map(([, name, value]) => [name, value]));
}

describe.each([":root", ':root[data-theme="dark"]'])("the theme %s", (selector) => {
  const token = tokens(selector);
  const rgb = (name: string) => rgbOf(token[name] ?? "") as Rgb;

  it.each(["--ink", "--dim", "--warn"])("has %s that can be read on every ground", (text) => {
    for (const ground of ["--panel", "--ground", "--grid"])
      expect(contrast(rgb(text), rgb(ground)), ground).toBeGreaterThan(4.5);
  });
});

it("counts contrast as WCAG does", () => {
  expect(contrast([0, 0, 0], [255, 255, 255])).toBeCloseTo(21, 5);
  expect(contrast([0x77, 0x77, 0x77], [255, 255, 255])).toBeCloseTo(4.48, 2);
});

it("reads the colours that servers write", () => {
  expect(["#0072B2", "#fff", "rgb(1, 2, 3)", "rgba(1,2,3,0.4)", "rgb(1 2 3 / 0.4)", "black"].map(rgbOf)).toEqual([
    [0, 114, 178],
    [255, 255, 255],
    [1, 2, 3],
    [1, 2, 3],
    [1, 2, 3],
    [0, 0, 0],
  ]);
  expect(rgbOf("transparent")).toBeUndefined();
});

it("writes every formula in pieces that join to what is there", () => {
  expect(pieces("s_{i,d} ^{−1}x")).toEqual([
    { text: "s", place: "base" },
    { text: "i,d", place: "sub" },
    { text: " ", place: "base" },
    { text: "−1", place: "sup" },
    { text: "x", place: "base" },
  ]);
  for (const term of Object.values(TERMS)) {
    if ("formula" in term)
      expect(
        pieces(term.formula)
          .map(({ text }) => text)
          .join(""),
      ).not.toMatch(/[_^{}]/);
  }
});
