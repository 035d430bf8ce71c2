// The page: what one does is asked of the server, and what comes from it is shown.

import { Choices } from "./controls/choices.js";
import { listen } from "./controls/keys.js";
import { Load } from "./controls/load.js";
import * as panel from "./controls/panel.js";
import { Patient } from "./controls/patient.js";
import { saveLoadCase, savePicture } from "./controls/save.js";
import { followTheme } from "./controls/theme.js";
import { Touch } from "./controls/touch.js";
import { Display, REGISTERED, SOLVED } from "./display.js";
import { Link } from "./protocol/link.js";
import { FIELDS, setFields } from "./scene/colours.js";
import { Stage } from "./scene/stage.js";

const { $ } = panel;
const SPEED_MS = 500; // between two readings of the speed
let setForce = () => {};
let setRadius = () => {};

const stage = new Stage($("canvas"), $("letters"));
const load = new Load(loadChanged);
const chosen = new Choices({
  changePredictor: () => { display.predictions.clear(); askIfLoaded(); },
  ask: askIfLoaded,
  askAgain,
  askSection,
  compare: () => { display.arrangeViews(); display.show(); askIfLoaded(); },
  restyle: () => display.restyle(),
});
const display = new Display(stage, load, chosen);
const touch = new Touch(stage, load, () => load.tail);
listen(stage, load, {
  fields: () => Object.keys(FIELDS),
  changeForce: (factor) => { load.newton = Math.min(load.newton * factor, load.maxNewton); loadChanged(); },
  changeRadius: (factor) => {
    load.radius = Math.min(Math.max(load.radius * factor, 1), display.scene.max_radius_mm);
    loadChanged();
  },
});
const link = new Link({ onScene, onSection, onPrediction, onCraniotomy, onState, onText, onClosed });
const patient = new Patient(link, {
  pick: (pick) => {
    const picked = touch.pick !== null;
    touch.pick = pick;
    stage.canvas.classList.toggle("picking", pick !== null);
    if (pick && load.point) load.release();
    if (pick) $("hint").textContent = "Click the middle of the craniotomy.";
    if (pick || picked) $("hint").classList.toggle("done", !pick);
  },
  preview: (arrays) => display.preview(arrays),
  showRest,
  message: panel.showMessage,
  field: () => chosen.field,
});

// --- from the server

function onScene(header, arrays) {
  chosen.predictor = header.predictors[0];
  setFields(header.fields);
  if (!FIELDS[chosen.field]?.available) [chosen.field] = Object.keys(FIELDS);
  display.fit(header, arrays);
  load.fit(header, arrays, stage.views[0].brain.normal.slice(), stage.size);
  setForce = panel.slider("force", { min: 0.02 * header.max_force_n, max: header.max_force_n, value: load.newton },
    (v) => `${v.toFixed(2)} N`, (v) => { load.newton = v; loadChanged(); });
  setRadius = panel.slider("radius", { min: 2, max: header.max_radius_mm, value: load.radius },
    (v) => `${v.toFixed(0)} mm`, (v) => { load.radius = v; loadChanged(); });
  chosen.fit(header, stage.box);
  patient.fit(header.patient);
  display.showRest();
  document.body.dataset.ready = "yes";
}

function onSection(header, arrays) {
  display.cut({ header, arrays });
  askAgain();
}

function onCraniotomy(header, arrays) {
  patient.onCraniotomy(header, arrays);
}

/** A registered state takes the place of a load. */
function onState(header, arrays) {
  const first = patient.onState(header);
  if (first === null) return;
  $("hint").classList.add("done");
  if (first) panel.hideMessage();
  if (load.point) load.release();
  display.register(header, arrays);
  if (first) chosen.colourByDeviation(display.scene);
}

/** Nothing that was registered is on show any more: a state of it failed, or it is registered anew. */
function showRest(failed = null) {
  if (failed && load.point) load.release();
  display.hideRegistration();
  if (!load.point) display.showRest();
  if (failed) panel.showFailed(failed);
}

function onPrediction(header, arrays, sent) {
  // While the pointer moves, a prediction for a moment ago is better than none.
  if (!load.point || (header.predictor === SOLVED && header.id !== link.id)) return;
  display.predictions.set(header.predictor, { header, arrays });
  if (header.predictor === SOLVED) display.solving = false;
  display.show();
  if (sent !== null) stage.afterDraw = () => link.drawn(sent);
}

function onText(message) {
  if (patient.onText(message)) return;
  if (message.kind === "solving") display.solving = message.id === link.id;
  else { display.solving = false; panel.showMessage(message.text); }
  display.show();
}

function onClosed() {
  patient.onClosed();
  if (display.scene) panel.showMessage("the server is gone; looking for it again…");
}

// --- to the server

function ask() {
  display.predictions.delete(SOLVED);
  display.solving = false;
  link.request(() => load.message(wanted()));
}

function askIfLoaded() {
  if (load.point) ask();
}

/** Ask anew for what is on show, with the scalar and the section that are chosen now. */
function askAgain() {
  if (load.point) ask();
  else if (display.predictions.has(REGISTERED)) patient.askState();
  else display.show();
}

function wanted() {
  const { compare, predictor, field, solve } = chosen;
  return { predictors: compare ? display.scene.predictors : [predictor], field, solve: solve || compare };
}

function loadChanged() {
  setForce(load.newton);
  setRadius(load.radius);
  $("save").disabled = load.point === null;
  display.hideRegistration();
  if (load.point) {
    $("hint").classList.add("done");
    ask();
    display.showLoadSoon();
  } else {
    link.forget();
    link.send({ type: "release" });
    display.showRest();
  }
}

function askSection() {
  const { section } = chosen;
  link.send({ type: "section", ...section });
  if (section.axis !== null) return;
  display.cut(null);
  display.show();
}

// --- beside the brain

function showSpeed() {
  const rate = link.rate();
  const latency = link.latencyMs === null ? "" : `${Math.round(link.latencyMs)} ms latency`;
  panel.write("speed", rate > 1 ? `${rate} predictions/s · ${latency}` : latency);
}
setInterval(showSpeed, SPEED_MS);
followTheme(() => display.retint());

$("release").addEventListener("click", () => load.release());
$("inward").addEventListener("click", () => load.straighten());
$("reset").addEventListener("click", () => stage.resetView());
$("save").addEventListener("click", () => {
  saveLoadCase(load.message(wanted())).catch((error) => panel.showMessage(error.message));
});
$("screenshot").addEventListener("click", () => {
  const { title, largest, range } = display;
  savePicture(stage, { lines: [title, largest], field: chosen.field, range });
});

/** For tests and for scripts: what is on show, as plain values. */
window.physgnn = {
  load,
  stage,
  link,
  patient,
  get predictions() {
    return Object.fromEntries([...display.predictions].map(([name, { header }]) => [name, header]));
  },
  get solving() { return display.solving; },
};
