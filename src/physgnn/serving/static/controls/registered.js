// What a registration found: its states on a slider, how far each can be relied on.

import { $, slider, write } from "./panel.js";

const MOST_MISFITS = 60; // in the table; the rest is in the file

/** A slider over the states of a series, with a mark for each; `onState` gets the number of one, from 0. */
export function showStates({ states, state, failed }, onState) {
  const isFailed = (number) => failed.some((one) => one.state === number);
  $("state-row").hidden = states < 2;
  slider("state", { min: 1, max: states, value: state + 1 },
    (v) => `${v} of ${states}${isFailed(v - 1) ? ", failed" : ""}`, (v) => onState(v - 1));
  $("state-marks").replaceChildren(...Array.from({ length: states }, (_, number) => {
    const mark = document.createElement("i");
    if (isFailed(number)) mark.title = line(failed.find((one) => one.state === number));
    mark.classList.toggle("failed", isFailed(number));
    return mark;
  }));
  listFailed(failed);
}

/** Why states failed, a line each. */
export function listFailed(failed) {
  $("failed").hidden = failed.length === 0;
  $("failed").replaceChildren(...failed.map((one) =>
    Object.assign(document.createElement("li"), { textContent: line(one) })));
}

function line({ state, name, reason }) {
  const saysWhich = name.split(" + ").some((file) => reason.includes(file));
  return `State ${state + 1}, ${saysWhich ? reason : `${name}: ${reason}`}`;
}

/** What is below the slider of the states leaves its place empty: the slider must not jump away. */
export function blankFound() {
  $("found").classList.add("blank");
}

export function hideFound() {
  for (const id of ["found", "state-row", "failed"]) $(id).hidden = true;
}

/** How well a state fits, and below it what was said of it, a line each. */
export function summary({ misfit_mm: misfit, held_out_mm: heldOut, deviation_mm: deviation, notes }) {
  const rest = heldOut === null ? "" : `, of points held out ${heldOut.toFixed(2)} mm`;
  const first = `Misfit ${misfit?.toFixed(2) ?? "?"} mm${rest}; deviation ${deviation.toFixed(2)} mm on average.`;
  return [first, ...notes].join("\n");
}

/** How far the state on show can be relied on, and what each measured place says. */
export function showFound({ status, usable, error, offset, misfits, places }) {
  $("found").hidden = false;
  $("found").classList.remove("blank");
  write("found-status", status);
  $("found-status").classList.toggle("outlier", !usable);
  const chance = error?.coverage < 1 ? ` (${Math.round(100 * error.coverage)} %)` : "";
  write("found-mean", error ? `${error.mean_mm.toFixed(2)} mm` : "not known");
  write("found-most", error ? `${error.max_mm.toFixed(2)} mm${chance}` : "not known");
  const done = offset.corrected ? "corrected" : `${Math.round(100 * offset.probability)} % probable`;
  const size = `${offset.length_mm.toFixed(1)} mm, ${offset.turn_deg.toFixed(1)}°`;
  write("found-offset", `${size}, ${done}; ${offset.bone ?? "not checked against bone"}`);
  $("misfits").replaceChildren(...misfits.slice(0, MOST_MISFITS).map(({ kind, label, mm, weight, outlier }) => {
    const row = Object.assign(document.createElement("tr"), { title: kind });
    for (const text of [outlier ? `${label} (outlier)` : label, mm.toFixed(2), weight.toFixed(2)]) {
      row.append(Object.assign(document.createElement("td"), { textContent: text }));
    }
    row.classList.toggle("outlier", outlier);
    return row;
  }));
  $("misfits-more").hidden = places <= MOST_MISFITS;
  write("misfits-more", `The ${MOST_MISFITS} farthest of ${places.toLocaleString("en")}; the file has all.`);
}
