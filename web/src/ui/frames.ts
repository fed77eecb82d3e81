/** The images at the cursor, unsmoothed and at whole multiples of their pixels. */
import type { Client } from "../client";
import { ahead, fixed, withUnit } from "../format";
import type { Meta } from "../meta";
import { FRAMES, type FrameName, frameOf } from "../names";
import { h, setHidden, setText } from "./dom";
import { explained } from "./term";

export class Frames {
  readonly element = h("section", {
    class: "pane frames",
    "data-pane": "frames",
    "aria-label": "Frames",
    tabindex: "0",
  });
  readonly #client: Client;
  readonly #slots: Slot[];

  constructor(client: Client) {
    this.#client = client;
    this.#slots = FRAMES.map((name) => new Slot(name));
    this.element.append(...this.#slots.map((slot) => slot.element));
  }

  update(): void {
    const { meta } = this.#client;
    for (const slot of this.#slots) slot.update(this.#client, meta);
    this.element.classList.toggle("stale", meta?.current === false);
  }
}

class Slot {
  readonly element: HTMLElement;
  readonly #name: FrameName;
  readonly #canvas: HTMLCanvasElement;
  readonly #empty = h("p", { class: "empty" });
  readonly #title = h("span", { class: "title" });
  readonly #note = h("span", { class: "note number" });
  /** The bytes that are drawn or being decoded. */
  #data: unknown;
  /** Images may be decoded out of order; only the newest is drawn. */
  #turn = 0;

  constructor(name: FrameName) {
    this.#name = name;
    this.#canvas = h("canvas", { role: "img", width: "256", height: "256", id: `frame-${name}` });
    const caption = h("figcaption", {}, h("span", explained(name), this.#title), this.#note);
    this.element = h(
      "figure",
      { class: `frame frame-${name}` },
      caption,
      h("div", { class: "picture" }, this.#canvas, this.#empty),
    );
  }

  update(client: Client, meta: Meta | undefined): void {
    const gui = client.element(frameOf(this.#name));
    const data = gui?.props["visible"] === false ? undefined : gui?.props["_data"];
    const bytes = data instanceof Uint8Array && data.byteLength > 0 ? data : undefined;
    setHidden(this.element, this.#name === "input" && bytes === undefined);
    setText(this.#title, TITLES[this.#name]);
    setText(this.#note, meta === undefined ? "" : noteOf(this.#name, meta, String(gui?.props["label"] ?? "")));
    setText(this.#empty, bytes === undefined ? whyEmpty(this.#name, meta) : "");
    setHidden(this.#canvas, bytes === undefined);
    this.#canvas.setAttribute("aria-label", `${TITLES[this.#name]} ${this.#note.textContent ?? ""}`);
    if (bytes !== this.#data) {
      this.#data = bytes;
      this.#turn += 1;
      if (bytes !== undefined)
        void this.#draw(bytes as Uint8Array<ArrayBuffer>, String(gui?.props["_format"] ?? "png"), this.#turn);
    }
  }

  async #draw(bytes: Uint8Array<ArrayBuffer>, format: string, turn: number): Promise<void> {
    try {
      const image = await createImageBitmap(new Blob([bytes], { type: `image/${format}` }));
      if (turn === this.#turn) {
        const { width, height } = image;
        if (this.#canvas.width !== width) this.#canvas.width = width;
        if (this.#canvas.height !== height) this.#canvas.height = height;
        const context = this.#canvas.getContext("2d");
        if (context !== null) {
          context.imageSmoothingEnabled = false;
          context.drawImage(image, 0, 0);
        }
      }
      image.close();
    } catch {
      if (turn === this.#turn) setText(this.#empty, "this image cannot be read");
    }
  }
}

const TITLES: Record<FrameName, string> = {
  truth: "truth",
  input: "input, damaged",
  belief: "belief",
  prediction: "prediction",
  error: "error",
};

function noteOf(name: FrameName, meta: Meta, label: string): string {
  switch (name) {
    case "belief":
      return withUnit(meta.psnr_db?.belief, 1, "dB").replace("–", "");
    case "prediction":
      return [ahead(meta.step, meta.start, meta.horizon), withUnit(meta.psnr_db?.prediction, 1, "dB").replace("–", "")]
        .join(" ")
        .trim();
    case "error": {
      // `error of belief: blue −0.5, orange +0.5`
      const range = /\+([\d.]+)/.exec(label)?.[1];
      return `${range === undefined ? "" : `±${range}`} ${meta.error_of}`.trim();
    }
    default:
      return "";
  }
}

function whyEmpty(name: FrameName, meta: Meta | undefined): string {
  if (meta === undefined || meta.episode === null) return "";
  if (meta.episode.missing.length > 0)
    return name === "truth" ? "no frame" : "the recording lacks what the model needs";
  if (name === "prediction") {
    const first = meta.start + 2;
    const last = Math.min(meta.start + 1 + meta.horizon, meta.steps);
    return first <= last
      ? `none at this step: predicted are ${first} to ${last}`
      : "none: the rollout starts at the last step";
  }
  if (name === "belief") return "the first belief comes later";
  return name === "error" ? "nothing to compare yet" : fixed(null, 0);
}
