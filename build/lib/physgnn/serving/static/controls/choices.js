// What one chooses beside the brain: a predictor, colours, a section, what is drawn and how.

import { FIELDS } from "../scene/colours.js";
import { $, choices, choose, NAMES, slider } from "./panel.js";

const AXES = [["none", "Off"], ["sagittal", "Sag"], ["coronal", "Cor"], ["axial", "Ax"]];
const PLANES = ["sagittal", "coronal", "axial"]; // across x, y and z

export class Choices {
  /** `page` has changePredictor, ask, askAgain, askSection, compare and restyle, called after a choice. */
  constructor(page) {
    Object.assign(this, { page, predictor: "network", field: null, solve: false, compare: false, axis: "none" });
    slider("opacity", { min: 0.08, max: 1, value: 0.45 }, (v) => `${Math.round(100 * v)} %`, () => page.restyle());
    $("image").addEventListener("change", () => page.restyle());
    $("solve").addEventListener("change", ({ target }) => { this.solve = target.checked; page.ask(); });
    $("compare").addEventListener("change", ({ target }) => { this.compare = target.checked; page.compare(); });
  }

  /** Fill what depends on the scene: its predictors, its scalars, where it can be cut. */
  fit(scene, box) {
    choices("predictors", scene.predictors.map((name) => [name, NAMES[name]]), this.predictor,
      (name) => { this.predictor = name; this.page.changePredictor(); });
    choices("fields", Object.entries(FIELDS).map(([name, { label, available }]) => [name, label, available]),
      this.field, (name) => { this.field = name; this.page.askAgain(); });
    choices("axes", AXES, this.axis, (axis) => { this.axis = axis; this.chooseOffset(scene, box); });
  }

  /** Start a cut in the tumour, or in the middle. */
  chooseOffset(scene, box) {
    const i = PLANES.indexOf(this.axis);
    $("offset-row").hidden = i < 0;
    $("image-row").hidden = i < 0 || !scene.image;
    if (i >= 0) {
      const [min, max] = [box.min, box.max].map((v) => v.getComponent(i));
      const value = Math.round(scene.tumour_centre?.[i] ?? (min + max) / 2);
      slider("offset", { min: Math.ceil(min) + 1, max: Math.floor(max) - 1, value },
        (v) => `${v.toFixed(0)} mm`, () => this.page.askSection());
    }
    this.page.askSection();
  }

  /** The cut that is chosen, as the server is asked for it. */
  get section() {
    return { axis: this.axis === "none" ? null : this.axis, offset_mm: Number($("offset").value) };
  }

  /** Colours and, if there is an image, a slice that show how sure a registration is. */
  colourByDeviation(scene) {
    choose("fields", "deviation");
    if (scene.image && this.axis === "none") choose("axes", "axial");
  }
}
