// The dialog that begins a front of compromises, or a study of tolerances.

import { dialog } from "./commands.js";
import { make } from "./dom.js";
import { ask } from "./link.js";
import { known, on } from "./store.js";

const TRADED = ["torque_ripple", "efficiency", "max_contact_stress", "pressure_ripple", "flow_ripple", "displacement", "max_pressure", "mean_torque"];

export function analyse() {
  const { model } = known, label = (name) => model.quantities[name]?.label ?? name.replaceAll("_", " ");
  const choose = (chosen, testid) => make("select", { "data-testid": testid, onchange: () => tellLine() }, ...TRADED.map((name) => make("option", { value: name, text: label(name), selected: name === chosen })));
  const first = choose("torque_ripple", "trade-first"), second = choose("efficiency", "trade-second");
  const points = make("input", { type: "number", min: "3", max: "200", value: "20", "data-testid": "front-points" });
  const samples = make("input", { type: "number", min: "16", value: "1024", "data-testid": "tolerance-samples" });
  const kinds = ["pareto", "tolerance"].map((kind, k) => make("input", { type: "radio", name: "kind", value: kind, checked: k === 0, "data-testid": `kind-${kind}`, onchange: () => tellLine() }));
  const line = make("code", { "data-testid": "analysis-line" });
  for (const each of [points, samples]) each.addEventListener("input", () => tellLine());
  const kind = () => kinds.find((each) => each.checked).value;
  const words = () => (kind() === "pareto" ? { kind: "pareto", of: `${first.value},${second.value}`, count: Number(points.value) } : { kind: "tolerance", count: Number(samples.value) });
  const tellLine = () => ask("analyse", { ...words(), ask: true });
  on("command", (message) => { line.textContent = message.line; });
  const begin = make("button", { class: "button primary", type: "submit", "data-testid": "begin-analysis", text: "Begin", disabled: model.evaluator });
  const box = dialog("Analyse this",
    make("form", { onsubmit: (event) => { event.preventDefault(); ask("analyse", words()); box.close(); } },
      make("label", {}, kinds[0], " Compromises: what one result costs in another, every limit kept"),
      make("div", { class: "command", style: "padding-left:1.6rem" }, first, "against", second, make("label", { class: "command" }, "designs", points)),
      make("label", {}, kinds[1], " Tolerances: how results scatter, and which tolerance is to blame ([tolerances] in the file)"),
      make("div", { class: "command", style: "padding-left:1.6rem" }, make("label", { class: "command" }, "motors built", samples)),
      make("p", { class: "quiet", text: "The same at a terminal:" }), make("div", { class: "command" }, line),
      make("div", { class: "buttons" }, make("button", { type: "button", class: "button", onclick: () => box.close(), text: "Cancel" }), begin)));
  tellLine();
  begin.focus();
}
