// The envelope over speed and pressure: where limits break, and the operating points in it.

import { canvasIn, hear, make, panel } from "./dom.js";
import { ask, move, standing } from "./link.js";
import { grip, nudged, stepOf } from "./nudge.js";
import { cell, nearest, nice, rounded, significant, within, written } from "./numbers.js";
import { known, on } from "./store.js";
import { colour, fontSize, isDark, marginColour, shade } from "./theme.js";

const CELLS = 44; // of the picture, each way
const PRESSURE_STEPS = [5, 1, 50]; // bar: of an arrow key, with Shift, of a page key
const SPEED_STEPS = [0.02, 0.002, 0.02]; // of the speed; the next round number above is taken

export function makeEnvelope() {
  const { body, tools, reading, heading } = panel("envelope", "Envelope");
  const what = make("select", { "aria-label": "What the envelope shows", "data-testid": "envelope-shows", onchange: () => picture.redraw() });
  tools.append(what, make("span", { class: "quiet", text: "points can be dragged", title: "Drag an operating point to another speed and pressure; Tab and arrow keys do the same" }));
  const picture = canvasIn(body, draw, { "data-testid": "plot-envelope", role: "application", tabindex: "0", "aria-label": "Envelope over speed and pressure; arrow keys move a cross that reads it" });
  const { canvas } = picture;
  const map = make("canvas", { width: CELLS, height: CELLS });
  const hand = standing();
  let held = null, spots = [], handles = [], cross = null;

  on("described", () => {
    while (handles.length > known.model.points.length) handles.pop().element.remove();
    while (handles.length < known.model.points.length) handles.push(handle(handles.length));
    const { model } = known, chosen = what.value || "limits";
    for (const each of handles) each.element.hidden = !model.envelope;
    what.replaceChildren(
      make("option", { value: "limits", text: "tightest limit" }),
      ...model.mapped.map((name) => make("option", { value: name, text: model.quantities[name].label.replace(", one-sided", "").toLowerCase() })),
      ...model.limits.map((limit) => make("option", { value: `limit:${limit.name}`, text: `limit: ${limit.label.toLowerCase()}` })));
    what.value = [...what.options].some((each) => each.value === chosen) ? chosen : "limits";
    heading.textContent = model.envelope && !model.envelope.asked ? "Envelope (from a tenth of the pressure)" : "Envelope";
  });

  /** At every node of the grid of speeds and pressures: the worst of what is shown there, and of which limit. */
  function field() {
    const { model, envelope } = known;
    const message = envelope.fine ?? envelope.coarse;
    if (!message || !model.envelope) return null;
    const grid = model.envelope[message.head.grid], count = grid.speed.length, { names } = message.head;
    if (message.arrays.limits.length !== names.length * count) return null;
    const speeds = [...new Set(grid.speed.map((each) => each.toPrecision(9)))].map(Number).sort((a, b) => a - b);
    const pressures = [...new Set(grid.pressure.map((each) => each.toPrecision(9)))].map(Number).sort((a, b) => a - b);
    const nodes = speeds.map(() => pressures.map(() => ({ value: -Infinity, limit: null })));
    const mode = what.value, margins = mode === "limits" || mode.startsWith("limit:");
    const better = margins ? -1 : model.quantities[mode].better;
    const varied = names.map((_, row) => varies(message.arrays.limits.subarray(row * count, (row + 1) * count)));
    for (let k = 0; k < count; k += 1) {
      const node = nodes[nearest(speeds, grid.speed[k])][nearest(pressures, grid.pressure[k])];
      if (margins) {
        names.forEach((name, row) => {
          // A limit of the ring alone is the same everywhere and says nothing of the envelope.
          if (mode === "limits" ? !varied[row] : mode !== `limit:${name}`) return;
          let g = message.arrays.limits[row * count + k];
          if (Number.isNaN(g)) g = Infinity;
          if (g > node.value) { node.value = g; node.limit = name; }
        });
      } else {
        const value = message.arrays.results[model.mapped.indexOf(mode) * count + k];
        const worse = node.value === -Infinity || (better < 0 ? value > node.value : value < node.value);
        if (worse) node.value = value;
      }
    }
    return { speeds, pressures, nodes, margins, mode };
  }

  function frame(width, height, found) {
    const size = fontSize(), left = 3.3 * size, bottom = 2.6 * size, top = 4, right = 8;
    const log = [Math.log(found.speeds[0]), Math.log(found.speeds.at(-1))], bar = [found.pressures[0], found.pressures.at(-1)];
    if (log[1] - log[0] < 1e-9) { log[0] -= 0.1; log[1] += 0.1; }
    if (bar[1] - bar[0] < 1e-9) { bar[0] *= 0.9; bar[1] *= 1.1; }
    const w = width - left - right, h = height - top - bottom;
    return {
      left, top, w, h, speeds: log.map(Math.exp), pressures: bar,
      x: (speed) => left + (Math.log(speed) - log[0]) / (log[1] - log[0]) * w,
      y: (pressure) => top + (bar[1] - pressure) / (bar[1] - bar[0]) * h,
      speed: (x) => Math.exp(log[0] + (x - left) / w * (log[1] - log[0])),
      pressure: (y) => bar[1] - (y - top) / h * (bar[1] - bar[0]),
    };
  }

  function draw(context, width, height) {
    const found = field();
    if (!found || width < 60) { reading.textContent = known.model?.envelope ? "being computed" : ""; return; }
    const place = frame(width, height, found);
    let low = Infinity, high = -Infinity;
    for (const row of found.nodes) for (const node of row) if (Number.isFinite(node.value)) { low = Math.min(low, node.value); high = Math.max(high, node.value); }
    const values = cells(found, place), broken = found.margins ? values.filter((each) => each > 0).length : 0;
    raster(values, found.margins ? marginColour : (value) => shade((value - low) / (high - low || 1)));
    context.imageSmoothingEnabled = false;
    context.drawImage(map, place.left, place.top, place.w, place.h);
    if (broken) hatch(context, place, values);
    axes(context, place, found, height);
    context.fillStyle = colour("ink");
    for (const speed of found.speeds) for (const pressure of found.pressures) {
      context.globalAlpha = 0.35;
      context.fillRect(place.x(speed) - 1, place.y(pressure) - 1, 2, 2);
    }
    context.globalAlpha = 1;
    points(context, place);
    drawCross(context, place);
    words(found, broken, low, high);
  }

  function words(found, broken, low, high) {
    if (held || cross) return;
    if (!found.margins) {
      const quantity = known.model.quantities[found.mode];
      reading.textContent = `${significant(low * quantity.factor, 3)} to ${significant(high * quantity.factor, 3)} ${quantity.unit}`;
      return;
    }
    const worst = found.nodes.flat().reduce((a, b) => (b.value > a.value ? b : a));
    const name = known.model.limits.find((each) => each.name === worst.limit)?.label ?? "";
    reading.textContent = worst.value > 0 ? `broken in ${Math.max(1, Math.round(100 * broken / CELLS ** 2))} %: ${name}` : `kept everywhere; least margin ${significant(-100 * worst.value, 2)} %`;
    reading.title = name;
  }

  function between(found, speed, pressure) {
    return mixed(found, cell(found.speeds, speed, Math.log), cell(found.pressures, pressure, (each) => each));
  }

  function mixed(found, [i, a], [j, b]) {
    const at = (p, q) => { const { value } = found.nodes[Math.min(p, found.speeds.length - 1)][Math.min(q, found.pressures.length - 1)]; return value; };
    const value = (1 - a) * ((1 - b) * at(i, j) + b * at(i, j + 1)) + a * ((1 - b) * at(i + 1, j) + b * at(i + 1, j + 1));
    return Number.isNaN(value) ? Infinity : value;
  }

  /** What is shown at the middle of every cell of the picture, row by row from the top. */
  function cells(found, place) {
    const columns = Array.from({ length: CELLS }, (_, i) => cell(found.speeds, place.speed(place.left + (i + 0.5) / CELLS * place.w), Math.log));
    const values = new Float64Array(CELLS * CELLS);
    for (let j = 0; j < CELLS; j += 1) {
      const row = cell(found.pressures, place.pressure(place.top + (j + 0.5) / CELLS * place.h), (each) => each);
      for (let i = 0; i < CELLS; i += 1) values[j * CELLS + i] = mixed(found, columns[i], row);
    }
    return values;
  }

  /** One pixel for each cell. */
  function raster(values, shadeOf) {
    const context = map.getContext("2d"), image = context.createImageData(CELLS, CELLS);
    values.forEach((value, k) => { image.data.set(shadeOf(value), 4 * k); image.data[4 * k + 3] = 255; });
    context.putImageData(image, 0, 0);
  }

  function hatch(context, place, values) {
    const across = place.w / CELLS, down = place.h / CELLS;
    context.save();
    context.beginPath();
    values.forEach((value, k) => {
      if (value > 0) context.rect(place.left + (k % CELLS) * across, place.top + Math.floor(k / CELLS) * down, across + 0.6, down + 0.6);
    });
    context.clip();
    context.strokeStyle = colour("limit");
    context.lineWidth = 1;
    context.beginPath();
    for (let k = -place.h; k < place.w; k += 9) { context.moveTo(place.left + k, place.top + place.h); context.lineTo(place.left + k + place.h, place.top); }
    context.stroke();
    context.restore();
  }

  function axes(context, place, found, height) {
    const size = Math.round(0.78 * fontSize());
    context.strokeStyle = colour("line");
    context.strokeRect(place.left, place.top, place.w, place.h);
    context.fillStyle = colour("quiet");
    context.font = `${size}px system-ui, sans-serif`;
    context.textAlign = "center";
    const [low, high] = [found.speeds[0], found.speeds.at(-1)];
    for (const speed of [low, Math.sqrt(low * high), high]) context.fillText(significant(speed, 3).replace(/\.0+$/, ""), Math.min(Math.max(place.x(speed), place.left + size), place.left + place.w - size), place.top + place.h + size + 2);
    context.fillText("rpm", place.left + place.w / 4, height - 2);
    context.textAlign = "right";
    const bars = [found.pressures[0], found.pressures.at(-1)];
    for (const pressure of [bars[0], (bars[0] + bars[1]) / 2, bars[1]]) context.fillText(significant(pressure, 3).replace(/\.0+$/, ""), place.left - 4, Math.max(place.y(pressure) + size / 3, size));
    context.save();
    context.translate(size, place.top + place.h / 2);
    context.rotate(-Math.PI / 2);
    context.textAlign = "center";
    context.fillText("supply, bar", 0, 0);
    context.restore();
  }

  function operating(k) {
    const moved = hand.or(null);
    if (moved?.k === k) return moved.to;
    const value = (key) => {
      const name = `operating_points[${k}].${key}`;
      return known.now?.head.set?.[name] ?? known.model.fields.find((each) => each.path === name)?.value;
    };
    return [value("speed") * 30 / Math.PI, value("supply_pressure") / 1e5];
  }

  function points(context, place) {
    spots = known.model.points.map((_, k) => {
      const [speed, pressure] = operating(k);
      return [Math.min(Math.max(place.x(speed), place.left), place.left + place.w), Math.min(Math.max(place.y(pressure), place.top), place.top + place.h)];
    });
    spots.forEach(([x, y], k) => {
      const [speed, pressure] = operating(k);
      handles[k].at(x, y);
      handles[k].says(rounded(speed, 0.01), `${significant(speed, 4)} rpm, ${significant(pressure, 4)} bar`, ...place.speeds);
      context.beginPath();
      context.arc(x, y, 6, 0, 2 * Math.PI);
      context.fillStyle = k === known.model.point ? colour("now") : colour("paper");
      context.fill();
      context.lineWidth = 2;
      context.strokeStyle = k === known.model.point ? colour("paper") : colour("now");
      context.stroke();
    });
  }

  /** A point at a speed and a pressure, rpm and bar, and at rest there. */
  function go(k, to, stamp) {
    const [speed, pressure] = to, name = `operating_points[${k}]`;
    const set = { [`${name}.speed`]: speed * Math.PI / 30, [`${name}.supply_pressure`]: pressure * 1e5 };
    reading.textContent = `${written(speed)} rpm, ${written(pressure)} bar`;
    hand.put({ k, to }, move({ set }, stamp));
  }
  function keep(k, [speed, pressure]) {
    const name = `operating_points[${k}]`;
    const asked = ask("commit", { set: { [`${name}.speed`]: `${written(speed)} rpm`, [`${name}.supply_pressure`]: `${written(pressure)} bar` }, label: `operating point ${k + 1}` });
    hand.put({ k, to: [speed, pressure] }, asked);
    return asked;
  }

  /** Of one operating point: arrow keys along both axes, Enter shows it. */
  function handle(k) {
    const made = grip(body, { "data-testid": `map-point-${k}`, "aria-roledescription": "point of two axes", "aria-label": `Operating point ${k + 1}: left and right change its speed, up and down its pressure` });
    nudged(made.element, {
      from: () => operating(k),
      by: (key, from, fine) => stepped(key, from, fine),
      go: (to, stamp) => { if (k !== known.model.point) ask("view", { point: k }); go(k, to, stamp); },
      keep: (to) => keep(k, to),
    });
    made.element.addEventListener("keydown", (event) => {
      if (event.key === "Enter") { event.preventDefault(); ask("view", { point: k }); }
    });
    return made;
  }

  function stepped(key, [speed, pressure], fine) {
    const found = field(), along = key === "ArrowLeft" || key === "ArrowRight";
    const step = stepOf(key, fine, along ? SPEED_STEPS : PRESSURE_STEPS);
    if (!step || !found) return null;
    const place = frame(...picture.size(), found), by = along ? Math.sign(step) * nice(Math.abs(step) * speed) : step;
    if (along) return [within(speed, rounded(speed + by, Math.abs(by)), place.speeds), pressure];
    return [speed, within(pressure, rounded(pressure + by, 1), place.pressures)];
  }

  function drawCross(context, place) {
    if (!cross) return;
    const x = place.left + cross[0] * place.w, y = place.top + cross[1] * place.h;
    for (const [width, name] of [[3, "paper"], [1, "ink"]]) {
      context.lineWidth = width;
      context.strokeStyle = colour(name);
      context.beginPath();
      context.moveTo(x, place.top); context.lineTo(x, place.top + place.h);
      context.moveTo(place.left, y); context.lineTo(place.left + place.w, y);
      context.stroke();
    }
  }

  canvas.addEventListener("keydown", (event) => {
    const found = field(), by = (event.shiftKey ? 1 : 4) / 100;
    const way = { ArrowLeft: [-by, 0], ArrowRight: [by, 0], ArrowUp: [0, -by], ArrowDown: [0, by] }[event.key];
    if (event.key === "Escape" && cross) { cross = null; picture.redraw(); }
    if (!way || !found || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    cross = (cross ?? [0.5, 0.5]).map((each, k) => Math.min(1, Math.max(0, each + way[k])));
    const place = frame(...picture.size(), found);
    tellAt(found, place.speed(place.left + cross[0] * place.w), place.pressure(place.top + cross[1] * place.h));
    hear(reading.textContent);
    picture.redraw();
  });
  canvas.addEventListener("blur", () => { if (cross) { cross = null; picture.redraw(); } });

  const at = (event) => { const box = canvas.getBoundingClientRect(); return [event.clientX - box.left, event.clientY - box.top]; };
  const hit = (event) => { const [x, y] = at(event); return spots.findIndex(([px, py]) => Math.hypot(px - x, py - y) < 12); };

  canvas.addEventListener("pointerdown", (event) => {
    const k = hit(event);
    if (k < 0) return;
    canvas.setPointerCapture(event.pointerId);
    held = { k };
    if (k !== known.model.point) ask("view", { point: k });
    known.held = true;
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!held) {
      canvas.style.cursor = hit(event) >= 0 ? "grab" : "";
      tellUnder(event);
      return;
    }
    const found = field();
    if (!found) return;
    const [width, height] = picture.size(), place = frame(width, height, found), [x, y] = at(event);
    const inside = [Math.min(Math.max(x, place.left), place.left + place.w), Math.min(Math.max(y, place.top), place.top + place.h)];
    held.to = [Number(place.speed(inside[0]).toPrecision(3)), rounded(place.pressure(inside[1]), 1)];
    go(held.k, held.to, event.timeStamp);
  });
  const release = () => {
    if (!held) return;
    known.held = false;
    if (held.to) keep(held.k, held.to);
    held = null;
  };
  canvas.addEventListener("pointerup", release);
  canvas.addEventListener("lostpointercapture", release);
  canvas.addEventListener("pointerleave", () => picture.redraw());

  function tellUnder(event) {
    const found = field();
    if (!found) return;
    const [width, height] = picture.size(), place = frame(width, height, found), [x, y] = at(event);
    if (x < place.left || y > place.top + place.h) return;
    tellAt(found, place.speed(x), place.pressure(y));
  }

  function tellAt(found, speed, pressure) {
    const value = between(found, speed, pressure);
    const where = `${significant(speed, 3)} rpm, ${significant(pressure, 3)} bar: `;
    if (found.margins) {
      const node = found.nodes[nearest(found.speeds, speed)][nearest(found.pressures, pressure)];
      const label = known.model.limits.find((each) => each.name === node.limit)?.label ?? "";
      reading.textContent = `${where}${value > 0 ? "broken" : `${significant(-100 * value, 2)} % margin`}, ${label}`;
    } else {
      const quantity = known.model.quantities[found.mode];
      reading.textContent = `${where}${significant(value * quantity.factor, 3)} ${quantity.unit}`;
    }
  }

  let drawn = null;

  /** Only when something in it has changed: the map takes longest to draw and comes less often. */
  function changed() {
    const { envelope, model } = known, message = envelope.fine ?? envelope.coarse;
    const set = Object.entries(known.now.head.set ?? {}).filter(([path]) => path.startsWith("operating_points"));
    const key = [message?.at, model.point, what.value, JSON.stringify(set), isDark()].join(" ");
    if (key === drawn) return;
    drawn = key;
    picture.redraw();
  }
  on("described", () => { drawn = null; });

  return { draw: changed };
}

function varies(values) {
  return values.some((each) => Number.isNaN(each) || Math.abs(each - values[0]) > 1e-6);
}
