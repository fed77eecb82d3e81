import { decode } from "@msgpack/msgpack";
import { describe, expect, it } from "vitest";
import { encodeMessage, guiUpdate, type Outgoing } from "../../src/protocol/outgoing";
import { bytes, entries, frame } from "./golden";

describe("what this client says", () => {
  const captured = entries.filter(({ file }) => file.startsWith("c2s"));
  it.each(captured)("packs $file as the stock client did", ({ file }) => {
    const original = new Uint8Array(bytes(file));
    expect(encodeMessage(decode(original) as Outgoing)).toEqual(original);
  });

  it("has the shape of a control's update", () => {
    const original = decode(new Uint8Array(frame("c2s_003"))) as { uuid: string; updates: { value: unknown } };
    expect(guiUpdate(original.uuid, original.updates.value)).toEqual(original);
  });
});
