// Arrow keys on what a pointer could drag, and handles over a canvas that keys can reach.

import { make } from "./dom.js";
import { standing } from "./link.js";

const REST = 450; // ms without a key after which a position is kept

/**
 * Each press is a position, as of a hand that drags; once the keys rest it is kept.
 * `by(key, from, fine)` gives where a key leads, or null for a key that means nothing here; `keep`
 * gives the number under which it has asked for that.
 */
export function nudged(element, { from, by, go, keep }) {
  const kept = standing();
  let pending = null, timer = 0;
  const rest = () => {
    clearTimeout(timer);
    if (pending === null) return;
    const to = pending;
    pending = null;
    kept.put(to, keep(to));
  };
  element.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) { rest(); return; } // undo must find it kept
    const to = by(event.key, pending ?? kept.or(from()), event.shiftKey);
    if (to === null) return;
    event.preventDefault();
    pending = to;
    go(to, event.timeStamp);
    clearTimeout(timer);
    timer = setTimeout(rest, REST);
  });
}

/** Steps of a number under the keys of a slider: an arrow, a tenth or so with Shift, a page. */
export function stepOf(key, fine, [arrow, small, page]) {
  const way = { ArrowUp: 1, ArrowRight: 1, PageUp: 1, ArrowDown: -1, ArrowLeft: -1, PageDown: -1 }[key];
  if (!way) return 0;
  return way * (key.startsWith("Page") ? page : fine ? small : arrow);
}

/** A handle on a picture that keys reach; the pointer goes through it to the picture itself. */
export function grip(place, attributes) {
  const element = make("div", { class: "grip", role: "slider", tabindex: "0", ...attributes });
  place.append(element);
  const put = (name, value) => { if (element.getAttribute(name) !== value) element.setAttribute(name, value); };
  let where = "";
  return {
    element,
    at(x, y) {
      const to = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
      if (to !== where) element.style.transform = where = to;
    },
    says(now, text, low, high) {
      put("aria-valuenow", String(now));
      put("aria-valuetext", text);
      put("aria-valuemin", String(Math.min(low, now)));
      put("aria-valuemax", String(Math.max(high, now)));
    },
  };
}
