import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { Client } from "../../src/client";
import { parsed } from "../../src/meta";
import { META, STATE } from "../../src/names";
import type { GuiUpdate, Outgoing } from "../../src/protocol/outgoing";

let sent: Outgoing[];
let answered: boolean[];
let open: boolean;
let client: Client;
const said = () => sent.map((message) => [(message as GuiUpdate).uuid, (message as GuiUpdate).updates.value]);
const text = (uuid: string, value: string) => ({
  type: "GuiTextMessage",
  uuid,
  container_uuid: "root",
  value,
  props: {},
});

beforeEach(() => {
  vi.useFakeTimers();
  [sent, answered, open] = [[], [], true];
  client = new Client((letter) => {
    if (!open) return false;
    sent.push(letter.message);
    answered.push(letter.answered);
    return true;
  });
});
afterEach(() => vi.useRealTimers());

describe("what is said to the server", () => {
  it("is the first value of a drag at once, and then the newest now and then", () => {
    vi.advanceTimersByTime(1000);
    for (let step = 1; step <= 5; step += 1) client.choose("step", step);
    expect(said()).toEqual([["step", 1]]);
    vi.advanceTimersByTime(20);
    expect(said()).toEqual([
      ["step", 1],
      ["step", 5],
    ]);
  });

  it("loses no control when two change at once", () => {
    vi.advanceTimersByTime(1000);
    client.choose("a", 1);
    client.choose("a", 2);
    client.choose("b", 3);
    vi.advanceTimersByTime(20);
    expect(said()).toEqual([
      ["a", 1],
      ["a", 2],
      ["b", 3],
    ]);
  });

  it("keeps keys in order, behind what was dragged before them, each with its number", () => {
    vi.advanceTimersByTime(1000);
    client.choose("step", 1);
    client.choose("step", 2);
    client.key("#");
    client.type("a b");
    client.line("context 5");
    expect(said()).toEqual([
      ["step", 1],
      ["step", 2],
      ["poescope-key", "##1"],
      ["poescope-key", "a#2"],
      ["poescope-key", "<space>#3"],
      ["poescope-key", "b#4"],
      ["poescope-line", "context 5#5"],
    ]);
  });

  it("counts no key that was not sent", () => {
    client.key("l");
    open = false;
    expect(client.key("l")).toBe(false);
    expect(client.lastKey).toBe(1);
    open = true;
    client.key("h");
    expect(said().at(-1)).toEqual(["poescope-key", "h#2"]);
  });

  it("is answered if it is a key, or a value that is another one", () => {
    client.store.apply([text("a", "now")]);
    client.key("l");
    client.press("play");
    for (const value of ["then", "then"]) {
      vi.advanceTimersByTime(1000);
      client.choose("a", value);
    }
    expect(answered).toEqual([true, false, true, false]);
  });
});

describe("what the server says in JSON", () => {
  it("is read once for each text", () => {
    client.store.apply([text(META, '{"step":3}')]);
    const before = client.meta;
    expect(before?.step).toBe(3);
    expect(client.meta).toBe(before);
    client.store.apply([{ type: "GuiUpdateMessage", uuid: META, updates: { value: '{"step":4}' } }]);
    expect(client.meta?.step).toBe(4);
  });

  it("may be nothing at all", () => {
    expect([parsed(""), parsed("{"), parsed("3"), parsed(undefined), parsed("null")]).toEqual(Array(5).fill(undefined));
    expect(client.meta).toBeUndefined();
    expect(client.keys).toEqual([]);
    client.store.apply([text(STATE, "v=1")]);
    expect(client.state).toBe("v=1");
  });
});
