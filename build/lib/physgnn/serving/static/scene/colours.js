// The scalars a surface can be coloured by: maps, ranges and legends.

export const TISSUE = [0.83, 0.79, 0.75];

/** Rows by name, as the server sends them with the scene (physgnn/serving/scene/colours.py). */
export const FIELDS = {};
const RGB = {};

export function setFields(rows) {
  for (const known of [FIELDS, RGB]) for (const name of Object.keys(known)) delete known[name];
  Object.assign(FIELDS, rows);
  for (const [name, { stops }] of Object.entries(rows)) RGB[name] = stops.map(fromHex);
}

export function fromHex(hex) {
  return [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);
}

/** Colour of t in [0, 1], written into `out` at `at`. */
function interpolate(stops, t, out, at) {
  const x = Math.min(Math.max(t, 0), 1) * (stops.length - 1);
  const i = Math.min(Math.floor(x), stops.length - 2);
  for (let k = 0; k < 3; k++) out[at + k] = stops[i][k] + (x - i) * (stops[i + 1][k] - stops[i][k]);
}

/** The next round number at or above a size. */
function nice(size) {
  const power = 10 ** Math.floor(Math.log10(size));
  return [1, 1.2, 1.6, 2, 3, 4, 5, 6, 8, 10].map((m) => m * power).find((m) => m >= size * 0.999);
}

/** Range [low, high] of a field for the values at hand; it changes in steps only. */
export function rangeOf(name, lists) {
  const { centre, diverging, least } = FIELDS[name];
  let size = least;
  for (const values of lists) for (const v of values) size = Math.max(size, Math.abs(v - centre));
  size = nice(size);
  return [diverging ? centre - size : centre, centre + size];
}

/** Fill `colours` (3 a point) from `values`; the tissue's colour where there are none. */
export function paint(name, values, [low, high], colours) {
  const stops = RGB[name];
  for (let i = 0; i < colours.length / 3; i++) {
    if (values === null) colours.set(TISSUE, 3 * i);
    else interpolate(stops, (values[i] - low) / (high - low), colours, 3 * i);
  }
}

export function drawLegend(context, name) {
  const { width, height } = context.canvas;
  const gradient = context.createLinearGradient(0, 0, width, 0);
  const { stops } = FIELDS[name];
  stops.forEach((hex, i) => gradient.addColorStop(i / (stops.length - 1), hex));
  context.fillStyle = gradient;
  context.fillRect(0, 0, width, height);
}

export function ticks([low, high]) {
  const digits = Math.max(0, 1 - Math.floor(Math.log10(high - low)));
  return [low, (low + high) / 2, high].map((v) => v.toFixed(Math.min(digits, 4)));
}
