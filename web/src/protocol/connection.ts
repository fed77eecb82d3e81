/** The websocket: opens, decodes, comes back when it is lost. Knows nothing of what the messages mean. */
import { backoffMs } from "./backoff";
import { ProtocolError } from "./error";
import { type Batch, decodeFrame } from "./frame";
import { encodeMessage, type Letter } from "./outgoing";
import { Pace } from "./pace";

export const SUBPROTOCOL = "viser-v1.1.1";

/** An opening socket gets so long before it is given up. */
const OPEN_MS = 5000;
/** A connection that held so long counts as good, and the next wait is the shortest again. */
const GOOD_MS = 3000;
/** A connection may break without a word, as in sleep; then a server that should answer is silent for so long. */
const ANSWER_MS = 8000;

export type Status =
  | { kind: "connecting"; attempt: number }
  | { kind: "open" }
  /** `reason` is the server's own where it gave one. */
  | { kind: "lost"; reason: string; retryAtMs: number };

export interface Listener {
  /** A new connection: what came before no longer holds, all of it is sent again. */
  opened(): void;
  received(batch: Batch): void;
  status(status: Status): void;
}

/** One server, for as long as the page is open. */
export class Connection {
  readonly #url: string;
  readonly #listener: Listener;
  #socket: WebSocket | undefined;
  #timer: ReturnType<typeof setTimeout> | undefined;
  readonly #pace = new Pace();
  /** Runs from what is to be answered to the next thing that the server says. */
  #patience: ReturnType<typeof setTimeout> | undefined;
  #failures = 0;
  #openedAtMs = 0;
  readonly #isThere: () => Promise<boolean>;
  /** Whether the server answered otherwise, when it last refused. */
  #there = false;
  /** Why this side closed it, if it did. */
  #fault: string | undefined;

  /** `isThere`: whether the server answers at all, asked where it opens no websocket. */
  constructor(url: string, listener: Listener, isThere: () => Promise<boolean>) {
    this.#url = url;
    this.#isThere = isThere;
    this.#listener = listener;
  }

  connect(): void {
    this.#stop();
    this.#socket?.close();
    this.#fault = undefined;
    this.#listener.status({ kind: "connecting", attempt: this.#failures + 1 });
    const socket = new WebSocket(this.#url, [SUBPROTOCOL]);
    this.#socket = socket;
    socket.binaryType = "arraybuffer";
    this.#timer = setTimeout(() => {
      this.#fault = `no answer within ${OPEN_MS / 1000} s`;
      socket.close();
    }, OPEN_MS);
    socket.addEventListener("open", () => this.#current(socket, () => this.#opened()));
    socket.addEventListener("message", (event) => this.#current(socket, () => this.#received(event.data)));
    socket.addEventListener("close", (event) => this.#current(socket, () => this.#closed(event.reason)));
  }

  /** Whether there is a socket for it; what is said while there is none is dropped, the state comes from the server. */
  send({ message, answered }: Letter): boolean {
    const socket = this.#socket;
    if (socket?.readyState !== WebSocket.OPEN) return false;
    this.#pace.push(() => {
      socket.send(encodeMessage(message));
      if (answered) this.#patience ??= setTimeout(() => this.#giveUp(), ANSWER_MS);
    });
    return true;
  }

  /** Ends all that was begun for one socket. */
  #stop(): void {
    clearTimeout(this.#timer);
    this.#hear();
    this.#pace.clear();
  }

  #hear(): void {
    clearTimeout(this.#patience);
    this.#patience = undefined;
  }

  /** Does not wait for the close event, which a browser holds back until the other side has agreed. */
  #giveUp(): void {
    const socket = this.#socket;
    this.#socket = undefined;
    socket?.close();
    this.#fault = `no answer for ${ANSWER_MS / 1000} s`;
    this.#closed("");
  }

  /** Events of a socket that was replaced mean nothing any more. */
  #current(socket: WebSocket, act: () => void): void {
    if (socket === this.#socket) act();
  }

  #opened(): void {
    clearTimeout(this.#timer);
    this.#there = false;
    this.#openedAtMs = performance.now();
    this.#listener.opened();
    this.#listener.status({ kind: "open" });
  }

  #received(data: unknown): void {
    this.#hear();
    try {
      if (!(data instanceof ArrayBuffer)) throw new ProtocolError("a text message; all are binary");
      this.#listener.received(decodeFrame(data));
    } catch (error) {
      // Half of a state is worse than none: ask for all of it again.
      this.#fault = error instanceof Error ? error.message : String(error);
      console.error("poescope: cannot read what the server sent:", error);
      this.#socket?.close(4000, "unreadable");
    }
  }

  /**
   * A browser does not say why a websocket was not opened. Whether the server itself is there tells a missing token and
   * a full house from a server that is away; that is known by the next time.
   */
  #whyRefused(): string {
    const there = this.#there;
    this.#there = false;
    this.#isThere().then(
      (is) => (this.#there = is),
      () => {},
    );
    return there ? "refused: the link may lack its token, or there are too many viewers" : "the server does not answer";
  }

  #closed(theirs: string): void {
    this.#stop();
    const held = this.#openedAtMs > 0 && performance.now() - this.#openedAtMs > GOOD_MS;
    this.#openedAtMs = 0;
    this.#failures = held ? 1 : this.#failures + 1;
    const wait = backoffMs(this.#failures, Math.random());
    const reason = this.#fault ?? (theirs || this.#whyRefused());
    this.#listener.status({ kind: "lost", reason, retryAtMs: performance.now() + wait });
    this.#timer = setTimeout(() => this.connect(), wait);
  }
}
