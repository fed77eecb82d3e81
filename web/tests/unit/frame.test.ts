import { encode } from "@msgpack/msgpack";
import { describe, expect, it } from "vitest";
import { ProtocolError } from "../../src/protocol/error";
import { decodeFrame } from "../../src/protocol/frame";
import { bytes, described, entries, frame } from "./golden";

/** A zstd frame of one stored block: magic, header with a content size of four bytes, block header, the bytes. */
function stored(payload: Uint8Array): Uint8Array {
  const out = new Uint8Array(12 + payload.length);
  const view = new DataView(out.buffer);
  view.setUint32(0, 0xfd2fb528, true);
  out[4] = 0xa0;
  view.setUint32(5, payload.length, true);
  const block = (payload.length << 3) | 1;
  out.set([block & 255, (block >> 8) & 255, (block >> 16) & 255], 9);
  out.set(payload, 12);
  return out;
}

function built(payload: unknown, tail: number[] = [], change: (view: DataView) => void = () => {}): ArrayBuffer {
  const packed = encode(payload);
  const compressed = stored(packed);
  const out = new Uint8Array(16 + compressed.length + tail.length);
  const view = new DataView(out.buffer);
  view.setUint32(0, packed.length, true);
  view.setUint32(8, compressed.length, true);
  out.set(compressed, 16);
  out.set(tail, 16 + compressed.length);
  change(view);
  return out.buffer;
}

const empty = { messages: [], timestampSec: 0, binaryBufferLengths: [] };

describe("frames of the real server", () => {
  const captured = entries.filter(({ file, messages }) => file.startsWith("s2c") && messages !== undefined);
  it.each(captured)("$file", ({ file, messages, timestampSec }) => {
    const batch = decodeFrame(bytes(file));
    expect(batch.messages.map((message, i) => described(message, messages?.[i]))).toEqual(messages);
    if (timestampSec !== undefined) expect(batch.timestampSec).toBeCloseTo(timestampSec, 6);
  });

  it("gives numbers their type", () => {
    const [line] = decodeFrame(frame("s2c_059")).messages;
    const props = line?.["props"] as Record<string, unknown>;
    expect(props["points"]).toBeInstanceOf(Float32Array);
    expect(props["colors"]).toBeInstanceOf(Uint8Array);
  });
});

describe("frames that are not as they should be", () => {
  it("reads a frame of stored blocks", () => {
    expect(decodeFrame(built(empty))).toEqual({ messages: [], timestampSec: 0 });
  });

  it("refuses every truncation", () => {
    const whole = frame("s2c_059");
    for (let length = 0; length < whole.byteLength; length += 7) {
      expect(() => decodeFrame(whole.slice(0, length)), `${length} bytes`).toThrow(ProtocolError);
    }
  });

  it("says both lengths where they differ", () => {
    const wrong = built(empty, [], (view) => view.setUint32(0, 7, true));
    expect(() => decodeFrame(wrong)).toThrow(/has \d+ bytes, the header says 7/);
    const huge = built(empty, [], (view) => view.setUint32(4, 1, true));
    expect(() => decodeFrame(huge)).toThrow(/2³²/);
  });

  it("refuses a payload that is not compressed, and one without messages", () => {
    const plain = built(empty, [], (view) => view.setUint32(16, 0, true));
    expect(() => decodeFrame(plain)).toThrow(/zstd/);
    expect(() => decodeFrame(built({ messages: [{ no: "type" }] }))).toThrow(/type/);
    expect(() => decodeFrame(built([1]))).toThrow(ProtocolError);
  });

  it("refuses unknown numbers and buffers that are not there", () => {
    const asking = (index: number, dtype: string) => ({
      messages: [{ type: "X", data: { __binary_index: index, dtype } }],
      timestampSec: 0,
      binaryBufferLengths: [],
    });
    expect(() => decodeFrame(built(asking(0, "<f4")))).toThrow(/buffer 0 of 0/);
    const one = { ...asking(0, "<i8"), binaryBufferLengths: [0] };
    expect(() => decodeFrame(built(one, [0, 0, 0, 0, 0, 0, 0, 0]))).toThrow(/<i8/);
  });
});
