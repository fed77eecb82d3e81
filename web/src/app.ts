/** The page: its parts in their places, brought up to date once a frame when something changed. */
import { Charts } from "./charts/charts";
import type { Client } from "./client";
import { Keyboard } from "./keyboard";
import type { FaceAnswer } from "./meta";
import { EPISODE } from "./names";
import type { Status } from "./protocol/connection";
import { SceneView } from "./scene/scene";
import { onTheme, toggleTheme } from "./theme";
import { Experts } from "./ui/experts";
import { Frames } from "./ui/frames";
import { Header } from "./ui/header";
import { Help } from "./ui/help";
import { Notices } from "./ui/notices";
import { Palette } from "./ui/palette";
import { Panes } from "./ui/panes";
import { Settings } from "./ui/settings";
import { Timeline } from "./ui/timeline";
import { h } from "./ui/dom";
import { startTooltips } from "./ui/term";
import { AddressBar, urlOfState } from "./url";

export class App {
  readonly #client: Client;
  readonly #root: HTMLElement;
  readonly #main: HTMLElement;
  readonly #header: Header;
  readonly #frames: Frames;
  readonly #experts: Experts;
  readonly #settings: Settings;
  readonly #charts: Charts;
  readonly #scene: SceneView;
  readonly #timeline: Timeline;
  readonly #notices: Notices;
  readonly #help = new Help();
  readonly #palette: Palette;
  readonly #panes: Panes;
  readonly #address = new AddressBar();
  #status: Status = { kind: "connecting", attempt: 1 };
  #asked = false;
  /** The answer whose face command was done last. */
  #done: FaceAnswer | undefined;

  constructor(root: HTMLElement, client: Client) {
    this.#client = client;
    this.#root = root;
    // Nothing to look at until the server has said what there is.
    root.classList.add("blank");
    this.#header = new Header(client, {
      help: () => this.#face("help"),
      palette: () => client.key(":"),
      theme: toggleTheme,
      copy: () => this.#face("copy-state"),
    });
    this.#frames = new Frames(client);
    this.#experts = new Experts(client);
    this.#settings = new Settings(client);
    this.#charts = new Charts(client);
    this.#scene = new SceneView(client);
    this.#timeline = new Timeline(client);
    this.#notices = new Notices(client);
    this.#palette = new Palette(client);
    const chart = (name: Parameters<Charts["element"]>[0]) => this.#charts.element(name);
    const section = (place: string, label: string, ...children: HTMLElement[]) =>
      h(
        "section",
        { class: `pane charts ${place}`, "data-pane": "charts", "aria-label": label, tabindex: "0" },
        ...children,
      );
    this.#main = h(
      "main",
      {},
      h("div", { class: "side" }, this.#experts.element, this.#settings.element),
      this.#frames.element,
      section("left", "Belief", chart("shares"), chart("latents"), chart("psnr")),
      this.#scene.element,
      section("right", "Position", chart("position"), chart("horizon")),
    );
    this.#panes = new Panes(this.#main);
    root.append(
      this.#header.element,
      this.#main,
      h("footer", {}, this.#timeline.element, this.#notices.line),
      this.#notices.element,
      this.#palette.element,
      this.#help.element,
    );
    new Keyboard(
      client,
      (command) => this.#face(command),
      () => this.#help.open,
    );
    startTooltips();
    onTheme(() => {
      this.#charts.retint();
      this.#scene.retint();
    });
    // Once a second, while waiting for the server: the seconds count down.
    setInterval(() => this.#status.kind === "lost" && this.invalidate(), 1000);
  }

  status(status: Status): void {
    this.#status = status;
    this.invalidate();
  }

  /** Brings the page up to date before the browser draws next. */
  invalidate(): void {
    if (this.#asked) return;
    this.#asked = true;
    // A hidden tab gets no frames; it looks again when it is shown.
    requestAnimationFrame(() => {
      this.#asked = false;
      this.#update();
    });
  }

  #update(): void {
    const client = this.#client;
    const open = this.#status.kind === "open";
    // What was seen last stays while the connection is away, marked as old.
    this.#root.classList.toggle("away", !open);
    this.#main.inert = !open;
    this.#timeline.element.inert = !open;
    if (!open) this.#palette.update(null);
    this.#header.update(statusText(this.#status), open);
    // Between losing the old connection and the end of the new one's replay nothing is brought up to date.
    if (!open || !client.store.complete) return;
    this.#root.classList.remove("blank");
    const changes = client.store.takeChanges();
    this.#experts.update();
    this.#settings.update();
    this.#frames.update();
    this.#charts.update();
    this.#scene.update(changes.scene, changes.reset);
    this.#timeline.update();
    this.#notices.update(changes.reset);
    if (changes.notices) this.#notices.updateNotices();
    const { answer } = client;
    this.#palette.update(answer?.palette ?? null);
    if (answer !== this.#done) {
      this.#done = answer;
      if (answer !== undefined && answer.face !== null) this.#face(answer.face);
    }
    this.#address.show(client.state);
    const meta = client.meta;
    const title = meta?.episode ? `${meta.episode.id} · ${meta.model.name} · poescope` : "poescope";
    if (document.title !== title) document.title = title;
  }

  /** What only a face can do. */
  #face(command: string): void {
    const [word, name] = command.split(" ");
    switch (word) {
      case "help":
        return this.#help.toggle(this.#client.keys);
      case "copy-state":
        return this.#copy();
      case "export":
        return this.#notices.say("files are written from a shell: poescope export --state, with what y copies");
      case "zoom":
        return this.#panes.zoom();
      case "back":
        return this.#panes.back();
      case "focus-next":
        return this.#panes.focusNext(1);
      case "focus-previous":
        return this.#panes.focusNext(-1);
      case "next-view":
        return this.#panes.nextView();
      case "view":
        if (!this.#panes.show(name ?? "")) this.#notices.say(`the view ${name} is in the terminal: poescope view`);
        return;
      case "episodes":
        return document.getElementById(EPISODE)?.focus();
      case "difference":
      case "blink":
      case "wipe":
        return this.#notices.say("two models side by side are in the terminal: poescope view");
      default:
        return;
    }
  }

  #copy(): void {
    const url = new URL(urlOfState(new URL(location.href), this.#client.state), location.href).href;
    const said = navigator.clipboard?.writeText(url);
    if (said === undefined)
      return this.#notices.say("this browser lets no page copy; the address bar has the same link");
    said.then(
      () => this.#notices.say("copied a link to this state"),
      () => this.#notices.say("the browser refused to copy; the address bar has the same link", true),
    );
  }
}

function statusText(status: Status): string {
  switch (status.kind) {
    case "open":
      return "connected";
    case "connecting":
      return "connecting …";
    case "lost": {
      const secs = Math.max(0, Math.ceil((status.retryAtMs - performance.now()) / 1000));
      return `${status.reason}; again in ${secs} s`;
    }
  }
}
