// The motor in section, turning: ring, rollers, chambers by their pressure, windows on a dial.

import { makeDial } from "./dial.js";
import { canvasIn, make, panel } from "./dom.js";
import { known, on } from "./store.js";
import { beforeDash, beforeWidth, colour, isDark } from "./theme.js";

const TURNS_PER_SECOND = 1 / 24;
const PICTURES_PER_SECOND = 20;

export function makeSection() {
  const { body, tools, reading } = panel("section", "Section, turning");
  let angle = 0, playing = !matchMedia("(prefers-reduced-motion: reduce)").matches, last = 0;
  const play = make("button", { type: "button", class: "button", "data-testid": "play", onclick: () => { playing = !playing; label(); } });
  const turn = make("input", { type: "range", min: "0", max: "360", step: "0.5", value: "0", "aria-label": "Shaft angle", "data-testid": "shaft-angle" });
  turn.addEventListener("input", () => { playing = false; label(); angle = Number(turn.value) * Math.PI / 180; picture.redraw(); });
  tools.append(play, turn, make("span", { class: "quiet", text: "windows can be dragged", title: "Drag a window to turn the whole plate, its edge to widen the windows of its kind; Tab and arrow keys do the same" }));
  const label = () => { play.textContent = playing ? "❚❚" : "▶"; play.setAttribute("aria-label", playing ? "Stop turning" : "Turn"); };
  label();
  on("toggle turning", () => { playing = !playing; label(); });

  const picture = canvasIn(body, draw, { "data-testid": "plot-section", role: "img", "aria-label": "Section of the motor with the windows of its valve plate" });
  const dial = makeDial(picture, body, places, reading);

  setInterval(() => {
    if (!playing || document.hidden || known.held) return;
    const now = performance.now();
    angle = (angle + 2 * Math.PI * TURNS_PER_SECOND * Math.min(now - last, 200) / 1000) % (2 * Math.PI);
    last = now;
    turn.value = String(angle * 180 / Math.PI);
    requestAnimationFrame(picture.redraw);
  }, 1000 / PICTURES_PER_SECOND);

  function places(width, height) {
    const frame = known.now, { motor } = known.model;
    let most = 0;
    for (const each of frame.arrays.radius) most = Math.max(most, each);
    const deepest = most + motor.roller, outer = Math.max((motor.outer ?? 0) / 2, deepest * 1.075);
    const scale = (Math.min(width, height) / 2 - 5) / outer;
    return { x: width / 2, y: height / 2, scale, outer, dial: 0.42 * most, band: 0.1 * most };
  }

  function radiusAt(frame, turned, name = "radius") {
    const { repeats } = known.model.motor, values = frame.arrays[name], count = values.length - 1;
    const at = ((turned * repeats / (2 * Math.PI)) % 1 + 1) % 1 * count, k = Math.floor(at);
    return values[k] + (at - k) * (values[Math.min(k + 1, count)] - values[k]);
  }

  function ring(frame, place) {
    const { motor } = known.model, { radius, slope } = frame.arrays, count = radius.length - 1;
    const by = Math.max(1, Math.round(count * motor.repeats / 480)), path = new Path2D();
    for (let lobe = 0; lobe < motor.repeats; lobe += 1) {
      for (let k = 0; k < count; k += by) {
        const turned = 2 * Math.PI * (lobe + k / count) / motor.repeats;
        const length = Math.hypot(radius[k], slope[k]) / motor.roller;
        const along = radius[k] + radius[k] / length, across = -slope[k] / length;
        const c = Math.cos(turned), s = Math.sin(turned);
        const px = place.x + place.scale * (along * c - across * s), py = place.y - place.scale * (along * s + across * c);
        if (lobe || k) path.lineTo(px, py); else path.moveTo(px, py);
      }
    }
    path.closePath();
    return path;
  }

  function draw(context, width, height) {
    const frame = known.now;
    if (!frame?.arrays.radius) return;
    const { motor } = known.model, place = places(width, height);
    const surface = ring(frame, place);
    const body = new Path2D();
    body.arc(place.x, place.y, place.outer * place.scale, 0, 2 * Math.PI);
    body.addPath(surface);
    context.fillStyle = colour("steel");
    context.fill(body, "evenodd");
    context.lineWidth = 1;
    context.strokeStyle = colour("steel-edge");
    context.beginPath();
    context.arc(place.x, place.y, place.outer * place.scale, 0, 2 * Math.PI);
    context.stroke();
    if (known.before?.arrays.radius && known.before.arrays.radius.length === frame.arrays.radius.length) {
      context.strokeStyle = colour("before");
      context.setLineDash(beforeDash());
      context.lineWidth = beforeWidth(1);
      context.stroke(ring(known.before, place));
      context.setLineDash([]);
    }
    context.strokeStyle = colour("now");
    context.lineWidth = 1.8;
    context.stroke(surface);
    drawPistons(context, frame, place, motor);
    dial.draw(context, place);
  }

  function drawPistons(context, frame, place, motor) {
    const { scale } = place, low = pressureEnds(frame);
    let inner = Infinity;
    for (const each of frame.arrays.radius) inner = Math.min(inner, each);
    const block = (inner - 0.25 * motor.roller) * scale, floor = (place.dial + 1.15 * place.band) * scale;
    context.beginPath();
    context.arc(place.x, place.y, block, 0, 2 * Math.PI);
    context.fillStyle = colour("soft");
    context.fill();
    context.strokeStyle = colour("line");
    context.lineWidth = 1;
    context.stroke();
    const bore = Math.min(motor.bore * scale, 2 * Math.PI * floor / motor.pistons * 0.8);
    for (let k = 0; k < motor.pistons; k += 1) {
      const turned = angle + 2 * Math.PI * k / motor.pistons;
      const at = radiusAt(frame, turned), share = (radiusAt(frame, turned, "pressure") - low[0]) / (low[1] - low[0]);
      context.save();
      context.translate(place.x, place.y);
      context.rotate(-turned);
      const foot = (at - 1.35 * motor.roller) * scale;
      context.fillStyle = pressureColour(share);
      context.fillRect(floor, -bore / 2, Math.max(foot - floor, 0), bore);
      context.fillStyle = colour("paper");
      context.strokeStyle = colour("quiet");
      context.fillRect(foot, -bore / 2, (1.35 * motor.roller) * scale, bore);
      context.strokeRect(floor, -bore / 2, at * scale - floor, bore);
      context.beginPath();
      context.arc(at * scale, 0, motor.roller * scale, 0, 2 * Math.PI);
      context.fillStyle = colour("paper");
      context.fill();
      context.strokeStyle = colour("ink");
      context.lineWidth = 1.2;
      context.stroke();
      context.restore();
    }
  }

  function pressureEnds(frame) {
    const values = frame.arrays.pressure;
    let low = Infinity, high = -Infinity;
    for (const each of values) { low = Math.min(low, each); high = Math.max(high, each); }
    return [low, Math.max(high, low + 1)];
  }

  function pressureColour(share) {
    const stops = known.model.pressure_stops;
    const at = Math.min(Math.max(isDark() ? 1 - share : share, 0), 1);
    for (let k = 1; k < stops.length; k += 1) {
      const [low, from] = stops[k - 1], [high, to] = stops[k];
      if (at <= high) {
        const part = (at - low) / (high - low);
        return `rgb(${from.map((each, c) => Math.round(each + part * (to[c] - each))).join(",")})`;
      }
    }
    return "#0c3468";
  }

  return { draw: picture.redraw };
}
