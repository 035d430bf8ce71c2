// Drives a real browser over the live view and prints what it saw as one line of JSON.
//   node browse.mjs <playwright-core folder> <chromium> <url> <folder for downloads>
import path from "node:path";
import { pathToFileURL } from "node:url";

const [, , playwright, chromium, url, folder] = process.argv;
const { chromium: launcher } = await import(pathToFileURL(path.join(playwright, "index.mjs")));
const FLAGS = [
  "--headless", "--no-sandbox", "--disable-quic", "--no-first-run",
  "--disable-background-networking", "--disable-component-update", "--disable-sync",
  "--enable-unsafe-swiftshader", // WebGL without a graphics card
];
const WAIT = { timeout: 60000 };
const READ_MS = 150; // the panel's numbers change ten times a second
const SECONDS = 5; // of dragging, over which the rate is measured
const MOVE_MS = 16; // what a mouse does

const browser = await launcher.launch({ executablePath: chromium, args: FLAGS });
const page = await browser.newPage({ viewport: { width: 1000, height: 640 }, hasTouch: true });
const saw = { errors: [], elsewhere: [] };
const DRIVER = /GL Driver Message .*Performance/; // Chromium's own, of drawing without a graphics card
page.on("console", (m) => {
  if (["error", "warning"].includes(m.type()) && !DRIVER.test(m.text())) saw.errors.push(m.text());
});
page.on("pageerror", (e) => saw.errors.push(String(e)));
page.on("request", (r) => { if (!r.url().startsWith(url) && !r.url().startsWith("blob:")) saw.elsewhere.push(r.url()); });

/** The place of an exposed point on the screen: the one nearest the middle, or near it. */
const place = (dx = 0, dy = 0) => page.evaluate(([dx, dy]) => {
  const { load, stage } = window.physgnn;
  const sum = load.touchable.reduce((a, t) => a.add(t.place), load.touchable[0].place.clone().multiplyScalar(0));
  const { x, y } = stage.toScreen(sum.multiplyScalar(1 / load.touchable.length));
  return { x: x + dx, y: y + dy };
}, [dx, dy]);
/** Wait until the newest patch load is sent, predicted and drawn. */
async function predicted(name) {
  await drawn();
  await page.waitForFunction(
    (name) => {
      const { predictions, link } = window.physgnn;
      return link.next === null && predictions[name]?.id === link.id;
    }, name, WAIT);
  await page.waitForTimeout(READ_MS);
  await drawn();
}
const state = async () => page.evaluate(() => ({
  predictions: window.physgnn.predictions,
  patch_load: window.physgnn.load.point && window.physgnn.load.message({ predictors: ["network"] }),
  largest: document.querySelector("#largest").textContent,
  error: document.querySelector("#error").textContent,
  chip: document.querySelector("#chip").textContent,
  displaced: Array.from(window.physgnn.stage.views[0].displacement ?? []),
}));
const picture = async () => (await page.locator("#canvas").screenshot()).toString("base64");
const drawn = () => page.evaluate(() => new Promise((done) =>
  requestAnimationFrame(() => requestAnimationFrame(done))));

async function drag(steps, seconds) {
  const { x, y } = await place();
  await page.mouse.move(x, y);
  await page.mouse.down();
  const start = Date.now(), end = start + 1000 * seconds;
  let i = 0;
  do {
    await page.mouse.move(x + 14 * Math.sin(i / 9), y + 8 * Math.cos(i / 7));
    i += 1;
    await page.waitForTimeout(Math.max(start + i * MOVE_MS - Date.now(), 0)); // a mouse has a clock of its own
  } while (i < steps || Date.now() < end);
  await page.mouse.up();
}

await page.goto(url);
await page.waitForSelector("body[data-ready=yes]", WAIT);
await drawn();
const atRest = await picture();

// a first patch load, so that whatever is compiled on first use is out of the way
await drag(5, 0);
await predicted("network");
saw.dragged = await state();
saw.pictureChanged = (await picture()) !== atRest;

/** Seconds of the processor that all of the browser's processes have taken. */
const devtools = await browser.newBrowserCDPSession();
const processorSeconds = async () => (await devtools.send("SystemInfo.getProcessInfo"))
  .processInfo.reduce((sum, one) => sum + one.cpuTime, 0);

await page.evaluate(() => { window.physgnn.link.drawnIn = []; });
const taken = await processorSeconds();
await drag(0, SECONDS);
saw.processorSeconds = await processorSeconds() - taken;
const latencies = await page.evaluate(() => window.physgnn.link.drawnIn);
saw.rate = latencies.length / SECONDS;
saw.processorMs = 1000 * saw.processorSeconds / latencies.length;
saw.latencyMs = latencies.sort((a, b) => a - b)[Math.floor(latencies.length / 2)];
await predicted("network");

const downloads = {};
for (const [button, name] of [["#save", "load-case.json"], ["#screenshot", "physgnn.png"]]) {
  const [download] = await Promise.all([page.waitForEvent("download", WAIT), page.click(button)]);
  downloads[name] = path.join(folder, download.suggestedFilename());
  await download.saveAs(downloads[name]);
}
saw.downloads = downloads;
saw.saved = await state();

await page.click("label:has(#solve)");
await predicted("finite elements");
saw.solved = await state();
await page.click("label:has(#solve)");

await page.click("label:has(#compare)");
await predicted("finite elements");
saw.captions = await page.locator("#captions span").allInnerTexts();
await page.click("label:has(#compare)");

saw.menu = await page.locator("#fields label").allInnerTexts();
saw.legends = {};
const names = await page.locator("#fields input").evaluateAll((inputs) => inputs.map((i) => i.value));
for (const field of names.reverse()) {
  await page.click(`#fields label:has([value=${field}])`);
  await predicted("network");
  saw.legends[field] = await page.locator("#legend-title").textContent();
}
await page.click("#axes label:has([value=axial])");
await page.waitForFunction(() => window.physgnn.stage.views[0].section !== null, null, WAIT);
await page.click("#axes label:has([value=none])");

await page.focus("#canvas");
await page.keyboard.press("Escape");
await drawn();
saw.released = await state();
await page.keyboard.press("Enter");
const force = await page.evaluate(() => window.physgnn.load.newton);
for (const key of ["+", "ArrowUp", "ArrowLeft", "Shift+ArrowRight", "]"]) await page.keyboard.press(key);
saw.keyboard = { grew: (await page.evaluate(() => window.physgnn.load.newton)) > force, ...(await state()) };
await page.keyboard.press("Escape");

const { x, y } = await place();
await page.touchscreen.tap(x, y);
saw.touched = await state();

await browser.close();
console.log(JSON.stringify(saw));
