// The keyboard, while the brain has the focus.

import * as THREE from "three";
import { $, choose } from "./panel.js";

const TILT_DEGREES = 4;
const STEP_MM = 6;
const FACTOR = 1.1;
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/** `actions` has changeForce(factor), changeRadius(factor) and fields(), the names to colour by. */
export function listen(stage, load, actions) {
  const keys = {
    Enter: () => load.loadMiddle(),
    Escape: () => load.release(),
    "+": () => actions.changeForce(FACTOR),
    "=": () => actions.changeForce(FACTOR),
    "-": () => actions.changeForce(1 / FACTOR),
    "]": () => actions.changeRadius(FACTOR),
    "[": () => actions.changeRadius(1 / FACTOR),
    n: () => load.straighten(),
    r: () => stage.resetView(),
    s: () => $("screenshot").click(),
    l: () => $("save").click(),
    f: () => $("solve").click(),
    c: () => $("compare").click(),
  };
  stage.canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const act = event.key in ARROWS ? () => steer(event)
      : keys[event.key] ?? keys[event.key.toLowerCase()] ?? colourBy(actions.fields()[event.key - 1]);
    if (!act) return;
    event.preventDefault();
    act();
  });

  function colourBy(name) {
    return name && (() => choose("fields", name));
  }

  function steer(event) {
    if (!load.point) return load.loadMiddle();
    const [x, y] = ARROWS[event.key];
    const [right, up, back] = [0, 1, 2].map((i) =>
      new THREE.Vector3().setFromMatrixColumn(stage.camera.matrixWorld, i));
    const across = right.multiplyScalar(x).addScaledVector(up, y);
    if (event.shiftKey) load.moveTo(load.point.clone().addScaledVector(across, STEP_MM));
    else load.tilt(across.clone().cross(back).normalize(), -TILT_DEGREES);
  }
}
