// What is looked at inside the page. Each function is sent there as it is, and uses nothing from outside.

/** How large the page is, and which of the parts that belong in one view are not in it. */
export function layoutOf() {
  const wide = innerWidth >= 1280;
  const parts = wide
    ? [
        ".frames",
        ".experts",
        ".scene",
        "#chart-shares",
        "#chart-position",
        "#chart-psnr",
        ".timeline",
        ".latent-shares",
      ]
    : [".timeline"];
  const hidden = parts.filter((selector) => {
    const box = document.querySelector(selector)?.getBoundingClientRect();
    return (
      box === undefined || box.height < 20 || box.bottom > innerHeight + 1 || box.right > innerWidth + 1 || box.top < 0
    );
  });
  return { width: document.documentElement.scrollWidth, height: document.documentElement.scrollHeight, hidden };
}

/** Controls that a screen reader could not name. */
export function namelessControls() {
  const named = (element) =>
    element.getAttribute("aria-label")?.trim() ||
    [...(element.labels ?? [])].some((label) => label.textContent.trim()) ||
    (element.matches("button, summary") && element.textContent.trim());
  return [...document.querySelectorAll("button, input, select, summary")]
    .filter((element) => element.checkVisibility() && !named(element))
    .map((element) => element.outerHTML.slice(0, 80));
}

/** Texts with less contrast than 4.5 to what is behind them. */
export function contrastFaults() {
  const channels = (css) => (css.match(/[\d.]+/g) ?? []).map(Number);
  const luminance = ([r, g, b]) => {
    const [x, y, z] = [r, g, b].map((c) => (c / 255 <= 0.04045 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4));
    return 0.2126 * x + 0.7152 * y + 0.0722 * z;
  };
  const over = (top, under) => top.slice(0, 3).map((c, i) => c * (top[3] ?? 1) + under[i] * (1 - (top[3] ?? 1)));
  const behind = (element) => {
    const layers = [];
    for (let each = element; each !== null; each = each.parentElement)
      layers.unshift(channels(getComputedStyle(each).backgroundColor));
    return layers.reduce((under, top) => over(top, under), [255, 255, 255]);
  };
  const faults = new Set();
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const element = walker.currentNode.parentElement;
    if (
      !walker.currentNode.textContent.trim() ||
      !element.checkVisibility({ visibilityProperty: true }) ||
      element.matches("option, :disabled")
    )
      continue;
    const ground = behind(element);
    const [low, high] = [luminance(over(channels(getComputedStyle(element).color), ground)), luminance(ground)].sort(
      (a, b) => a - b,
    );
    const contrast = (high + 0.05) / (low + 0.05);
    if (contrast < 4.5) faults.add(`"${walker.currentNode.textContent.trim().slice(0, 30)}" ${contrast.toFixed(2)}`);
  }
  return [...faults];
}
