// The windows of the valve plate on the section's dial: drawn, dragged, and moved by keys.

import { ask, move, standing } from "./link.js";
import { grip, nudged, stepOf } from "./nudge.js";
import { rounded, written } from "./numbers.js";
import { known } from "./store.js";
import { colour } from "./theme.js";

const GRASP = 9; // pixels around a window's edge
const PLATE = "motor.valve_plate.";
const STEPS = [0.05, 0.01, 0.5]; // degrees: of an arrow key, with Shift, of a page key
const FINEST = 0.01; // degrees
const HANDLES = [
  ["shift", "Shift of the valve plate"],
  ["supply_width", "Width of the supply windows"],
  ["return_width", "Width of the return windows"],
];
const DEGREE = Math.PI / 180;

/** `places(width, height)` says where the section's circles lie; `reading` tells what is under the hand. */
export function makeDial(picture, body, places, reading) {
  const { canvas } = picture;
  const hand = standing();
  let hover = null, held = null, focused = null;

  const field = (key) => known.model.fields.find((each) => each.path === PLATE + key);
  const value = (key) => hand.or({})[key] ?? known.now?.head.set?.[PLATE + key] ?? field(key)?.value ?? 0;

  function windows() {
    const { lobes } = known.model.motor, pitch = 2 * Math.PI / lobes;
    return ["supply", "return"].map((side) => ({
      side, centre: value(`${side}_centre`) + value("shift"), width: value(`${side}_width`), pitch, lobes,
    }));
  }

  function go(key, degrees, stamp) {
    reading.textContent = `${key.replace("_", " ")} ${written(degrees)}°`;
    const to = degrees * DEGREE;
    hand.put({ [key]: to }, move({ set: { [PLATE + key]: to } }, stamp));
  }
  function keep(key, degrees) {
    const asked = ask("commit", { set: { [PLATE + key]: `${written(degrees)} deg` }, label: PLATE + key });
    hand.put({ [key]: degrees * DEGREE }, asked);
    return asked;
  }

  const handles = HANDLES.map(([key, label]) => {
    const handle = grip(body, { "data-testid": `dial-${key}`, "aria-label": label });
    nudged(handle.element, {
      from: () => value(key) / DEGREE,
      by: (name, from, fine) => { const step = stepOf(name, fine, STEPS); return step ? rounded(from + step, FINEST) : null; },
      go: (to, stamp) => go(key, to, stamp),
      keep: (to) => keep(key, to),
    });
    handle.element.addEventListener("focus", () => { focused = key; reading.textContent = `${key.replace("_", " ")} ${written(rounded(value(key) / DEGREE, FINEST))}°`; picture.redraw(); });
    handle.element.addEventListener("blur", () => { focused = null; reading.textContent = ""; picture.redraw(); });
    return { key, ...handle };
  });

  /** On the first windows: the plate by their middle, a width by the edge. */
  function placeHandles(place, [supply, back]) {
    const radius = place.dial * place.scale;
    const angles = { shift: supply.centre, supply_width: supply.centre + supply.width / 2, return_width: back.centre + back.width / 2 };
    for (const { key, element, at, says } of handles) {
      const here = field(key);
      element.hidden = !here;
      if (!here) continue;
      at(place.x + radius * Math.cos(angles[key]), place.y - radius * Math.sin(angles[key]));
      const degrees = rounded(value(key) / DEGREE, FINEST);
      const ends = [here.low, here.high].map((each) => (each === null ? degrees : rounded(each / DEGREE, FINEST)));
      says(degrees, `${written(degrees)} degrees`, ...ends);
    }
  }

  function lit(side) {
    if (held ?? hover) return (held ?? hover).side === side;
    return focused === "shift" || focused === `${side}_width`;
  }

  function draw(context, place) {
    const radius = place.dial * place.scale, band = place.band * place.scale, all = windows();
    context.beginPath();
    context.arc(place.x, place.y, radius + band / 2 + 2, 0, 2 * Math.PI);
    context.fillStyle = colour("paper");
    context.fill();
    context.strokeStyle = colour("line");
    context.stroke();
    const idle = known.model.points[known.model.point].idle;
    for (const each of all) {
      const wide = band * (lit(each.side) ? 1 : 0.78), edge = Math.max(1.2, 0.13 * wide);
      for (let lobe = 0; lobe < each.lobes; lobe += 1) {
        const centre = each.centre + lobe * each.pitch;
        context.beginPath();
        context.arc(place.x, place.y, radius, -(centre + each.width / 2), -(centre - each.width / 2));
        context.lineWidth = wide;
        const side = idle.includes(lobe) ? "return" : each.side; // a valve leads the windows of idle lobes there
        context.strokeStyle = colour(side);
        context.stroke();
        if (side !== "return") continue;
        // Hollow, so that the two kinds differ for every eye.
        const inset = Math.min(edge / radius, 0.45 * each.width);
        context.beginPath();
        context.arc(place.x, place.y, radius, -(centre + each.width / 2 - inset), -(centre - each.width / 2 + inset));
        context.lineWidth = wide - 2 * edge;
        context.strokeStyle = colour("paper");
        context.stroke();
      }
    }
    legend(context, place, radius);
    placeHandles(place, all);
  }

  function legend(context, place, radius) {
    if (radius <= 45) return;
    const size = Math.max(9, 0.11 * radius);
    context.font = `${size}px system-ui, sans-serif`;
    context.textAlign = "center";
    context.fillStyle = colour("supply");
    context.fillText("■ supply", place.x, place.y - 4);
    context.fillStyle = colour("return");
    context.fillText("□ return", place.x, place.y + size);
  }

  const angleAt = (event, place) => {
    const box = canvas.getBoundingClientRect();
    const dx = event.clientX - box.left - place.x, dy = place.y - (event.clientY - box.top);
    return [Math.atan2(dy, dx), Math.hypot(dx, dy)];
  };

  /** Which window, and which part of it, lies under a place of the canvas. */
  function under(event) {
    if (!known.now?.arrays.radius) return null;
    const place = places(...picture.size()), [at, radius] = angleAt(event, place), dial = place.dial * place.scale;
    if (Math.abs(radius - dial) > place.band * place.scale * 0.8) return null;
    for (const each of windows()) {
      const off = at - each.centre, lobe = Math.round(off / each.pitch), from = off - lobe * each.pitch;
      const edge = Math.abs(Math.abs(from) - each.width / 2) * radius;
      if (edge < GRASP) return { part: "edge", side: each.side, way: Math.sign(from), at };
      if (Math.abs(from) < each.width / 2) return { part: "plate", side: each.side, at };
    }
    return null;
  }

  canvas.addEventListener("pointermove", (event) => {
    if (held) { drag(event); return; }
    hover = under(event);
    canvas.style.cursor = hover ? (hover.part === "edge" ? "col-resize" : "grab") : "";
    reading.textContent = hover ? (hover.part === "edge" ? `width of the ${hover.side} windows` : "shift of the whole plate") : "";
  });
  canvas.addEventListener("pointerdown", (event) => {
    const found = under(event);
    if (!found) return;
    event.preventDefault();
    canvas.setPointerCapture(event.pointerId);
    held = { ...found, shift: value("shift"), width: value(`${found.side}_width`) };
    known.held = true;
  });
  function drag(event) {
    const by = angleAt(event, places(...picture.size()))[0] - held.at;
    const turned = Math.atan2(Math.sin(by), Math.cos(by)) * (event.shiftKey ? 0.1 : 1);
    held.key = held.part === "edge" ? `${held.side}_width` : "shift";
    held.to = rounded((held.part === "edge" ? held.width + 2 * held.way * turned : held.shift + turned) / DEGREE, FINEST);
    go(held.key, held.to, event.timeStamp);
  }
  const release = () => {
    if (!held) return;
    known.held = false;
    if (held.key) keep(held.key, held.to);
    held = null;
  };
  canvas.addEventListener("pointerup", release);
  canvas.addEventListener("lostpointercapture", release);

  return { draw };
}
