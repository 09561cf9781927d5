// A search under way: its convergence, pause, stop, and its designs into the hand.

import { byId, canvasIn, make } from "./dom.js";
import { ask } from "./link.js";
import { significant } from "./numbers.js";
import { known, on, tell } from "./store.js";
import { colour, fontSize } from "./theme.js";
import { walked } from "./walk.js";

const STATES = { starting: "begins", running: "searches", paused: "is paused", stopped: "was stopped", done: "is done", failed: "has failed" };

export function makeStudy() {
  const place = byId("study");
  const button = (text, testid, op, words) => make("button", { type: "button", class: "button", "data-testid": testid, onclick: () => ask(op, words?.() ?? {}) }, text);
  const title = make("h2", { "data-testid": "study-state" }), line = make("p", { class: "quiet" }), best = make("p", { "data-testid": "study-best" }), under = make("p", { "aria-live": "polite" }), bar = make("progress", { max: "1", value: "0" });
  const pause = button("Pause", "pause", "pause"), go = button("Go on", "continue", "continue"), stop = button("Stop", "stop", "stop"), take = button("Take over the best", "take-best", "take");
  take.classList.add("primary");
  const report = make("a", { class: "button", target: "_blank", rel: "noopener", text: "Report", "data-testid": "study-report" });
  const close = make("button", { type: "button", class: "button plain", "aria-label": "Close the study", onclick: () => { place.hidden = true; dispatchEvent(new Event("resize")); } }, "✕");
  const body = make("div", { class: "body" });
  place.append(make("div", { class: "words" }, title, bar, make("div", { class: "row-of-buttons" }, pause, go, stop, take, report, close), line, best, under), body);
  let spots = [], hover = null;
  const picture = canvasIn(body, draw, { "data-testid": "plot-study", role: "application", tabindex: "0", "aria-label": "Ripple of every design of the search; arrow keys choose one, Enter takes it" });

  on("study", (message) => {
    known.study = message;
    place.hidden = false;
    tell("opened beside", "study");
    const { trials, state } = message, feasible = trials.filter((each) => each[4]).length;
    title.textContent = `${message.folder} ${STATES[state] ?? state}`;
    bar.value = String(trials.length / Math.max(message.budget, 1));
    line.textContent = message.sentence || `${trials.length} of ${message.budget} designs evaluated, ${feasible} keep every limit. Click one, or choose with ← → and press Enter, to take it into the hand.`;
    const found = trials.find((each) => each[0] === message.best);
    best.textContent = found ? `Best so far: ripple ${significant(100 * found[2], 3)} %, efficiency ${significant(100 * found[3], 4)} %` : trials.length ? "No design keeps every limit yet." : "";
    const running = state === "running" || state === "starting";
    pause.hidden = !running; stop.hidden = !running;
    go.hidden = !["paused", "stopped"].includes(state);
    take.disabled = !found;
    report.hidden = state !== "done";
    report.href = `report/${encodeURIComponent(message.folder)}`;
    picture.redraw();
  });
  on("theme", () => picture.redraw());
  // One strip at the bottom leaves room for the pictures; what still runs keeps its own.
  on("opened beside", (other) => { if (other !== "study" && !["running", "starting"].includes(known.study?.state)) place.hidden = true; });

  function draw(context, width, height) {
    const message = known.study;
    if (!message) return;
    const rows = message.trials.filter((each) => each[2] !== null && each[2] > 0);
    const size = fontSize(), left = 3.6 * size, bottom = 1.6 * size, top = 6, right = 10;
    context.font = `${Math.round(0.78 * size)}px system-ui, sans-serif`;
    context.fillStyle = colour("quiet");
    if (!rows.length) { context.fillText("The first designs are being evaluated.", left, height / 2); return; }
    let low = Infinity, high = 0;
    for (const each of rows) { low = Math.min(low, 100 * each[2]); high = Math.max(high, 100 * each[2]); }
    const logs = [Math.log10(low) - 0.06, Math.log10(Math.max(high, low * 1.2)) + 0.06], most = Math.max(message.budget, rows.length);
    const x = (trial) => left + (trial + 0.5) / most * (width - left - right), y = (ripple) => top + (logs[1] - Math.log10(100 * ripple)) / (logs[1] - logs[0]) * (height - top - bottom);
    context.strokeStyle = colour("line");
    context.textAlign = "right";
    for (let power = Math.floor(logs[0]); power <= logs[1]; power += 1) for (const times of [1, 2, 5]) {
      const value = times * 10 ** power, at = y(value / 100);
      if (at < top || at > height - bottom) continue;
      context.beginPath(); context.moveTo(left, at); context.lineTo(width - right, at); context.stroke();
      context.fillText(`${Number(value.toPrecision(2))} %`, left - 5, at + 4);
    }
    context.textAlign = "left";
    context.fillText("torque ripple of each design, at the first operating point", left, height - 4);
    spots = rows.map((each) => [x(each[0]), y(each[2]), each]);
    for (const [px, py, each] of spots) {
      context.beginPath();
      context.arc(px, py, each[0] === hover ? 5.5 : 3.2, 0, 2 * Math.PI);
      context.fillStyle = each[4] ? colour("now") : "transparent";
      context.strokeStyle = each[4] ? colour("now") : colour("limit");
      context.fill();
      context.stroke();
    }
    let lowest = Infinity;
    context.beginPath();
    for (const [px, py, each] of spots) if (each[4] && each[1] < lowest) { lowest = each[1]; context.lineTo(px, py); }
    context.strokeStyle = colour("now");
    context.lineWidth = 1.5;
    context.stroke();
    context.lineWidth = 1;
  }

  walked(picture, () => spots.map(([x, y, each]) => [x, y, each[0]]), {
    choose: (trial) => { hover = trial; tellDesign(); picture.redraw(); },
    take: (trial) => ask("take", { trial }),
  });

  function tellDesign() {
    const each = known.study?.trials.find((one) => one[0] === hover);
    under.textContent = each ? `Design ${each[0]}: ripple ${significant(100 * each[2], 3)} %, efficiency ${significant(100 * each[3], 4)} %, ${each[4] ? "keeps every limit" : "breaks a limit"}` : "";
  }
}
