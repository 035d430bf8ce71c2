// The load: where, which way, how much. `onChange` is called after every change.

import * as THREE from "three";

const LENGTH = [0.05, 0.225]; // of the arrow, at no force and at the greatest, in body sizes

export class Load {
  constructor(onChange) {
    this.onChange = onChange;
    this.point = null;
    this.tip = null; // where the arrow's head is: on the surface as it is now
  }

  /** What the scene says of limits and of the exposed surface. */
  fit(header, { points, exposed }, restNormals, size) {
    this.lengths = LENGTH.map((fraction) => fraction * size);
    this.newton = header.force_n;
    this.maxNewton = header.max_force_n;
    this.radius = header.radius_mm;
    this.touchable = [];
    exposed.forEach((is, i) => {
      if (!is) return;
      this.touchable.push({
        place: new THREE.Vector3().fromArray(points, 3 * i),
        normal: new THREE.Vector3().fromArray(restNormals, 3 * i),
      });
    });
    this.point = null;
  }

  /** The inward unit normal of the patch around a place. */
  normalAt(place) {
    const inward = new THREE.Vector3();
    let nearest = this.touchable[0];
    for (const one of this.touchable) {
      const distance = one.place.distanceTo(place);
      if (distance < this.radius) inward.sub(one.normal);
      if (distance < nearest.place.distanceTo(place)) nearest = one;
    }
    if (inward.length() === 0) inward.copy(nearest.normal).negate();
    return inward.normalize();
  }

  /** Load a place; the direction stays if it was tilted by hand. */
  loadAt(point, normal) {
    this.point = point;
    if (!this.tilted || !this.direction) this.direction = normal;
    this.onChange();
  }

  loadMiddle() {
    const middle = new THREE.Vector3();
    for (const { place } of this.touchable) middle.addScaledVector(place, 1 / this.touchable.length);
    this.moveTo(middle);
  }

  /** Load the exposed node nearest to a place. */
  moveTo(place) {
    const nearest = this.touchable.reduce((a, b) =>
      b.place.distanceTo(place) < a.place.distanceTo(place) ? b : a);
    this.loadAt(nearest.place.clone(), this.normalAt(nearest.place));
  }

  straighten() {
    this.tilted = false;
    if (this.point) this.loadAt(this.point, this.normalAt(this.point));
  }

  release() {
    this.point = null;
    this.tip = null;
    this.tilted = false;
    this.onChange();
  }

  /** Have the arrow's tail at a place: that sets direction and force. */
  pullFrom(place) {
    const along = this.tip.clone().sub(place);
    const [least, most] = this.lengths;
    const fraction = (along.length() - least) / (most - least);
    this.newton = this.maxNewton * Math.min(Math.max(fraction, 0.02), 1);
    this.direction = along.normalize();
    this.tilted = true;
    this.onChange();
  }

  tilt(axis, degrees) {
    if (!this.point) return;
    this.direction = this.direction.clone().applyAxisAngle(axis, THREE.MathUtils.degToRad(degrees));
    this.tilted = true;
    this.onChange();
  }

  get tail() {
    if (!this.point || !this.tip) return null;
    const [least, most] = this.lengths;
    const length = least + (most - least) * (this.newton / this.maxNewton);
    return this.tip.clone().addScaledVector(this.direction, -length);
  }

  /** The message to the server, as messages.PatchLoad reads it. */
  message(wanted) {
    return {
      type: "patch_load",
      point: this.point.toArray(),
      force_n: this.direction.clone().multiplyScalar(this.newton).toArray(),
      radius_mm: this.radius,
      ...wanted,
    };
  }
}
