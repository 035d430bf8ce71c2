// The cut through the brain on the clipping plane, with the image on it if there is one.

import * as THREE from "three";

const VERTEX = `
  attribute vec3 colour, rest;
  attribute vec2 place;
  attribute float tumour;
  varying vec3 vColour;
  varying vec2 vPlace;
  varying float vTumour;
  void main() {
    vColour = colour;
    vPlace = place;
    vTumour = tumour;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  }`;

const FRAGMENT = `
  uniform sampler2D image;
  uniform float grey;
  varying vec3 vColour;
  varying vec2 vPlace;
  varying float vTumour;
  void main() {
    vec3 tinted = mix(vColour, vec3(0.62, 0.42, 0.82), 0.55 * vTumour);
    vec3 scanned = vec3(texture2D(image, vPlace).r * 1.05);
    scanned = mix(scanned, vec3(0.62, 0.42, 0.82), 0.35 * vTumour);
    gl_FragColor = vec4(mix(0.92 * tinted, scanned, grey), 1.0);
  }`;

/** Corners are not shared between triangles: each has its own region. */
export function sectionGeometry(header, { points, faces, region }) {
  const n = points.length / 3;
  const axes = [0, 1, 2].filter((a) => a !== header.axis);
  const place = new Float32Array(2 * n);
  for (let i = 0; i < n; i++) {
    axes.forEach((a, k) => {
      place[2 * i + k] = (points[3 * i + a] - header.low[a]) / (header.high[a] - header.low[a]);
    });
  }
  const tumour = new Float32Array(n);
  region.forEach((r, i) => {
    if (r > 0) for (let k = 0; k < 3; k++) tumour[faces[3 * i + k]] = 1;
  });
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(Float32Array.from(points), 3));
  geometry.setAttribute("rest", new THREE.BufferAttribute(points, 3));
  geometry.setAttribute("colour", new THREE.BufferAttribute(new Float32Array(3 * n).fill(0.8), 3));
  geometry.setAttribute("place", new THREE.BufferAttribute(place, 2));
  geometry.setAttribute("tumour", new THREE.BufferAttribute(tumour, 1));
  geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(faces), 1));
  return geometry;
}

export function sectionMaterial(image) {
  const [rows, columns] = image ? image.shape : [1, 1];
  const values = image ? Uint8Array.from(image) : new Uint8Array(1);
  const texture = new THREE.DataTexture(values, columns, rows, THREE.RedFormat);
  texture.minFilter = texture.magFilter = THREE.LinearFilter;
  texture.unpackAlignment = 1;
  texture.needsUpdate = true;
  return new THREE.ShaderMaterial({
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    side: THREE.DoubleSide,
    uniforms: { image: { value: texture }, grey: { value: image ? 1 : 0 } },
  });
}
