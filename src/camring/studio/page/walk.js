// Spots of a picture under pointer and keys: one is chosen, a click or Enter takes it.

const NEAR = 12; // pixels

/** `spots()` gives x, y and the number of each; `choose` gets a number or null, `take` a number. */
export function walked({ canvas }, spots, { choose, take }) {
  let chosen = null;
  const set = (number) => { if (number !== chosen) { chosen = number; choose(number); } };
  const under = (event) => {
    const box = canvas.getBoundingClientRect(), px = event.clientX - box.left, py = event.clientY - box.top;
    return spots().reduce((found, [x, y, number]) => { const away = Math.hypot(x - px, y - py); return away < NEAR && away < (found?.[0] ?? NEAR) ? [away, number] : found; }, null)?.[1] ?? null;
  };
  canvas.addEventListener("pointermove", (event) => { set(under(event)); canvas.style.cursor = chosen === null ? "" : "pointer"; });
  canvas.addEventListener("click", (event) => { const number = under(event); if (number !== null) take(number); });
  canvas.addEventListener("keydown", (event) => {
    const numbers = spots().map((each) => each[2]), at = numbers.indexOf(chosen), last = numbers.length - 1;
    const to = { ArrowRight: Math.min(at + 1, last), ArrowLeft: at < 0 ? last : Math.max(at - 1, 0), Home: 0, End: last }[event.key];
    if (to !== undefined && last >= 0) { event.preventDefault(); set(numbers[to]); }
    else if (event.key === "Enter" && chosen !== null) { event.preventDefault(); take(chosen); }
  });
}
