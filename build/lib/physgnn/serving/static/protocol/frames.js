// Binary messages from the server: physgnn/serving/protocol/frames.py says how they are laid out.

const VIEWS = { f4: Float32Array, i4: Int32Array, u1: Uint8Array };

/** Return {header, arrays} of a message; the arrays are views, not copies. */
export function decode(buffer) {
  const magic = new TextDecoder().decode(new Uint8Array(buffer, 0, 4));
  if (magic !== "PGV1") throw new Error("not a frame of this program");
  const length = new DataView(buffer).getUint32(4, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 8, length)));
  const arrays = {};
  let start = 8 + length;
  for (const { name, type, shape } of header.arrays) {
    const count = shape.reduce((a, b) => a * b, 1);
    arrays[name] = new VIEWS[type](buffer, start, count);
    arrays[name].shape = shape;
    start += Math.ceil(arrays[name].byteLength / 4) * 4;
  }
  return { header, arrays };
}
