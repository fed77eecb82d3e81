// Drives viser's own client in a real Chromium against a running server, and keeps pictures of it.
//
//   node tests/browser/stock.mjs --page PATH/viser/client/build/index.html [--command "… serve --port {port}"] [--out DIR] [--require]
//
// The page is the one file of the Python package viser 1.1.1. Where it or Chromium is not there this says so and ends
// well; --require makes that a failure.
import { spawn, spawnSync } from "node:child_process";
import { existsSync, mkdirSync, readFileSync } from "node:fs";
import { createServer as httpServer } from "node:http";
import { createServer } from "node:net";
import { parseArgs } from "node:util";
import { chromium } from "playwright-core";

const { values: options } = parseArgs({
  options: {
    page: { type: "string", default: process.env["VISER_CLIENT"] ?? "" },
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
const PATIENCE = 40_000;
/** What the page itself complains about, whatever it is told. */
const BENIGN = /favicon|passive event listener/i;

const executablePath = [process.env["CHROMIUM"], "chromium", "chromium-browser", "google-chrome"]
  .filter(Boolean)
  .map((name) => spawnSync("which", [name]).stdout.toString().trim())
  .find(Boolean);
const missing =
  executablePath === undefined ? "no Chromium" : existsSync(options.page) ? undefined : "no page of viser 1.1.1";
if (missing !== undefined) {
  console.log(`skipped: ${missing}`);
  process.exit(options.require ? 1 : 0);
}

const port = await freePort();
const page = readFileSync(options.page);
const site = httpServer((_, answer) => answer.setHeader("Content-Type", "text/html").end(page));
await new Promise((done) => site.listen(0, "127.0.0.1", done));
const url = `http://127.0.0.1:${site.address().port}/?websocket=ws://127.0.0.1:${port}`;
const faults = [];
let checks = 0;
let server = await serve();
mkdirSync(options.out, { recursive: true });
const browser = await chromium.launch({
  executablePath,
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});
try {
  const one = await open();
  const other = await open();
  await scrubs(one, other);
  await switches(one, other);
  for (const [width, height] of SIZES) {
    // That client keeps its panel where it was, so each size has a page of its own.
    const sized = await open({ width, height });
    await sized.waitForTimeout(4000);
    await sized.screenshot({ path: `${options.out}/stock-${width}.png` });
    await sized.close();
  }
  await reconnects(one);
} finally {
  await browser.close();
  server.kill();
  site.close();
}
for (const fault of faults) console.log(`FAILED ${fault}`);
console.log(`${checks - faults.length} of ${checks} checks hold; pictures in ${options.out}`);
process.exit(faults.length === 0 ? 0 : 1);

async function open(viewport = { width: 1280, height: 720 }) {
  const page = await browser.newPage({ viewport });
  page.errors = [];
  page.on("console", (message) => {
    if (message.type() === "error" && !BENIGN.test(message.text()))
      page.errors.push(`${message.text()} ${message.location().url}`);
  });
  page.on("pageerror", (error) => page.errors.push(String(error)));
  await page.goto(url);
  await holds("it connects", page, () => document.body.innerText.includes("Experts"));
  return page;
}

async function scrubs(one, other) {
  const before = await pictures(other);
  const table = await drawn(other);
  const slider = one.locator("label", { hasText: /^Step$/ }).first();
  const id = await slider.getAttribute("for");
  const thumb = one.locator(`[id="${id}"] [role=slider]`);
  await thumb.focus();
  // Back to where there is no belief, whose chart goes, and forth.
  await thumb.press("Home");
  await holds("the other client shows the first step", other, () => /step\s*1\s*of/.test(document.body.innerText));
  for (let press = 0; press < 6; press++) await thumb.press("ArrowRight");
  await holds("the other client shows the step", other, () => /step\s*7\s*of/.test(document.body.innerText));
  await differs("the other client shows its frames", other, before);
  await moves("the other client shows the plate moved", other, table);
  await holds("prediction and error are there", one, () => document.querySelectorAll("img").length >= 4);
}

async function switches(one, other) {
  const before = await pictures(other);
  const table = await drawn(other);
  await other.waitForTimeout(1000);
  check("the 3-D view stands still while nothing happens", (await drawn(other)) === table);
  await holds("vision has a share", other, () => /V vision\s*[1-9]\d* %/.test(document.body.innerText));
  const box = (page) => page.getByLabel("V vision", { exact: true });
  check("vision is on", await box(other).isChecked());
  await box(one).click({ force: true });
  await holds("a switch shows in the other client", other, () => {
    const label = [...document.querySelectorAll("label")].find((each) => each.textContent === "V vision");
    return document.getElementById(label?.htmlFor)?.checked === false;
  });
  await differs("the belief changes with it", other, before);
  await holds("its share is gone", other, () => /V vision\s*0 %/.test(document.body.innerText));
  await moves("the predicted plate moves with it", other, table);
  for (const page of [one, other]) check(`no errors: ${page.errors.join(" | ")}`, page.errors.length === 0);
}

async function reconnects(page) {
  await page.bringToFront();
  server.kill("SIGTERM");
  await new Promise((done) => server.once("exit", done));
  await page.waitForTimeout(1000);
  server = await serve();
  // A new session begins at the first predicted step.
  await holds("it comes back after a restart", page, () => /step\s*5\s*of/.test(document.body.innerText));
}

/** Whether the frames become others. */
async function differs(what, page, before) {
  const changed = (before) => {
    const now = [...document.querySelectorAll("img")].map((image) => image.src);
    return JSON.stringify(now) !== JSON.stringify(before);
  };
  const held = await page.waitForFunction(changed, before, { timeout: PATIENCE, polling: 200 }).catch(() => undefined);
  check(what, held !== undefined);
}

/** Whether the 3-D view becomes another. */
async function moves(what, page, before) {
  let now = before;
  for (let tries = 0; tries < 40 && now === before; tries++) {
    await page.waitForTimeout(250);
    now = await drawn(page);
  }
  check(what, now !== before);
}

/** The 3-D view, read in the very frame that draws it: afterwards the browser has taken it away. */
async function drawn(page) {
  await page.bringToFront();
  return page.evaluate(
    () =>
      new Promise((done) => {
        const area = (canvas) => canvas.width * canvas.height;
        const [largest] = [...document.querySelectorAll("canvas")].sort((a, b) => area(b) - area(a));
        requestAnimationFrame(() => done(largest.toDataURL()));
      }),
  );
}

/** What the frames are, as their addresses say. */
function pictures(page) {
  return page.evaluate(() => [...document.querySelectorAll("img")].map((image) => image.src));
}

async function holds(what, page, condition) {
  const held = await page.waitForFunction(condition, undefined, { timeout: PATIENCE, polling: 200 }).catch(() => undefined);
  check(what, held !== undefined);
}

function check(what, held) {
  checks += 1;
  if (!held) faults.push(what);
}

async function serve() {
  const [program, ...rest] = options.command.replace("{port}", String(port)).split(" ");
  const child = spawn(program, rest, { stdio: ["ignore", "pipe", "inherit"] });
  await new Promise((done, fail) => {
    child.stdout.once("data", done);
    child.once("exit", () => fail(new Error(`${options.command} ended`)));
  });
  return child;
}

async function freePort() {
  const probe = createServer();
  await new Promise((done) => probe.listen(0, "127.0.0.1", done));
  const { port } = probe.address();
  await new Promise((done) => probe.close(done));
  return port;
}
