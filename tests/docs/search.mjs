// Opens the built site from its folder, searches for a word and prints what was found.
//   node search.mjs <playwright-core folder> <chromium> <site folder> <word>
import path from "node:path";
import { pathToFileURL } from "node:url";

const [, , playwright, chromium, site, word] = process.argv;
const { chromium: launcher } = await import(pathToFileURL(path.join(playwright, "index.mjs")));
const browser = await launcher.launch({
  executablePath: chromium, args: ["--headless", "--no-sandbox", "--disable-background-networking"],
});
const page = await browser.newPage();
const saw = { errors: [], elsewhere: [] };
page.on("console", (m) => { if (["error", "warning"].includes(m.type())) saw.errors.push(m.text()); });
page.on("pageerror", (e) => saw.errors.push(String(e)));
page.on("request", (r) => { if (/^https?:/.test(r.url())) saw.elsewhere.push(r.url()); });

await page.goto(pathToFileURL(path.join(site, "index.html")).href);
await page.locator("input.md-search__input").fill(word);
await page.waitForSelector(".md-search-result__link", { timeout: 60000, state: "attached" });
saw.found = await page.locator(".md-search-result__link").evaluateAll((all) => all.map((a) => a.href));
console.log(JSON.stringify(saw));
await browser.close();
