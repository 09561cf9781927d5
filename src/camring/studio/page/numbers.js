// Numbers as people write them: units, digits, steps.

export function fromSi(value, unit) { return (value - unit[2]) / unit[1]; }
export function toSi(value, unit) { return value * unit[1] + unit[2]; }

/** So many significant digits, without an exponent where people avoid one. */
export function significant(value, digits = 4) {
  if (!Number.isFinite(value)) return "–";
  if (value === 0 || Math.abs(value) < 1e-300) return "0";
  const power = Math.floor(Math.log10(Math.abs(value)));
  if (power < -5 || power > 8) return value.toExponential(digits - 1).replace("-", "−").replace("e−", "e-").replace("e+", "e");
  return value.toFixed(Math.max(digits - 1 - power, 0)).replace("-", "−");
}

const BEYOND = 1e6; // a margin further out is that of a result without bounds, an undercut ring's stress say

/** A margin in per cent, without its sign. */
export function percent(margin, digits = 2) { return Math.abs(margin) > BEYOND ? "∞" : significant(100 * Math.abs(margin), digits); }

/** Of a length of slider: some four hundredths of it. */
export function step(range) { return range > 0 ? nice(range / 400) : 1; }

/** 1, 2 or 5 times a power of ten, not below a number. */
export function nice(raw) {
  const power = 10 ** Math.floor(Math.log10(raw));
  for (const times of [1, 2, 5]) if (times * power >= raw * 0.999) return times * power;
  return 10 * power;
}

/** Rounded to a step, written with as many decimals as the step has. */
export function rounded(value, by) {
  const decimals = Math.max(0, -Math.floor(Math.log10(by) + 1e-9));
  return Number((Math.round(value / by) * by).toFixed(Math.min(decimals, 15)));
}

/** As a motor file holds it: a dot, no thousands, no more digits than the number needs. */
export function written(value) {
  if (!Number.isFinite(value)) return "";
  const text = Number(value.toPrecision(12)).toString();
  return text;
}

/** As people type numbers: a typesetter's minus, and a decimal comma unless it could part thousands. */
export function typed(text) {
  const plain = text.trim().replaceAll("−", "-"), found = /^([+-]?\d*),(\d+)(?![\d.,])/.exec(plain);
  if (!found || (found[2].length === 3 && /[1-9]/.test(found[1]))) return plain;
  return `${found[1]}.${plain.slice(found[1].length + 1)}`;
}

/** A result in the engineer's unit. */
export function shown(quantity, si) { return significant(si * quantity.factor, quantity.digits); }

/** A step that does not lead out of the map, nor a point that lies outside back by more than itself. */
export function within(from, to, [low, high]) { return to > from ? Math.min(to, Math.max(from, high)) : Math.max(to, Math.min(from, low)); }

/** Which of the values lies nearest. */
export function nearest(values, wanted) {
  let best = 0;
  values.forEach((each, k) => { if (Math.abs(each - wanted) < Math.abs(values[best] - wanted)) best = k; });
  return best;
}

/** In which cell a value lies, and how far into it. */
export function cell(values, wanted, measure) {
  if (values.length < 2) return [0, 0];
  let k = 0;
  while (k < values.length - 2 && wanted > values[k + 1]) k += 1;
  const part = (measure(wanted) - measure(values[k])) / (measure(values[k + 1]) - measure(values[k]));
  return [k, Math.min(1, Math.max(0, part))];
}
