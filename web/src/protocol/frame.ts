/**
 * One websocket message of the server: its header, the compressed payload, and the buffers behind it.
 *
 * | offset | size | content |
 * | 0      | 8    | u64: length of the payload before compression |
 * | 8      | 8    | u64: length N of the zstd frame |
 * | 16     | N    | the zstd frame |
 * | 16 + N | …    | zeros up to a multiple of 8, buffer 0, zeros, buffer 1, … |
 *
 * All little endian; multiples count from the start of the message.
 */
import { decode } from "@msgpack/msgpack";
import { decompress } from "fzstd";
import { fillBuffers } from "./buffers";
import { ProtocolError } from "./error";

const HEADER_BYTES = 16;
/** Larger payloads are not of this tool: a 64 × 64 frame at any scale, and a chart, stay far below. */
const MAX_PAYLOAD_BYTES = 64 * 1024 * 1024;

/** A message as it was on the wire: `type` and the fields of that type. */
export interface Message {
  type: string;
  [field: string]: unknown;
}

/** What arrives at once and is applied at once. */
export interface Batch {
  messages: Message[];
  /** The server's clock in seconds; only differences mean anything. */
  timestampSec: number;
}

/** Reads one binary websocket message; throws a `ProtocolError` that names both numbers where something does not fit. */
export function decodeFrame(data: ArrayBuffer): Batch {
  if (data.byteLength < HEADER_BYTES) {
    throw new ProtocolError(`a frame of ${data.byteLength} bytes has no header of ${HEADER_BYTES}`);
  }
  const view = new DataView(data);
  const payloadBytes = readLength(view, 0);
  const compressedBytes = readLength(view, 8);
  if (payloadBytes > MAX_PAYLOAD_BYTES) {
    throw new ProtocolError(`a payload of ${payloadBytes} bytes; ${MAX_PAYLOAD_BYTES} is the most`);
  }
  const end = HEADER_BYTES + compressedBytes;
  if (end > data.byteLength) {
    throw new ProtocolError(`the payload ends at byte ${end} of ${data.byteLength}`);
  }
  const payload = inflate(new Uint8Array(data, HEADER_BYTES, compressedBytes), payloadBytes);
  const batch = asBatch(decode(payload));
  const buffers = sliceBuffers(data, end, batch.binaryBufferLengths);
  return {
    messages: batch.messages.map((message) => fillBuffers(message, buffers) as Message),
    timestampSec: batch.timestampSec,
  };
}

function readLength(view: DataView, offset: number): number {
  const high = view.getUint32(offset + 4, true);
  if (high !== 0) {
    throw new ProtocolError(`a length of ${high} × 2³² bytes`);
  }
  return view.getUint32(offset, true);
}

function inflate(compressed: Uint8Array, expected: number): Uint8Array {
  let payload: Uint8Array;
  try {
    payload = decompress(compressed);
  } catch (error) {
    throw new ProtocolError(`the payload is no zstd frame: ${String(error)}`);
  }
  if (payload.byteLength !== expected) {
    throw new ProtocolError(`the payload has ${payload.byteLength} bytes, the header says ${expected}`);
  }
  return payload;
}

interface Payload extends Batch {
  binaryBufferLengths: number[];
}

function asBatch(value: unknown): Payload {
  if (typeof value !== "object" || value === null) {
    throw new ProtocolError("the payload is no map");
  }
  const { messages, timestampSec, binaryBufferLengths } = value as Record<string, unknown>;
  if (!Array.isArray(messages) || !messages.every(isMessage)) {
    throw new ProtocolError("the payload has no list of messages with a type");
  }
  const lengths = binaryBufferLengths ?? [];
  if (!Array.isArray(lengths) || !lengths.every((n) => Number.isSafeInteger(n) && n >= 0)) {
    throw new ProtocolError("the payload's buffer lengths are no list of lengths");
  }
  return {
    messages,
    timestampSec: typeof timestampSec === "number" ? timestampSec : 0,
    binaryBufferLengths: lengths as number[],
  };
}

function isMessage(value: unknown): value is Message {
  return typeof value === "object" && value !== null && typeof (value as Message).type === "string";
}

function sliceBuffers(data: ArrayBuffer, end: number, lengths: number[]): ArrayBuffer[] {
  let offset = end;
  return lengths.map((length, i) => {
    offset = Math.ceil(offset / 8) * 8;
    if (offset + length > data.byteLength) {
      throw new ProtocolError(`buffer ${i} ends at byte ${offset + length} of ${data.byteLength}`);
    }
    // A copy of its own: whoever keeps an array does not keep the whole message.
    const buffer = data.slice(offset, offset + length);
    offset += length;
    return buffer;
  });
}
