// Margins to every limit as bars that redden; the one that stops the hand is lit.

import { make, panel } from "./dom.js";
import { percent } from "./numbers.js";
import { known, margins, on, tell, tightest } from "./store.js";

const NEAR = 0.02; // of a limit's own scale

export function makeMargins() {
  const { body, reading } = panel("margins", "Margins to the limits");
  const list = make("div", { class: "bars", "data-testid": "plot-margins" });
  body.append(list);
  let rows = [], chosen = null;

  on("described", () => {
    rows = known.model.limits.map((limit) => {
      const parts = {
        fill: make("span", { class: "fill" }), ghost: make("span", { class: "ghost" }),
        share: make("span", { class: "share", "data-testid": `margin-${limit.name}` }),
        stops: make("span", { class: "stops", text: "stops", title: "This limit stops you: it has the least margin", hidden: true }),
      };
      const name = make("span", { class: "name", title: `${limit.label}: ${limit.text}` }, limit.label, parts.stops);
      const element = make("button", { type: "button", class: "margin", "data-limit": limit.name, title: "Show which numbers widen the margin to this limit", onclick: () => choose(limit.name) },
        make("span", { class: "track" }, parts.fill, parts.ghost), name, parts.share);
      return { limit, element, ...parts };
    });
    list.replaceChildren(...rows.map((row) => row.element));
  });
  on("show limit", choose);

  function choose(name) {
    chosen = chosen === name ? null : name;
    tell("aim", chosen === null ? "torque_ripple" : `limit:${chosen}`);
    for (const row of rows) row.element.setAttribute("aria-pressed", String(row.limit.name === chosen));
    rows.find((row) => row.limit.name === chosen)?.element.scrollIntoView({ block: "nearest" });
  }

  function draw() {
    const { now, before, model } = known;
    const worst = tightest(now);
    const same = before && before.arrays.limits.length === model.limits.length;
    let broken = 0;
    margins(now).forEach((each, k) => {
      const row = rows[k], margin = -each.g;
      const width = `${(100 * Math.min(1, Math.max(Math.abs(margin), 0.006))).toFixed(1)}%`;
      if (row.fill.style.width !== width) row.fill.style.width = width;
      row.element.classList.toggle("broken", margin < 0);
      row.element.classList.toggle("near", margin >= 0 && margin < NEAR);
      row.element.classList.toggle("binding", each.name === worst.name);
      row.stops.hidden = each.name !== worst.name || margin > NEAR;
      row.ghost.hidden = !same;
      row.ghost.style.width = same ? `${100 * Math.min(1, Math.max(-before.arrays.limits[k], 0))}%` : "0";
      const text = margin < 0 ? `−${percent(margin)} %` : `${percent(margin, margin > 1 ? 3 : 2)} %`;
      if (row.share.textContent !== text) row.share.textContent = text;
      broken += margin < 0;
    });
    const words = broken ? `${broken} broken at the operating points` : "all kept at the operating points";
    if (reading.textContent !== words) reading.textContent = words;
  }

  return { draw };
}
