// The panel beside the brain: what it shows and what it lets one choose.

import { drawLegend, FIELDS, ticks } from "../scene/colours.js";

export const $ = (id) => document.getElementById(id);

const READ_MS = 100; // numbers that change faster can't be read, and cost time

export const NAMES = {
  network: "Network", linear: "Linear", "finite elements": "Finite elements", registration: "Registration",
};

/** Set a text that often stays as it is: the same again would still be laid out anew. */
export function write(id, text) {
  if ($(id).textContent !== text) $(id).textContent = text;
}

/** Fill a group of radio buttons; `options` is a list of [value, label, enabled]. */
export function choices(id, options, chosen, onChoose) {
  $(id).replaceChildren(...options.map(([value, label, enabled = true]) => {
    const row = document.createElement("label");
    const input = Object.assign(document.createElement("input"), {
      type: "radio", name: id, value, checked: value === chosen, disabled: !enabled,
    });
    const text = Object.assign(document.createElement("span"), { textContent: label });
    input.addEventListener("change", () => onChoose(value));
    row.append(input, text);
    return row;
  }));
}

export function choose(id, value) {
  const input = document.querySelector(`#${id} input[value="${value}"]`);
  if (input && !input.disabled) input.click();
}

/** A slider with its value beside it. */
export function slider(id, { min, max, value }, format, onInput) {
  const input = $(id);
  Object.assign(input, { min, max });
  input.value = value;
  const show = () => { $(`${id}-value`).textContent = format(Number(input.value)); };
  input.oninput = () => { show(); onInput(Number(input.value)); };
  show();
  return (v) => { input.value = v; show(); };
}

/** Call `act` at once, and again at most so often as one can read, with what is newest. */
function calm(act) {
  let newest = null, timer = 0;
  const run = () => {
    timer = 0;
    if (newest === null) return;
    timer = setTimeout(run, READ_MS);
    act(...newest.splice(0));
    newest = null;
  };
  const calmed = (...values) => {
    newest = values;
    if (!timer) run();
  };
  calmed.cancel = () => { newest = null; };
  return calmed;
}

export function showRest() {
  showPrediction.cancel();
  chip("at rest", "");
  $("chip").title = "";
  for (const id of ["largest", "tumour", "error"]) $(id).textContent = "–";
  showReasons([]);
  $("source").textContent = "";
  $("error-name").textContent = "Error at most";
  $("error-bar").className = "unknown";
  $("error-bar").querySelector(".value").style.left = "0";
}

/** A state that could not be registered. */
export function showFailed({ name, reason }) {
  chip("not registered", "failed");
  $("source").textContent = name;
  showReasons([reason]);
}

function showReasons(reasons) {
  $("reasons").replaceChildren(...reasons.map((text) =>
    Object.assign(document.createElement("li"), { textContent: text })));
}

export const showPrediction = calm((header, solving) => {
  $("largest").textContent = header.largest_mm.toFixed(2);
  $("tumour").textContent = header.tumour_mm === null ? "–" : header.tumour_mm.toFixed(2);
  showError(header);
  showStatus(header);
  const after = solving ? " · finite elements are solving…" : "";
  const what = header.name ?? `${header.loaded_nodes} nodes loaded`;
  $("source").textContent = `${NAMES[header.predictor]} · ${milliseconds(header.seconds)} · ${what}${after}`;
});

/** What the chip says of a status that is not usable: its text and kind. */
const FLAGGED = {
  "outside trained range": ["outside the trained range", "outside"],
  "tolerance not met": ["not solved", "failed"],
  "implausible displacement": ["implausible displacement", "failed"],
};

const FINE = { network: "inside the trained range", registration: "registered" };

function showStatus({ predictor, status, usable, remedy, reasons }) {
  // Linear elasticity is shown to compare with, and says itself what it is.
  const compared = predictor === "linear" && status === "no error estimate";
  if (compared) chip("linear elasticity", "");
  else if (!usable) chip(...(FLAGGED[status] ?? [status, "outside"]));
  else chip(FINE[predictor] ?? "solved", "ok");
  $("chip").title = remedy;
  showReasons(compared ? [] : reasons);
}

function showError({ error, usable, largest_mm: largest }) {
  const bar = $("error-bar");
  bar.className = error ? "" : "unknown";
  $("error").textContent = error ? precise(error.max_mm) : "?";
  const chance = error?.coverage < 1 ? ` (${Math.round(100 * error.coverage)} %)` : "";
  $("error-name").textContent = usable || !error ? `Error at most${chance}` : "Error, not promised";
  const end = 1.25 * (largest + (error?.max_mm ?? 0)) || 1;
  const percent = (mm) => `${(100 * Math.min(Math.max(mm / end, 0), 1)).toFixed(1)}%`;
  bar.querySelector(".value").style.left = percent(largest);
  if (!error) return;
  const range = bar.querySelector(".range");
  range.style.left = percent(largest - error.max_mm);
  range.style.right = `calc(100% - ${percent(largest + error.max_mm)})`;
  bar.setAttribute("aria-label",
    `largest displacement ${largest.toFixed(2)} mm, error at most ${precise(error.max_mm)} mm`);
}

function chip(text, kind) {
  $("chip").textContent = text;
  $("chip").className = `chip ${kind}`;
}

function precise(mm) {
  return mm < 0.1 ? String(Number(mm.toPrecision(2))) : mm.toFixed(2);
}

export function milliseconds(seconds) {
  return seconds < 1 ? `${Math.round(1000 * seconds)} ms` : `${seconds.toFixed(1)} s`;
}

let legend = "";

export function showLegend(field, range) {
  if (legend === (legend = `${field} ${range}`)) return;
  $("legend").hidden = false;
  $("legend-title").textContent = FIELDS[field].title;
  drawLegend($("legend-bar").getContext("2d"), field);
  $("legend-ticks").replaceChildren(...ticks(range).map((text) =>
    Object.assign(document.createElement("span"), { textContent: text })));
}

let hiding = 0;

export function showMessage(text) {
  $("message").textContent = text;
  $("message").hidden = false;
  clearTimeout(hiding);
  hiding = setTimeout(hideMessage, 6000);
}

export function hideMessage() {
  $("message").hidden = true;
}
