// Drives a real browser over a case and prints what it saw as one line of JSON.
//   node browse_case.mjs <playwright-core folder> <chromium> <url> <folder of measured files, and for pictures>
import path from "node:path";
import { readFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

const [, , playwright, chromium, url, folder] = process.argv;
const { chromium: launcher } = await import(pathToFileURL(path.join(playwright, "index.mjs")));
const FLAGS = [
  "--headless", "--no-sandbox", "--disable-quic", "--no-first-run",
  "--disable-background-networking", "--disable-component-update", "--disable-sync",
  "--enable-unsafe-swiftshader", // WebGL without a graphics card
];
const WAIT = { timeout: 90000 };
const DRIVER = /GL Driver Message .*Performance/;

const browser = await launcher.launch({ executablePath: chromium, args: FLAGS });
const page = await browser.newPage({ viewport: { width: 1100, height: 1000 }, hasTouch: true });
const saw = { errors: [], elsewhere: [], asked: [] };
page.on("console", (m) => {
  if (["error", "warning"].includes(m.type()) && !DRIVER.test(m.text())) saw.errors.push(m.text());
});
page.on("pageerror", (e) => saw.errors.push(String(e)));
page.on("request", (r) => { if (!r.url().startsWith(url) && !r.url().startsWith("blob:")) saw.elsewhere.push(r.url()); });
page.on("websocket", (socket) => socket.on("framesent", ({ payload }) => {
  if (String(payload).includes('"type":"register"')) saw.asked.push(JSON.parse(payload));
}));

const text = (id) => page.locator(`#${id}`).textContent();
const settled = (id, pattern) => page.waitForFunction(
  ([id, source]) => new RegExp(source).test(document.getElementById(id).textContent), [id, pattern.source], WAIT);
const drawn = () => page.evaluate(() => new Promise((done) =>
  requestAnimationFrame(() => requestAnimationFrame(done))));
const picture = async (name) => { await page.waitForTimeout(500); await page.screenshot({ path: path.join(folder, name) }); };
/** Where a place of the brain at rest is on the screen. */
const screen = (place) => page.evaluate((p) => {
  const { stage, load } = window.physgnn;
  const box = stage.canvas.getBoundingClientRect();
  const { x, y } = stage.toScreen(load.touchable[0].place.clone().set(...p));
  return { x: x + box.left, y: y + box.top };
}, place);
/** The lowest contrast of text that is shown, after WCAG 2.2, and whose it is. */
const contrast = () => page.evaluate(() => {
  const numbers = (colour) => colour.match(/[\d.]+/g).map(Number);
  const over = ([r, g, b, a = 1], below) => [r, g, b].map((v, i) => a * v + (1 - a) * below[i]);
  const light = (rgb) => rgb.map((v) => v / 255)
    .map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4))
    .reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
  const ratio = (a, b) => (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
  /** What may be behind an element: several colours where it is a gradient. */
  const behind = (element) => {
    if (element === null) return [[255, 255, 255]];
    const { backgroundColor, backgroundImage } = getComputedStyle(element);
    const stops = backgroundImage.match(/rgba?\([^)]*\)/g);
    if (stops) return stops.map(numbers);
    const own = numbers(backgroundColor);
    return own[3] === 0 ? behind(element.parentElement) : behind(element.parentElement).map((below) => over(own, below));
  };
  let worst = { ratio: 21, text: "" }, texts = 0;
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const text = walker.currentNode.textContent.trim(), element = walker.currentNode.parentElement;
    if (!text || !element.checkVisibility({ opacityProperty: true, visibilityProperty: true })) continue;
    if (element.matches("option") || element.closest(":disabled") || element.parentElement.querySelector(":disabled + span")) continue;
    texts += 1;
    for (const below of behind(element)) {
      const found = ratio(light(over(numbers(getComputedStyle(element).color), below)), light(below));
      if (found < worst.ratio) worst = { ratio: found, text: `${text}: ${getComputedStyle(element).color} on ${below}` };
    }
  }
  return { ...worst, texts };
});
/** What lies over something else, or is wider than its place, in windows of some widths. */
async function misplaced() {
  const before = page.viewportSize(), found = [];
  for (const width of [400, 800, 1400]) {
    await page.setViewportSize({ width, height: 800 });
    await drawn();
    found.push(...await page.evaluate((width) => {
      const shown = (element) => element.checkVisibility({ opacityProperty: true, visibilityProperty: true });
      const over = ["main header", "#hint:not(.done)", "#reasons li", "#legend", "#speed", "#message"]
        .flatMap((name) => [...document.querySelectorAll(name)].map((element) => [name, element]))
        .filter(([, element]) => shown(element) && element.textContent.trim())
        .map(([name, element]) => [name, element.getBoundingClientRect()]);
      const faults = over.flatMap(([name, a], i) => over.slice(i + 1)
        .filter(([, b]) => a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1)
        .map(([other]) => `${width}: ${name} over ${other}`));
      const stage = document.getElementById("stage").getBoundingClientRect();
      for (const [name, box] of over) {
        if (box.left < stage.left || box.right > stage.right || box.bottom > stage.bottom) faults.push(`${width}: ${name} outside`);
      }
      for (const element of document.querySelectorAll("aside, aside *:not(select, option, input, #state-marks *)")) {
        if (shown(element) && element.clientWidth && element.scrollWidth > element.clientWidth + 1) {
          faults.push(`${width}: ${element.tagName} ${element.id || element.textContent.trim().slice(0, 40)} is cut`);
        }
      }
      return faults;
    }, width));
  }
  await page.setViewportSize(before);
  await drawn();
  return found;
}
const menus = () => page.locator("#menus label").evaluateAll((all) => Object.fromEntries(all.map(
  (one) => [one.querySelector("select").id, one.checkVisibility() ? [...one.querySelectorAll("option")].map((o) => o.text) : null])));
const theme = () => page.evaluate(() => [document.documentElement.dataset.theme, getComputedStyle(document.body).backgroundColor]);
/** Drop files on the page as a file manager does. */
async function drop(...names) {
  const files = names.map((name) => ({ name, content: readFileSync(path.join(folder, name)).toString("base64") }));
  await page.evaluate((files) => {
    const data = new DataTransfer();
    for (const { name, content } of files) {
      data.items.add(new File([Uint8Array.from(atob(content), (c) => c.charCodeAt(0))], name));
    }
    for (const type of ["dragover", "drop"]) {
      document.body.dispatchEvent(new DragEvent(type, { dataTransfer: data, bubbles: true, cancelable: true }));
    }
  }, files);
}

await page.goto(url);
await page.waitForSelector("body[data-ready=yes]", WAIT);
await drawn();
saw.note = await text("note");
saw.misplaced = { rest: await misplaced() };
saw.menus = { rest: await menus() };

// the craniotomy: a click, the radius, opened
await page.click("#pick");
const { x, y } = await screen([40, 40, 80]);
await page.mouse.click(x, y);
await settled("opened", /cm² open/);
saw.tried = await text("opened");
await page.locator("#opening").fill("20");
await page.waitForFunction((before) => document.getElementById("opened").textContent !== before, saw.tried, WAIT);
saw.smaller = await text("opened");
saw.loadedMeanwhile = await page.evaluate(() => window.physgnn.load.point !== null);
await picture("craniotomy.png");
await page.click("#open");
await settled("opened", /Saved/);
saw.opened = await text("opened");
saw.noteAfter = await text("note");

// a file that is none, by its name and by its content
await drop("picture.gif");
await settled("message", /picture\.gif/);
saw.refused = await text("message");
await drop("broken.csv");
await page.click("#register");
await settled("registered", /broken\.csv/);
saw.broken = await text("registered");
await page.click("#files button");

// a scan calls for its contrast, a transform for what it takes along
await drop("scan.nii.gz");
saw.menus.scan = await menus();
await page.locator("#contrast").selectOption("flair");
await page.click("#register");
await settled("registered", /scan\.nii\.gz/);
saw.scan = await text("registered");
await page.locator("#files select").selectOption("surface");
saw.menus.noScan = await menus();
await page.click("#files button");

// what was measured, registered, saved
await drop("pairs.csv");
saw.roles = await page.locator("#files select").first().locator("option").allInnerTexts();
await page.click("#register");
await settled("registered", /Misfit/);
await page.waitForFunction(() => window.physgnn.predictions.registration?.field === "deviation"
  && window.physgnn.stage.views[0].sectionValues !== null, null, WAIT);
await drawn();
saw.registered = await text("registered");
saw.chip = await text("chip");
saw.header = await page.evaluate(() => window.physgnn.predictions.registration);
saw.displaced = await page.evaluate(() => Array.from(window.physgnn.stage.views[0].displacement));
saw.legend = await text("legend-title");
saw.misfits = await page.locator("#misfits tr").allInnerTexts();
saw.found = Object.fromEntries(await page.locator("#found dt").evaluateAll(
  (rows) => rows.map((row) => [row.textContent, row.nextElementSibling.textContent])));
const [csv] = await Promise.all([page.waitForEvent("download", WAIT), page.click("#misfits-csv")]);
saw.csv = { name: csv.suggestedFilename(), path: path.join(folder, "downloaded.csv") };
await csv.saveAs(saw.csv.path);
saw.reasons = await page.locator("#reasons li").allInnerTexts();
await page.emulateMedia({ colorScheme: "dark" });
saw.dark = { theme: await theme(), contrast: await contrast() };
await picture("registration.png");
await page.emulateMedia({ colorScheme: "light" });
saw.light = { theme: await theme(), contrast: await contrast() };
await picture("registration-light.png");
saw.misplaced.registered = await misplaced();
await page.click("#keep");
await settled("registered", /Saved/);
saw.saved = await text("registered");

// a load takes its place, and it comes back
await page.focus("#canvas");
await page.keyboard.press("Enter");
await page.waitForFunction(() => window.physgnn.predictions.linear !== undefined, null, WAIT);
saw.loaded = await page.evaluate(() => Object.keys(window.physgnn.predictions));
await page.click("#show");
await page.waitForFunction(() => window.physgnn.predictions.registration !== undefined, null, WAIT);

// the package's network, adapted to the case
await page.click("#adapt");
await page.waitForFunction(() => /network|cannot|must|does/.test(document.getElementById("opened").textContent)
  && !/adapting/.test(document.getElementById("opened").textContent)
  || /adapted/.test(document.getElementById("note").textContent), null, WAIT);
saw.adapted = { note: await text("note"), opened: await text("opened"),
  predictors: await page.locator("#predictors span").allInnerTexts() };

// a series
await drop("state-2.csv", "state-10.csv", "tracker.txt");
await page.click("label:has(#rigid-offset)");
saw.menus.transform = await menus();
await page.locator("#transformed").selectOption("after");
saw.guessed = await page.locator("#files select").evaluateAll((all) => all.map((one) => one.value));
saw.order = await page.locator("#files .name").allInnerTexts();
await page.click("#register");
await page.waitForFunction(() => window.physgnn.predictions.registration?.states === 3, null, WAIT);
await page.locator("#state").fill("1");
await page.waitForFunction(() => window.physgnn.predictions.registration?.state === 0, null, WAIT);
saw.first = await page.evaluate(() => window.physgnn.predictions.registration.name);
saw.offset = await text("found-offset");
await picture("series.png");
await page.click("#keep");
await settled("registered", /Saved/);
saw.series = await text("registered");

// one more state, which fails
await drop("broken.csv");
await page.click("#register");
await page.waitForFunction(() => window.physgnn.predictions.registration?.states === 4, null, WAIT);
saw.failed = {
  shown: await page.evaluate(() => window.physgnn.predictions.registration.name),
  lines: await page.locator("#failed li").allInnerTexts(),
  marks: await page.locator("#state-marks i").evaluateAll((all) => all.map((one) => one.title)),
};
await page.locator("#state").fill("1");
Object.assign(saw.failed, {
  value: await text("state-value"), chip: await text("chip"), source: await text("source"),
  reasons: await page.locator("#reasons li").allInnerTexts(),
  predictions: await page.evaluate(() => Object.keys(window.physgnn.predictions)),
  misfits: await page.locator("#misfits-csv").isVisible(),
});
saw.misplaced.failed = await misplaced();
await picture("failed.png");
await page.locator("#state").fill("3");
await page.waitForFunction(() => window.physgnn.predictions.registration?.state === 2, null, WAIT);
saw.failed.next = { chip: await text("chip"), source: await text("source"), misfits: await page.locator("#misfits-csv").isVisible() };
await page.click("#keep");
await settled("registered", /Saved/);
saw.failed.saved = await text("registered");

// the theme that is chosen stays
await page.click("#themes label:has([value=dark])");
saw.chosen = await theme();
await page.reload();
await page.waitForSelector("body[data-ready=yes]", WAIT);
saw.remembered = await theme();

await browser.close();
console.log(JSON.stringify(saw));
