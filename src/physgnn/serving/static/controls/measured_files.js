// The measured files that are to be sent: what each is, and what is chosen for them.

import { $ } from "./panel.js";

const GUESSES = [[/before|source|preop/i, "before"], [/after|target|intraop/i, "after"]];
const KINDS = [[/landmark|ultrasound/i, "landmarks"], [/bone|skull|divot/i, "bone"]];
const POINTS = [".csv", ".fcsv", ".tag", ".mrk.json"];
const TRANSFORMS = [".txt", ".tfm", ".h5"];
const SCANS = [".nii", ".nii.gz", ".nrrd", ".mha", ".mgz"];
const MOST_FAULTS = 4; // that are said at once

export class MeasuredFiles {
  /** `page`: changed() after every change, message(text) for what is refused. */
  constructor(page) {
    Object.assign(this, { page, row: null, files: [] });
    $("choose").addEventListener("change", ({ target }) => {
      this.add(target.files);
      target.value = "";
    });
    this.takeDrops();
  }

  /** What the scene says of files, roles and menus; null where no case is on show. */
  fit(row) {
    this.row = row;
    if (row === null) return;
    const known = this.chosen;
    $("menus").replaceChildren(...Object.entries(row.menus).map(([name, { title, values }]) => {
      const menu = element("select", { id: name });
      for (const [value, text] of Object.entries(values)) {
        menu.append(new Option(text, value, false, value === known[name]));
      }
      const label = element("label", { textContent: `${title} `, hidden: true });
      label.append(menu);
      return label;
    }));
    this.list();
  }

  get length() {
    return this.files.length;
  }

  /** The name of each menu on show → what is chosen in it. */
  get chosen() {
    const shown = [...$("menus").children].filter((label) => !label.hidden);
    return Object.fromEntries(shown.map((label) => label.querySelector("select")).map(({ id, value }) => [id, value]));
  }

  [Symbol.iterator]() {
    return this.files[Symbol.iterator]();
  }

  takeDrops() {
    const over = (is) => (event) => {
      if (this.row === null || !event.dataTransfer?.types.includes("Files")) return;
      event.preventDefault();
      $("drop").classList.toggle("over", is);
      if (event.type === "drop") this.add(event.dataTransfer.files);
    };
    document.addEventListener("dragover", over(true));
    for (const type of ["dragleave", "drop"]) document.addEventListener(type, over(false));
  }

  add(list) {
    const faults = [];
    for (const file of list) {
      const fault = this.fault(file);
      if (fault) faults.push(fault);
      else this.files.push({ file, role: this.guess(file.name) });
    }
    const more = faults.length - MOST_FAULTS;
    if (more > 0) faults.splice(MOST_FAULTS, more, `and ${more} more`);
    if (faults.length) this.page.message(faults.join("\n"));
    this.files.sort((a, b) => a.file.name.localeCompare(b.file.name, "en", { numeric: true }));
    this.list();
  }

  fault(file) {
    const { suffixes, most_bytes: most, most_files: count, most_total_bytes: all } = this.row;
    if (!suffixes.some((suffix) => file.name.toLowerCase().endsWith(suffix))) {
      return `${file.name}: measured files end in ${suffixes.join(", ")}`;
    }
    if (file.size === 0) return `${file.name}: this file is empty`;
    if (file.size > most) return `${file.name}: a file must have at most ${most >> 20} MB`;
    if (this.length >= count) return `${file.name}: at most ${count} files can be measured`;
    const total = this.files.reduce((sum, one) => sum + one.file.size, file.size);
    return total > all ? `${file.name}: all measured files must be at most ${all >> 20} MB together` : null;
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

  list() {
    $("files").replaceChildren(...this.files.map((one) => {
      const role = element("select", { title: "What this file is" });
      for (const [value, text] of Object.entries(this.row.roles)) {
        role.append(new Option(text, value, false, value === one.role));
      }
      role.setAttribute("aria-label", `What ${one.file.name} is`);
      role.addEventListener("change", () => {
        one.role = role.value;
        this.showMenus();
      });
      const away = element("button", { type: "button", textContent: "×", title: "Leave it out" });
      away.setAttribute("aria-label", `Leave ${one.file.name} out`);
      away.addEventListener("click", () => {
        this.files = this.files.filter((other) => other !== one);
        this.list();
      });
      const name = element("span", { className: "name", textContent: one.file.name, title: one.file.name });
      return item(name, role, away);
    }));
    this.showMenus();
    this.page.changed();
  }

  /** Show the menus that some file calls for. */
  showMenus() {
    for (const label of $("menus").children) {
      const { roles } = this.row.menus[label.querySelector("select").id];
      label.hidden = !this.files.some(({ role }) => roles.includes(role));
    }
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
