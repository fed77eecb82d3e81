/** Notifications of the server, and one line for what was just said or is being asked. */
import type { Client } from "../client";
import * as names from "../names";
import { Keyed, h, setHidden, setText } from "./dom";
import type { Notice } from "../state/notices";

const LINE_SECS = 6;

export class Notices {
  readonly element = h("div", {
    class: "notices",
    role: "region",
    "aria-label": "Notifications",
    "aria-live": "polite",
  });
  /** The line at the foot of the page. */
  readonly line = h("div", { class: "line", role: "status" });
  readonly #client: Client;
  readonly #keyed = new Keyed<Notice>(this.element);
  readonly #timers = new Map<string, ReturnType<typeof setTimeout>>();
  readonly #progress = h("progress", { max: "100", "aria-label": "progress" });
  readonly #text = h("span");
  #said: { text: string; error: boolean } | undefined;
  #saidTimer: ReturnType<typeof setTimeout> | undefined;
  #metaMessage = "";
  #explained = 0;

  constructor(client: Client) {
    this.#client = client;
    this.line.append(this.#text, this.#progress);
  }

  /** Says something for a while. */
  say(text: string, error = false): void {
    this.#said = { text, error };
    clearTimeout(this.#saidTimer);
    this.#saidTimer = setTimeout(() => {
      this.#said = undefined;
      this.#showLine();
    }, LINE_SECS * 1000);
    this.#showLine();
  }

  /** `reset`: a new connection, whose keys are counted from the first one again. */
  update(reset: boolean): void {
    if (reset) this.#explained = 0;
    const { meta, answer } = this.#client;
    const message = meta?.message ?? null;
    const key = message === null ? "" : `${meta?.told} ${message.text}`;
    if (key !== this.#metaMessage) {
      this.#metaMessage = key;
      if (message !== null) this.say(message.text, message.error);
    }
    if (answer?.explain && answer.n !== this.#explained) {
      this.#explained = answer.n;
      this.say(answer.explain.text, answer.explain.error);
    }
    this.#showLine();
    const bar = this.#client.element(names.PROGRESS);
    setHidden(this.#progress, bar === undefined || bar.props["visible"] === false);
    this.#progress.value = Number(bar?.value ?? 0);
  }

  /** Called when notifications changed, not with every step. */
  updateNotices(): void {
    // What the session says stands in the line; only errors come as a notification as well.
    const all = [...this.#client.store.notices.values()];
    const notices = all.filter(({ uuid, error }) => error || !uuid.startsWith(names.SAID));
    const elements = this.#keyed.update(
      notices,
      ({ uuid }) => uuid,
      ({ uuid }) => this.#make(uuid),
    );
    notices.forEach((notice, i) => {
      const element = elements[i];
      if (element === undefined) return;
      setText(element.children[0] as Element, notice.title);
      setText(element.children[1] as Element, notice.body);
      element.classList.toggle("loading", notice.loading);
      element.classList.toggle("error", notice.error);
      this.#expire(notice);
    });
  }

  #make(uuid: string): HTMLElement {
    const close = h("button", { type: "button", "aria-label": "close" }, "×");
    close.addEventListener("click", () => {
      this.#client.store.dismiss(uuid);
      this.updateNotices();
    });
    return h("article", { class: "notice" }, h("strong"), h("p"), close);
  }

  #expire({ uuid, autoCloseSecs }: Notice): void {
    clearTimeout(this.#timers.get(uuid));
    this.#timers.delete(uuid);
    if (autoCloseSecs === undefined) return;
    const timer = setTimeout(() => {
      this.#timers.delete(uuid);
      this.#client.store.dismiss(uuid);
      this.updateNotices();
    }, autoCloseSecs * 1000);
    this.#timers.set(uuid, timer);
  }

  #showLine(): void {
    const { answer } = this.#client;
    const hint = answer?.palette === null ? answer.hint : null;
    setText(this.#text, hint ?? this.#said?.text ?? "");
    this.line.dataset["kind"] = hint ? "hint" : this.#said?.error ? "error" : "";
  }
}
