// The picture of a case in the live view, from a server that runs:
//   python docs/figures/live_case.py patient/
//   physgnn view patient/case.vtu --image mni152 --save patient/kept
//   node docs/figures/live_case.mjs <playwright-core folder> <chromium> http://127.0.0.1:8750/ patient docs/images
import path from "node:path";
import { pathToFileURL } from "node:url";

const [, , playwright, chromium, url, patient, folder] = process.argv;
const { chromium: launcher } = await import(pathToFileURL(path.resolve(playwright, "index.mjs")));
const WAIT = { timeout: 120000 };
const FLAGS = ["--headless", "--no-sandbox", "--enable-unsafe-swiftshader"]; // WebGL without a graphics card
const CRANIOTOMY = [39.7, 8.8, 62.5]; // of the bundled brain, mm
const STATES = [1, 2, 3];
const NEARER = -250; // turns of the wheel towards the brain
const SHARP_MS = 1500;

const browser = await launcher.launch({ executablePath: chromium, args: FLAGS });
const page = await browser.newPage({ viewport: { width: 1280, height: 1100 }, colorScheme: "dark" });
await page.goto(url);
await page.waitForSelector("body[data-ready=yes]", WAIT);
const said = (id, pattern) => page.waitForFunction(
  ([id, source]) => new RegExp(source).test(document.getElementById(id).textContent), [id, pattern.source], WAIT);

await page.click("#pick");
const { x, y } = await page.evaluate((place) => {
  const { stage, load } = window.physgnn;
  const box = stage.canvas.getBoundingClientRect();
  const at = stage.toScreen(load.touchable[0].place.clone().set(...place));
  return { x: at.x + box.left, y: at.y + box.top };
}, CRANIOTOMY);
await page.mouse.click(x, y);
await said("opened", /cm² open/);
await page.click("#open");
await page.waitForFunction(() => document.getElementById("open").disabled, null, WAIT);

const files = STATES.flatMap((i) => [`cortex-${i}.csv`, `ultrasound-${i}.csv`]);
await page.setInputFiles("#choose", files.map((name) => path.join(patient, name)));
await page.locator("#noise").fill("0.7");
await page.click("#register");
await said("registered", /Misfit/);
await page.waitForFunction((states) => window.physgnn.predictions.registration?.states === states, STATES.length, WAIT);
await page.click("#axes label:has([value=coronal])");
await page.mouse.move(x, y);
await page.mouse.wheel(0, NEARER);
await page.waitForFunction(() => window.physgnn.stage.views[0].sectionValues !== null, null, WAIT);
await page.waitForTimeout(SHARP_MS);
await page.evaluate(() => { // without times: they are those of the machine that draws it
  document.getElementById("speed").style.visibility = "hidden";
  const source = document.getElementById("source");
  source.textContent = source.textContent.replace(/ · [\d.]+ m?s/, "");
  document.querySelector("aside").scrollTop = 0;
});
await page.screenshot({ path: path.join(folder, "live-view-case.png") });
await browser.close();
