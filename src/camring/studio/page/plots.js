// The curves: chamber pressure, torque, orders, work, contact stress; before and now in each.

import { hear, panel } from "./dom.js";
import { significant } from "./numbers.js";
import { known, on, result } from "./store.js";
import { beforeDash, beforeWidth, colour, fontSize } from "./theme.js";

const FLOOR = 1e-3; // per cent of the mean; what lies lower is not drawn
const SHRINK = 0.5; // an axis narrows only when less than this share of it is used
const STRIP = 0.2; // of a picture's height for the windows

/** One picture of curves over a common x; `series` gives now and before. */
function plot(name, title, { x, y, read, log = false, before: beneath, after: above, bars = false, thickness = 1.9, pad = [0.06, 0.06] }) {
  const { body, reading } = panel(name, title);
  body.dataset.testid = `plot-${name}`;
  let chart = null, built = 0, span = null, width = 0, height = 0;

  const line = (dashed) => ({
    stroke: () => colour(dashed ? "before" : "now"), width: dashed ? beforeWidth(thickness) : thickness, dash: dashed ? [6, 3] : undefined, points: { show: false },
    ...(bars ? { paths: uPlot.paths.bars({ size: [0.36, 26], align: dashed ? -1 : 1 }), fill: () => colour(dashed ? "paper" : "now"), fillTo: () => FLOOR } : {}),
  });
  const font = () => `${Math.round(0.78 * fontSize())}px system-ui, sans-serif`;
  const axis = (label, size) => ({
    ...(label ? { label } : {}),
    stroke: () => colour("quiet"), grid: { stroke: () => colour("line"), width: 1 }, ticks: { show: false }, font: font(), labelFont: font(), gap: 3,
    labelSize: 1.05 * fontSize(), labelGap: 0, size,
  });

  function build() {
    chart?.destroy();
    const size = built = fontSize();
    chart = new uPlot({
      width, height, legend: { show: false }, padding: [6, 8, 0, 0],
      cursor: { y: false, points: { show: false }, drag: { x: false, y: false } },
      scales: {
        x: { time: false, range: () => (known.now ? x.range() : [0, 1]) },
        y: log ? { distr: 3, range: () => span ?? [FLOOR, 1] } : { range: () => span ?? [0, 1] },
      },
      axes: [
        { ...axis(x.label, (x.label ? 2.7 : 1.75) * size), space: 34, ...(x.splits ? { splits: () => (known.now ? x.splits() : [0, 1]) } : {}), values: (_, all) => all.map((each) => `${each}${x.unit}`) },
        { ...axis(y.label, 4.1 * size), space: log ? 22 : 28, ...(log ? { splits: decades, filter: (_, all) => all } : {}), values: (_, all) => all.map((each) => (each === null ? "" : Math.abs(each) >= 1e5 ? each.toExponential(0) : `${Number(each.toPrecision(6))}`)) },
      ],
      series: [{}, line(true), line(false)],
      hooks: {
        drawClear: [(u) => { if (known.now) beneath?.(u); }],
        draw: [(u) => { if (known.now) above?.(u); }],
        setCursor: [(u) => { reading.textContent = !read || u.cursor.idx === null || u.cursor.idx === undefined ? "" : read(u.data, u.cursor.idx); }],
      },
    }, [[0, 1], [null, null], [0, 0]], body);
  }

  new ResizeObserver(() => {
    width = body.clientWidth;
    height = body.clientHeight;
    if (!width || !height) return;
    if (!chart || built !== fontSize()) build(); else chart.setSize({ width, height });
    draw();
  }).observe(body);
  on("theme", () => { if (chart && width) { build(); draw(); } });
  if (read) readByKeys();
  on("described", ({ other }) => { if (other) span = null; });

  /** What a pointer over the curve reads, by arrow keys; Escape takes the cursor away. */
  function readByKeys() {
    for (const [key, value] of [["tabindex", "0"], ["role", "application"], ["aria-label", `${title}; arrow keys read the curve`]]) body.setAttribute(key, value);
    let at = null;
    const away = () => { at = null; chart?.setCursor({ left: -10, top: -10 }); };
    body.addEventListener("blur", away);
    body.addEventListener("keydown", (event) => {
      if (!chart || !known.now || event.ctrlKey || event.metaKey || event.altKey) return;
      if (event.key === "Escape") { away(); return; }
      const last = chart.data[0].length - 1, from = Math.min(at ?? 0, last), by = event.shiftKey ? 1 : Math.max(1, Math.round(last / 90));
      const to = { ArrowRight: Math.min(from + by, last), ArrowLeft: Math.max(from - by, 0), Home: 0, End: last }[event.key];
      if (to === undefined) return;
      event.preventDefault();
      at = to;
      chart.setCursor({ left: chart.valToPos(chart.data[0][to], "x"), top: 1 });
      reading.textContent = read(chart.data, to);
      hear(reading.textContent);
    });
  }

  function draw() {
    if (!chart || !known.now?.arrays.radius) return;
    const now = y.of(known.now), at = x.of(known.now);
    const before = known.before?.arrays.radius ? fitted(y.of(known.before), now.length) : new Array(now.length).fill(null);
    fit([now, before], y.include?.() ?? []);
    chart.series[1].dash = beforeDash();
    chart.series[1].width = beforeWidth(bars ? 1.2 : thickness);
    chart.setData([at, before, now], true);
  }

  function fit(all, include) {
    let low = Infinity, high = -Infinity;
    for (const values of [...all, include]) for (const each of values) {
      if (each === null || !Number.isFinite(each)) continue;
      if (each < low) low = each;
      if (each > high) high = each;
    }
    if (!(high >= low)) { low = 0; high = 1; }
    if (log) { span = [FLOOR, 10 ** (Math.ceil(2 * Math.log10(Math.max(high, 10 * FLOOR)) + 0.2) / 2)]; return; }
    const size = high - low || Math.abs(high) || 1;
    const wanted = [low - pad[0] * size, high + pad[1] * size];
    const fits = span && low >= span[0] && high <= span[1] && size > SHRINK * (span[1] - span[0]) * (1 / (1 + pad[0] + pad[1]));
    if (!fits) span = wanted;
  }

  return { draw, span: () => span };
}

function decades() {
  const found = [];
  for (let power = -3; power <= 3; power += 1) found.push(10 ** power);
  return found;
}

/** Another design's curve over as many places. */
function fitted(values, count) {
  if (values.length === count) return values;
  return Array.from({ length: count }, (_, k) => {
    const at = k / Math.max(count - 1, 1) * (values.length - 1), low = Math.floor(at);
    return values[low] + (at - low) * (values[Math.min(low + 1, values.length - 1)] - values[low]);
  });
}

const grids = new Map();
function angles(count, span) {
  const key = `${count} ${span}`;
  if (!grids.has(key)) grids.set(key, Float64Array.from({ length: count }, (_, k) => k / (count - 1) * span));
  return grids.get(key);
}

const scaled = (values, factor) => Float64Array.from(values, (each) => each * factor);
const period = () => 360 / known.model.motor.repeats;
const overPeriod = { label: null, unit: "°", range: () => [0, period()], of: (frame) => angles(frame.arrays.radius.length, period()) };

function rule(u, value, name, words) {
  if (value === undefined || value === null || !Number.isFinite(value)) return;
  const { ctx, bbox } = u, at = u.valToPos(value, "y", true);
  if (at < bbox.top || at > bbox.top + bbox.height) return;
  ctx.save();
  ctx.strokeStyle = colour(name);
  ctx.fillStyle = colour(name);
  ctx.lineWidth = 1;
  ctx.setLineDash([2, 3]);
  ctx.beginPath();
  ctx.moveTo(bbox.left, at);
  ctx.lineTo(bbox.left + bbox.width, at);
  ctx.stroke();
  ctx.font = `${Math.round(0.76 * fontSize() * devicePixelRatio)}px system-ui, sans-serif`;
  ctx.textAlign = "right";
  ctx.fillText(words, bbox.left + bbox.width - 4, at - 3);
  ctx.restore();
}

const fieldValue = (path) => known.now?.head.set?.[path] ?? known.model.fields.find((each) => each.path === path)?.value;

function pressure() {
  return plot("pressure", "Chamber pressure, and the windows below", {
    x: overPeriod, pad: [0.3, 0.07],
    y: { label: "bar", of: (frame) => scaled(frame.arrays.pressure, 1e-5) },
    read: (data, k) => `${significant(data[0][k], 4)}°: ${significant(data[2][k], 4)} bar${data[1][k] === null ? "" : `, was ${significant(data[1][k], 4)}`}`,
    before: (u) => windows(u),
    after: (u) => {
      const point = `operating_points[${known.model.point}].`;
      rule(u, 1e-5 * fieldValue(`${point}supply_pressure`), "quiet", "supply");
      rule(u, 1e-5 * fieldValue(`${point}return_pressure`), "quiet", "return");
    },
  });
}

/** How far each window is open, in a strip at the bottom. */
function windows(u) {
  if (!known.now?.arrays.radius) return;
  const { ctx, bbox } = u, strip = STRIP * bbox.height, floor = bbox.top + bbox.height;
  const draw = (frame, dashed) => {
    for (const side of ["supply", "return"]) {
      const values = frame.arrays[`${side}_opening`], last = values.length - 1;
      const path = new Path2D();
      path.moveTo(bbox.left, floor);
      for (let k = 0; k <= last; k += 1) path.lineTo(bbox.left + k / last * bbox.width, floor - values[k] * strip * 0.9);
      path.lineTo(bbox.left + bbox.width, floor);
      ctx.strokeStyle = dashed ? colour("before") : colour(side);
      ctx.setLineDash(dashed ? beforeDash() : []);
      ctx.lineWidth = dashed ? beforeWidth(1.2) : 1.2;
      // Only one kind is filled, so that the two differ for every eye, as on the dial.
      if (!dashed && side === "supply") { ctx.globalAlpha = 0.22; ctx.fillStyle = colour(side); ctx.fill(path); ctx.globalAlpha = 1; }
      ctx.stroke(path);
    }
  };
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  draw(known.now, false);
  if (known.before?.arrays.radius) draw(known.before, true);
  ctx.restore();
}

function torque() {
  const kept = new WeakMap(); // of a frame its curve over a whole revolution
  const whole = (frame) => {
    if (!kept.has(frame)) kept.set(frame, repeated(frame));
    return kept.get(frame);
  };
  const repeated = (frame) => {
    const values = frame.arrays.torque, one = values.length - 1, { repeats } = known.model.motor;
    const by = Math.max(1, Math.floor(one * repeats / 1450)), per = Math.floor(one / by);
    const found = new Float64Array(per * repeats + 1);
    for (let k = 0; k < found.length; k += 1) found[k] = values[Math.min((k % per) * by, one)];
    return found;
  };
  return plot("torque", "Shaft torque over a revolution", {
    thickness: 1, // a long curve of more than a pixel's width takes longer than all other pictures
    x: { label: null, unit: "°", range: () => [0, 360], splits: () => [0, 60, 120, 180, 240, 300, 360], of: (frame) => angles(whole(frame).length, 360) },
    y: { label: "N·m", of: whole },
    read: (data, k) => `${significant(data[0][k], 4)}°: ${significant(data[2][k], 5)} N·m${data[1][k] === null ? "" : `, was ${significant(data[1][k], 5)}`}`,
    after: (u) => rule(u, result(known.now, "mean_torque"), "quiet", "mean"),
  });
}

function orders() {
  const percent = (frame) => {
    const mean = Math.abs(result(frame, "mean_torque"));
    return Float64Array.from(frame.arrays.torque_orders, (each) => Math.max(100 * each / mean, FLOOR));
  };
  const first = () => known.model.points[known.model.point].order; // of a mode another one
  const at = (count) => Float64Array.from({ length: count }, (_, k) => (k + 1) * first());
  return plot("orders", "Torque by shaft order", {
    log: true, bars: true,
    x: { label: null, unit: "", range: () => [0.4 * first(), ((known.now?.arrays.torque_orders?.length ?? 1) + 0.6) * first()],
      splits: () => [...at(known.now?.arrays.torque_orders?.length ?? 1)].filter((_, k, all) => all.length < 8 || k % 2 === 1), of: (frame) => at(frame.arrays.torque_orders.length) },
    y: { label: "% of mean, peak", of: percent },
    read: (data, k) => `order ${data[0][k]}: ${significant(data[2][k], 3)} %${data[1][k] === null ? "" : `, was ${significant(data[1][k], 3)}`}`,
  });
}

function work() {
  const ends = (values, factor) => {
    let low = Infinity, high = -Infinity;
    for (const each of values) { low = Math.min(low, each); high = Math.max(high, each); }
    const spare = 0.05 * (high - low);
    return [(low - spare) * factor, (high + spare) * factor];
  };
  const loop = (u, frame, name, dashed) => {
    const { ctx } = u, { volume, pressure: values } = frame.arrays;
    ctx.beginPath();
    for (let k = 0; k < volume.length; k += 1) ctx.lineTo(u.valToPos(1e6 * volume[k], "x", true), u.valToPos(1e-5 * values[k], "y", true));
    ctx.strokeStyle = colour(name);
    ctx.lineWidth = (dashed ? beforeWidth(1.9) : 1.9) * devicePixelRatio;
    ctx.setLineDash(dashed ? beforeDash() : []);
    ctx.stroke();
  };
  const nothing = (frame) => new Array(frame.arrays.volume.length).fill(null);
  return plot("work", "Work of a chamber", {
    x: { label: "cm³", unit: "", range: () => (known.now?.arrays.volume ? ends(known.now.arrays.volume, 1e6) : [0, 1]), of: (frame) => angles(frame.arrays.volume.length, 1) },
    y: { label: "bar", of: nothing, include: () => [...scaled(known.now.arrays.pressure, 1e-5), ...(known.before?.arrays.pressure ? scaled(known.before.arrays.pressure, 1e-5) : [])] },
    after: (u) => {
      if (!known.now?.arrays.volume) return;
      u.ctx.save();
      u.ctx.beginPath();
      u.ctx.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
      u.ctx.clip();
      if (known.before?.arrays.volume) loop(u, known.before, "before", true);
      loop(u, known.now, "now", false);
      u.ctx.restore();
    },
  });
}

function stress() {
  return plot("stress", "Contact stress over one period", {
    x: overPeriod, pad: [0.06, 0.08],
    y: { label: "GPa", of: (frame) => scaled(frame.arrays.stress, 1e-9) },
    read: (data, k) => `${significant(data[0][k], 4)}°: ${significant(data[2][k], 4)} GPa${data[1][k] === null ? "" : `, was ${significant(data[1][k], 4)}`}`,
    after: (u) => rule(u, 1e-9 * fieldValue("constraints.max_contact_stress"), "limit", "limit"),
  });
}

export function makePlots() { return [pressure(), torque(), orders(), work(), stress()]; }
