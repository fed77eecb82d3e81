import { afterEach, beforeEach, expect, it, vi } from "vitest";
import type { Client } from "../../src/client";
import { Keyboard } from "../../src/keyboard";

const line = (keys: string[], face: string | null = null) => ({ group: "", keys, label: "", help: "", face });
const KEYS = [line(["l"]), line(["<c-k>"]), line(["<f1>"], "help")];

let page: EventTarget;
let session: { answer: { n: number; mode: boolean }; keys: typeof KEYS; lastKey: number; open: boolean };
let sent: string[];
let done: string[];

/** Whether a key was taken from the browser. */
function press(key: string, more: Partial<KeyboardEvent> = {}): boolean {
  const event = new Event("keydown", { cancelable: true });
  page.dispatchEvent(Object.assign(event, { key, getModifierState: () => false, ...more }));
  return event.defaultPrevented;
}

beforeEach(() => {
  page = new EventTarget();
  vi.stubGlobal("document", page);
  vi.stubGlobal("HTMLElement", class {});
  [sent, done] = [[], []];
  session = { answer: { n: 0, mode: false }, keys: KEYS, lastKey: 0, open: true };
  const key = (name: string) => session.open && sent.push(name) > 0;
  new Keyboard(
    Object.assign(session, { key }) as unknown as Client,
    (command) => done.push(command),
    () => false,
  );
});
afterEach(() => vi.unstubAllGlobals());

it("takes the keys of the table, and nothing of the browser's", () => {
  expect([press("l"), press("z"), press("F5"), press("l", { ctrlKey: true })]).toEqual([true, false, false, false]);
  expect([press("F1"), sent, done]).toEqual([true, ["l"], ["help"]]);
});

it.each(["waiting", "in a mode"])("leaves the browser's shortcuts alone while %s", (what) => {
  if (what === "waiting") session.lastKey = 1;
  else session.answer.mode = true;
  const control = (key: string) => press(key, { ctrlKey: true });
  expect([press("F5"), press("F12"), control("l"), control("v"), control("r")]).toEqual(Array(5).fill(false));
  expect([press("z"), control("k"), press("F1"), sent]).toEqual([true, true, true, ["z", "<c-k>", "<f1>"]]);
});

it("leaves all keys that cannot be sent to the browser", () => {
  session.open = false;
  expect([press("l"), press("F5")]).toEqual([false, false]);
  session.lastKey = 1;
  expect([press("l"), press("z"), done]).toEqual([false, false, []]);
});
