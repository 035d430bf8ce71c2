// One brain on show: outer surface, what is inside, a section, and the force's arrow.

import * as THREE from "three";
import { FIELDS, paint } from "./colours.js";
import { sectionGeometry, sectionMaterial } from "./section.js";
import { Surface } from "./surface.js";
import { setPlane, tissue } from "./tissue.js";

const INSIDE = { tumour: [0.62, 0.42, 0.82], ventricle: [0.35, 0.55, 0.8] };
const HELD = [0.06, 0.1, 0.16]; // added to half the tissue's colour
const OTHER = [0.5, 0.6, 0.6];
const DOT = 0.007; // radius of a measured place, in body sizes
const LARGE_DOTS = 100; // as many are that large

export class BodyView {
  constructor(arrays, size) {
    this.scene = new THREE.Scene();
    this.displacement = null;
    this.values = null;
    this.inside = [];
    this.ghosts = [];
    const { points } = arrays;
    this.exposed = arrays.exposed;
    this.brain = new Surface(points, arrays["faces:brain"], { exposed: arrays.exposed });
    this.back = this.add(this.brain.geometry, tissue({ side: THREE.BackSide, opacity: 0.45 }), 1);
    this.front = this.add(this.brain.geometry, tissue({ opacity: 0.45, rim: 1 }), 3);
    for (const [name, faces] of Object.entries(arrays)) {
      if (!name.startsWith("faces:") || name === "faces:brain") continue;
      const colour = INSIDE[name.slice(6)] ?? OTHER;
      const part = new Surface(points, faces, { colour });
      this.add(part.geometry, tissue(), 0);
      this.ghosts.push(ghost(part));
      this.inside.push(part);
    }
    this.scene.add(...this.ghosts);
    this.section = null;
    this.arrow = new Arrow(size);
    this.scene.add(this.arrow.group);
    this.held = null;
    this.dots = null;
    this.size = size;
  }

  add(geometry, material, order) {
    const mesh = new THREE.Mesh(geometry, material);
    mesh.frustumCulled = false;
    mesh.renderOrder = order;
    this.scene.add(mesh);
    return mesh;
  }

  /** Show a prediction's arrays, or the rest state for null. */
  show(arrays) {
    this.displacement = arrays?.displacement ?? null;
    this.values = arrays?.field ?? null;
    for (const part of [this.brain, ...this.inside]) part.move(this.displacement);
    this.sectionValues = arrays?.section_field ?? null;
    this.sectionDisplacement = arrays?.section_displacement ?? null;
    this.moveSection();
  }

  /** Outline a craniotomy and shade what the skull would hold; null is the scene's own. */
  tryOpening(arrays) {
    this.brain.expose(arrays?.loaded ?? this.exposed);
    this.held = arrays?.held ?? null;
  }

  /** Show where places were measured, in the colours of what fits and of outliers; null takes them away. */
  setMeasured(places, misfits, colours) {
    if (this.dots) {
      this.scene.remove(this.dots);
      this.dots.dispose();
      this.dots.material.dispose();
      this.dots = null;
    }
    if (!places?.length) return;
    this.dots = dots(places, misfits, colours, this.size);
    this.scene.add(this.dots);
  }

  /** The scalar at the points in a field's units; null where there is none. */
  scalars(field) {
    return FIELDS[field].sent ? this.values : lengths(this.displacement, this.count);
  }

  /** Where a place of the surface at rest is now: by its three nearest points. */
  at(place) {
    const { rest, count } = this.brain;
    const near = [];
    const p = new THREE.Vector3();
    for (let i = 0; i < count; i++) {
      const distance = p.fromArray(rest, 3 * i).distanceTo(place);
      if (near.length === 3 && distance >= near[2][0]) continue;
      near.push([distance, i]);
      near.sort((a, b) => a[0] - b[0]);
      near.length = Math.min(near.length, 3);
    }
    const total = near.reduce((sum, [d]) => sum + 1 / (d + 1e-6), 0);
    const now = place.clone();
    if (this.displacement === null) return now;
    for (const [d, i] of near) {
      now.addScaledVector(p.fromArray(this.displacement, 3 * i), 1 / (d + 1e-6) / total);
    }
    return now;
  }

  get count() {
    return this.brain.count;
  }

  recolour(field, range) {
    const own = this.brain.colour.subarray(0, 3 * this.count);
    paint(field, this.scalars(field), range, own);
    if (this.held) shade(own, this.held);
    this.brain.recolour();
    if (!this.section) return;
    const n = this.section.geometry.attributes.rest.count;
    const known = FIELDS[field].sent ? this.fits(this.sectionValues, n)
      : lengths(this.fits(this.sectionDisplacement, 3 * n), n);
    const painted = this.section.geometry.attributes.colour;
    paint(field, known, range, painted.array);
    painted.needsUpdate = true;
  }

  setSection(header, arrays) {
    if (this.section) {
      this.scene.remove(this.section);
      this.section.geometry.dispose();
      this.section.material.dispose();
      this.section = null;
    }
    if (header) {
      this.section = this.add(sectionGeometry(header, arrays), sectionMaterial(arrays.image), 0);
      this.moveSection();
    }
  }

  moveSection() {
    if (!this.section) return;
    const { rest, position } = this.section.geometry.attributes;
    const by = this.fits(this.sectionDisplacement, rest.array.length);
    for (let i = 0; i < rest.array.length; i++) position.array[i] = rest.array[i] + (by?.[i] ?? 0);
    position.needsUpdate = true;
  }

  /** A prediction may still be of the section before this one. */
  fits(values, length) {
    return values && values.length === length ? values : null;
  }

  /** Whether a place at rest lies beyond the clipping plane. */
  isCutAway(place) {
    const plane = this.front.material.uniforms.plane.value;
    return place.dot(plane) > plane.w; // of a Vector4, dot takes x, y and z
  }

  /** Leave out what costs time and says little while things move. */
  setSharp(is) {
    for (const part of [this.back, ...this.ghosts]) part.visible = is;
    for (const part of [this.brain, ...this.inside]) part.setSharp(is);
  }

  style({ opacity, plane, patch, ink, accent }) {
    for (const lines of this.ghosts) lines.material.color.set(ink);
    for (const { material } of [this.back, this.front]) {
      material.uniforms.opacity.value = opacity;
      material.uniforms.patchRadius.value = patch ? patch.radius : 0;
      material.uniforms.accent.value.set(accent);
      if (patch) material.uniforms.patchCentre.value.fromArray(patch.point);
      setPlane(material, plane);
    }
  }
}

/** Darken the colours of points that are marked. */
function shade(colours, marked) {
  for (let i = 0; i < marked.length; i++) {
    if (marked[i]) for (let k = 0; k < 3; k++) colours[3 * i + k] = 0.5 * colours[3 * i + k] + HELD[k];
  }
}

/** Many are smaller: those of a whole surface would hide it. */
function dots(places, misfits, colours, size) {
  const count = places.length / 3;
  const radius = DOT * size * Math.min(1, Math.sqrt(LARGE_DOTS / count));
  const made = new THREE.InstancedMesh(new THREE.SphereGeometry(radius, 12, 8), new THREE.MeshBasicMaterial(), count);
  const at = new THREE.Matrix4();
  misfits.forEach(({ outlier }, i) => {
    made.setMatrixAt(i, at.makeTranslation(...places.subarray(3 * i, 3 * i + 3)));
    made.setColorAt(i, new THREE.Color(outlier ? colours.outlier : colours.fits));
  });
  made.renderOrder = 4;
  made.frustumCulled = false;
  return made;
}

function lengths(displacement, count) {
  const out = new Float32Array(count);
  if (displacement === null) return out;
  for (let i = 0; i < count; i++) {
    out[i] = Math.hypot(displacement[3 * i], displacement[3 * i + 1], displacement[3 * i + 2]);
  }
  return out;
}

/** Where a region was at rest, as faint lines. */
function ghost(part) {
  const rest = new THREE.BufferGeometry();
  rest.setAttribute("position", new THREE.BufferAttribute(part.rest, 3));
  rest.setIndex(new THREE.BufferAttribute(Uint32Array.from(part.faces), 1));
  const lines = new THREE.LineSegments(
    new THREE.WireframeGeometry(rest),
    new THREE.LineBasicMaterial({ transparent: true, opacity: 0.13, depthWrite: false }),
  );
  lines.renderOrder = 2;
  return lines;
}

/** The force: its head on the surface, a handle at its tail. */
class Arrow {
  constructor(size) {
    const material = new THREE.MeshBasicMaterial();
    this.material = material;
    this.headLength = 0.03 * size;
    const [thin, wide, ball] = [0.004, 0.012, 0.0125].map((fraction) => fraction * size);
    this.shaft = new THREE.Mesh(new THREE.CylinderGeometry(thin, thin, 1, 16), material);
    this.head = new THREE.Mesh(new THREE.ConeGeometry(wide, this.headLength, 24), material);
    this.handle = new THREE.Mesh(new THREE.SphereGeometry(ball, 24, 16), material);
    this.group = new THREE.Group();
    this.group.add(this.shaft, this.head, this.handle);
    this.group.visible = false;
    for (const part of this.group.children) part.renderOrder = 4;
  }

  /** From `tail` to `tip`, both THREE.Vector3. */
  place(tail, tip, colour) {
    const along = tip.clone().sub(tail);
    const length = along.length();
    along.divideScalar(length);
    this.group.visible = true;
    this.group.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), along);
    this.group.position.copy(tail);
    this.shaft.scale.y = Math.max(length - 0.9 * this.headLength, 0.1 * this.headLength);
    this.shaft.position.y = this.shaft.scale.y / 2;
    this.head.position.y = length - this.headLength / 2;
    this.material.color.set(colour);
  }
}
