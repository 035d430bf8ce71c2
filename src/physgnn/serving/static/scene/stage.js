// Cameras and drawing: one or several bodies side by side, seen from the same place.

import * as THREE from "three";
import { OrbitControls } from "../vendor/OrbitControls.js";
import { BodyView } from "./body.js";

const LETTERS = { R: [1, 0, 0], L: [-1, 0, 0], A: [0, 1, 0], P: [0, -1, 0], S: [0, 0, 1], I: [0, 0, -1] };
const VIEW_ANGLE = 32;
const SLOW_MS = 20; // a draw that takes longer is coarser while things move
const COARSE = 0.5;
const FINE = 1.5;
const SHARP_AFTER_MS = 250;
const LETTER_PX = 12; // a letter keeps so far from the rim
THREE.ColorManagement.enabled = false;

/** Whether WebGL runs on a graphics card; a processor cannot afford smoothing each frame. */
function hasGraphicsCard() {
  const context = document.createElement("canvas").getContext("webgl2", { failIfMajorPerformanceCaveat: true });
  context?.getExtension("WEBGL_lose_context")?.loseContext();
  return context !== null;
}

export class Stage {
  constructor(canvas, lettersBox) {
    this.canvas = canvas;
    this.drawsItself = !hasGraphicsCard();
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: !this.drawsItself, alpha: true });
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace; // colours are as written
    this.renderer.setClearColor(0x000000, 0);
    this.pixelRatio = Math.min(devicePixelRatio, 2);
    this.setRatio(this.pixelRatio);
    this.renderer.autoClear = false;
    this.camera = new THREE.PerspectiveCamera(VIEW_ANGLE, 1);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enablePan = false;
    this.controls.addEventListener("change", () => this.invalidate());
    this.views = [];
    this.afterDraw = null;
    this.lettersBox = lettersBox;
    this.letters = Object.keys(LETTERS).map((text) => {
      const span = lettersBox.appendChild(document.createElement("span"));
      span.textContent = text;
      return span;
    });
    new ResizeObserver(() => this.invalidate()).observe(canvas);
  }

  load(header, arrays) {
    this.arrays = arrays;
    this.box = new THREE.Box3().setFromArray(arrays.points);
    this.size = this.box.getSize(new THREE.Vector3()).length();
    this.normal = new THREE.Vector3(...header.normal).normalize();
    this.resetView();
  }

  /** Have as many bodies as names. */
  setViews(n) {
    this.views = Array.from({ length: n }, () => new BodyView(this.arrays, this.size));
    this.slow = this.drawsItself || this.drawingTime() > SLOW_MS;
    this.invalidate();
  }

  /** How long a draw takes, in ms; the second one, since the first compiles. */
  drawingTime() {
    const gl = this.renderer.getContext();
    let start;
    for (let i = 0; i < 2; i++) {
      start = performance.now();
      this.draw();
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4)); // waits
    }
    return performance.now() - start;
  }

  /** Look at the exposed surface, somewhat from above and the side. */
  resetView() {
    const centre = this.box.getCenter(new THREE.Vector3());
    const { size } = this;
    const side = new THREE.Vector3(0, 0, 1).cross(this.normal);
    if (side.length() < 0.1) side.set(1, 0, 0);
    const from = this.normal.clone().multiplyScalar(0.62).addScaledVector(side.normalize(), -0.72);
    from.z = Math.max(from.z, 0.2) * 0.75;
    this.controls.target.copy(centre);
    this.camera.position.copy(centre).addScaledVector(from.normalize(), 1.72 * size);
    [this.camera.near, this.camera.far] = [0.05 * size, 10 * size];
    this.controls.minDistance = 0.5 * size;
    this.controls.maxDistance = 4 * size;
    this.controls.update();
    this.invalidate();
  }

  invalidate() {
    if (this.scheduled || this.views.length === 0) return;
    this.scheduled = true;
    requestAnimationFrame(() => {
      this.scheduled = false;
      if (this.slow) this.hurry();
      this.draw();
      this.afterDraw?.();
      this.afterDraw = null;
    });
  }

  /** Draw coarsely now, and sharply when nothing has moved for a moment. */
  hurry() {
    this.setSharp(false);
    clearTimeout(this.sharpening);
    this.sharpening = setTimeout(() => this.sharpen(), SHARP_AFTER_MS);
  }

  sharpen() {
    if (this.canvas.classList.contains("busy")) return this.hurry(); // somebody is dragging
    this.setSharp(true);
    this.draw();
  }

  /** Whether to draw every pixel and the far side of the brain, or to save time. */
  setSharp(is) {
    const finest = this.drawsItself ? FINE : 1; // more pixels instead of smoothing
    this.setRatio((is ? finest : COARSE) * this.pixelRatio);
    for (const view of this.views) view.setSharp(is);
  }

  setRatio(ratio) {
    if (ratio !== this.renderer.getPixelRatio()) this.renderer.setPixelRatio(ratio);
  }

  draw() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return;
    const size = this.renderer.getSize(new THREE.Vector2());
    if (size.x !== width || size.y !== height) this.renderer.setSize(width, height, false);
    const each = width / this.views.length;
    this.camera.aspect = each / height;
    // A narrow view would cut the brain off left and right.
    this.camera.fov = 2 * THREE.MathUtils.radToDeg(
      Math.atan(Math.tan(THREE.MathUtils.degToRad(VIEW_ANGLE / 2)) * Math.max(1, 0.76 / this.camera.aspect)),
    );
    this.camera.updateProjectionMatrix();
    this.renderer.setScissorTest(true);
    this.views.forEach((view, i) => {
      this.renderer.setViewport(i * each, 0, each, height);
      this.renderer.setScissor(i * each, 0, each, height);
      this.renderer.clear();
      this.renderer.render(view.scene, this.camera);
    });
    this.placeLetters(each, height);
    this.onDrawn?.();
  }

  placeLetters(width, height) {
    this.lettersBox.hidden = this.views.length > 1;
    const centre = this.box.getCenter(new THREE.Vector3());
    const half = this.box.getSize(new THREE.Vector3()).multiplyScalar(0.5).addScalar(0.05 * this.size);
    const towards = this.camera.position.clone().sub(centre).normalize();
    Object.values(LETTERS).forEach((direction, i) => {
      const place = new THREE.Vector3(...direction).multiply(half).add(centre);
      const { x, y } = this.toScreen(place, width, height);
      const facing = new THREE.Vector3(...direction).dot(towards);
      this.letters[i].hidden = Math.abs(facing) > 0.6; // it would be on or behind the brain
      const [left, top] = [[x, width], [y, height]].map(([at, end]) => Math.min(Math.max(at, LETTER_PX), end - LETTER_PX));
      this.letters[i].style.transform = `translate(-50%, -50%) translate(${left}px, ${top}px)`;
    });
  }

  /** Pixels, within one view, of a point of the world. */
  toScreen(place, width = this.canvas.clientWidth / this.views.length, height = this.canvas.clientHeight) {
    const p = place.clone().project(this.camera);
    return { x: ((p.x + 1) / 2) * width, y: ((1 - p.y) / 2) * height };
  }

  /** The view under a pixel and a ray through it. */
  rayAt(clientX, clientY) {
    const box = this.canvas.getBoundingClientRect();
    const each = box.width / this.views.length;
    const x = clientX - box.left;
    const i = Math.min(Math.max(Math.floor(x / each), 0), this.views.length - 1);
    const at = new THREE.Vector2(((x - i * each) / each) * 2 - 1, 1 - ((clientY - box.top) / box.height) * 2);
    const caster = new THREE.Raycaster();
    caster.setFromCamera(at, this.camera);
    return { view: this.views[i], caster };
  }
}
