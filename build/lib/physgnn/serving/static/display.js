// What is on show: the predictions for the load as it is now, on the bodies and beside them.

import * as THREE from "three";
import * as panel from "./controls/panel.js";
import { rangeOf } from "./scene/colours.js";

const { $, NAMES } = panel;
export const SOLVED = "finite elements";
export const REGISTERED = "registration";
const FAINT = 0.5; // how far the image shows through a registration's colours
const LABEL_PX = 72; // room for the force beside its arrow
const PATIENCE_MS = 80; // a prediction draws the load too; later than this it is drawn alone
const COLOURS = { calm: 0x45c3a6, outside: 0xf0a843 };

export class Display {
  /** `chosen`: what the panel says of predictor, field, solve, compare and axis. */
  constructor(stage, load, chosen) {
    Object.assign(this, { stage, load, chosen, scene: null, section: null, solving: false, patience: 0 });
    this.predictions = new Map(); // name → {header, arrays} of the load as it is now
    stage.onDrawn = () => this.placeForceLabel();
    stage.controls.addEventListener("change", () => { if (this.section) this.restyle(); });
  }

  /** Which predictions are on show, one a view. */
  get shown() {
    if (this.registered) return this.stage.views.map(() => REGISTERED);
    if (this.chosen.compare) return [...this.scene.predictors, SOLVED];
    return [this.predictions.has(SOLVED) ? SOLVED : this.chosen.predictor];
  }

  get registered() {
    return this.predictions.has(REGISTERED);
  }

  /** The range of the colours that the views share. */
  get range() {
    const { field } = this.chosen;
    return rangeOf(field, this.stage.views.map((view) => view.scalars(field)).filter(Boolean));
  }

  get title() {
    const { point, newton, radius } = this.load;
    const what = point ? `${newton.toFixed(2)} N on a patch of ${radius.toFixed(0)} mm` : "at rest";
    return `${this.scene.title}: ${what}`;
  }

  /** The largest displacement of each prediction on show, in one line. */
  get largest() {
    return this.shown.map((name) => {
      const header = this.predictions.get(name)?.header;
      return header ? `${NAMES[name]}: largest displacement ${header.largest_mm.toFixed(2)} mm` : null;
    }).filter(Boolean).join("   ");
  }

  // --- what comes

  fit(header, arrays) {
    this.scene = header;
    $("title").textContent = header.title;
    $("subtitle").textContent = `${header.n_points.toLocaleString("en")} points, ${header.n_cells.toLocaleString("en")} cells`;
    this.predictions.clear();
    this.stage.load(header, arrays);
    this.arrangeViews();
  }

  /** Cut along a section that has come; null for none. */
  cut(section) {
    this.section = section;
    for (const view of this.stage.views) view.setSection(section?.header ?? null, section?.arrays);
    this.restyle();
  }

  register(header, arrays) {
    this.predictions.set(REGISTERED, { header, arrays });
    for (const view of this.stage.views) view.setMeasured(arrays.measured, header.misfits);
    this.show();
  }

  hideRegistration() {
    if (!this.predictions.delete(REGISTERED)) return;
    for (const view of this.stage.views) view.setMeasured(null);
  }

  /** Outline a craniotomy that is tried, or the scene's own for null. */
  preview(arrays) {
    for (const view of this.stage.views) view.tryOpening(arrays);
    this.show();
  }

  // --- what is drawn

  arrangeViews() {
    this.stage.setViews(this.chosen.compare ? this.scene.predictors.length + 1 : 1);
    if (!this.section) return;
    for (const view of this.stage.views) view.setSection(this.section.header, this.section.arrays);
  }

  showRest() {
    this.predictions.clear();
    panel.showRest();
    for (const view of this.stage.views) view.arrow.group.visible = false;
    this.show();
  }

  show() {
    if (!this.scene) return;
    const { field, compare, predictor } = this.chosen;
    const names = this.shown;
    this.stage.views.forEach((view, i) => view.show(this.predictions.get(names[i])?.arrays ?? null));
    const range = this.range;
    this.stage.views.forEach((view) => view.recolour(field, range));
    panel.showLegend(field, range);
    const best = this.predictions.get(compare && !this.registered ? predictor : names[0]);
    if (best) panel.showPrediction(best.header, this.solving);
    this.showCaptions(names);
    this.showLoad();
  }

  showCaptions(names) {
    $("captions").replaceChildren(...(names.length < 2 || this.registered ? [] : names.map((name) => {
      const span = Object.assign(document.createElement("span"), { textContent: NAMES[name] });
      const header = this.predictions.get(name)?.header;
      const text = header ? `${header.largest_mm.toFixed(2)} mm · ${panel.milliseconds(header.seconds)}`
        : name === SOLVED && this.solving ? "solving…" : "–";
      span.append(Object.assign(document.createElement("small"), { textContent: text }));
      return span;
    })));
  }

  /** Show the load with its prediction, so that nothing is drawn twice, but don't wait long. */
  showLoadSoon() {
    if (!this.predictions.has(this.chosen.predictor)) this.showLoad();
    else this.patience ||= setTimeout(() => this.showLoad(), PATIENCE_MS);
  }

  showLoad() {
    clearTimeout(this.patience);
    this.patience = 0;
    this.placeArrow();
    this.restyle();
  }

  /** The arrow's head follows the surface of each view. */
  placeArrow() {
    const { load } = this;
    if (!load.point) return;
    const outside = this.predictions.get("network")?.header.usable === false;
    this.stage.views.forEach((view, i) => {
      const tip = view.at(load.point);
      if (i === 0) load.tip = tip;
      const tail = load.tail.add(tip).sub(load.tip);
      view.arrow.place(tail, tip, outside ? COLOURS.outside : COLOURS.calm);
    });
  }

  placeForceLabel() {
    const tail = this.load.tail;
    $("force-label").hidden = tail === null;
    if (tail === null) return;
    const { x, y } = this.stage.toScreen(tail);
    const left = Math.min(x + 14, this.stage.canvas.clientWidth / this.stage.views.length - LABEL_PX);
    panel.write("force-label", `${this.load.newton.toFixed(2)} N`);
    $("force-label").style.transform = `translate(${left}px, ${y - 30}px)`;
  }

  restyle() {
    const { load, scene } = this;
    const patch = load.point ? { point: load.point.toArray(), radius: load.radius } : null;
    const style = { opacity: Number($("opacity").value), plane: this.clippingPlane(), patch };
    for (const view of this.stage.views) {
      view.style(style);
      if (view.section) {
        const most = this.registered && this.chosen.field === "deviation" ? FAINT : 1;
        view.section.material.uniforms.grey.value = scene.image && $("image").checked ? most : 0;
      }
    }
    this.stage.invalidate();
  }

  /** The clipping plane as (normal, offset): what lies beyond it, towards the camera, is cut. */
  clippingPlane() {
    if (!this.section) return null;
    const { axis, offset_mm: offset } = this.section.header;
    const { camera, controls } = this.stage;
    const towards = Math.sign(camera.position.getComponent(axis) - controls.target.getComponent(axis)) || 1;
    const normal = new THREE.Vector3().setComponent(axis, towards);
    return new THREE.Vector4(normal.x, normal.y, normal.z, towards * offset);
  }
}
