// A front of compromises, whose designs go into the hand, or what tolerances make of the motor.

import { byId, canvasIn, make } from "./dom.js";
import { ask } from "./link.js";
import { significant } from "./numbers.js";
import { known, on, tell } from "./store.js";
import { colour, fontSize } from "./theme.js";
import { walked } from "./walk.js";

const TITLES = { pareto: "Compromises", tolerance: "Tolerances" };
const STATES = { running: "being computed", done: "done", failed: "failed", stopped: "stopped" };

export function makeAnalysis() {
  const place = byId("analysis");
  const title = make("h2", { "data-testid": "analysis-state" }), line = make("p", { class: "quiet", "data-testid": "analysis-words" }), under = make("p", { "aria-live": "polite" });
  const stop = make("button", { type: "button", class: "button", "data-testid": "stop-analysis", onclick: () => ask("end_analysis") }, "Stop");
  const close = make("button", { type: "button", class: "button plain", "aria-label": "Close the analysis", onclick: () => { place.hidden = true; } }, "✕");
  const body = make("div", { class: "body" }), text = make("pre", { class: "printed", tabindex: "0", "data-testid": "tolerance-text" });
  place.append(make("div", { class: "words" }, title, make("div", { class: "row-of-buttons" }, stop, close), line, under), body);
  let message = null, spots = [], chosen = null;
  const picture = canvasIn(body, draw, { "data-testid": "plot-front", role: "application", tabindex: "0" });
  body.append(text);

  on("analysis", (news) => {
    message = news;
    chosen = null;
    place.hidden = false;
    tell("opened beside", "analysis");
    const front = news.kind === "pareto";
    title.textContent = `${TITLES[news.kind]}: ${STATES[news.state]}`;
    line.textContent = news.sentence || (news.state === "running" ? "Takes from some seconds to some minutes; the hand may go on meanwhile." : "");
    if (news.designs) line.textContent += " Click one, or choose with ← → and press Enter, to take it into the hand.";
    under.textContent = "";
    stop.hidden = news.state !== "running";
    picture.canvas.hidden = !front;
    picture.canvas.setAttribute("aria-label", front && news.of ? `Front of ${news.of.map(named).join(" and ")}; arrow keys choose a design, Enter takes it` : "Front");
    text.hidden = front;
    text.textContent = news.text ?? "";
    picture.redraw();
  });
  on("theme", () => picture.redraw());
  on("opened beside", (other) => { if (other !== "analysis" && message?.state !== "running") place.hidden = true; });

  const named = (name) => known.model.quantities[name]?.label.toLowerCase() ?? name;
  const shown = (name, value) => { const each = known.model.quantities[name]; return each ? `${significant(value * each.factor, 4)} ${each.unit}` : significant(value, 4); };

  function draw(context, width, height) {
    spots = [];
    if (!message?.designs?.length) return;
    const size = fontSize(), left = 4.6 * size, bottom = 2.8 * size, top = 8, right = 14;
    const ends = [0, 1].map((k) => {
      const values = [...message.designs, message.given].map((each) => each[k]), low = Math.min(...values), high = Math.max(...values), room = 0.06 * (high - low || Math.abs(high) || 1);
      return [low - room, high + room];
    });
    const x = (value) => left + (value - ends[0][0]) / (ends[0][1] - ends[0][0]) * (width - left - right);
    const y = (value) => top + (ends[1][1] - value) / (ends[1][1] - ends[1][0]) * (height - top - bottom);
    context.font = `${Math.round(0.78 * size)}px system-ui, sans-serif`;
    context.strokeStyle = colour("line");
    context.strokeRect(left, top, width - left - right, height - top - bottom);
    context.fillStyle = colour("quiet");
    context.textAlign = "center";
    const [across, up] = message.of;
    for (const part of [0.1, 0.5, 0.9]) { const value = ends[0][0] + part * (ends[0][1] - ends[0][0]); context.fillText(shown(across, value), x(value), height - bottom + size); }
    context.fillText(named(across), (left + width) / 2, height - 4);
    context.textAlign = "right";
    for (const part of [0.1, 0.5, 0.9]) { const value = ends[1][0] + part * (ends[1][1] - ends[1][0]); context.fillText(shown(up, value), left - 5, y(value) + 4); }
    context.textAlign = "left";
    context.fillText(named(up), left + 6, top + size);
    const dot = (each, radius, fill, edge) => { context.beginPath(); context.arc(x(each[0]), y(each[1]), radius, 0, 2 * Math.PI); context.fillStyle = fill; context.fill(); context.strokeStyle = edge; context.lineWidth = 1.6; context.stroke(); context.lineWidth = 1; };
    dot(message.given, 5, "transparent", colour("before"));
    context.fillStyle = colour("quiet");
    context.fillText("in the hand at the start", Math.min(x(message.given[0]) + 9, width - 13 * size), y(message.given[1]) - 6);
    message.designs.forEach((each, k) => {
      spots.push([x(each[0]), y(each[1]), k + 1]);
      dot(each, k + 1 === chosen ? 6.5 : 4, colour("now"), k + 1 === chosen ? colour("ink") : colour("now"));
    });
  }

  walked(picture, () => spots.map(([x, y, number]) => [x, y, number]), {
    choose: (number) => {
      chosen = number;
      under.textContent = number === null ? "" : `Design ${number}: ${message.of.map((name, k) => `${named(name)} ${shown(name, message.designs[number - 1][k])}`).join(", ")}`;
      picture.redraw();
    },
    take: (number) => ask("take_compromise", { design: number }),
  });
}
