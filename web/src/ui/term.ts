/** Tooltips: a term's formula and reading beside whatever names it in `data-term`, on hover and on focus. */
import { TERMS, type Term, type TermName, pieces } from "../formulas";
import { h } from "./dom";

/** Attributes of an element that a term explains. */
export function explained(term: TermName): { "data-term": string } {
  return { "data-term": term };
}

/** A term as elements; for the tooltip and for help. */
export function termElements(term: Term): HTMLElement[] {
  const formula =
    term.formula === undefined
      ? []
      : [
          h(
            "div",
            { class: "formula" },
            ...pieces(term.formula).map(({ text, place }) => (place === "base" ? text : h(place, {}, text))),
          ),
        ];
  return [h("strong", {}, term.title), ...formula, h("p", {}, term.text)];
}

const WAIT_MS = 350;

/** Watches the whole page; one tooltip for all. */
export function startTooltips(): void {
  const tip = h("div", { class: "tip", role: "tooltip", id: "tip", hidden: true });
  document.body.append(tip);
  let timer: ReturnType<typeof setTimeout> | undefined;
  let shownFor: Element | undefined;

  const hide = () => {
    clearTimeout(timer);
    tip.hidden = true;
    shownFor?.removeAttribute("aria-describedby");
    shownFor = undefined;
  };
  const show = (target: Element) => {
    const term = TERMS[target.getAttribute("data-term") as TermName] as Term | undefined;
    if (term === undefined) return;
    hide();
    shownFor = target;
    tip.replaceChildren(...termElements(term));
    tip.hidden = false;
    target.setAttribute("aria-describedby", "tip");
    place(tip, target.getBoundingClientRect());
  };
  const targetOf = (event: Event) => (event.target instanceof Element ? event.target.closest("[data-term]") : null);

  document.addEventListener("pointerover", (event) => {
    const target = targetOf(event);
    if (target === shownFor) return;
    hide();
    if (target !== null && event.pointerType !== "touch") timer = setTimeout(() => show(target), WAIT_MS);
  });
  document.addEventListener("focusin", (event) => {
    const target = targetOf(event);
    if (target !== null && target.matches(":focus-visible")) show(target);
    else hide();
  });
  for (const type of ["pointerdown", "keydown", "scroll", "blur"]) addEventListener(type, hide, true);
}

/** Below the target where there is room, else above; never beyond the window. */
function place(tip: HTMLElement, target: DOMRect): void {
  const gap = 6;
  const { width, height } = tip.getBoundingClientRect();
  const left = Math.max(gap, Math.min(target.left, innerWidth - width - gap));
  const below = target.bottom + gap;
  const top = below + height > innerHeight ? Math.max(gap, target.top - height - gap) : below;
  tip.style.left = `${left}px`;
  tip.style.top = `${top}px`;
}
