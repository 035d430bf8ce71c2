// Pointer, touch and keys on the brain: press the exposed surface, drag the arrow's handle.

import * as THREE from "three";

const EXPOSED = 0.5; // a place counts as exposed from this fraction of its corners on
const HANDLE_PX = 16;

export class Touch {
  /**
   * While `pick` is a function, it gets the places pressed, anywhere on the brain.
   * `load` has point, direction, newton and methods loadAt(point, normal), setForce(vector);
   * `tail()` tells where the arrow's handle is.
   */
  constructor(stage, load, tail) {
    Object.assign(this, { stage, load, tail, drag: null, pick: null });
    const { canvas } = stage;
    // Before OrbitControls hears of it: a press on the brain must not turn it.
    canvas.addEventListener("pointerdown", (e) => this.down(e), { capture: true });
    canvas.addEventListener("pointermove", (e) => this.move(e));
    for (const type of ["pointerup", "pointercancel"]) {
      canvas.addEventListener(type, () => this.up());
    }
  }

  down(event) {
    if (event.button !== 0 || !event.isPrimary || this.stage.views.length === 0) return;
    if (!this.pick && this.nearHandle(event)) this.drag = "handle";
    else if (this.pressAt(event)) this.drag = "surface";
    else return;
    this.stage.controls.enabled = false;
    this.stage.canvas.setPointerCapture(event.pointerId);
    this.stage.canvas.classList.add("busy");
  }

  move(event) {
    if (!event.isPrimary) return;
    if (this.drag === "surface") this.pressAt(event);
    else if (this.drag === "handle") this.pull(event);
    else if (event.pointerType === "mouse" && event.buttons === 0) {
      const touchable = (!this.pick && this.nearHandle(event)) || this.hit(event) !== null;
      this.stage.canvas.classList.toggle("touchable", touchable);
    }
  }

  up() {
    this.drag = null;
    this.stage.controls.enabled = true;
    this.stage.canvas.classList.remove("busy");
  }

  pressAt(event) {
    const hit = this.hit(event);
    if (hit && this.pick) this.pick(hit.point);
    else if (hit) this.load.loadAt(hit.point, hit.normal);
    return hit !== null;
  }

  /** The rest place and inward direction of the exposed surface under a pointer. */
  hit(event) {
    const { view, caster } = this.stage.rayAt(event.clientX, event.clientY);
    const { exposed, position, rest } = view.brain.geometry.attributes;
    for (const { face, point: touched } of caster.intersectObject(view.front)) {
      const corners = [face.a, face.b, face.c];
      const at = (attribute) => corners.map((i) => new THREE.Vector3().fromBufferAttribute(attribute, i));
      const fraction = THREE.Triangle.getBarycoord(touched, ...at(position), new THREE.Vector3()).toArray();
      const point = new THREE.Vector3();
      at(rest).forEach((place, k) => point.addScaledVector(place, fraction[k]));
      if (view.isCutAway(point)) continue;
      if (this.pick) return { point };
      const isExposed = corners.reduce((sum, c, k) => sum + fraction[k] * exposed.getX(c), 0);
      return isExposed < EXPOSED ? null : { point, normal: this.load.normalAt(point) };
    }
    return null;
  }

  nearHandle(event) {
    const tail = this.tail();
    if (!tail) return false;
    const box = this.stage.canvas.getBoundingClientRect();
    const each = box.width / this.stage.views.length;
    const { x, y } = this.stage.toScreen(tail);
    const reach = event.pointerType === "touch" ? 2 * HANDLE_PX : HANDLE_PX;
    return Math.hypot(((event.clientX - box.left) % each) - x, event.clientY - box.top - y) < reach;
  }

  /** Let the handle follow the pointer in the plane that faces the camera. */
  pull(event) {
    const { caster } = this.stage.rayAt(event.clientX, event.clientY);
    const facing = this.stage.camera.getWorldDirection(new THREE.Vector3());
    const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(facing, this.tail());
    const place = caster.ray.intersectPlane(plane, new THREE.Vector3());
    if (place) this.load.pullFrom(place);
  }
}
