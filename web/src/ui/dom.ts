/** Elements in one line each. Texts are texts: nothing here reads markup. */

type Attributes = Record<string, string | boolean | undefined>;
type Child = Node | string | undefined;

/** An HTML element with attributes (`true` is an empty one, `false` none) and children. */
export function h<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  fill(element, attributes, children);
  return element;
}

/** The same for SVG. */
export function svg<K extends keyof SVGElementTagNameMap>(
  tag: K,
  attributes: Attributes = {},
  ...children: Child[]
): SVGElementTagNameMap[K] {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  fill(element, attributes, children);
  return element;
}

function fill(element: Element, attributes: Attributes, children: Child[]): void {
  for (const [name, value] of Object.entries(attributes)) {
    if (value === undefined || value === false) continue;
    element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...children.filter((child) => child !== undefined));
}

/** Sets a text only where it differs, so that nothing is laid out for nothing. */
export function setText(element: Element, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

export function setHidden(element: HTMLElement | SVGElement, hidden: boolean): void {
  element.toggleAttribute("hidden", hidden);
}

/** Makes children for the items, keeping those whose key was there before. */
export class Keyed<T> {
  readonly #parent: Element;
  readonly #kept = new Map<string, Element>();

  constructor(parent: Element) {
    this.#parent = parent;
  }

  update(items: readonly T[], key: (item: T) => string, make: (item: T) => Element): Element[] {
    const keys = new Set(items.map(key));
    for (const [name, element] of this.#kept) {
      if (keys.has(name)) continue;
      element.remove();
      this.#kept.delete(name);
    }
    return items.map((item, i) => {
      const name = key(item);
      const element = this.#kept.get(name) ?? make(item);
      this.#kept.set(name, element);
      if (this.#parent.children[i] !== element) this.#parent.insertBefore(element, this.#parent.children[i] ?? null);
      return element;
    });
  }
}
