import { decode } from "@msgpack/msgpack";
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { Connection, SUBPROTOCOL, type Status } from "../../src/protocol/connection";
import type { Batch } from "../../src/protocol/frame";
import { type GuiUpdate, guiUpdate } from "../../src/protocol/outgoing";
import { frame } from "./golden";

/** A socket that does what the test says. */
class FakeSocket extends EventTarget {
  static readonly OPEN = 1;
  static made: FakeSocket[] = [];
  readyState = 0;
  binaryType = "";
  sent: unknown[] = [];
  constructor(
    readonly url: string,
    readonly protocols: string[],
  ) {
    super();
    FakeSocket.made.push(this);
  }
  open(): void {
    this.readyState = 1;
    this.dispatchEvent(new Event("open"));
  }
  receive(data: unknown): void {
    this.dispatchEvent(Object.assign(new Event("message"), { data }));
  }
  lose(reason = ""): void {
    this.readyState = 3;
    this.dispatchEvent(Object.assign(new Event("close"), { reason }));
  }
  send(data: unknown): void {
    this.sent.push(data);
  }
  close(): void {
    if (this.readyState !== 3) this.lose();
  }
}

let statuses: Status[];
let batches: Batch[];
let opened: number;
let there: boolean;
let connection: Connection;
const last = () => FakeSocket.made.at(-1) as FakeSocket;
const letter = (answered = false) => ({ message: guiUpdate("a", 1), answered });
const lost = () => statuses.at(-1) as Extract<Status, { kind: "lost" }>;

beforeEach(() => {
  vi.useFakeTimers();
  vi.stubGlobal("WebSocket", FakeSocket);
  vi.spyOn(console, "error").mockImplementation(() => {});
  FakeSocket.made = [];
  statuses = [];
  batches = [];
  opened = 0;
  there = false;
  const listener = {
    opened: () => (opened += 1),
    received: (batch: Batch) => batches.push(batch),
    status: (status: Status) => statuses.push(status),
  };
  connection = new Connection("ws://h/", listener, () => Promise.resolve(there));
  connection.connect();
});
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
  vi.restoreAllMocks();
});

describe("a connection", () => {
  it("asks for the protocol's version, hands on what it reads, and sends", () => {
    expect(last().protocols).toEqual([SUBPROTOCOL]);
    expect(connection.send(letter())).toBe(false);
    last().open();
    last().receive(frame("s2c_000"));
    expect([opened, batches[0]?.messages.length]).toEqual([1, 10]);
    expect(connection.send(letter())).toBe(true);
    expect(last().sent.length).toBe(1);
  });

  it("comes back when it is lost, later each time", () => {
    const waits = [];
    for (let i = 0; i < 4; i += 1) {
      last().lose();
      waits.push(lost().retryAtMs - performance.now());
      vi.advanceTimersToNextTimer();
    }
    expect(FakeSocket.made.length).toBe(5);
    for (let i = 1; i < waits.length; i += 1) expect(waits[i]).toBeGreaterThan(waits[i - 1] as number);
  });

  it("waits the least again after one that held", () => {
    for (let i = 0; i < 5; i += 1) {
      last().lose();
      vi.advanceTimersToNextTimer();
    }
    last().open();
    vi.advanceTimersByTime(10_000);
    last().lose("server ends");
    expect(lost().reason).toBe("server ends");
    expect(lost().retryAtMs - performance.now()).toBeLessThan(400);
  });

  it("gives up a socket that does not open", () => {
    vi.advanceTimersByTime(5_000);
    expect(lost().reason).toMatch(/no answer within 5 s/);
  });

  it("asks for everything again when it cannot read a frame", () => {
    last().open();
    last().receive(new ArrayBuffer(3));
    expect(lost().reason).toMatch(/3 bytes/);
    vi.advanceTimersToNextTimer();
    last().open();
    last().receive("text");
    expect(lost().reason).toMatch(/text/);
    expect(opened).toBe(2);
  });

  it("tells a server that refuses from one that is away", async () => {
    last().lose();
    expect(lost().reason).toBe("the server does not answer");
    there = true;
    await vi.advanceTimersToNextTimerAsync();
    last().lose();
    await vi.advanceTimersToNextTimerAsync();
    last().lose();
    expect(lost().reason).toMatch(/refused.*token/);
  });

  it("says all of much in order, and never more than the server hears", () => {
    last().open();
    for (let i = 0; i < 4096; i += 1) connection.send({ message: guiUpdate("a", i), answered: false });
    expect(last().sent.length).toBe(200);
    vi.advanceTimersByTime(1000);
    expect(last().sent.length).toBeLessThanOrEqual(300);
    vi.advanceTimersByTime(40_000);
    const values = last().sent.map((bytes) => (decode(bytes as Uint8Array) as GuiUpdate).updates.value);
    expect(values).toEqual(Array.from({ length: 4096 }, (_, i) => i));
  });

  it("says nothing of the rest to the next socket", () => {
    last().open();
    for (let i = 0; i < 300; i += 1) connection.send(letter());
    last().lose();
    vi.advanceTimersByTime(500);
    last().open();
    vi.advanceTimersByTime(2000);
    expect(last().sent).toEqual([]);
  });

  it("gives up a server that does not answer, without waiting for the socket's end", () => {
    last().open();
    connection.send(letter());
    vi.advanceTimersByTime(60_000);
    connection.send(letter(true));
    vi.advanceTimersByTime(5000);
    last().receive(frame("s2c_000"));
    vi.advanceTimersByTime(60_000);
    expect(statuses.at(-1)).toEqual({ kind: "open" });
    connection.send(letter(true));
    vi.spyOn(last(), "close").mockImplementation(() => {});
    vi.advanceTimersByTime(8000);
    expect(lost().reason).toBe("no answer for 8 s");
    vi.advanceTimersByTime(500);
    expect(FakeSocket.made.length).toBe(2);
  });

  it("does not listen to a socket that was replaced", () => {
    const old = last();
    connection.connect();
    old.open();
    old.receive(frame("s2c_000"));
    expect([opened, batches.length]).toEqual([0, 0]);
  });
});
