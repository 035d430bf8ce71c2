// A patient: the craniotomy that is clicked, what was measured, the states registered.

import { $, slider, write } from "./panel.js";
import { download } from "./save.js";

const MIDDLE_RADIUS_MM = 30;
const MOST_MISFITS = 60; // in the table; the rest is in the file
const GUESSES = [[/before|source|preop/i, "before"], [/after|target|intraop/i, "after"]];
const KINDS = [[/landmark|ultrasound/i, "landmarks"], [/bone|skull|divot/i, "bone"]];
const POINTS = [".csv", ".fcsv", ".tag", ".mrk.json"];
const TRANSFORMS = [".txt", ".tfm", ".h5"];
const SCANS = [".nii", ".nii.gz", ".nrrd", ".mha", ".mgz"];

export class Patient {
  /** `page`: pick(function or null), preview(arrays or null), showState(header, arrays), message(text), field(). */
  constructor(link, page) {
    Object.assign(this, { link, page, row: null, point: null, files: [], state: null, busy: false });
    $("pick").addEventListener("click", () => this.setPicking(!this.picking));
    $("open").addEventListener("click", () => this.link.send({ type: "open_skull" }));
    $("adapt").addEventListener("click", () => this.link.send({ type: "adapt" }));
    $("register").addEventListener("click", () => this.register());
    $("keep").addEventListener("click", () => this.link.send({ type: "save" }));
    $("misfits-csv").addEventListener("click", () => this.link.send({ type: "misfits", state: this.state }));
    $("show").addEventListener("click", () => this.askState());
    $("choose").addEventListener("change", ({ target }) => {
      this.addFiles(target.files);
      target.value = "";
    });
    this.takeDrops();
  }

  get picking() {
    return $("pick").getAttribute("aria-pressed") === "true";
  }

  /** What the scene says can be done; null where no case is on show. */
  fit(row) {
    this.row = row;
    this.adapting = false;
    for (const id of ["patient", "measurement"]) $(id).hidden = row === null;
    if (row === null) return;
    $("note").textContent = row.note;
    const [min, max] = row.radius_mm;
    slider("opening", { min, max, value: MIDDLE_RADIUS_MM }, (v) => `${v.toFixed(0)} mm`, () => this.ask());
    slider("noise", { min: 0.2, max: 5, value: 1 }, (v) => `${v.toFixed(1)} mm`, () => {});
    const hint = row.saves ? "" : "Start physgnn view with --save FOLDER to save.";
    $("keep").title = hint;
    $("open").title = row.saves ? "Writes case.toml" : "Nothing is written: start physgnn view with --save FOLDER";
    this.state = null;
    $("opened").textContent = $("registered").textContent = "";
    $("found").hidden = $("state-row").hidden = true;
    this.setPicking(false);
  }

  enable() {
    $("open").disabled = this.point === null || this.busy;
    $("adapt").disabled = this.busy || this.adapting || !this.row?.adapts;
    $("register").disabled = this.files.length === 0 || this.busy;
    $("show").disabled = this.state === null || this.busy;
    $("keep").disabled = this.state === null || this.busy || !this.row?.saves;
  }

  // --- the craniotomy

  setPicking(is) {
    $("pick").setAttribute("aria-pressed", String(is));
    this.page.pick(is ? (point) => { this.point = point; this.ask(); } : null);
    if (is) return;
    this.point = null;
    $("opening-row").hidden = true;
    this.page.preview(null);
    this.enable();
  }

  ask() {
    if (!this.point) return;
    $("opening-row").hidden = false;
    this.link.send({ type: "craniotomy", point: this.point.toArray(), radius_mm: Number($("opening").value) });
  }

  onCraniotomy(header, arrays) {
    if (!this.point) return;
    write("opened", `${header.area_cm2.toFixed(1)} cm² open, ${header.n_loaded} points; the skull holds ${header.n_held}.`);
    this.page.preview(arrays);
    this.enable();
  }

  // --- what was measured

  takeDrops() {
    const over = (is) => (event) => {
      if (this.row === null || !event.dataTransfer?.types.includes("Files")) return;
      event.preventDefault();
      $("drop").classList.toggle("over", is);
      if (event.type === "drop") this.addFiles(event.dataTransfer.files);
    };
    document.addEventListener("dragover", over(true));
    for (const type of ["dragleave", "drop"]) document.addEventListener(type, over(false));
  }

  addFiles(list) {
    for (const file of list) {
      const fault = this.fault(file);
      if (fault) this.page.message(fault);
      else this.files.push({ file, role: this.guess(file.name) });
    }
    this.files.sort((a, b) => a.file.name.localeCompare(b.file.name, "en", { numeric: true }));
    this.listFiles();
  }

  fault(file) {
    const { suffixes, most_bytes: most, most_files: count } = this.row;
    if (!suffixes.some((suffix) => file.name.toLowerCase().endsWith(suffix))) {
      return `${file.name}: measured files end in ${suffixes.join(", ")}`;
    }
    if (file.size === 0) return `${file.name}: this file is empty`;
    if (file.size > most) return `${file.name}: a file must have at most ${most >> 20} MB`;
    return this.files.length < count ? null : `at most ${count} files can be measured`;
  }

  guess(name) {
    const ends = (suffixes) => suffixes.some((suffix) => name.toLowerCase().endsWith(suffix));
    if (ends(TRANSFORMS)) return "initial transform";
    if (ends(SCANS)) return "intraoperative";
    if (!ends(POINTS)) return "surface";
    const when = GUESSES.find(([words]) => words.test(name))?.[1];
    const kind = KINDS.find(([words]) => words.test(name))?.[1];
    if (kind) return when ? `${kind} ${when}` : kind;
    return when ?? "pairs";
  }

  listFiles() {
    $("files").replaceChildren(...this.files.map((one) => {
      const role = element("select", { title: "What this file is" });
      for (const [value, text] of Object.entries(this.row.roles)) {
        role.append(new Option(text, value, false, value === one.role));
      }
      role.setAttribute("aria-label", `What ${one.file.name} is`);
      role.addEventListener("change", () => { one.role = role.value; });
      const away = element("button", { type: "button", textContent: "×", title: "Leave it out" });
      away.addEventListener("click", () => {
        this.files = this.files.filter((other) => other !== one);
        this.listFiles();
      });
      const name = element("span", { className: "name", textContent: one.file.name, title: one.file.name });
      return item(name, role, away);
    }));
    this.enable();
  }

  async register() {
    this.setBusy(true);
    try {
      this.link.send({ type: "forget" });
      for (const { file, role } of this.files) await this.link.sendFile(file, role);
      this.link.send({ type: "register", noise_mm: Number($("noise").value), rigid_offset: $("rigid-offset").checked });
    } catch (error) {
      this.setBusy(false);
      this.page.message(`a file cannot be read any more: ${error.message}`);
    }
  }

  setBusy(is) {
    this.busy = is;
    if (is) {
      $("registered").textContent = "sending…";
      $("found").hidden = $("state-row").hidden = true;
      this.state = null; // the server forgets it, too
    }
    this.enable();
  }

  /** Ask again for the state on show, with the scalar that is chosen. */
  askState(state = this.state) {
    if (state !== null) this.link.send({ type: "state", state, field: this.page.field() });
  }

  /** A state has come; returns whether it is the first of a registration. */
  onState(header) {
    const first = this.busy;
    this.setBusy(false);
    this.state = header.state;
    if (first) {
      $("state-row").hidden = header.states < 2;
      slider("state", { min: 1, max: header.states, value: header.state + 1 },
        (v) => `${v} of ${header.states}`, (v) => this.askState(v - 1));
    }
    this.showFound(header);
    const rest = header.held_out_mm === null ? "" : `, of points held out ${header.held_out_mm.toFixed(2)} mm`;
    const notes = header.notes.length ? ` ${header.notes.join("; ")}.` : "";
    write("registered", `Misfit ${header.misfit_mm?.toFixed(2) ?? "?"} mm${rest}; deviation ${header.deviation_mm.toFixed(2)} mm on average.${notes}`);
    this.enable();
    return first;
  }

  /** How far the state on show can be relied on, and what each measured place says. */
  showFound({ status, usable, error, offset, misfits, places }) {
    $("found").hidden = false;
    write("found-status", status);
    $("found-status").classList.toggle("outlier", !usable);
    const chance = error?.coverage < 1 ? ` (${Math.round(100 * error.coverage)} %)` : "";
    write("found-mean", error ? `${error.mean_mm.toFixed(2)} mm` : "not known");
    write("found-most", error ? `${error.max_mm.toFixed(2)} mm${chance}` : "not known");
    const done = offset.corrected ? "corrected" : `${Math.round(100 * offset.probability)} % probable`;
    const size = `${offset.length_mm.toFixed(1)} mm, ${offset.turn_deg.toFixed(1)}°`;
    write("found-offset", `${size}, ${done}; ${offset.bone ?? "not checked against bone"}`);
    $("misfits").replaceChildren(...misfits.slice(0, MOST_MISFITS).map(({ kind, label, mm, weight, outlier }) => {
      const row = element("tr", { title: kind });
      for (const text of [outlier ? `${label} (outlier)` : label, mm.toFixed(2), weight.toFixed(2)]) {
        row.append(element("td", { textContent: text }));
      }
      row.classList.toggle("outlier", outlier);
      return row;
    }));
    $("misfits-more").hidden = places <= MOST_MISFITS;
    write("misfits-more", `The ${MOST_MISFITS} farthest of ${places.toLocaleString("en")}; the file has all.`);
  }

  /** A line from the server; returns whether it was about the patient. */
  onText(message) {
    if (message.kind === "registering") {
      write("registered", message.states > 1 ? `registering ${message.state + 1} of ${message.states}…` : "registering…");
    } else if (message.kind === "adapting") {
      this.adapting = true;
      write("opened", "adapting the network to this case…");
      this.enable();
    } else if (message.kind === "misfits") {
      download(new Blob([message.text], { type: "text/csv" }), message.name);
    } else if (message.kind === "saved") {
      const text = message.files.length ? `Saved: ${message.files.join(", ")}.` : "Nothing written: no --save FOLDER.";
      write(message.what === "craniotomy" ? "opened" : "registered", text);
    } else {
      if (message.kind === "error" && this.adapting) {
        this.adapting = false;
        $("opened").textContent = message.text;
        this.enable();
      } else if (message.kind === "error" && this.busy) {
        this.setBusy(false);
        $("registered").textContent = message.text;
      }
      return false;
    }
    return true;
  }

  onClosed() {
    if (this.busy) this.setBusy(false);
  }
}

function element(tag, properties) {
  return Object.assign(document.createElement(tag), properties);
}

function item(...children) {
  const row = document.createElement("li");
  row.append(...children);
  return row;
}
