// Which way a slider or a handle improves what is aimed at, and by how much: from exact slopes.

import { byId, make } from "./dom.js";
import { significant } from "./numbers.js";
import { known, on, result, tell, tightest } from "./store.js";

let aim = "torque_ripple";
let strongest = 0;
const NEAR = 0.02;

on("described", () => {
  const select = byId("aim"), { model } = known;
  const results = model.sloped.filter((name) => model.quantities[name]?.better);
  const options = [
    ...results.map((name) => [name, `${model.quantities[name].better < 0 ? "less" : "more"} ${model.quantities[name].label.toLowerCase().replace(", one-sided", "")}`]),
    ...model.limits.map((limit) => [`limit:${limit.name}`, `margin of: ${limit.label}`]),
  ];
  if (!options.some(([value]) => value === aim)) aim = "torque_ripple";
  select.replaceChildren(...options.map(([value, text]) => make("option", { value, text, selected: value === aim })));
  select.value = aim;
  select.onchange = () => { aim = select.value; weigh(); tell("aimed"); };
});
on("aim", (name) => { aim = name; byId("aim").value = name; weigh(); tell("aimed"); });
on("slopes", weigh);

/** The change of what is aimed at for one step of each direction; less is better. */
function slopes() {
  const { arrows, model } = known;
  if (!arrows) return null;
  const count = arrows.head.paths.length;
  if (aim.startsWith("limit:")) {
    const row = arrows.head.limits.indexOf(aim.slice(6));
    return row < 0 ? null : arrows.arrays.slopes.subarray(row * count, (row + 1) * count);
  }
  const row = model.sloped.indexOf(aim), better = model.quantities[aim].better;
  return arrows.arrays.results.subarray(row * count, (row + 1) * count).map((each) => (better < 0 ? each : -each));
}

let found = null;
function weigh() {
  found = slopes();
  strongest = 0;
  if (!found) return;
  found.forEach((each, k) => { if (!known.arrows.head.paths[k].startsWith("cam-handle")) strongest = Math.max(strongest, Math.abs(each)); });
}

/** How much of what is aimed at there is now, in the unit of its slopes. */
export function present() {
  if (aimedAtLimit()) return 0.1;
  const value = Math.abs(result(known.now, aim));
  return known.model.quantities[aim].better < 0 ? value : 0.1 * value;
}

export const aimedAtLimit = () => aim.startsWith("limit:");

/** The slope along one direction, for one step; null where none is known. */
export function slopeOf(path) {
  if (!known.arrows || !found) return null;
  const at = known.arrows.head.paths.indexOf(path);
  return at < 0 ? null : found[at];
}

/** The arrow of a slider: its side, length as a share of the longest, and words. */
export function bestArrow(path) {
  const slope = slopeOf(path);
  if (slope === null || !strongest || Math.abs(slope) < 0.01 * strongest) return null;
  const sign = slope > 0 ? -1 : 1, size = Math.abs(slope), { model } = known;
  let words, what;
  if (aimedAtLimit()) {
    words = `${significant(100 * size, 2)} %`;
    what = `gives ${words} more margin to “${model.limits.find((each) => each.name === aim.slice(6))?.label}”`;
  } else {
    const quantity = model.quantities[aim];
    const points = quantity.unit === "%";
    const relative = Math.abs(size / result(known.now, aim));
    words = points ? `${significant(size * quantity.factor, 2)}` : `${significant(100 * relative, 2)} %`;
    what = `${quantity.better < 0 ? "cuts" : "raises"} ${quantity.label.toLowerCase()} by ${points ? `${words} points` : words}`;
  }
  const against = stops(path, sign);
  const sentence = `${model.step} to the ${sign > 0 ? "right" : "left"} ${what}${against ? `, but “${against}” stops it` : ""}. A click, or Enter on the slider: two steps that way.`;
  return { sign, share: Math.sqrt(size / strongest), words, sentence: sentence[0].toUpperCase() + sentence.slice(1), against, lit: aimedAtLimit() && size > 0.3 * strongest };
}

/** The limit that is at hand and would be broken by going that way. */
function stops(path, sign) {
  const { arrows, now, model } = known;
  const at = arrows.head.paths.indexOf(path), count = arrows.head.paths.length;
  if (aimedAtLimit() || tightest(now) === null) return null;
  for (let k = 0; k < model.limits.length; k += 1) {
    const g = now.arrays.limits[k], change = sign * arrows.arrays.slopes[k * count + at];
    if (g > -NEAR && change > 1e-5 && (g > 0 || change > 0.2 * -g)) return model.limits[k].label;
  }
  return null;
}
