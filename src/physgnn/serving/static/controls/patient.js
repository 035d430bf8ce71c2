// A patient: the craniotomy that is clicked, what was measured, the states registered.

import { MeasuredFiles } from "./measured_files.js";
import { $, slider, write } from "./panel.js";
import { blankFound, hideFound, listFailed, showFound, showStates, summary } from "./registered.js";
import { download } from "./save.js";

const MIDDLE_RADIUS_MM = 30;
const USUAL_NOISE_MM = 1;

export class Patient {
  /**
   * `page`: pick(function or null), preview(arrays or null), showRest(failed state or nothing), message(text), field().
   */
  constructor(link, page) {
    Object.assign(this, { link, page, row: null, point: null, state: null, failed: [], busy: false });
    this.files = new MeasuredFiles({ changed: () => this.enable(), message: page.message });
    $("pick").addEventListener("click", () => this.setPicking(!this.picking));
    $("open").addEventListener("click", () => this.link.send({ type: "open_skull" }));
    $("adapt").addEventListener("click", () => this.link.send({ type: "adapt" }));
    $("register").addEventListener("click", () => this.register());
    $("keep").addEventListener("click", () => this.link.send({ type: "save" }));
    $("misfits-csv").addEventListener("click", () => this.link.send({ type: "misfits", state: this.state }));
    $("show").addEventListener("click", () => this.askState());
  }

  get picking() {
    return $("pick").getAttribute("aria-pressed") === "true";
  }

  /** What the scene says can be done; null where no case is on show. */
  fit(row) {
    const noise = this.row ? Number($("noise").value) : USUAL_NOISE_MM;
    this.row = row;
    this.adapting = false;
    for (const id of ["patient", "measurement"]) $(id).hidden = row === null;
    this.files.fit(row);
    if (row === null) return;
    $("note").textContent = row.note;
    const [min, max] = row.radius_mm;
    slider("opening", { min, max, value: MIDDLE_RADIUS_MM }, (v) => `${v.toFixed(0)} mm`, () => this.ask());
    slider("noise", { min: 0.2, max: 5, value: noise }, (v) => `${v.toFixed(1)} mm`, () => {});
    const hint = row.saves ? "" : "Start physgnn view with --save FOLDER to save.";
    $("keep").title = hint;
    $("open").title = row.saves ? "Writes case.toml" : "Nothing is written: start physgnn view with --save FOLDER";
    this.state = null;
    this.failed = [];
    $("opened").textContent = $("registered").textContent = "";
    hideFound();
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

  async register() {
    this.setBusy(true);
    try {
      this.link.send({ type: "forget" });
      for (const { file, role } of this.files) await this.link.sendFile(file, role);
      this.link.send({
        type: "register",
        noise_mm: Number($("noise").value),
        rigid_offset: $("rigid-offset").checked,
        chosen: this.files.chosen,
      });
    } catch (error) {
      this.setBusy(false);
      this.page.message(`a file cannot be read any more: ${error.message}`);
    }
  }

  setBusy(is) {
    this.busy = is;
    if (is) {
      $("registered").textContent = "sending…";
      hideFound();
      this.page.showRest(); // what was registered is forgotten, here and by the server
      this.state = null;
      this.failed = [];
    }
    this.enable();
  }

  /** Ask again for the state on show, with the scalar that is chosen. */
  askState(state = this.state) {
    if (state === null) return;
    this.state = state;
    const failed = this.failed.find((one) => one.state === state);
    if (failed) this.showFailed(failed);
    else this.link.send({ type: "state", state, field: this.page.field() });
  }

  /** A state that failed has nothing to show. */
  showFailed({ name, reason }) {
    blankFound();
    write("registered", "This state could not be registered.");
    this.page.showRest({ reason, name });
  }

  /** A state has come; returns whether it is the first of a registration, null if it is not wanted any more. */
  onState(header) {
    const first = this.busy;
    if (!first && header.state !== this.state) return null;
    this.setBusy(false);
    this.state = header.state;
    this.failed = header.failed;
    if (first) showStates(header, (state) => this.askState(state));
    showFound(header);
    write("registered", summary(header));
    this.enable();
    return first;
  }

  /** A line from the server; returns whether it was about the patient. */
  onText(message) {
    if (message.kind === "registering") {
      write("registered", message.states > 1 ? `registering ${message.state + 1} of ${message.states}…` : "registering…");
    } else if (message.kind === "adapting") {
      this.adapting = true;
      write("opened", "adapting the network to this case…");
      this.enable();
    } else if (message.kind === "unregistered") {
      this.setBusy(false);
      $("registered").textContent = `None of the ${message.states} states could be registered.`;
      listFailed(message.failed);
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
