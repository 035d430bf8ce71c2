// The page: what is chosen, what is asked of the server, what is shown of its predictions.

import * as THREE from "three";
import { FIELDS, rangeOf, setFields } from "./scene/colours.js";
import { saveLoadCase, savePicture } from "./controls/save.js";
import { listen } from "./controls/keys.js";
import { Link } from "./protocol/link.js";
import { Load } from "./controls/load.js";
import * as panel from "./controls/panel.js";
import { Patient } from "./controls/patient.js";
import { Stage } from "./scene/stage.js";
import { Touch } from "./controls/touch.js";

const { $, NAMES } = panel;
const SOLVED = "finite elements";
const REGISTERED = "registration";
const FAINT = 0.5; // how far the image shows through a registration's colours
const AXES = [["none", "Off"], ["sagittal", "Sag"], ["coronal", "Cor"], ["axial", "Ax"]];
const LABEL_PX = 72; // room for the force beside its arrow
const PATIENCE_MS = 80; // a prediction draws the load too; later than this it is drawn alone
const COLOURS = { calm: 0x45c3a6, outside: 0xf0a843 };

const chosen = { predictor: "network", field: null, solve: false, compare: false, axis: "none" };
const predictions = new Map(); // name → {header, arrays} of the load as it is now
let scene = null;
let sectionFrame = null;
let solving = false;
let setForce = () => {};
let setRadius = () => {};

const stage = new Stage($("canvas"), $("letters"));
const load = new Load(loadChanged);
const touch = new Touch(stage, load, () => load.tail);
listen(stage, load, {
  fields: () => Object.keys(FIELDS),
  changeForce: (factor) => { load.newton = Math.min(load.newton * factor, load.maxNewton); loadChanged(); },
  changeRadius: (factor) => {
    load.radius = Math.min(Math.max(load.radius * factor, 1), scene.max_radius_mm);
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
  preview,
  message: panel.showMessage,
  field: () => chosen.field,
});
stage.onDrawn = placeForceLabel;

// --- from the server

function onScene(header, arrays) {
  scene = header;
  chosen.predictor = header.predictors[0];
  setFields(header.fields);
  if (!FIELDS[chosen.field]?.available) [chosen.field] = Object.keys(FIELDS);
  $("title").textContent = header.title;
  $("subtitle").textContent = `${header.n_points.toLocaleString("en")} points, ${header.n_cells.toLocaleString("en")} cells`;
  stage.load(header, arrays);
  arrangeViews();
  load.fit(header, arrays, stage.views[0].brain.normal.slice(), stage.size);
  setForce = panel.slider("force", { min: 0.02 * header.max_force_n, max: header.max_force_n, value: load.newton },
    (v) => `${v.toFixed(2)} N`, (v) => { load.newton = v; loadChanged(); });
  setRadius = panel.slider("radius", { min: 2, max: header.max_radius_mm, value: load.radius },
    (v) => `${v.toFixed(0)} mm`, (v) => { load.radius = v; loadChanged(); });
  fillChoices();
  predictions.clear();
  patient.fit(header.patient);
  showRest();
  document.body.dataset.ready = "yes";
}

function onSection(header, arrays) {
  for (const view of stage.views) view.setSection(header, arrays);
  sectionFrame = { header, arrays };
  restyle();
  askAgain();
}

function onCraniotomy(header, arrays) {
  patient.onCraniotomy(header, arrays);
}

/** A registered state takes the place of a load. */
function onState(header, arrays) {
  const first = patient.onState(header);
  $("hint").classList.add("done");
  if (first) panel.hideMessage();
  if (load.point) load.release();
  predictions.set(REGISTERED, { header, arrays });
  for (const view of stage.views) view.setMeasured(arrays.measured, header.misfits);
  show();
  if (first) colourByDeviation();
}

function onPrediction(header, arrays, sent) {
  // While the pointer moves, a prediction for a moment ago is better than none.
  if (!load.point || (header.predictor === SOLVED && header.id !== link.id)) return;
  predictions.set(header.predictor, { header, arrays });
  if (header.predictor === SOLVED) solving = false;
  show();
  if (sent !== null) stage.afterDraw = () => link.drawn(sent);
}

function onText(message) {
  if (patient.onText(message)) return;
  if (message.kind === "solving") solving = message.id === link.id;
  else { solving = false; panel.showMessage(message.text); }
  show();
}

function onClosed() {
  patient.onClosed();
  if (scene) panel.showMessage("the server is gone; looking for it again…");
}

// --- to the server

function ask() {
  predictions.delete(SOLVED);
  solving = false;
  link.request(() => load.message(wanted()));
}

/** Ask anew for what is on show, with the scalar and the section that are chosen now. */
function askAgain() {
  if (load.point) ask();
  else if (predictions.has(REGISTERED)) patient.askState();
  else show();
}

function wanted() {
  const { compare, predictor, field, solve } = chosen;
  return { predictors: compare ? scene.predictors : [predictor], field, solve: solve || compare };
}

function loadChanged() {
  setForce(load.newton);
  setRadius(load.radius);
  $("save").disabled = load.point === null;
  if (load.point) {
    hideRegistration();
    $("hint").classList.add("done");
    ask();
    showLoadSoon();
  } else {
    link.forget();
    link.send({ type: "release" });
    hideRegistration();
    predictions.clear();
    showRest();
  }
}

function hideRegistration() {
  if (!predictions.delete(REGISTERED)) return;
  for (const view of stage.views) view.setMeasured(null);
}

function askSection() {
  const axis = chosen.axis === "none" ? null : chosen.axis;
  link.send({ type: "section", axis, offset_mm: Number($("offset").value) });
  if (axis !== null) return;
  sectionFrame = null;
  for (const view of stage.views) view.setSection(null);
  restyle();
  show();
}

// --- on the page

/** Which predictions are on show, one a view. */
function shown() {
  if (predictions.has(REGISTERED)) return stage.views.map(() => REGISTERED);
  if (chosen.compare) return [...scene.predictors, SOLVED];
  return [predictions.has(SOLVED) ? SOLVED : chosen.predictor];
}

let patience = 0;

/** Show the load with its prediction, so that nothing is drawn twice, but don't wait long. */
function showLoadSoon() {
  if (!predictions.has(chosen.predictor)) showLoad();
  else patience ||= setTimeout(showLoad, PATIENCE_MS);
}

function showLoad() {
  clearTimeout(patience);
  patience = 0;
  placeArrow();
  restyle();
}

function show() {
  if (!scene) return;
  const names = shown();
  stage.views.forEach((view, i) => view.show(predictions.get(names[i])?.arrays ?? null));
  const range = rangeOf(chosen.field, stage.views.map((v) => v.scalars(chosen.field)).filter(Boolean));
  stage.views.forEach((view) => view.recolour(chosen.field, range));
  panel.showLegend(chosen.field, range);
  const best = chosen.compare && names[0] !== REGISTERED ? predictions.get(chosen.predictor) : predictions.get(names[0]);
  if (best) panel.showPrediction(best.header, solving);
  showCaptions(names);
  showLoad();
}

/** Outline a craniotomy that is tried, or the scene's own for null. */
function preview(arrays) {
  for (const view of stage.views) view.tryOpening(arrays);
  show();
}

/** Colours and, if there is an image, a slice that show how sure a registration is. */
function colourByDeviation() {
  panel.choose("fields", "deviation");
  if (scene.image && chosen.axis === "none") panel.choose("axes", "axial");
}

function showRest() {
  panel.showRest();
  for (const view of stage.views) view.arrow.group.visible = false;
  show();
}

function showCaptions(names) {
  $("captions").replaceChildren(...(names.length < 2 || names[0] === REGISTERED ? [] : names.map((name) => {
    const span = Object.assign(document.createElement("span"), { textContent: NAMES[name] });
    const header = predictions.get(name)?.header;
    const text = header ? `${header.largest_mm.toFixed(2)} mm · ${panel.milliseconds(header.seconds)}`
      : name === SOLVED && solving ? "solving…" : "–";
    span.append(Object.assign(document.createElement("small"), { textContent: text }));
    return span;
  })));
}

function showSpeed() {
  const rate = link.rate();
  const latency = link.latencyMs === null ? "" : `${Math.round(link.latencyMs)} ms latency`;
  panel.write("speed", rate > 1 ? `${rate} predictions/s · ${latency}` : latency);
}
setInterval(showSpeed, 500);

function arrangeViews() {
  stage.setViews(chosen.compare ? scene.predictors.length + 1 : 1);
  if (sectionFrame) {
    for (const view of stage.views) view.setSection(sectionFrame.header, sectionFrame.arrays);
  }
}

/** The clipping plane as (normal, offset): what lies beyond it, towards the camera, is cut. */
function clippingPlane() {
  if (!sectionFrame) return null;
  const { axis, offset_mm: offset } = sectionFrame.header;
  const towards = Math.sign(stage.camera.position.getComponent(axis) - stage.controls.target.getComponent(axis)) || 1;
  const normal = new THREE.Vector3().setComponent(axis, towards);
  return new THREE.Vector4(normal.x, normal.y, normal.z, towards * offset);
}

function restyle() {
  const patch = load.point ? { point: load.point.toArray(), radius: load.radius } : null;
  const style = { opacity: Number($("opacity").value), plane: clippingPlane(), patch };
  for (const view of stage.views) {
    view.style(style);
    if (view.section) {
      const most = predictions.has(REGISTERED) && chosen.field === "deviation" ? FAINT : 1;
      view.section.material.uniforms.grey.value = scene.image && $("image").checked ? most : 0;
    }
  }
  stage.invalidate();
}
stage.controls.addEventListener("change", () => { if (sectionFrame) restyle(); });

/** The arrow's head follows the surface of each view. */
function placeArrow() {
  if (!load.point) return;
  const outside = predictions.get("network")?.header.usable === false;
  stage.views.forEach((view, i) => {
    const tip = view.at(load.point);
    if (i === 0) load.tip = tip;
    const tail = load.tail.add(tip).sub(load.tip);
    view.arrow.place(tail, tip, outside ? COLOURS.outside : COLOURS.calm);
  });
}

function placeForceLabel() {
  const tail = load.tail;
  $("force-label").hidden = tail === null;
  if (tail === null) return;
  const { x, y } = stage.toScreen(tail);
  const left = Math.min(x + 14, stage.canvas.clientWidth / stage.views.length - LABEL_PX);
  panel.write("force-label", `${load.newton.toFixed(2)} N`);
  $("force-label").style.transform = `translate(${left}px, ${y - 30}px)`;
}

function fillChoices() {
  panel.choices("predictors", scene.predictors.map((name) => [name, NAMES[name]]), chosen.predictor, (name) => {
    chosen.predictor = name;
    predictions.clear();
    if (load.point) ask();
  });
  panel.choices("fields",
    Object.entries(FIELDS).map(([name, { label, available }]) => [name, label, available]),
    chosen.field, (name) => {
      chosen.field = name;
      askAgain();
    });
  panel.choices("axes", AXES, chosen.axis, (axis) => {
    chosen.axis = axis;
    const i = ["sagittal", "coronal", "axial"].indexOf(axis);
    $("offset-row").hidden = i < 0;
    $("image-row").hidden = i < 0 || !scene.image;
    if (i >= 0) {
      const [min, max] = [stage.box.min, stage.box.max].map((v) => v.getComponent(i));
      const value = Math.round(scene.tumour_centre?.[i] ?? (min + max) / 2);
      panel.slider("offset", { min: Math.ceil(min) + 1, max: Math.floor(max) - 1, value },
        (v) => `${v.toFixed(0)} mm`, askSection);
    }
    askSection();
  });
}

panel.slider("opacity", { min: 0.08, max: 1, value: 0.45 }, (v) => `${Math.round(100 * v)} %`, restyle);
$("image").addEventListener("change", restyle);
$("solve").addEventListener("change", (e) => { chosen.solve = e.target.checked; if (load.point) ask(); });
$("compare").addEventListener("change", (e) => {
  chosen.compare = e.target.checked;
  arrangeViews();
  show();
  if (load.point) ask();
});
$("release").addEventListener("click", () => load.release());
$("inward").addEventListener("click", () => load.straighten());
$("reset").addEventListener("click", () => stage.resetView());
$("save").addEventListener("click", () => {
  saveLoadCase(load.message(wanted())).catch((error) => panel.showMessage(error.message));
});
$("screenshot").addEventListener("click", () => {
  const names = shown();
  const range = rangeOf(chosen.field, stage.views.map((v) => v.scalars(chosen.field)).filter(Boolean));
  const lines = [`${scene.title}: ${load.point ? `${load.newton.toFixed(2)} N on a patch of ${load.radius.toFixed(0)} mm` : "at rest"}`];
  lines.push(names.map((name) => {
    const header = predictions.get(name)?.header;
    return header ? `${NAMES[name]}: largest displacement ${header.largest_mm.toFixed(2)} mm` : null;
  }).filter(Boolean).join("   "));
  savePicture(stage, { lines, field: chosen.field, range });
});

/** For tests and for scripts: what is on show, as plain values. */
window.physgnn = {
  load,
  stage,
  link,
  patient,
  get predictions() { return Object.fromEntries([...predictions].map(([name, { header }]) => [name, header])); },
  get solving() { return solving; },
};
