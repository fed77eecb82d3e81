import { describe, expect, it } from "vitest";
import { type Pressed, keyName, namesOf } from "../../src/keys";
import { grouped } from "../../src/ui/help";

const plain: Pressed = {
  key: "",
  shiftKey: false,
  ctrlKey: false,
  altKey: false,
  metaKey: false,
  isComposing: false,
  altGraph: false,
};
const press = (key: string, more: Partial<Pressed> = {}) => keyName({ ...plain, key, ...more });

describe("names of keys", () => {
  it("are the table's", () => {
    expect([press("l"), press("G", { shiftKey: true }), press(" "), press("<", { shiftKey: true })]).toEqual([
      "l",
      "G",
      "<space>",
      "<",
    ]);
    expect(press("ArrowLeft")).toBe("<left>");
    expect(press("ArrowLeft", { shiftKey: true })).toBe("<s-left>");
    expect(press("F1")).toBe("<f1>");
    expect(press("k", { ctrlKey: true })).toBe("<c-k>");
    expect(press("k", { metaKey: true })).toBe("<c-k>");
  });

  it("know brackets of the third level, which come with Ctrl and Alt", () => {
    expect(press("[", { ctrlKey: true, altKey: true, altGraph: true })).toBe("[");
  });

  it("leave the browser its own", () => {
    expect([
      press("ArrowLeft", { altKey: true }),
      press("Dead"),
      press("Shift"),
      press("l", { isComposing: true }),
    ]).toEqual([undefined, undefined, undefined, undefined]);
    expect(press("ArrowRight", { ctrlKey: true })).toBeUndefined();
    expect(press("K", { ctrlKey: true, shiftKey: true })).toBeUndefined();
  });

  it("come one for each character of a text, and none for what is no text", () => {
    expect(namesOf("a b\n😀")).toEqual(["a", "<space>", "b", "😀"]);
  });
});

it("help groups the table's lines in its order, without what only a terminal can do", () => {
  const line = (group: string, help: string, face: string | null = null) => ({
    group,
    keys: [],
    label: "",
    help,
    face,
  });
  const groups = grouped([
    line("Time", "play"),
    line("Screen", "quit", "quit"),
    line("Time", "pause"),
    line("Screen", "keys", "help"),
  ]);
  expect(groups.map(([name, lines]) => [name, lines.map(({ help }) => help)])).toEqual([
    ["Time", ["play", "pause"]],
    ["Screen", ["keys"]],
  ]);
});
