// Every number of the motor file as a row: name, number, unit, slider, arrow, whether it is free.

import { bestArrow, present, slopeOf } from "./arrows.js";
import { byId, make, say } from "./dom.js";
import { ask, isAcknowledged, move } from "./link.js";
import { fromSi, rounded, step, toSi, typed, written } from "./numbers.js";
import { known, on } from "./store.js";

const OPEN = new Set(["Valve plate", "Cam shape", "Operating point 1"]);
const REST = 450; // ms without a key after which a number is kept
const UNITS_KEY = "camring-units";
const chosenUnits = JSON.parse(localStorage.getItem(UNITS_KEY) ?? "{}");
const rows = new Map();

/** A step of everything that is free along its arrow, as far as what is aimed at would fall by a sixth. */
function stepAlong() {
  const free = [...rows.values()].filter((row) => row.field.free && row.field.low !== null && slopeOf(row.field.path) !== null);
  const slopes = free.map((row) => slopeOf(row.field.path)), size = Math.hypot(...slopes);
  if (!size) { say("There is no arrow to follow: mark numbers as free, or wait for the slopes."); return; }
  const most = Math.max(...slopes.map(Math.abs)) / size;
  const length = Math.min(present() / 6 / size, 6 / most); // in hundredths of a slider
  const set = {}, waves = [];
  free.forEach((row, k) => {
    const { field } = row, to = row.at() - (slopes[k] / size) * length * 0.01 * (field.high - field.low);
    const inside = Math.min(field.high, Math.max(field.low, to));
    if (field.kind === "mode") { waves.push([field.mode.kind, field.mode.number, inside]); return; }
    const unit = field.units[0], by = step(fromSi(field.high, unit) - fromSi(field.low, unit)) / 10;
    set[field.path] = `${written(rounded(fromSi(inside, unit), by))}${unit[0] ? ` ${unit[0]}` : ""}`;
  });
  ask("commit", { set, ...(waves.length ? { grip: { kind: "waves", waves, keep: known.keep ?? true } } : {}), label: "a step along the arrows" });
}

export function makeFields() {
  const place = byId("fields"), search = byId("search"), onlyFree = byId("only-free");
  on("described", ({ other }) => {
    const { model } = known;
    const all = [...model.fields.filter((each) => each.group === "Valve plate"), ...modeFields(model), ...model.fields.filter((each) => each.group !== "Valve plate")];
    const same = !other && all.length === rows.size && all.every((each) => rows.get(each.path)?.field.kind === each.kind);
    if (same) for (const each of all) rows.get(each.path).update(each);
    else build(place, all);
    for (const [path, [text, sentence]] of Object.entries(model.typed)) rows.get(path)?.refuse(text, sentence);
    filter();
  });
  on("refused", (message) => {
    for (const path of Object.keys(message.of.set)) rows.get(path)?.refuse(message.of.set[path], message.sentence);
  });
  on("frame", (message) => {
    for (const [path, value] of Object.entries(message.head.set ?? {})) rows.get(path)?.follow(value);
  });
  on("slopes", () => { for (const row of rows.values()) row.arrow(); });
  on("aimed", () => { for (const row of rows.values()) row.arrow(); });
  byId("follow").addEventListener("click", stepAlong);
  search.addEventListener("input", filter);
  onlyFree.addEventListener("change", filter);

  function filter() {
    place.classList.toggle("only-free", onlyFree.checked);
    const words = search.value.toLowerCase().split(/\s+/).filter(Boolean);
    for (const group of place.children) {
      let shown = 0;
      for (const element of group.querySelectorAll(".row")) {
        const row = rows.get(element.dataset.path);
        const text = `${row.field.path} ${row.field.label} ${row.field.meaning} ${row.field.group}`.toLowerCase().replaceAll("_", " ");
        const fits = words.every((word) => text.includes(word.replaceAll("_", " "))) && (!onlyFree.checked || row.field.free);
        element.hidden = !fits;
        shown += fits;
      }
      group.hidden = shown === 0;
      if (words.length || onlyFree.checked) group.open = true;
      else group.open = OPEN.has(group.dataset.group);
      group.querySelector(".count").textContent = words.length || onlyFree.checked ? `${shown}` : "";
    }
  }
}

function build(place, fields) {
  rows.clear();
  const groups = new Map();
  for (const field of fields) {
    if (!groups.has(field.group)) {
      groups.set(field.group, make("details", { class: "group", "data-group": field.group, open: OPEN.has(field.group) },
        make("summary", {}, field.group, make("span", { class: "count" }))));
      groups.get(field.group).addEventListener("toggle", (event) => {
        if (byId("search").value || byId("only-free").checked) return;
        if (event.target.open) OPEN.add(field.group); else OPEN.delete(field.group);
      });
    }
    const row = makeRow(field);
    rows.set(field.path, row);
    groups.get(field.group).append(row.element);
  }
  place.replaceChildren(...groups.values());
}

/** Smooth modes of the cam, with sliders like numbers of the file. */
function modeFields(model) {
  const unit = [["mm", 1e-3, 0], ["um", 1e-6, 0]];
  const alike = model.cam.mirror && model.cam.symmetric; // then sines are none of its waves
  return model.cam.modes.filter((mode) => mode.kind === "cos" || !alike).map((mode) => ({
    path: mode.path, group: "Cam shape", label: `${mode.kind === "cos" ? "Cosine" : "Sine"} wave ${mode.number}`,
    meaning: `amplitude of the ${mode.number}-fold wave of a lobe in the control values, ${mode.kind === "cos" ? "alike" : "unlike"} on both sides of a dead centre`,
    example: "", kind: "mode", value: mode.value, written: true, units: unit, words: [],
    low: mode.value - mode.reach, high: mode.value + mode.reach, free: mode.free ? ["", ""] : null, can_be_free: false, mode,
  }));
}

function makeRow(first) {
  let field = first, at = null, dirty = false;
  let moving = false, byKeys = false, timer = 0, asked = 0; // what the hand does to it, and under which number it asked last
  const id = `f-${first.path}`;
  const name = make("label", { class: "name", for: id });
  const fault = make("div", { class: "fault", role: "alert", "data-testid": `fault-${first.path}` });
  const free = make("button", { type: "button", class: "free", onclick: toggleFree, "data-testid": `free-${first.path}` });
  const element = make("div", { class: "row", "data-path": first.path });
  const top = make("div", { class: "top" }, free, name);
  element.append(top);
  let input = null, units = null, slider = null, arrow = null, bounds = null;
  const number = first.kind === "number" || first.kind === "mode";

  if (first.kind === "word" || first.kind === "switch") {
    const words = first.kind === "switch" ? ["false", "true"] : first.words;
    input = make("select", { id, class: "wide", "data-testid": `field-${first.path}`, onchange: () => commit(input.value) });
    input.append(...["", ...words].map((word) => make("option", { value: word, text: word || "not given" })));
    top.append(input);
  } else {
    input = make("input", { id, type: "text", autocomplete: "off", spellcheck: "false", "data-testid": `field-${first.path}`, class: number ? "" : "wide" });
    input.addEventListener("input", () => { dirty = true; });
    input.addEventListener("change", () => typedIn());
    input.addEventListener("keydown", keyed);
    input.addEventListener("blur", rest);
    top.append(input);
    if (number) {
      units = make("select", { class: "unit", "aria-label": `Unit of ${first.label}`, onchange: () => { chosenUnits[first.path] = units.value; localStorage.setItem(UNITS_KEY, JSON.stringify(chosenUnits)); show(at); ranged(); } });
      top.append(units);
      slider = make("input", { type: "range", "data-testid": `slider-${first.path}`, "aria-label": first.label });
      slider.addEventListener("input", (event) => slid(event));
      slider.addEventListener("change", () => letGo());
      slider.addEventListener("blur", rest);
      slider.addEventListener("pointerdown", () => { byKeys = false; });
      slider.addEventListener("keydown", (event) => {
        byKeys = true;
        if (event.ctrlKey || event.metaKey || event.altKey) rest(); // undo must find it kept
        if (event.key === "Enter") { event.preventDefault(); followArrow(); }
      });
      arrow = make("button", { type: "button", class: "arrow", tabindex: "-1", "data-testid": `arrow-${first.path}`, onclick: followArrow });
      element.append(make("div", { class: "slide" }, slider, arrow));
    }
  }
  element.append(fault);

  const unit = () => field.units.find((each) => each[0] === chosenUnits[field.path]) ?? field.units[0];
  /** What stands half typed in it is nobody's to change, whatever comes from the server. */
  const typing = () => dirty && document.activeElement === input;
  /** What the hand has set stands until the server's words hold it: an older answer takes nothing back. */
  const mine = () => moving || !isAcknowledged(asked);
  const ends = () => [fromSi(field.low, unit()), fromSi(field.high, unit())];

  function update(next) {
    field = next;
    row.field = next;
    name.textContent = field.label;
    name.title = `${field.path}\n${field.meaning}`;
    input.setAttribute("aria-description", field.meaning);
    element.classList.toggle("absent", !field.written);
    if (!typing() && !mine()) {
      element.classList.remove("wrong");
      fault.textContent = "";
    }
    const canBeFree = field.can_be_free || field.kind === "mode" && field.free;
    free.disabled = !canBeFree;
    free.textContent = field.free ? "◆" : "◇";
    free.setAttribute("aria-pressed", String(Boolean(field.free)));
    free.title = field.kind === "mode" ? "A search may change this wave ([design_space.cam])" : field.free ? "A search may change this number: hold it" : "Held: let a search change this number";
    free.setAttribute("aria-label", `${field.label}: ${field.free ? "free for a search" : "held"}`);
    if (number) {
      units.replaceChildren(...field.units.map((each) => make("option", { value: each[0], text: each[0] || "–", selected: each === unit() })));
      units.disabled = field.units.length < 2;
      slider.parentElement.hidden = field.low === null;
      ranged();
      if (!mine()) show(field.value);
      if (document.activeElement !== input || field.value !== null) input.placeholder = field.written ? "" : field.example.replaceAll('"', "").split(" ")[0];
      showBounds();
      row.arrow();
    } else if (!mine() && (document.activeElement !== input || input.tagName === "SELECT")) {
      input.value = field.value === null || field.value === undefined ? "" : String(field.value);
      input.placeholder = field.example.replaceAll('"', "");
    }
  }

  function ranged() {
    if (field.low === null) return;
    const [low, high] = ends();
    const by = step(high - low);
    slider.min = low; slider.max = high; slider.step = by;
    if (at !== null) slider.value = fromSi(at, unit());
    slider.setAttribute("aria-valuetext", `${input.value} ${unit()[0]}`);
  }

  function show(value) {
    at = value;
    if (typing()) { if (slider && value !== null) slider.value = fromSi(value, unit()); return; }
    if (value === null || value === undefined) { input.value = ""; return; }
    const shown = fromSi(value, unit());
    input.value = written(field.kind === "mode" ? rounded(shown, 1e-4) : Number(shown.toPrecision(6)));
    if (slider) slider.value = shown;
  }

  function slid(event) {
    const by = step(slider.max - slider.min);
    const value = rounded(Number(slider.value), by);
    input.value = written(value);
    at = toSi(value, unit());
    moving = known.held = true;
    clearTimeout(timer);
    if (field.kind === "mode") move({ grip: grip() }, event.timeStamp);
    else move({ set: { [field.path]: at } }, event.timeStamp);
  }

  function letGo() {
    known.held = false;
    slider.setAttribute("aria-valuetext", `${input.value} ${unit()[0]}`);
    if (byKeys) soon(); else rest();
  }

  /** Presses that follow each other are one step. */
  function soon() {
    clearTimeout(timer);
    timer = setTimeout(rest, REST);
  }

  /** What was moved is kept. */
  function rest() {
    clearTimeout(timer);
    if (moving) commit(input.value);
  }

  const grip = () => ({ kind: field.mode.kind, number: field.mode.number, to: at, keep: known.keep ?? true });

  function typedIn() { commit(input.value); }

  function commit(text) {
    dirty = moving = false;
    text = ["text", "list"].includes(field.kind) ? text.trim() : typed(text); // a comma parts a list
    if (field.kind === "mode") {
      const value = Number(text);
      if (!Number.isFinite(value) || text === "") { refuse(text, `${field.label} is "${text}" but must be a number; give it in ${unit()[0]}.`); return; }
      at = toSi(value, unit());
      asked = ask("commit", { grip: grip(), label: field.label });
      return;
    }
    const bare = number && text !== "" && !Number.isNaN(Number(text));
    const whole = bare && unit()[0] ? `${text} ${unit()[0]}` : text;
    asked = ask("commit", { set: { [field.path]: whole }, label: field.label });
  }

  function keyed(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) { rest(); return; }
    if (event.key === "Escape") { dirty = false; show(field.value); fault.textContent = ""; element.classList.remove("wrong"); return; }
    if (!number || field.low === null || !["ArrowUp", "ArrowDown"].includes(event.key)) return;
    event.preventDefault();
    const [low, high] = ends();
    const by = step(high - low) * (event.shiftKey ? 10 : 1);
    const there = Number(typed(input.value) || NaN), from = Number.isNaN(there) ? fromSi(at, unit()) : there; // "28 deg", say
    dirty = false;
    const value = rounded(from + (event.key === "ArrowUp" ? by : -by), step(high - low));
    input.value = written(value);
    at = toSi(value, unit());
    moving = true;
    move(field.kind === "mode" ? { grip: grip() } : { set: { [field.path]: at } }, event.timeStamp);
    soon();
  }

  function refuse(text, sentence) {
    element.classList.add("wrong");
    fault.textContent = sentence;
    if (text !== undefined && input.tagName === "INPUT" && !typing()) input.value = text.replace(new RegExp(`\\s*${unit()?.[0]?.replace(/[.*+?^${}()|[\]\\/]/g, "\\$&") ?? ""}$`), "");
  }

  function toggleFree() {
    if (field.kind === "mode") return;
    if (field.free) { ask("free", { path: field.path, bounds: null }); return; }
    const [low, high] = ends(), by = step(high - low), name = unit()[0];
    ask("free", { path: field.path, bounds: [low, high].map((each) => `${written(rounded(each, by))}${name ? ` ${name}` : ""}`) });
  }

  function showBounds() {
    bounds?.remove();
    bounds = null;
    if (!field.free || field.kind === "mode") return;
    const inputs = field.free.map((text, k) => make("input", { type: "text", value: text, "aria-label": `${field.label}: ${k ? "highest" : "lowest"} for a search`, "data-testid": `bound-${k}-${field.path}`,
      onchange: () => ask("free", { path: field.path, bounds: inputs.map((each) => typed(each.value)) }) }));
    bounds = make("div", { class: "bounds" }, "free from", inputs[0], "to", inputs[1]);
    element.insertBefore(bounds, fault);
  }

  function followArrow() {
    const found = bestArrow(field.path);
    if (!found || field.low === null) return;
    const [low, high] = ends(), by = step(high - low);
    const value = Math.min(high, Math.max(low, rounded(fromSi(at, unit()) + found.sign * 0.02 * (high - low), by)));
    input.value = written(value);
    at = toSi(value, unit());
    commit(input.value);
  }

  const row = {
    element, field, update, at: () => at,
    refuse(text, sentence) { if (!mine()) refuse(text, sentence); }, // else it is of what has been typed over since
    follow(value) { if (number && !mine() && document.activeElement !== slider && document.activeElement !== input) show(value); },
    arrow() {
      if (!arrow) return;
      const found = bestArrow(field.path);
      arrow.hidden = !found;
      slider.setAttribute("aria-description", found ? found.sentence : "");
      if (!found) { element.classList.remove("lit"); return; }
      const length = 4 + 26 * found.share;
      const [from, to] = found.sign > 0 ? [2, 2 + length] : [32, 32 - length];
      arrow.className = `arrow${found.against ? " against" : ""}`;
      arrow.replaceChildren(
        make("svg", { viewBox: "0 0 34 12", "aria-hidden": "true" },
          make("path", { d: `M${from} 6H${to}M${to - 4 * found.sign} 2.5L${to} 6L${to - 4 * found.sign} 9.5${found.against ? `M${to} 0.5V11.5` : ""}`, fill: "none", stroke: "currentColor", "stroke-width": "1.6" })),
        make("span", { text: found.words }));
      arrow.title = found.sentence;
      arrow.setAttribute("aria-label", found.sentence);
      element.classList.toggle("lit", found.lit);
    },
  };
  update(first);
  return row;
}
