// Small helpers for elements.

export function make(tag, attributes = {}, ...children) {
  const svg = ["svg", "path", "circle", "line", "text", "g", "rect"].includes(tag);
  const element = svg ? document.createElementNS("http://www.w3.org/2000/svg", tag) : document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (name === "text") element.textContent = value;
    else if (name in element && !svg && typeof value !== "string") element[name] = value;
    else element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...children.filter((each) => each !== null && each !== undefined));
  return element;
}

export const byId = (id) => document.getElementById(id);

/** Head and body of a panel; the reading at its right tells numbers under the pointer. */
export function panel(name, title, testid = `panel-${name}`) {
  const element = document.querySelector(`[data-panel="${name}"]`);
  element.dataset.testid = testid;
  element.setAttribute("aria-label", title);
  const reading = make("span", { class: "reading" });
  const heading = make("h2", { text: title });
  const head = make("header", {}, heading, reading);
  const body = make("div", { class: "body" });
  const tools = make("div", { class: "tools" });
  element.replaceChildren(head, body, tools);
  return { element, head, heading, reading, body, tools };
}

/** A canvas that keeps the size of its place; `draw(context, width, height)` in CSS pixels. */
export function canvasIn(place, draw, attributes = {}) {
  const canvas = make("canvas", attributes);
  place.append(canvas);
  let width = 0, height = 0;
  const redraw = () => {
    if (!width || !height) return;
    const context = canvas.getContext("2d");
    const dense = devicePixelRatio || 1;
    context.setTransform(dense, 0, 0, dense, 0, 0);
    context.clearRect(0, 0, width, height);
    draw(context, width, height);
  };
  new ResizeObserver(() => {
    const dense = devicePixelRatio || 1;
    width = place.clientWidth;
    height = place.clientHeight;
    canvas.width = Math.round(width * dense);
    canvas.height = Math.round(height * dense);
    redraw();
  }).observe(place);
  return { canvas, redraw, size: () => [width, height] };
}

/** For a screen reader alone: what keys have just read off a picture. */
export function hear(words) { byId("heard").textContent = words; }

let timer = 0;
export function say(sentence, seconds = 6) {
  const place = byId("say");
  place.textContent = sentence;
  place.classList.add("shown");
  clearTimeout(timer);
  timer = setTimeout(() => place.classList.remove("shown"), 1000 * seconds);
}
