// A surface that moves: its own points first, then those that make it round.

import * as THREE from "three";
import { TISSUE } from "./colours.js";
import { average, normals, round, subdivision } from "./smooth.js";

const LEVELS = 1; // a second is hardly seen, and slow where the processor draws
const MAX_FACES = 2000; // a finer surface is round enough as it is
const BLURS = 8; // of the border of what is exposed

export class Surface {
  /** `points` at rest and `faces` over them; `exposed` is 0 or 1 a point. */
  constructor(points, faces, { exposed = null, colour = TISSUE } = {}) {
    this.rest = points;
    this.faces = faces;
    this.count = points.length / 3;
    this.steps = [];
    let [count, finest] = [this.count, Uint32Array.from(faces)];
    for (let i = 0; i < LEVELS && faces.length / 3 <= MAX_FACES; i++) {
      const step = subdivision(finest, count);
      this.steps.push({ ...step, before: count, coarse: finest });
      [count, finest] = [step.count, step.faces];
    }
    this.finest = finest;
    this.geometry = new THREE.BufferGeometry();
    const attribute = (name, size) => {
      const made = new THREE.BufferAttribute(new Float32Array(size * count), size);
      this.geometry.setAttribute(name, made.setUsage(THREE.DynamicDrawUsage));
      return made.array;
    };
    [this.position, this.normal, this.colour] = ["position", "normal", "colour"].map((n) => attribute(n, 3));
    this.indices = [Uint32Array.from(faces), finest].map((i) => new THREE.BufferAttribute(i, 1));
    this.setSharp(true);
    for (let i = 0; i < count; i++) this.colour.set(colour, 3 * i);
    this.move(null);
    attribute("rest", 3).set(this.position);
    attribute("exposed", 1);
    if (exposed) this.expose(exposed);
  }

  /** Outline what is exposed: 0 or 1 a point. */
  expose(exposed) {
    const border = this.geometry.attributes.exposed.array;
    border.fill(0);
    border.set(exposed);
    this.spread(border, 1);
    for (let i = 0; i < BLURS; i++) blur(border, this.finest);
    this.changed("exposed");
  }

  /** Whether to draw every triangle, or only those between the surface's own points. */
  setSharp(is) {
    this.geometry.setIndex(this.indices[is ? 1 : 0]);
  }

  /** Go to rest + displacement; null is the rest state. */
  move(displacement) {
    const { position, normal, rest, steps, finest } = this;
    for (let i = 0; i < rest.length; i++) {
      position[i] = displacement === null ? rest[i] : rest[i] + displacement[i];
    }
    for (const step of steps) {
      normals(position, step.coarse, normal);
      round(position, normal, step, step.before);
    }
    normals(position, finest, normal);
    this.changed("position", "normal");
    this.geometry.boundingSphere = null;
  }

  /** Take the colours of the surface's own points to all. */
  spread(values, size) {
    for (const step of this.steps) average(values, size, step, step.before);
  }

  recolour() {
    this.spread(this.colour, 3);
    this.changed("colour");
  }

  changed(...names) {
    for (const name of names) this.geometry.attributes[name].needsUpdate = true;
  }
}

/** Replace every value by the mean over the triangles around it. */
function blur(values, faces) {
  const sum = new Float32Array(values.length);
  const count = new Float32Array(values.length);
  for (let f = 0; f < faces.length; f += 3) {
    const mean = (values[faces[f]] + values[faces[f + 1]] + values[faces[f + 2]]) / 3;
    for (let k = 0; k < 3; k++) {
      sum[faces[f + k]] += mean;
      count[faces[f + k]] += 1;
    }
  }
  for (let i = 0; i < values.length; i++) if (count[i]) values[i] = sum[i] / count[i];
}
