// Drives the built page in a real Chromium against a running server, and keeps pictures of it.
//
//   node tests/browser/run.mjs [--command "../target/release/poescope serve --port {port}"] [--out DIR] [--require]
//
// Says so and ends well where there is no Chromium; --require makes that a failure.
import { spawn, spawnSync } from "node:child_process";
import { mkdirSync } from "node:fs";
import { createServer } from "node:net";
import { parseArgs } from "node:util";
import { chromium } from "playwright-core";
import { contrastFaults, layoutOf, namelessControls } from "./page.mjs";

const { values: options } = parseArgs({
  options: {
    command: { type: "string", default: "../target/release/poescope serve --port {port}" },
    out: { type: "string", default: "tests/browser/out" },
    require: { type: "boolean", default: false },
  },
});

const SIZES = [
  [1280, 720],
  [400, 800],
  [1920, 1080],
];
const WAIT = { timeout: 15_000 };

const executablePath = [process.env["CHROMIUM"], "chromium", "chromium-browser", "google-chrome"]
  .filter(Boolean)
  .map((name) => spawnSync("which", [name]).stdout.toString().trim())
  .find(Boolean);
if (executablePath === undefined) {
  console.log("skipped: no Chromium on the path or in $CHROMIUM");
  process.exit(options.require ? 1 : 0);
}

const port = await freePort();
const url = `http://127.0.0.1:${port}/`;
const faults = [];
let checks = 0;
let server = await serve();
mkdirSync(options.out, { recursive: true });

const browser = await chromium.launch({
  executablePath,
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});
try {
  const { page, context } = await open(url);
  await scrubs(page);
  await switches(page);
  await keys(page);
  await scene(page);
  await restores(page, context);
  await latency(page);
  await appearance();
  await reconnects(page);
} catch (error) {
  faults.push(String(error?.stack ?? error));
} finally {
  await browser.close();
  server.kill();
}
for (const fault of faults) console.error(`FAULT ${fault}`);
console.log(`${checks} checks, ${faults.length} faults; pictures in ${options.out}`);
process.exit(faults.length === 0 ? 0 : 1);

function check(holds, what) {
  checks += 1;
  if (!holds) faults.push(what);
}

async function scrubs(page) {
  await press(page, "g");
  await see(page, /step 1 of/);
  const before = await looks(page);
  await page.locator("#poescope-step").focus();
  for (let i = 0; i < 7; i += 1) await page.keyboard.press("ArrowRight");
  await see(page, /step 8 of/);
  const after = await changed(page, before, ["truth", "belief", "stage"]);
  check(after, "scrubbing changes truth, belief and the table");
  check(!(await page.locator("#frame-prediction").isHidden()), "there is a prediction after the context");
  await page.locator("#poescope-step").blur();
}

async function switches(page) {
  const before = await looks(page);
  const share = () => page.locator('[data-expert="vision"] .part').first().textContent();
  check((await share()) !== "0 %", "vision has a share");
  await page.locator("#poescope-switch-vision").click();
  await page.waitForFunction(
    () => document.querySelector('[data-expert="vision"]')?.classList.contains("off"),
    undefined,
    WAIT,
  );
  // The switch shows at once, the shares when they are computed.
  await page.waitForFunction(
    () => document.querySelector('[data-expert="vision"] .part')?.textContent === "0 %",
    undefined,
    WAIT,
  );
  check(await changed(page, before, ["belief", "stage"]), "without vision belief and plate change");
  const untouched = await looks(page);
  check(untouched.truth === before.truth, "the truth stays as it is");
  await press(page, "1");
  await page.waitForFunction(
    () => !document.querySelector('[data-expert="vision"]')?.classList.contains("off"),
    undefined,
    WAIT,
  );
  check(await same(page, before, ["belief"]), "on again, the belief is what it was");
}

async function keys(page) {
  await press(page, "?");
  await page.locator("dialog.help[open]").waitFor(WAIT);
  check((await page.locator(".help kbd").count()) > 50, "help lists the keys of the table");
  await page.keyboard.press("Escape");
  check((await page.locator("dialog.help[open]").count()) === 0, "Esc closes help");
  await page.keyboard.press("Control+k");
  await page.locator(".palette").waitFor({ state: "visible", ...WAIT });
  await page.keyboard.type("first step");
  await page.waitForFunction(() => document.querySelector(".palette input")?.value === "first step", undefined, WAIT);
  await page.screenshot({ path: `${options.out}/palette.png` });
  await page.keyboard.press("Enter");
  await see(page, /step 1 of/);
  check(await page.locator(".palette").isHidden(), "the palette is gone when its command is done");
  await page.keyboard.type(":8");
  await page.keyboard.press("Enter");
  await see(page, /step 8 of/);
  await press(page, "a");
  await page.waitForFunction(() => /α/.test(document.querySelector(".line")?.textContent ?? ""), undefined, WAIT);
  await press(page, "Escape");
  await page.waitForFunction(() => !/α/.test(document.querySelector(".line")?.textContent ?? ""), undefined, WAIT);
}

/** A click on a point of the path goes to its step. */
async function scene(page) {
  const stage = page.locator(".stage canvas");
  const box = await stage.boundingBox();
  let pointer = false;
  for (let y = 0.2; y < 0.9 && !pointer; y += 0.03) {
    for (let x = 0.1; x < 0.95 && !pointer; x += 0.03) {
      await page.mouse.move(box.x + x * box.width, box.y + y * box.height);
      pointer = await stage.evaluate((canvas) => canvas.style.cursor === "pointer");
    }
  }
  check(pointer, "there is a point of the path to click");
  const before = await page.locator(".where").textContent();
  await page.mouse.down();
  await page.mouse.up();
  await page.waitForTimeout(600);
  const after = await page.locator(".where").textContent();
  check(after !== before || /step 8 /.test(after ?? ""), `a click on the path seeks (${before} → ${after})`);
}

async function restores(page, context) {
  await page.locator("#poescope-switch-haptic").click();
  await page.waitForFunction(
    () => document.querySelector('[data-expert="haptic"]')?.classList.contains("off"),
    undefined,
    WAIT,
  );
  await page.waitForFunction(() => /alpha=haptic/.test(location.search), undefined, WAIT);
  const wanted = await page.locator(".where").textContent();
  const address = page.url();
  await press(page, "0");
  await press(page, "g");
  await see(page, /step 1 of/);
  await page.goto(address);
  await page.waitForFunction((text) => document.querySelector(".where")?.textContent === text, wanted, WAIT);
  await page.waitForFunction(
    () => document.querySelector('[data-expert="haptic"]')?.classList.contains("off"),
    undefined,
    WAIT,
  );
  check(true, "a state URL brings step and switches back");
  // Another viewer sees what this one does.
  const other = await context.newPage();
  await other.goto(url);
  await other.locator('.connection[data-open="true"]').waitFor(WAIT);
  await other.waitForFunction(
    () => document.querySelector('[data-expert="haptic"]')?.classList.contains("off"),
    undefined,
    WAIT,
  );
  await press(page, "0");
  await other.waitForFunction(
    () => !document.querySelector('[data-expert="haptic"]')?.classList.contains("off"),
    undefined,
    WAIT,
  );
  check(true, "two viewers see one session");
  await other.close();
}

/** From a key to the frame in which its step is painted; eight keys a second, as fast as one looks. */
async function latency(page) {
  await press(page, "g");
  await see(page, /step 1 of/);
  const times = [];
  for (let i = 0; i < 30; i += 1) {
    const key = i % 2 === 0 ? "l" : "h";
    await page.waitForTimeout(125);
    times.push(
      await page.evaluate(
        (key) =>
          new Promise((done) => {
            const where = document.querySelector(".where");
            const start = performance.now();
            const watch = new MutationObserver(() => {
              watch.disconnect();
              requestAnimationFrame(() => setTimeout(() => done(performance.now() - start)));
            });
            watch.observe(where, { childList: true, characterData: true, subtree: true });
            document.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
          }),
        key,
      ),
    );
  }
  times.sort((a, b) => a - b);
  console.log(`key to paint: median ${times[15].toFixed(0)} ms, p95 ${times[28].toFixed(0)} ms`);
}

async function appearance() {
  for (const scheme of ["light", "dark"]) {
    for (const [width, height] of SIZES) {
      const { page, context } = await open(url, { viewport: { width, height }, colorScheme: scheme });
      await page.keyboard.type(":9");
      await page.keyboard.press("Enter");
      await see(page, /step 9 of/);
      await page.waitForTimeout(700);
      const layout = await page.evaluate(layoutOf);
      check(layout.width <= width, `${width}×${height}: nothing is wider than the window (${layout.width})`);
      if (width >= 1280) check(layout.height <= height, `${width}×${height}: no scrolling (${layout.height})`);
      check(layout.hidden.length === 0, `${width}×${height}: in view are not ${layout.hidden.join(", ")}`);
      const nameless = await page.evaluate(namelessControls);
      check(nameless.length === 0, `controls without a name: ${nameless.join(", ")}`);
      const faint = await page.evaluate(contrastFaults);
      check(faint.length === 0, `${scheme}: too little contrast: ${faint.join(", ")}`);
      await page.screenshot({ path: `${options.out}/${width}x${height}-${scheme}.png` });
      if (width === 400)
        await page.screenshot({ path: `${options.out}/${width}x${height}-${scheme}-full.png`, fullPage: true });
      if (width === 1280) {
        await press(page, "?");
        await page.locator("dialog.help[open]").waitFor(WAIT);
        const faintHelp = await page.evaluate(contrastFaults);
        check(faintHelp.length === 0, `${scheme}, help: too little contrast: ${faintHelp.join(", ")}`);
        await page.screenshot({ path: `${options.out}/help-${scheme}.png` });
      }
      await context.close();
    }
  }
}

async function reconnects(page) {
  server.kill();
  await page.locator('.connection[data-open="false"]').waitFor(WAIT);
  check((await page.locator(".expert").count()) > 0, "what was seen last stays while the server is away");
  await page.waitForTimeout(700);
  server = await serve();
  await page.locator('.connection[data-open="true"]').waitFor(WAIT);
  await press(page, "g");
  await see(page, /step 1 of/);
  await press(page, "l");
  await see(page, /step 2 of/);
  check(true, "connects again, and works");
}

/** A page that is connected, in a context of its own; what it complains about are faults. */
async function open(address, settings = { viewport: { width: 1280, height: 720 } }) {
  const context = await browser.newContext(settings);
  const page = await context.newPage();
  page.on("console", (message) => {
    // A server that was stopped on purpose is no fault of the page.
    const expected = /WebSocket connection|ERR_CONNECTION_REFUSED|GPU stall|GL Driver/.test(message.text());
    if (!expected && ["error", "warning"].includes(message.type())) faults.push(`console: ${message.text()}`);
  });
  page.on("pageerror", (error) => faults.push(`page: ${error.stack}`));
  page.on("request", (request) => {
    if (!request.url().startsWith(url) && !/^(blob|data):/.test(request.url()))
      faults.push(`asks elsewhere: ${request.url()}`);
  });
  await page.goto(address);
  await page.locator('.connection[data-open="true"]').waitFor(WAIT);
  await page.locator("#frame-truth").waitFor(WAIT);
  await see(page, /step \d+ of/);
  return { page, context };
}

async function press(page, key) {
  await page.locator("body").press(key);
}

async function see(page, pattern) {
  await page.waitForFunction(
    ([source]) => new RegExp(source).test(document.querySelector(".where")?.textContent ?? ""),
    [pattern.source],
    WAIT,
  );
}

/** What frames and table look like, each as a text to compare. */
async function looks(page) {
  await page.waitForTimeout(400);
  const frames = await page.evaluate(() =>
    Object.fromEntries(["truth", "belief"].map((name) => [name, document.getElementById(`frame-${name}`).toDataURL()])),
  );
  const stage = await page.locator(".stage").screenshot();
  return { ...frames, stage: stage.toString("base64") };
}

async function changed(page, before, names) {
  return until(page, (now) => names.every((name) => now[name] !== before[name]));
}

async function same(page, before, names) {
  return until(page, (now) => names.every((name) => now[name] === before[name]));
}

async function until(page, holds) {
  for (let i = 0; i < 12; i += 1) if (holds(await looks(page))) return true;
  return false;
}

async function freePort() {
  const probe = createServer();
  await new Promise((ready) => probe.listen(0, "127.0.0.1", ready));
  const { port: free } = probe.address();
  await new Promise((closed) => probe.close(closed));
  return free;
}

/** Starts the server and waits until it answers. */
async function serve() {
  const [command, ...args] = options.command.replaceAll("{port}", String(port)).split(" ");
  const child = spawn(command, args, { stdio: ["ignore", "ignore", "inherit"] });
  const failed = new Promise((_, reject) => child.once("error", reject));
  for (let i = 0; i < 100; i += 1) {
    const answers = await Promise.race([
      fetch(url).then(
        (answer) => answer.ok,
        () => false,
      ),
      failed,
    ]);
    if (answers) return child;
    await new Promise((later) => setTimeout(later, 100));
  }
  throw new Error(`no answer from: ${options.command}`);
}
