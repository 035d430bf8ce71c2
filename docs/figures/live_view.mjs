// Pictures of the live view for the documentation, from a server that runs:
//   physgnn view --image mni152
//   node docs/figures/live_view.mjs <playwright-core folder> <chromium> http://127.0.0.1:8750/ docs/images
import path from "node:path";
import { pathToFileURL } from "node:url";

const [, , playwright, chromium, url, folder] = process.argv;
const { chromium: launcher } = await import(pathToFileURL(path.resolve(playwright, "index.mjs")));
const WAIT = { timeout: 120000 };
const FLAGS = ["--headless", "--no-sandbox", "--enable-unsafe-swiftshader"]; // WebGL without a graphics card
const SHARP_MS = 1500;

const browser = await launcher.launch({ executablePath: chromium, args: FLAGS });
const page = await browser.newPage({ viewport: { width: 1280, height: 800 }, colorScheme: "dark" });
await page.goto(url);
await page.waitForSelector("body[data-ready=yes]", WAIT);
const predicted = (name) => page.waitForFunction((name) => {
  const { predictions, link } = window.physgnn;
  return link.next === null && predictions[name]?.id === link.id;
}, name, WAIT);
/** Save a picture without times: they are those of the machine that draws it. */
const picture = async (name) => {
  await page.waitForTimeout(SHARP_MS);
  await page.evaluate(() => {
    document.getElementById("speed").style.visibility = "hidden";
    for (const element of document.querySelectorAll("#captions small, #source")) {
      element.textContent = element.textContent.replace(/ · [\d.]+ m?s/, "");
    }
  });
  await page.screenshot({ path: path.join(folder, name) });
};

await page.focus("#canvas");
await page.keyboard.press("Enter");
await page.locator("#force").fill("2.5");
await page.locator("#radius").fill("37");
await predicted("network");
await picture("live-view.png");

await page.click("label:has(#compare)");
await predicted("finite elements");
await picture("live-view-side-by-side.png");
await page.click("label:has(#compare)");

await page.click("#axes label:has([value=coronal])");
await page.waitForFunction(() => window.physgnn.stage.views[0].section !== null, null, WAIT);
await predicted("network");
await picture("live-view-t1.png");
await browser.close();
