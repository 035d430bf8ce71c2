// Light or dark: as the system says, or as was chosen here last.

import { choices } from "./panel.js";

const KEY = "physgnn-theme";
const THEMES = [["auto", "As the system"], ["light", "Light"], ["dark", "Dark"]];
const system = matchMedia("(prefers-color-scheme: light)");
const colours = new Map(); // name → as it is in the theme on show

/** A page that may store nothing still has its themes. */
function remembered() {
  try {
    return localStorage.getItem(KEY) ?? "auto";
  } catch {
    return "auto";
  }
}

function remember(theme) {
  try {
    localStorage.setItem(KEY, theme);
  } catch { /* then it counts until the page is left */ }
}

/** Show the theme and its switch; `restyle` is called when the colours are others. */
export function followTheme(restyle) {
  const { dataset } = document.documentElement;
  const changed = () => { colours.clear(); restyle(); };
  dataset.theme = remembered();
  choices("themes", THEMES, dataset.theme, (chosen) => {
    dataset.theme = chosen;
    remember(chosen);
    changed();
  });
  system.addEventListener("change", changed);
}

/** A colour of style.css in the theme on show, "rgb(…)"; a browser takes a while to find it. */
export function themed(name) {
  if (!colours.has(name)) colours.set(name, resolved(name));
  return colours.get(name);
}

function resolved(name) {
  const probe = document.body.appendChild(document.createElement("i"));
  probe.style.color = `var(--${name})`;
  const { color } = getComputedStyle(probe);
  probe.remove();
  return color;
}
