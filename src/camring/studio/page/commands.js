// The bar at the top: undo, snapshots, files, downloads, improvement, theme, keys.

import { analyse } from "./analyse.js";
import { byId, make, say } from "./dom.js";
import { ask } from "./link.js";
import { typed } from "./numbers.js";
import { known, on, tell } from "./store.js";
import { setTheme, theme } from "./theme.js";

const button = (text, testid, action, more = {}) => make("button", { type: "button", class: "button", "data-testid": testid, onclick: action, ...more }, text);

let saving = false; // until the server has said that the file is written

export function makeCommands() {
  const undo = button("↶ Undo", "undo", () => ask("undo")), redo = button("↷ Redo", "redo", () => ask("redo"));
  const pin = button("Pin as before", "pin", () => ask("snapshot", { name: "before", pin: true }), { title: "Keeps this design as a snapshot and draws it beneath all that follows (P)" });
  const unpin = button("Unpin", "unpin", () => ask("pin", { name: null }));
  const save = button("Save", "save", () => saveNow());
  const themeChoice = make("select", { class: "button", "aria-label": "Light or dark", "data-testid": "theme", onchange: (event) => setTheme(event.target.value) },
    ...["auto", "light", "dark"].map((each) => make("option", { value: each, text: each, selected: each === theme() })));
  const warned = button("", "warnings", () => dialog("Warnings", make("ul", {}, ...known.model.warnings.map((each) => make("li", { text: each }))), closing()), { title: "What is odd about this motor" });
  byId("file").after(warned);
  byId("commands").append(
    undo, redo, pin, unpin,
    button("Snapshots", "snapshots", snapshots), button("Motor…", "files", files), save, button("Export", "export", downloads),
    button("Improve this", "improve", improve, { class: "button primary" }), button("Analyse…", "analyse", analyse), themeChoice, button("?", "keys", keys, { "aria-label": "Keys and help", class: "button plain" }));

  on("described", () => {
    const { model } = known;
    document.querySelector(".bar h1").textContent = model.title;
    document.title = `${model.unsaved ? "• " : ""}${model.title} – camring studio`;
    byId("file").textContent = `${model.file}${model.unsaved ? (model.on_disk ? " · changed" : " · not saved yet") : ""}`;
    warned.hidden = model.warnings.length === 0;
    warned.textContent = `⚠ ${model.warnings.length}`;
    warned.setAttribute("aria-label", `Warnings: ${model.warnings.length}`);
    undo.disabled = model.undo === null;
    undo.title = model.undo ? `Takes back: ${model.undo} (Ctrl+Z)` : "";
    redo.disabled = model.redo === null;
    redo.title = model.redo ? `Does again: ${model.redo} (Ctrl+Shift+Z)` : "";
    unpin.hidden = model.pinned === null;
    pin.hidden = model.pinned !== null;
    save.disabled = !model.unsaved;
  });
  on("comparison", comparison);
  on("described", () => {
    if (saving && !known.model.unsaved) say(`Saved ${known.model.file}; comments and order are as they were.`);
    if (!known.model.unsaved) saving = false;
  });
  on("error", () => { saving = false; });

  document.addEventListener("keydown", (event) => {
    const typing = ["INPUT", "SELECT", "TEXTAREA"].includes(event.target.tagName) && event.target.type !== "range" && event.target.type !== "checkbox";
    const key = event.key.toLowerCase(), command = event.ctrlKey || event.metaKey;
    if (command && key === "s") { event.preventDefault(); saveNow(); return; }
    if (typing || document.querySelector("dialog[open]")) return;
    if (command && key === "z") { event.preventDefault(); ask(event.shiftKey ? "redo" : "undo"); }
    else if (command && key === "y") { event.preventDefault(); ask("redo"); }
    else if (command || event.altKey) return;
    else if (event.key === "/") { event.preventDefault(); byId("search").focus(); }
    else if (key === "p") { if (known.model?.pinned) ask("pin", { name: null }); else ask("snapshot", { name: "before", pin: true }); }
    else if (key === "i") improve();
    else if (key === "a") analyse();
    else if (event.key === "?") keys();
    else if (key === " " && event.target === document.body) { event.preventDefault(); tell("toggle turning"); }
  });
}

export function dialog(title, ...content) {
  const element = make("dialog", { "aria-label": title }, make("h2", { text: title }), ...content);
  element.addEventListener("close", () => element.remove());
  document.body.append(element);
  element.showModal();
  return element;
}

const closing = (text = "Close") => make("div", { class: "buttons" }, button(text, "close", (event) => event.target.closest("dialog").close()));

function saveNow() {
  const { model } = known;
  if (model.on_disk) { saving = true; ask("save", { replace: true }); return; }
  saveAs();
}

function saveAs() {
  const name = make("input", { type: "text", value: known.model.file, "data-testid": "save-name" });
  const over = make("input", { type: "checkbox" });
  const box = dialog("Save as a motor file", make("form", { onsubmit: (event) => {
    event.preventDefault();
    saving = true;
    ask("save", { name: name.value, replace: over.checked });
    box.close();
  } }, make("label", { class: "line" }, "Name in this folder", name), make("label", {}, over, " replace a file of that name"),
  make("div", { class: "buttons" }, button("Cancel", "cancel", () => box.close()), make("button", { class: "button primary", type: "submit", "data-testid": "save-as", text: "Save" }))));
}

function files() {
  const { choices } = known;
  const pick = (op, words) => { ask(op, words); box.close(); };
  const list = (names, op, empty) => names.length
    ? make("div", { class: "list" }, ...names.map((name) => button(name, `${op}-${name}`, () => pick(op, { name }))))
    : make("p", { class: "quiet", text: empty });
  const demand = ["displacement", "pressure", "speed", "outer_diameter", "counts"];
  const hints = { displacement: "2.5 L/rev", pressure: "250 bar", speed: "100 rpm", outer_diameter: "500 mm, may stay empty", counts: "10x8, may stay empty" };
  const inputs = Object.fromEntries(demand.map((each) => [each, make("input", { type: "text", placeholder: hints[each], "data-testid": `demand-${each}` })]));
  const box = dialog("Motor files",
    make("p", { class: "quiet", text: choices.folder }),
    make("h3", { text: "Open" }), list(choices.motors, "open", "No motor file lies in this folder yet."),
    make("h3", { text: "Studies" }), list(choices.studies, "study", "No study lies in this folder yet."),
    make("h3", { text: "Begin from the library" }),
    make("div", { class: "list" }, ...choices.library.map((each) => button("", `like-${each.name}`, () => pick("begin", { like: each.name })))),
    make("h3", { text: "Begin from a line of a catalogue" }),
    make("form", { onsubmit: (event) => { event.preventDefault(); pick("begin", Object.fromEntries(demand.map((each) => [each, typed(inputs[each].value)]))); } },
      ...demand.map((each) => make("label", { class: "line" }, each.replace("_", " "), inputs[each])),
      make("div", { class: "buttons" }, make("button", { class: "button", type: "submit", "data-testid": "begin", text: "Begin" }))),
    make("div", { class: "buttons" }, button("Save as…", "open-save-as", () => { box.close(); saveAs(); }), button("Close", "close", () => box.close())));
  box.querySelectorAll('[data-testid^="like-"]').forEach((element, k) => element.append(choices.library[k].name, make("small", { text: choices.library[k].class })));
}

function snapshots() {
  const { model } = known;
  const name = make("input", { type: "text", placeholder: "a name for this design", "data-testid": "snapshot-name" });
  const again = () => { box.close(); };
  const one = (each) => make("tr", {},
    make("td", {}, each, model.pinned === each ? " (pinned)" : ""),
    make("td", {}, button("Into the hand", `restore-${each}`, () => { ask("restore", { name: each }); again(); })),
    make("td", {}, button(model.pinned === each ? "Unpin" : "Pin", `pin-${each}`, () => { ask("pin", { name: model.pinned === each ? null : each }); again(); })),
    make("td", {}, button("Forget", `forget-${each}`, () => { ask("forget", { name: each }); again(); })));
  const names = ["now", ...model.snapshots];
  const choose = (chosen, testid) => make("select", { "data-testid": testid }, ...names.map((each) => make("option", { value: each, text: each, selected: each === chosen })));
  const first = choose(model.pinned ?? model.snapshots[0], "compare-first"), second = choose("now", "compare-second");
  const box = dialog("Snapshots",
    make("form", { onsubmit: (event) => { event.preventDefault(); ask("snapshot", { name: name.value || "snapshot" }); again(); } },
      make("div", { class: "command" }, name, make("button", { class: "button primary", type: "submit", "data-testid": "take-snapshot", text: "Keep this design" }))),
    model.snapshots.length ? make("table", { style: "margin-top:.8rem" }, ...model.snapshots.map(one)) : make("p", { class: "quiet", text: "None yet." }),
    make("h3", { text: "Compare two" }),
    make("div", { class: "command" }, first, "with", second, button("Compare", "compare", () => { ask("compare", { first: first.value, second: second.value }); again(); }, { disabled: names.length < 2 })),
    closing());
  name.focus();
}

function comparison(message) {
  const [first, second] = message.names;
  const content = message.points.map((point) => make("div", {},
    make("h3", { text: point.text }),
    make("table", { "data-testid": "comparison" },
      make("tr", {}, make("th", { text: "Result" }), make("th", { text: first }), make("th", { text: second }), make("th", { text: "Change" })),
      ...point.groups.flatMap((group) => group.rows.map(([label, unit, a, b, change, better]) => make("tr", {},
        make("td", {}, label, make("span", { class: "quiet", text: unit ? ` ${unit}` : "" })), make("td", { text: a }), make("td", { text: b }),
        make("td", { class: better > 0 ? "better" : better < 0 ? "worse" : "", text: `${better > 0 ? "✓ " : better < 0 ? "✗ " : ""}${change}` })))))));
  const box = dialog(`${first} and ${second}`, ...content, closing());
  box.querySelector("button").focus();
  box.scrollTop = 0;
}

function downloads() {
  const box = dialog("Export",
    make("p", { class: "quiet", text: "Each is made from the design in the hand, as `camring export` makes it." }),
    make("div", { class: "list", style: "margin-top:.6rem" }, ...known.choices.downloads.map((each) => button(each.words, `download-${each.name}`, () => download(each.name)))),
    closing());
  async function download(name) {
    say("Being made …", 60);
    const answer = await fetch(`download/${name}`);
    if (!answer.ok) { say(await answer.text(), 12); return; }
    const file = /filename\*=UTF-8''(.+)$/.exec(answer.headers.get("content-disposition") ?? "");
    const link = make("a", { href: URL.createObjectURL(await answer.blob()), download: file ? decodeURIComponent(file[1]) : name });
    link.click();
    URL.revokeObjectURL(link.href);
    say(`${link.download} is among your downloads.`);
    box.close();
  }
}

function improve() {
  const { model } = known;
  const free = model.fields.filter((each) => each.free).map((each) => each.label), modes = model.cam.free.length;
  const budget = make("input", { type: "number", min: "1", value: String(model.budget), "data-testid": "budget" });
  const line = make("code", { "data-testid": "command-line" });
  const copy = button("Copy", "copy", async () => { await navigator.clipboard.writeText(line.textContent); say("Copied."); });
  const tellLine = () => ask("command", { budget: Number(budget.value) });
  budget.addEventListener("input", tellLine);
  const heard = (message) => { line.textContent = message.line; };
  on("command", heard);
  const box = dialog("Improve this",
    make("p", { text: free.length + modes ? `A search changes what is marked ◆: ${[...free, ...(modes ? [`${modes} waves of the cam`] : [])].join(", ")}.` : "Nothing is marked as free yet. Mark numbers with ◇ on the left; then a search may change them." }),
    model.evaluator ? make("p", { style: "color:var(--limit)", text: "This file names an evaluator of its own. The studio runs none: use the command line below with --allow-evaluator." }) : null,
    make("form", { style: "margin-top:.7rem", onsubmit: (event) => { event.preventDefault(); ask("improve", { budget: Number(budget.value) }); box.close(); } },
      make("label", { class: "line" }, "Evaluations", budget),
      make("div", {}, make("p", { class: "quiet", text: "The same at a terminal:" }), make("div", { class: "command" }, line, copy),
        model.unsaved ? make("p", { class: "quiet", text: "Save first: the command reads the file." }) : null),
      make("div", { class: "buttons" }, button("Cancel", "cancel", () => box.close()),
        make("button", { class: "button primary", type: "submit", "data-testid": "begin-search", text: "Begin", disabled: !model.searchable || model.evaluator }))));
  tellLine();
  box.querySelector(".primary").focus();
}

function keys() {
  const rows = [
    ["/", "search the numbers"], ["Ctrl+Z, Ctrl+Shift+Z", "undo, redo"], ["Ctrl+S", "save"], ["P", "pin this design as before, or unpin"], ["I", "improve this"], ["A", "compromises, tolerances"], ["← → and Enter in the picture of a study", "choose a design and take it"], ["Space", "turn or stop"],
    ["↑ ↓ in a number", "a small step; with Shift ten of them"], ["← → on a slider", "a small step"], ["Enter on a slider", "two steps along its arrow"], ["↑ ↓ on a handle of the cam", "20 µm; with Shift 1 µm; Page keys 200 µm"], ["← → on a handle", "the next handle"],
    ["↑ ↓ on a window of the dial", "0.05°; with Shift 0.01°; Page keys 0.5°"], ["← → ↑ ↓ on an operating point of the envelope", "its speed, its pressure (5 bar; with Shift 1 bar); Enter shows it"],
    ["arrow keys on the envelope or a curve", "read it; with Shift finer; Esc ends that"],
    ["Shift while dragging", "ten times finer"], ["Esc in a number", "back to what counts"],
  ];
  dialog("Keys",
    make("table", {}, ...rows.map(([key, words]) => make("tr", {}, make("td", {}, make("kbd", { text: key })), make("td", { style: "text-align:left", text: words })))),
    make("p", { style: "margin-top:.8rem;max-width:36rem", text: "Blue is the design in the hand, dashed orange what it is held against. Every arrow beside a slider comes from exact slopes: which way improves what is chosen above, and by how much for a hundredth of the slider; a red one is stopped by a limit." }),
    closing());
}
