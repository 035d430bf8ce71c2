// A finer, rounder copy of a triangle surface that passes through every point of it.
//
// Phong tessellation (Boubekeur & Alexa 2008, ACM Trans. Graph. 27): the midpoint of an
// edge is drawn towards the tangent planes at its ends. For the eye only: what is loaded
// and what is predicted are the points themselves.

const FRACTION = 0.7; // of the way to the tangent planes

/** Topology of one subdivision: midpoints as pairs of points, and four faces for one. */
export function subdivision(faces, count) {
  const pairs = [];
  const known = new Map();
  const middle = (a, b) => {
    const key = a < b ? a * 2 ** 26 + b : b * 2 ** 26 + a;
    if (!known.has(key)) {
      known.set(key, count + pairs.length / 2);
      pairs.push(a, b);
    }
    return known.get(key);
  };
  const finer = new Uint32Array(4 * faces.length);
  for (let f = 0, out = 0; f < faces.length; f += 3) {
    const [a, b, c] = [faces[f], faces[f + 1], faces[f + 2]];
    const [p, q, r] = [middle(a, b), middle(b, c), middle(c, a)];
    for (const i of [a, p, r, p, b, q, r, q, c, p, q, r]) finer[out++] = i;
  }
  return { pairs: Uint32Array.from(pairs), faces: finer, count: count + pairs.length / 2 };
}

/** Fill the midpoints of `values` (`size` a point) with the mean of their ends. */
export function average(values, size, { pairs }, count) {
  for (let m = 0; m < pairs.length; m += 2) {
    for (let k = 0; k < size; k++) {
      values[(count + m / 2) * size + k] =
        (values[pairs[m] * size + k] + values[pairs[m + 1] * size + k]) / 2;
    }
  }
}

/** Fill the midpoints of `position`, rounded by the normals at their ends. */
export function round(position, normal, { pairs }, count) {
  for (let m = 0; m < pairs.length; m += 2) {
    const [a, b, at] = [3 * pairs[m], 3 * pairs[m + 1], 3 * (count + m / 2)];
    let alongA = 0, alongB = 0; // from an end's tangent plane to the midpoint
    for (let k = 0; k < 3; k++) {
      const half = (position[b + k] - position[a + k]) / 2;
      alongA += half * normal[a + k];
      alongB -= half * normal[b + k];
    }
    for (let k = 0; k < 3; k++) {
      const middle = (position[a + k] + position[b + k]) / 2;
      position[at + k] = middle - (FRACTION / 2) * (alongA * normal[a + k] + alongB * normal[b + k]);
    }
  }
}

/** Unit normals of the points, weighted by area. */
export function normals(position, faces, out) {
  out.fill(0);
  for (let f = 0; f < faces.length; f += 3) {
    const [a, b, c] = [3 * faces[f], 3 * faces[f + 1], 3 * faces[f + 2]];
    const ux = position[b] - position[a], uy = position[b + 1] - position[a + 1], uz = position[b + 2] - position[a + 2];
    const vx = position[c] - position[a], vy = position[c + 1] - position[a + 1], vz = position[c + 2] - position[a + 2];
    const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    for (const i of [a, b, c]) {
      out[i] += nx;
      out[i + 1] += ny;
      out[i + 2] += nz;
    }
  }
  for (let i = 0; i < out.length; i += 3) {
    const length = Math.hypot(out[i], out[i + 1], out[i + 2]) || 1;
    for (let k = 0; k < 3; k++) out[i + k] /= length;
  }
}
