/** The captured frames, and the one comparison that all tests of them need. */
import { createHash } from "node:crypto";
import { readFileSync } from "node:fs";

const folder = new URL("../golden/", import.meta.url);

interface Entry {
  file: string;
  types?: string[];
  timestampSec?: number;
  messages?: Record<string, unknown>[];
  message?: Record<string, unknown>;
}

export const entries: Entry[] = JSON.parse(readFileSync(new URL("index.json", folder), "utf8")).entries;

/** The bytes of the frame whose file name begins so. */
export function frame(prefix: string): ArrayBuffer {
  const entry = entries.find(({ file }) => file.startsWith(prefix));
  if (entry === undefined) throw new Error(`no golden frame ${prefix}`);
  return bytes(entry.file);
}

export function bytes(file: string): ArrayBuffer {
  const data = readFileSync(new URL(file, folder));
  return data.buffer.slice(data.byteOffset, data.byteOffset + data.byteLength) as ArrayBuffer;
}

/** A decoded value in the words of the index: bytes by their number, arrays by number and hash. */
export function described(value: unknown, expected: unknown): unknown {
  if (ArrayBuffer.isView(value)) {
    const view = new Uint8Array(value.buffer, value.byteOffset, value.byteLength);
    const words = expected as Record<string, unknown> | undefined;
    const found = {
      $bin: view.byteLength,
      $nbytes: view.byteLength,
      $sha256: createHash("sha256").update(view).digest("hex").slice(0, 16),
      $head: Buffer.from(view.subarray(0, 8)).toString("hex"),
    };
    return Object.fromEntries(
      Object.entries(words ?? {}).map(([key, word]) => [key, key in found ? found[key as keyof typeof found] : word]),
    );
  }
  if (Array.isArray(value)) {
    return value.map((item, i) => described(item, (expected as unknown[] | undefined)?.[i]));
  }
  if (typeof value === "object" && value !== null) {
    const map = expected as Record<string, unknown> | undefined;
    return Object.fromEntries(Object.entries(value).map(([key, item]) => [key, described(item, map?.[key])]));
  }
  return value;
}
