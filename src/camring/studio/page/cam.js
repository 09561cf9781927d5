// The cam unrolled: its curve, its control values as handles, and what the hand does to them.

import { slopeOf } from "./arrows.js";
import { make, panel } from "./dom.js";
import { ask, move, standing } from "./link.js";
import { nudged, stepOf } from "./nudge.js";
import { nice, significant } from "./numbers.js";
import { known, on } from "./store.js";

const PAD = { left: 46, right: 12, top: 10, bottom: 22 };
const SHOWN_LOBES = 2;
const STEPS = [2e-5, 1e-6, 2e-4]; // metres: of an arrow key, with Shift, of a page key

export function makeCamPanel() {
  const { body, tools, reading, heading } = panel("cam", "Cam: pitch radius over one period");
  const svg = make("svg", { "data-testid": "plot-cam", role: "group", "aria-label": "Cam with its control values as handles" });
  const grid = make("g"), before = make("path", { class: "cam-before" }), curve = make("path", { class: "cam-now" });
  const arrows = make("path", { class: "handle-arrow" }), handles = make("g");
  svg.append(grid, before, curve, arrows, handles);
  body.append(svg);

  const reach = make("input", { type: "range", min: "0", max: "8", step: "1", value: "2", id: "reach", "data-testid": "cam-reach" });
  const reachWords = make("span", { text: "2" });
  const mirror = make("input", { type: "checkbox", "data-testid": "cam-mirror" });
  const keep = make("input", { type: "checkbox", "data-testid": "cam-keep" });
  tools.append(
    make("label", { for: "reach" }, "neighbours "), reach, reachWords,
    make("label", { title: "What is done on one side of a dead centre is done on the other, too" }, mirror, " mirror"),
    make("label", { title: "The cam is scaled until all rises together are what they were" }, keep, " same displacement"));
  reach.addEventListener("input", () => { reachWords.textContent = reach.value; });
  keep.addEventListener("change", () => { known.keep = keep.checked; });

  const hand = standing();
  let circles = [], width = 0, height = 0, scale = null, held = null;
  new ResizeObserver(() => { width = body.clientWidth; height = body.clientHeight; draw(); }).observe(body);

  on("described", ({ first, other }) => {
    const { cam } = known.model;
    if (first || other) { mirror.checked = cam.mirror && cam.symmetric; keep.checked = cam.keep; known.keep = cam.keep; scale = null; }
    if (circles.length !== cam.count) {
      circles = Array.from({ length: cam.count }, (_, k) => handle(k));
      handles.replaceChildren(...circles);
    }
  });
  on("aimed", () => draw());

  function handle(k) {
    const circle = make("circle", { class: "handle", r: "6", tabindex: "0", role: "slider", "data-testid": `cam-handle-${k}`, "aria-orientation": "vertical", "aria-label": `Control value ${k + 1}` });
    circle.addEventListener("pointerdown", (event) => {
      event.preventDefault();
      circle.focus();
      if (!known.now) return;
      circle.setPointerCapture(event.pointerId);
      held = { k, from: event.clientY, start: at(k), to: null };
      circle.classList.add("held");
      known.held = true;
    });
    // Raw updates come before the browser has gathered them for its next picture.
    const kind = "onpointerrawupdate" in window ? "pointerrawupdate" : "pointermove";
    circle.addEventListener(kind, (event) => {
      if (held?.k !== k) return;
      const fine = event.shiftKey ? 0.1 : 1;
      held.to = held.start - fine * (event.clientY - held.from) / scale.y;
      move({ grip: grip(k, held.to) }, event.timeStamp);
    });
    const release = () => {
      if (held?.k !== k) return;
      circle.classList.remove("held");
      known.held = false;
      if (held.to !== null) keepAt(k, held.to);
      held = null;
    };
    circle.addEventListener("pointerup", release);
    circle.addEventListener("lostpointercapture", release);
    circle.addEventListener("keydown", (event) => {
      const way = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (!way) return;
      circles[(k + way + circles.length) % circles.length].focus();
      event.preventDefault();
    });
    nudged(circle, {
      from: () => at(k),
      by: (key, from, fine) => { const step = key === "ArrowLeft" || key === "ArrowRight" ? 0 : stepOf(key, fine, STEPS); return step && from !== undefined ? from + step : null; },
      go: (to, stamp) => move({ grip: grip(k, to) }, stamp),
      keep: (to) => keepAt(k, to),
    });
    circle.addEventListener("focus", () => tellHandle(k));
    return circle;
  }

  const at = (k) => hand.or({})[k] ?? known.now?.arrays.controls[k];

  function keepAt(k, to) {
    const asked = ask("commit", { grip: grip(k, to), label: `control value ${k + 1}` });
    hand.put({ [k]: to }, asked);
    return asked;
  }

  const grip = (k, to) => ({ kind: "handle", number: k, to, reach: Number(reach.value), mirror: mirror.checked, keep: keep.checked });

  function tellHandle(k) {
    const value = known.now?.arrays.controls[k];
    if (value === undefined || !scale) return;
    const shown = (1e3 * value).toFixed(4);
    reading.textContent = `control value ${k + 1}: ${shown} mm`;
    put(circles[k], "aria-valuenow", shown);
    put(circles[k], "aria-valuetext", `${shown} millimetres`);
    put(circles[k], "aria-valuemin", (1e3 * Math.min(scale.low, value)).toFixed(4));
    put(circles[k], "aria-valuemax", (1e3 * Math.max(scale.high, value)).toFixed(4));
  }

  function draw() {
    const { now, model } = known;
    if (!now || !width || !now.arrays.radius) return;
    const { cam } = model, shown = Math.min(cam.lobes, SHOWN_LOBES) / cam.lobes;
    if (!held || !scale) rescale(now, known.before);
    const span = cam.period * shown;
    heading.textContent = cam.lobes > 1 ? `Cam: pitch radius, ${Math.min(cam.lobes, SHOWN_LOBES)} of ${cam.lobes} lobes` : "Cam: pitch radius over one lobe";
    const x = (share) => PAD.left + share / shown * (width - PAD.left - PAD.right);
    const y = (radius) => PAD.top + (scale.high - radius) * scale.y;
    const part = model.motor.repeats * cam.period / 360; // of what is sent: a mode repeats less often than its cam
    const ofCam = (radius) => radius.subarray(0, Math.round((radius.length - 1) * part) + 1);
    curve.setAttribute("d", path(ofCam(now.arrays.radius), x, y, shown));
    put(before, "d", known.before?.arrays.radius ? path(ofCam(known.before.arrays.radius), x, y, shown) : "");
    const controls = now.arrays.controls;
    let tips = "";
    circles.forEach((circle, k) => {
      const share = k / cam.count;
      put(circle, "display", share <= shown ? "inline" : "none");
      if (share > shown) return;
      const cx = x(share), cy = y(controls[k]);
      put(circle, "cx", cx.toFixed(1));
      put(circle, "cy", cy.toFixed(1));
      if (k === held?.k || document.activeElement === circle) {
        tellHandle(k);
      }
      const slope = held ? null : slopeOf(`cam-handle-${k}`);
      if (slope) {
        const length = Math.sign(-slope) * 22 * Math.sqrt(Math.abs(slope) / strongestHandle(cam.count));
        const end = cy - length, way = Math.sign(length);
        if (Math.abs(length) > 4) tips += `M${cx} ${cy - 6 * way}V${end}M${cx - 3} ${end + 4 * way}L${cx} ${end}L${cx + 3} ${end + 4 * way}`;
      }
    });
    put(arrows, "d", tips);
    drawGrid(x, y, span, shown);
    if (!held && !circles.includes(document.activeElement)) {
      const low = Math.min(...now.arrays.radius), high = Math.max(...now.arrays.radius);
      reading.textContent = `${significant(1e3 * low, 5)} to ${significant(1e3 * high, 5)} mm`;
    }
  }

  function strongestHandle(count) {
    let most = 1e-300;
    for (let k = 0; k < count; k += 1) most = Math.max(most, Math.abs(slopeOf(`cam-handle-${k}`) ?? 0));
    return most;
  }

  function rescale(now, old) {
    let low = Infinity, high = -Infinity;
    for (const each of [now.arrays.radius, now.arrays.controls, old?.arrays.radius ?? []]) {
      for (const value of each) { low = Math.min(low, value); high = Math.max(high, value); }
    }
    const spare = 0.12 * (high - low);
    if (!scale || low < scale.low + 0.3 * spare || high > scale.high - 0.3 * spare || high - low < 0.6 * (scale.high - scale.low)) {
      scale = { low: low - spare, high: high + spare };
    }
    scale.y = (height - PAD.top - PAD.bottom) / (scale.high - scale.low);
  }

  function drawGrid(x, y, span, shown) {
    const key = `${width} ${height} ${scale.low} ${scale.high} ${span}`;
    if (grid.dataset.key === key) return;
    grid.dataset.key = key;
    const parts = [];
    const step = nice((scale.high - scale.low) * 1e3 / 5);
    for (let v = Math.ceil(scale.low * 1e3 / step) * step; v < scale.high * 1e3; v += step) {
      parts.push(make("line", { class: "grid", x1: PAD.left, x2: width - PAD.right, y1: y(v / 1e3), y2: y(v / 1e3) }),
        make("text", { class: "tick", x: PAD.left - 6, y: y(v / 1e3) + 4, "text-anchor": "end", text: significant(v, 4) }));
    }
    const turn = nice(span / 7);
    for (let v = 0; v <= span * 1.0001; v += turn) {
      parts.push(make("line", { class: "grid", x1: x(v / span * shown), x2: x(v / span * shown), y1: PAD.top, y2: height - PAD.bottom }),
        make("text", { class: "tick", x: x(v / span * shown), y: height - 6, "text-anchor": "middle", text: `${significant(v, 3)}°`.replace(/\.0+°/, "°") }));
    }
    parts.push(make("text", { class: "tick", x: 2, y: 12, text: "mm" }));
    grid.replaceChildren(...parts);
  }

  return { draw };
}

/** Only what has changed: the browser lays out anew whatever is set, the same or not. */
function put(element, name, value) {
  if (element.getAttribute(name) !== value) element.setAttribute(name, value);
}

function path(values, x, y, shown) {
  const count = values.length - 1, last = Math.round(count * shown), by = Math.max(1, Math.round(last / 240));
  let text = "";
  for (let k = 0; k <= last; k += by) text += `${k ? "L" : "M"}${x(k / count).toFixed(1)} ${y(values[k]).toFixed(1)}`;
  return text;
}
