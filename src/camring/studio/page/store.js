// What the page knows: the motor in words, the numbers of now and before, and who wants to hear.

const listeners = new Map();

export const known = {
  model: null,      // the motor in words (description.py)
  choices: null,    // library, files, downloads
  now: null,        // newest frame: {head, arrays}
  before: null,     // of the pinned snapshot
  envelope: { coarse: null, fine: null, before: null },
  arrows: null,
  study: null,
  held: false,      // whether the hand moves something
};

export function on(kind, listener) {
  if (!listeners.has(kind)) listeners.set(kind, []);
  listeners.get(kind).push(listener);
}

export function tell(kind, what) {
  for (const each of listeners.get(kind) ?? []) each(what);
}

/** A result of a frame at an operating point, SI. */
export function result(frame, name, point = known.model.point) {
  const count = known.model.metrics.length;
  const rows = frame.arrays.results.length / count;
  return frame.arrays.results[Math.min(point, rows - 1) * count + known.model.metrics.indexOf(name)];
}

/** Margins of now: name, label, g, in the order of the file. */
export function margins(frame) {
  return known.model.limits.map((limit, k) => ({ ...limit, g: frame.arrays.limits[k] }));
}

/** The limit with the least margin. */
export function tightest(frame) {
  let worst = null;
  for (const each of margins(frame)) if (worst === null || each.g > worst.g) worst = each;
  return worst;
}
