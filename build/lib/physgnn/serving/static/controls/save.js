// What one can take away: a picture with its caption, and the load case.

import { FIELDS, ticks } from "../scene/colours.js";

function download(blob, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

/** The picture on the page with a caption and the legend below. */
export function savePicture(stage, { lines, field, range }) {
  stage.setSharp(true);
  stage.draw(); // the drawing buffer is only there right after drawing
  const { width, height } = stage.canvas;
  const scale = width / stage.canvas.clientWidth;
  const strip = 64 * scale;
  const canvas = Object.assign(document.createElement("canvas"), { width, height: height + strip });
  const c = canvas.getContext("2d");
  c.fillStyle = "#161c22";
  c.fillRect(0, 0, width, height + strip);
  c.drawImage(stage.canvas, 0, 0);
  c.font = `${13 * scale}px system-ui, sans-serif`;
  c.fillStyle = "#e8ecef";
  lines.forEach((line, i) => c.fillText(line, 20 * scale, height + (24 + 20 * i) * scale));
  const [left, wide] = [width - 240 * scale, 220 * scale];
  const gradient = c.createLinearGradient(left, 0, left + wide, 0);
  const { stops, title } = FIELDS[field];
  stops.forEach((hex, i) => gradient.addColorStop(i / (stops.length - 1), hex));
  c.fillText(title, left, height + 14 * scale);
  c.fillStyle = gradient;
  c.fillRect(left, height + 22 * scale, wide, 10 * scale);
  c.fillStyle = "#e8ecef";
  ticks(range).forEach((text, i) => {
    c.textAlign = ["left", "center", "right"][i];
    c.fillText(text, left + (wide * i) / 2, height + 50 * scale);
  });
  canvas.toBlob((blob) => download(blob, "physgnn.png"), "image/png");
}

/** Ask the server for the nodal forces of a patch load and save them. */
export async function saveLoadCase(message) {
  const reply = await fetch("/load-case", { method: "POST", body: JSON.stringify(message) });
  const content = await reply.json();
  if (!reply.ok) throw new Error(content.error);
  download(new Blob([JSON.stringify(content)], { type: "application/json" }), "load-case.json");
}
