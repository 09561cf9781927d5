// The strip of five results, the operating points, and where the power goes.

import { byId, make } from "./dom.js";
import { ask } from "./link.js";
import { percent, shown, significant } from "./numbers.js";
import { known, on, result, tell, tightest } from "./store.js";

const FIGURES = [
  ["ripple", "torque_ripple"], ["efficiency", "efficiency"],
  ["stress", "max_contact_stress"], ["displacement", "displacement"],
];
const NAMES = { ripple: "Torque ripple", efficiency: "Efficiency", stress: "Contact stress", displacement: "Displacement" };

export function makeHeadline() {
  const strip = byId("headline"), power = byId("power");
  const figures = new Map();

  function figure(name, label, tag = "div") {
    const value = make("div", { class: "value", "data-testid": `headline-${name}` });
    const was = make("div", { class: "was", "data-testid": `headline-${name}-was` });
    const element = make(tag, { class: "figure", ...(tag === "button" ? { type: "button" } : {}) }, make("div", { class: "name", text: label }), value, was);
    figures.set(name, { element, value, was });
    return element;
  }

  const points = make("fieldset", { class: "figure points", style: "border-width:1px;margin:0" });
  const limit = figure("limit", "Tightest limit", "button");
  limit.addEventListener("click", () => tell("show limit", tightest(known.now)?.name));
  limit.title = "Lights the numbers that widen the margin to this limit";
  strip.replaceChildren(...FIGURES.map(([name]) => figure(name, NAMES[name])), limit, points);

  on("described", () => {
    const { model } = known;
    points.replaceChildren(
      make("legend", { class: "name quiet", text: model.points.length > 1 ? "Operating point shown" : "Operating point", style: "padding:0;float:left" }),
      ...model.points.map((point, k) => make("label", {},
        make("input", { type: "radio", name: "point", checked: k === model.point, "data-testid": `point-${k}`, onchange: () => ask("view", { point: k }) }),
        make("span", { text: point.text }))));
  });

  const keys = make("div", { class: "keys" }), bar = make("div", { class: "strip", "data-testid": "plot-power", role: "img" });
  power.replaceChildren(bar, keys);

  function draw() {
    const { now, before, model } = known;
    for (const [name, metric] of FIGURES) {
      const quantity = model.quantities[metric], figure = figures.get(name);
      const value = result(now, metric);
      put(figure.value, shown(quantity, value), quantity.unit);
      const words = before ? was(quantity, result(before, metric), value) : [];
      const key = words.map((each) => each.textContent ?? each).join("");
      if (figure.was.dataset.words !== key) { figure.was.dataset.words = key; figure.was.replaceChildren(...words); }
    }
    const worst = tightest(now), figure = figures.get("limit");
    if (worst) {
      const broken = worst.g > 0;
      figure.element.classList.toggle("broken", broken || Boolean(now.head.fault));
      put(figure.value, `${broken ? "−" : ""}${percent(worst.g)}`, `% ${broken ? "over" : "to spare"}`);
      const label = now.head.fault || worst.label;
      if (figure.was.textContent !== label) figure.was.textContent = label;
      figure.was.style.color = "inherit";
    }
    drawPower();
  }

  function drawPower() {
    const { now, model } = known;
    // As in the report: of a brake, leakage down to the case and power between the ports, which balance.
    const drained = result(now, "leakage_loss") < 0;
    const oil = result(now, drained ? "port_power" : "input_power"), shaft = result(now, "output_power");
    const input = Math.max(oil, 0) + Math.max(-shaft, 0), output = Math.max(shaft, 0) + Math.max(-oil, 0);
    const parts = Object.entries(model.losses)
      .map(([name, colour]) => ({ name, colour, value: result(now, drained && name === "leakage_loss" ? "full_leakage_loss" : name) }))
      .filter((each) => Math.abs(each.value) > 1e-9);
    const total = output + parts.reduce((sum, each) => sum + Math.max(each.value, 0), 0);
    const share = (value) => `${Math.max(0, (100 * value) / total)}%`;
    while (bar.children.length < parts.length + 1) bar.append(make("span"));
    while (bar.children.length > parts.length + 1) bar.lastChild.remove();
    bar.children[0].style.cssText = `width:${share(output)};background:var(--now);opacity:.35`;
    parts.forEach((each, k) => { bar.children[k + 1].style.cssText = `width:${share(each.value)};background:${each.colour}`; });
    const kilowatts = (value) => `${significant(value / 1000, 3)} kW`;
    const words = [
      [oil > 0 ? `${kilowatts(oil)} from the oil` : "", shaft < 0 ? `${kilowatts(-shaft)} from the shaft` : ""].filter(Boolean).join(", "),
      oil < 0 ? `${kilowatts(-oil)} into the oil` : `${kilowatts(Math.max(shaft, 0))} at the shaft`,
    ];
    bar.setAttribute("aria-label", `Power balance: ${words.join(", ")}`);
    while (keys.children.length < parts.length + 2) keys.append(make("span", {}, make("i"), make("span")));
    while (keys.children.length > parts.length + 2) keys.lastChild.remove();
    const label = (k, colour, text) => {
      const [icon, word] = keys.children[k].children;
      icon.style.cssText = colour ? `background:${colour}` : "display:none";
      if (word.textContent !== text) word.textContent = text;
    };
    label(0, "", words[0]);
    label(1, "color-mix(in srgb, var(--now) 35%, transparent)", words[1]);
    parts.forEach((each, k) => {
      const name = model.quantities[each.name]?.label.toLowerCase() ?? each.name;
      label(k + 2, each.colour, `${name} ${significant(each.value, 3)} W (${significant((100 * each.value) / input, 2)} %)`);
    });
  }

  function was(quantity, before, now) {
    const text = `was ${shown(quantity, before)}`;
    if (!quantity.better || Math.abs(now - before) <= 1e-4 * Math.abs(before)) return [text];
    const better = Math.sign(now - before) === Math.sign(quantity.better);
    const times = before > 0 && now > 0 && quantity.unit === "%" && before / now >= 1.5 ? ` ÷ ${significant(before / now, 2)}` : "";
    return [text, " ", make("span", { class: better ? "better" : "worse", text: `${better ? "✓ better" : "✗ worse"}${better ? times : ""}` })];
  }

  return { draw };
}

function put(element, number, unit) {
  if (element.dataset.number === number + unit) return;
  element.dataset.number = number + unit;
  element.replaceChildren(number, make("small", { text: unit }));
}
