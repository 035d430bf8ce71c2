// How tissue looks: soft light, a brighter rim, clipped by a plane, touched in a ring.

import * as THREE from "three";

const VERTEX = `
  attribute vec3 colour, rest;
  attribute float exposed;
  varying vec3 vNormal, vView, vColour, vRest;
  varying float vExposed;
  void main() {
    vec4 view = modelViewMatrix * vec4(position, 1.0);
    vNormal = normalMatrix * normal;
    vView = view.xyz;
    vColour = colour;
    vRest = rest;
    vExposed = exposed;
    gl_Position = projectionMatrix * view;
  }`;

const FRAGMENT = `
  uniform float opacity, rim, patchRadius;
  uniform vec3 patchCentre, accent;
  uniform vec4 plane;
  varying vec3 vNormal, vView, vColour, vRest;
  varying float vExposed;
  void main() {
    if (dot(vRest, plane.xyz) > plane.w) discard; // a plane of the tissue, not of space
    vec3 n = normalize(vNormal);
    if (!gl_FrontFacing) n = -n;
    vec3 v = normalize(-vView);
    float key = 0.5 + 0.5 * dot(n, normalize(vec3(0.35, 0.75, 0.6)));
    float fill = 0.5 + 0.5 * dot(n, normalize(vec3(-0.8, -0.2, 0.4)));
    float gloss = pow(max(dot(n, normalize(normalize(vec3(0.35, 0.75, 0.6)) + v)), 0.0), 48.0);
    vec3 c = vColour * (0.36 + 0.72 * key * key + 0.16 * fill) + 0.12 * gloss;
    float edge = pow(1.0 - abs(dot(n, v)), 2.5);
    float alpha = mix(opacity, min(1.0, opacity + 0.5), rim * edge);
    c += rim * 0.10 * edge;
    // the border of what is exposed, and the ring of the patch: lines on the screen
    float border = 1.0 - smoothstep(0.5, 1.5, abs(vExposed - 0.5) / max(fwidth(vExposed), 1e-3));
    float away = length(vRest - patchCentre);
    float ring = 1.0 - smoothstep(0.7, 1.7, abs(away - patchRadius) / max(fwidth(away), 1e-3));
    ring *= step(0.5, vExposed) * step(0.001, patchRadius);
    c = mix(c, vec3(1.0), 0.55 * border);
    c = mix(c, accent, 0.9 * ring);
    alpha = max(alpha, max(0.75 * border, 0.9 * ring) * step(0.0, dot(n, v)));
    gl_FragColor = vec4(c, alpha);
  }`;

const FAR = new THREE.Vector4(0, 0, 0, 1);

/** A material; `side` "back" and "front" of a translucent body are drawn one after another. */
export function tissue({ side = THREE.FrontSide, opacity = 1, rim = 0 } = {}) {
  return new THREE.ShaderMaterial({
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    side,
    transparent: opacity < 1,
    depthWrite: opacity === 1,
    uniforms: {
      opacity: { value: opacity },
      rim: { value: rim },
      patchRadius: { value: 0 },
      patchCentre: { value: new THREE.Vector3() },
      accent: { value: new THREE.Color(0x45c3a6) },
      plane: { value: FAR.clone() },
    },
  });
}

export function setPlane(material, plane) {
  material.uniforms.plane.value.copy(plane ?? FAR);
}
