/** Number arrays: the payload holds `{__binary_index, dtype}`, the numbers stand behind it. */
import { ProtocolError } from "./error";

type Numbers =
  Float32Array | Float64Array | Uint8Array | Int8Array | Uint16Array | Int16Array | Uint32Array | Int32Array;

const VIEWS: Record<string, { new (buffer: ArrayBuffer): Numbers; BYTES_PER_ELEMENT: number }> = {
  "<f4": Float32Array,
  "<f8": Float64Array,
  // The bits of half floats, as in the stock client; nothing here draws them.
  "<f2": Uint16Array,
  "|u1": Uint8Array,
  "|i1": Int8Array,
  "<u2": Uint16Array,
  "<i2": Int16Array,
  "<u4": Uint32Array,
  "<i4": Int32Array,
};

/** The value with every placeholder in it, at any depth, replaced by its numbers. */
export function fillBuffers(value: unknown, buffers: ArrayBuffer[]): unknown {
  if (Array.isArray(value)) {
    return value.map((item) => fillBuffers(item, buffers));
  }
  if (typeof value !== "object" || value === null || ArrayBuffer.isView(value)) {
    return value;
  }
  const map = value as Record<string, unknown>;
  if ("__binary_index" in map && "dtype" in map) {
    return numbersOf(buffers, map["__binary_index"], map["dtype"]);
  }
  return Object.fromEntries(Object.entries(map).map(([key, item]) => [key, fillBuffers(item, buffers)]));
}

function numbersOf(buffers: ArrayBuffer[], index: unknown, dtype: unknown): Numbers {
  const buffer = buffers[Number(index)];
  if (buffer === undefined) {
    throw new ProtocolError(`buffer ${String(index)} of ${buffers.length} is asked for`);
  }
  const View = VIEWS[String(dtype)];
  if (View === undefined) {
    throw new ProtocolError(`numbers of type ${String(dtype)}; known are ${Object.keys(VIEWS).join(" ")}`);
  }
  if (buffer.byteLength % View.BYTES_PER_ELEMENT !== 0) {
    throw new ProtocolError(`${buffer.byteLength} bytes are no whole number of ${String(dtype)}`);
  }
  return new View(buffer);
}
