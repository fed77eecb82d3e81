/**
 * What the server has said, applied in order: controls, scene, notifications. Plain data; whoever shows it asks what
 * changed since it last looked.
 */
import type { Message } from "../protocol/frame";
import { type InitialCamera, applyCamera } from "./camera";
import { applyGui, type GuiElement } from "./gui";
import { applyNotice, type Notice } from "./notices";
import { applyScene, type SceneNode } from "./scene";

/** Names of what changed; something that is gone counts as changed. */
export interface Changes {
  /** Everything before is void: a new connection. */
  reset: boolean;
  gui: Set<string>;
  scene: Set<string>;
  notices: boolean;
}

export class Store {
  readonly gui = new Map<string, GuiElement>();
  readonly scene = new Map<string, SceneNode>();
  readonly notices = new Map<string, Notice>();
  camera: InitialCamera = { position: undefined, lookAt: undefined, fov: undefined };
  /** Type names that were skipped, each once: newer servers may say more. */
  readonly skipped = new Set<string>();
  /** Whether the server has sent all there was when we came. */
  complete = false;
  #changes = noChanges();

  /** Applies messages one after the other. */
  apply(messages: readonly Message[]): void {
    for (const message of messages) this.#applyOne(message);
  }

  /** Forgets everything: the server sends it again. */
  reset(): void {
    this.gui.clear();
    this.scene.clear();
    this.notices.clear();
    this.complete = false;
    this.#changes = { ...noChanges(), reset: true, notices: true };
  }

  /** A value that was chosen here. The server tells all others, but not us. */
  choose(uuid: string, value: unknown): void {
    const element = this.gui.get(uuid);
    if (element === undefined) return;
    this.gui.set(uuid, { ...element, value });
    this.#changes.gui.add(uuid);
  }

  /** Closes a notification on this side. */
  dismiss(uuid: string): void {
    if (this.notices.delete(uuid)) this.#changes.notices = true;
  }

  /** What changed since the last call. */
  takeChanges(): Changes {
    const changes = this.#changes;
    this.#changes = noChanges();
    return changes;
  }

  /** Whether `takeChanges` would say anything. */
  get changed(): boolean {
    const { reset, gui, scene, notices } = this.#changes;
    return reset || notices || gui.size > 0 || scene.size > 0;
  }

  #applyOne(message: Message): void {
    if (message.type === "ReplayDoneMessage") {
      this.complete = true;
      this.#changes.notices = true;
      return;
    }
    // No server, ours or another, gets to run scripts in this page.
    if (message.type === "RunJavascriptMessage") return;
    const gui = applyGui(this.gui, message);
    if (gui !== undefined) return void this.#changes.gui.add(gui);
    const scene = applyScene(this.scene, message);
    if (scene !== undefined) return scene.forEach((name) => this.#changes.scene.add(name));
    const camera = applyCamera(this.camera, message);
    if (camera !== undefined) {
      this.camera = camera;
      // The root: whoever draws the scene looks again.
      return void this.#changes.scene.add("");
    }
    if (applyNotice(this.notices, message)) {
      this.#changes.notices = true;
      return;
    }
    this.skipped.add(message.type);
  }
}

function noChanges(): Changes {
  return { reset: false, gui: new Set(), scene: new Set(), notices: false };
}
