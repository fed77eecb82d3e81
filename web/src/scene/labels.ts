/** Words in the scene, as elements over it: crisp, and of the page's own letters. */
import { type Camera, type Object3D, Vector3 } from "three";
import { h } from "../ui/dom";

export class Labels {
  readonly element = h("div", { class: "labels", "aria-hidden": "true" });
  readonly #labels = new Map<string, { element: HTMLElement; object: Object3D }>();

  set(name: string, text: string, object: Object3D): void {
    let label = this.#labels.get(name);
    if (label === undefined) {
      label = { element: h("span"), object };
      this.#labels.set(name, label);
      this.element.append(label.element);
    }
    label.object = object;
    label.element.textContent = text;
    label.element.className = text.length === 1 ? "letter" : "";
  }

  remove(name: string): void {
    this.#labels.get(name)?.element.remove();
    this.#labels.delete(name);
  }

  /** Puts each above where its object is on the screen. */
  place(camera: Camera, width: number, height: number): void {
    const point = new Vector3();
    for (const { element, object } of this.#labels.values()) {
      object.getWorldPosition(point).project(camera);
      element.hidden = !shownBelow(object) || point.z > 1;
      element.style.transform = `translate(${((point.x + 1) / 2) * width}px, ${((1 - point.y) / 2) * height}px) translate(-50%, -190%)`;
    }
  }
}

/** Whether it and all above it are visible. */
function shownBelow(object: Object3D): boolean {
  for (let each: Object3D | null = object; each !== null; each = each.parent) if (!each.visible) return false;
  return true;
}
