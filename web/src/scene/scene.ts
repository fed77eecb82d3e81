/** The table in three dimensions: the server's nodes, orbit controls, clicks on the path. Draws only when something changed. */
import {
  AmbientLight,
  Box3,
  DirectionalLight,
  Group,
  type Object3D,
  PerspectiveCamera,
  Scene,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { Client } from "../client";
import { fixed } from "../format";
import { PATH_POINTS, PULL } from "../names";
import type { SceneNode } from "../state/scene";
import { token } from "../theme";
import { h } from "../ui/dom";
import { icon } from "../ui/icons";
import { explained } from "../ui/term";
import { contentOf, dispose, floats } from "./content";
import { Labels } from "./labels";
import { pick } from "./pick";

/** Around the path: the plate is larger than its own middle. */
const ROOM_M = 0.08;
/** A plate that hardly moves is still seen with its surroundings. */
const NEAREST_M = 0.14;

interface Shown {
  holder: Group;
  content: Object3D | undefined;
  /** What the content was made of. */
  props: unknown;
  type: string | undefined;
}

export class SceneView {
  readonly element: HTMLElement;
  readonly #client: Client;
  readonly #canvas = h("canvas", { role: "img" });
  readonly #labels = new Labels();
  readonly #note = h("p", { class: "empty" });
  readonly #scene = new Scene();
  readonly #root = new Group();
  readonly #camera = new PerspectiveCamera(40, 1, 0.01, 100);
  readonly #shown = new Map<string, Shown>();
  #renderer: WebGLRenderer | undefined;
  #controls: OrbitControls | undefined;
  /** What was replaced. It goes after the next picture: its shader is that of what took its place, and costs much to make. */
  #old: Object3D[] = [];
  #asked = false;
  #placed = "";

  constructor(client: Client) {
    this.#client = client;
    const reset = h(
      "button",
      { type: "button", "aria-label": "reset the view", title: "reset the view" },
      icon("reset"),
    );
    reset.addEventListener("click", () => this.#place());
    const legend = h(
      "span",
      { class: "legend" },
      ...LEGEND.map(([cssClass, text]) =>
        h("span", {}, h("i", { class: `swatch ${cssClass}`, "aria-hidden": "true" }), text),
      ),
    );
    this.element = h(
      "section",
      { class: "pane scene", "data-pane": "scene", "aria-label": "Table", tabindex: "0" },
      h("header", {}, h("h3", explained("ellipse"), "table"), legend, reset),
      h("div", { class: "stage" }, this.#canvas, this.#labels.element, this.#note),
    );
    this.#scene.add(this.#root);
    this.#camera.up.set(0, 0, 1);
    this.#light();
    this.#start();
  }

  /** Takes over what changed in the store; everything on a reset. */
  update(changed: ReadonlySet<string>, reset: boolean): void {
    const { scene, camera } = this.#client.store;
    if (reset) for (const name of [...this.#shown.keys()]) if (!scene.has(name)) this.#remove(name);
    for (const name of reset ? scene.keys() : changed) {
      const node = scene.get(name);
      if (node === undefined) this.#remove(name);
      else this.#show(node);
    }
    // Another episode goes elsewhere on the table; within one the camera is the viewer's.
    const placed = JSON.stringify([camera, this.#client.meta?.episode?.index]);
    if (placed !== this.#placed) {
      this.#placed = placed;
      this.#place();
    }
    const meta = this.#client.meta;
    const error = meta?.position_error_cm?.[meta.error_of];
    this.#canvas.setAttribute(
      "aria-label",
      `The table; the ${meta?.error_of ?? "belief"} is ${fixed(error, 1)} cm from the plate`,
    );
    if (changed.size > 0 || reset) this.invalidate();
  }

  /** Makes everything again in the colours of now. */
  retint(): void {
    for (const shown of this.#shown.values()) shown.props = undefined;
    for (const node of this.#client.store.scene.values()) this.#show(node);
    this.invalidate();
  }

  /** Asks for a picture with the next frame of the browser. */
  invalidate(): void {
    if (this.#asked || this.#renderer === undefined) return;
    this.#asked = true;
    requestAnimationFrame(() => {
      this.#asked = false;
      this.#render();
    });
  }

  #start(): void {
    try {
      this.#renderer = new WebGLRenderer({ canvas: this.#canvas, antialias: true, alpha: true });
    } catch {
      this.#note.textContent = "no WebGL here: the charts show the same position as numbers";
      return;
    }
    // Asking whether a shader is right makes the page wait for it.
    this.#renderer.debug.checkShaderErrors = false;
    const controls = new OrbitControls(this.#camera, this.#canvas);
    controls.addEventListener("change", () => this.invalidate());
    // A finger that goes up or down scrolls the page.
    this.#canvas.style.touchAction = "pan-y";
    this.#controls = controls;
    this.#place();
    this.#listen();
    new ResizeObserver(() => this.#resize()).observe(this.#canvas.parentElement as HTMLElement);
  }

  #light(): void {
    const sun = new DirectionalLight(0xffffff, 1.6);
    sun.position.set(0.4, -0.6, 1.2);
    this.#scene.add(sun, new AmbientLight(0xffffff, 1.5));
  }

  #show(node: SceneNode): void {
    const shown = this.#shown.get(node.name) ?? this.#hold(node.name);
    if (shown.props !== node.props || shown.type !== node.type) {
      this.#empty(shown);
      shown.props = node.props;
      shown.type = node.type;
      shown.content = contentOf(node);
      if (shown.content !== undefined) shown.holder.add(shown.content);
    }
    const [x = 0, y = 0, z = 0] = node.position;
    const [qw = 1, qx = 0, qy = 0, qz = 0] = node.wxyz;
    // The root's turn is between viser's axes and three's; here z is up from the start.
    if (node.name !== "") {
      shown.holder.position.set(x, y, z);
      shown.holder.quaternion.set(qx, qy, qz, qw);
    }
    shown.holder.visible = node.visible;
    const puller = node.name.startsWith(PULL) ? node.name.slice(PULL.length) : undefined;
    const letter = this.#client.meta?.experts.find(({ name }) => name === puller)?.letter;
    // Colours alone would not tell the arrows apart.
    if (letter !== undefined && lengthOf(node) > SEEN_M) this.#labels.set(node.name, letter, tipOf(node, shown.holder));
    else if (puller !== undefined) this.#labels.remove(node.name);
    if (node.type === "LabelMessage") this.#labels.set(node.name, String(node.props["text"] ?? ""), shown.holder);
  }

  /** The group of a name below that of its parent, made where it is missing. */
  #hold(name: string): Shown {
    const holder = new Group();
    const parent = name.slice(0, Math.max(0, name.lastIndexOf("/")));
    const above =
      name === "" ? this.#root : parent === "" ? this.#root : (this.#shown.get(parent) ?? this.#hold(parent)).holder;
    above.add(holder);
    const shown: Shown = { holder, content: undefined, props: undefined, type: undefined };
    this.#shown.set(name, shown);
    return shown;
  }

  #empty(shown: Shown): void {
    if (shown.content === undefined) return;
    shown.holder.remove(shown.content);
    if (this.#renderer === undefined) dispose(shown.content);
    else this.#old.push(shown.content);
    shown.content = undefined;
  }

  #remove(name: string): void {
    const shown = this.#shown.get(name);
    if (shown === undefined) return;
    this.#empty(shown);
    this.#labels.remove(name);
    shown.holder.removeFromParent();
    this.#shown.delete(name);
  }

  /** The camera on the server's side of the table, as near as shows the whole path. */
  #place(): void {
    const { store } = this.#client;
    const from = new Vector3(...(store.camera.position ?? [0, -1, 1]));
    const to = new Vector3(...(store.camera.lookAt ?? [0, 0, 0]));
    const path = floats(store.scene.get(PATH_POINTS)?.props["batched_positions"]);
    const away = from.sub(to);
    if (path.length > 3) {
      const box = new Box3().setFromArray(path);
      box.getCenter(to);
      const radius = Math.max(box.getSize(new Vector3()).length() / 2 + ROOM_M, NEAREST_M);
      away.setLength(radius / Math.tan(this.#narrowest() / 2));
    }
    this.#camera.position.copy(to).add(away);
    this.#controls?.target.copy(to);
    this.#camera.lookAt(to);
    this.#controls?.update();
    this.invalidate();
  }

  /** The smaller one of the camera's two angles, in radians. */
  #narrowest(): number {
    const upright = (this.#camera.fov * Math.PI) / 180;
    return 2 * Math.atan(Math.tan(upright / 2) * Math.min(1, this.#camera.aspect));
  }

  #resize(): void {
    const box = this.#canvas.parentElement as HTMLElement;
    const [width, height] = [Math.max(1, box.clientWidth), Math.max(1, box.clientHeight)];
    this.#renderer?.setPixelRatio(devicePixelRatio);
    this.#renderer?.setSize(width, height, false);
    this.#camera.aspect = width / height;
    this.#camera.updateProjectionMatrix();
    this.#render();
  }

  #render(): void {
    if (this.#renderer === undefined || document.hidden) return;
    this.#renderer.setClearColor(token("--panel"), 1);
    this.#renderer.render(this.#scene, this.#camera);
    this.#old.forEach(dispose);
    this.#old = [];
    this.#labels.place(this.#camera, this.#canvas.clientWidth, this.#canvas.clientHeight);
  }

  #listen(): void {
    let down: { x: number; y: number } | undefined;
    const under = (event: PointerEvent) => {
      const box = this.#canvas.getBoundingClientRect();
      const objects = new Map([...this.#shown].map(([name, { holder }]) => [name, holder as Object3D]));
      const [x, y] = [event.clientX - box.left, event.clientY - box.top];
      return pick(this.#client.store.scene.values(), objects, this.#camera, x, y, box.width, box.height);
    };
    this.#canvas.addEventListener("pointerdown", (event) => (down = { x: event.clientX, y: event.clientY }));
    this.#canvas.addEventListener("pointermove", (event) => {
      if (event.buttons === 0) this.#canvas.style.cursor = under(event) === undefined ? "grab" : "pointer";
    });
    this.#canvas.addEventListener("pointerup", (event) => {
      const still = down !== undefined && new Vector3(event.clientX - down.x, event.clientY - down.y, 0).length() < 4;
      const hit = still ? under(event) : undefined;
      if (hit !== undefined) this.#client.clickNode(hit.name, hit.instance, hit.ray, hit.screen);
    });
    document.addEventListener("visibilitychange", () => this.invalidate());
  }
}

/** A place at the end of a node's last arrow, which moves with the node. */
function tipOf(node: SceneNode, holder: Group): Object3D {
  const [x = 0, y = 0, z = 0] = floats(node.props["points"]).slice(-3);
  const tip = holder.getObjectByName(TIP) ?? Object.assign(new Group(), { name: TIP });
  tip.position.set(x, y, z);
  return holder.add(tip) && tip;
}

const TIP = "tip";

/** Arrows that are shorter are none: the expert is off. */
const SEEN_M = 0.002;

function lengthOf(node: SceneNode): number {
  const [x = 0, y = 0, z = 0, u = 0, v = 0, w = 0] = floats(node.props["points"]);
  return Math.hypot(u - x, v - y, w - z);
}

const LEGEND: [string, string][] = [
  ["truth", "truth"],
  ["belief", "belief"],
  ["prediction", "prediction"],
];
