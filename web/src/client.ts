/** The session as this page has it: what the server said, and how to say something back. */
import * as names from "./names";
import { namesOf } from "./keys";
import { type FaceAnswer, type KeyLine, type Meta, NO_ANSWER, parsed } from "./meta";
import { type Letter, type Outgoing, guiUpdate } from "./protocol/outgoing";
import type { GuiElement } from "./state/gui";
import { Store } from "./state/store";

/** A control that is dragged sends at most so often; the last value always goes. */
const DRAG_MS = 16;
/** The server's line holds no more than so many characters. */
const LONGEST_LINE = 4096;

export class Client {
  readonly store = new Store();
  readonly #post: (letter: Letter) => boolean;
  readonly #waiting = new Map<string, unknown>();
  /** Whether one of them is another value than was shown; the server says nothing to one that is not. */
  #differs = false;
  #timer: ReturnType<typeof setTimeout> | undefined;
  #counter = 0;
  #sentAt = 0;
  readonly #parsed = new Map<string, { text: unknown; value: unknown }>();

  constructor(post: (letter: Letter) => boolean) {
    this.#post = post;
  }

  /** A new connection: the server says everything again, and counts keys from the first one. */
  opened(): void {
    this.store.reset();
    this.#waiting.clear();
    this.#differs = false;
    this.#counter = 0;
  }

  /** A control of this uuid, if the server has sent one. */
  element(uuid: string): GuiElement | undefined {
    return this.store.gui.get(uuid);
  }

  get meta(): Meta | undefined {
    return this.#json<Meta>(names.META, (found) => ({
      ...found,
      error_of: String(found.error_of).toLowerCase() === "prediction" ? "prediction" : "belief",
    }));
  }

  get keys(): readonly KeyLine[] {
    return this.#json<KeyLine[]>(names.KEYS) ?? [];
  }

  get answer(): FaceAnswer | undefined {
    return this.#json<FaceAnswer>(names.FACE, (found) => ({ ...NO_ANSWER, ...found }));
  }

  get state(): string {
    const value = this.element(names.STATE)?.value;
    return typeof value === "string" ? value : "";
  }

  /** The counter of the last key or line that was sent; its answer carries it. */
  get lastKey(): number {
    return this.#counter;
  }

  /** A value for a control: shown at once, sent at once unless one was sent just now. */
  choose(uuid: string, value: unknown): void {
    this.#differs ||= this.element(uuid)?.value !== value;
    this.store.choose(uuid, value);
    this.#waiting.delete(uuid);
    this.#waiting.set(uuid, value);
    const wait = this.#sentAt + DRAG_MS - performance.now();
    if (wait <= 0) return this.flush();
    this.#timer ??= setTimeout(() => this.flush(), wait);
  }

  /** A button. */
  press(uuid: string): void {
    this.flush();
    this.#send(guiUpdate(uuid, true));
  }

  /** A key by name; whether it was sent. What was dragged before goes before it. */
  key(name: string): boolean {
    return this.#numbered(names.KEY, name);
  }

  /** Characters, as if typed. */
  type(text: string): void {
    namesOf(text)
      .slice(0, LONGEST_LINE)
      .forEach((name) => this.key(name));
  }

  /** A whole line, as if typed after `:` and ended. */
  line(text: string): void {
    this.#numbered(names.LINE, text);
  }

  restore(state: string): void {
    this.#send(guiUpdate(names.STATE, state));
  }

  /** An instance of a node of the scene. */
  clickNode(
    name: string,
    instance: number,
    ray: { origin: number[]; direction: number[] },
    at: [number, number],
  ): void {
    this.#send({
      type: "SceneNodeClickMessage",
      name,
      instance_index: instance,
      ray_origin: ray.origin as [number, number, number],
      ray_direction: ray.direction as [number, number, number],
      screen_pos: at,
      modifier: null,
      owner: this.store.scene.get(name)?.owner ?? "",
    });
  }

  /** Sends what waits. */
  flush(): void {
    clearTimeout(this.#timer);
    this.#timer = undefined;
    for (const [uuid, value] of this.#waiting) this.#send(guiUpdate(uuid, value), this.#differs);
    if (this.#waiting.size > 0) this.#sentAt = performance.now();
    this.#waiting.clear();
    this.#differs = false;
  }

  /** Only what was sent is counted: nothing else will be answered. */
  #numbered(uuid: string, text: string): boolean {
    this.flush();
    const sent = this.#send(guiUpdate(uuid, `${text}#${this.#counter + 1}`), true);
    if (sent) this.#counter += 1;
    return sent;
  }

  #send(message: Outgoing, answered = false): boolean {
    return this.#post({ message, answered });
  }

  /** Parsed once for each text. */
  #json<T>(uuid: string, whole: (found: T) => T = (found) => found): T | undefined {
    const text = this.element(uuid)?.value;
    let known = this.#parsed.get(uuid);
    if (known === undefined || known.text !== text) {
      const found = parsed<T>(text);
      known = { text, value: found === undefined ? undefined : whole(found) };
      this.#parsed.set(uuid, known);
    }
    return known.value as T | undefined;
  }
}
