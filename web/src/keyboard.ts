/**
 * Which keys go to the session. All that its table knows, but for those that the focused control needs itself; what only
 * a face can do is done here at once, unless the session may be in a mode that reads the key otherwise.
 */
import type { Client } from "./client";
import { keyName } from "./keys";
import { BROWSERS_OWN } from "./ui/help";

export class Keyboard {
  readonly #client: Client;
  readonly #face: (command: string) => void;
  readonly #blocked: () => boolean;

  /** `blocked`: something is open that has the keyboard for itself. */
  constructor(client: Client, face: (command: string) => void, blocked: () => boolean) {
    this.#client = client;
    this.#face = face;
    this.#blocked = blocked;
    document.addEventListener("keydown", (event) => this.#pressed(event));
    giveBack();
  }

  #pressed(event: KeyboardEvent): void {
    if (event.defaultPrevented || this.#blocked()) return;
    const name = keyName({
      key: event.key,
      shiftKey: event.shiftKey,
      ctrlKey: event.ctrlKey,
      altKey: event.altKey,
      metaKey: event.metaKey,
      isComposing: event.isComposing,
      altGraph: event.getModifierState("AltGraph"),
    });
    if (name === undefined || BROWSERS_OWN.has(name)) return;
    const { answer, keys, lastKey } = this.#client;
    // Keys may be typed faster than the answers come; until then the session is asked.
    const waiting = (answer?.n ?? 0) < lastKey;
    const mode = answer?.mode === true;
    const line = keys.find((each) => each.keys.includes(name));
    if (mode || waiting) {
      // In a line or a mode nearly everything means something, but reloading, copying and the like stay the browser's.
      if ((line === undefined && /^<(c-.+|f\d+)>$/.test(name)) || (!mode && /tab>$/.test(name))) return;
      return this.#send(event, name);
    }
    if (line === undefined || name === "<tab>" || name === "<s-tab>" || needed(document.activeElement, name)) return;
    if (line.face === null) return this.#send(event, name);
    event.preventDefault();
    this.#face(line.face);
  }

  /** A key that cannot be sent is left to the browser. */
  #send(event: KeyboardEvent, name: string): void {
    if (this.#client.key(name)) event.preventDefault();
  }
}

/** Whether a focused control has its own use for a key. */
export function needed(target: EventTarget | null, name: string): boolean {
  if (!(target instanceof HTMLElement)) return false;
  if (name === "<enter>" || name === "<space>") {
    return (
      target.matches("button, select, summary, a") || (name === "<space>" && target.matches("input[type=checkbox]"))
    );
  }
  if (target.matches("input[type=range]")) return /^<(left|right|up|down|home|end|pageup|pagedown)>$/.test(name);
  if (target.matches("select")) return name.length === 1 || /^<(up|down|home|end|esc)>$/.test(name);
  return target.matches("input[type=text], textarea");
}

/** A control that was used with a pointer gives the keyboard back; one that was tabbed to keeps it. */
function giveBack(): void {
  let pointed = false;
  const release = ({ target }: Event) => {
    const used = target instanceof Element ? target.closest("button, input:not([type=text]), select, summary") : null;
    if (pointed && used instanceof HTMLElement && used.closest("dialog") === null) used.blur();
  };
  document.addEventListener("pointerdown", () => (pointed = true), true);
  document.addEventListener("keydown", () => (pointed = false), true);
  document.addEventListener("click", (event) => event.target instanceof HTMLSelectElement || release(event));
  document.addEventListener("change", release);
}
