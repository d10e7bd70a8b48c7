// Numbers and sentences as the page writes them.

const MINUS = "\u2212";
const SPACE = "\u00a0";

/** A number to so many significant digits, with a real minus sign. */
export function significant(value, digits = 5) {
  if (!Number.isFinite(value)) return "not known";
  if (value === 0) return "0";
  const size = Math.abs(value);
  const text = size >= 1e6 || size < 1e-5 ? value.toExponential(digits - 1) : String(Number(value.toPrecision(digits)));
  return text.replace("-", MINUS);
}

/** A told number to the digits that its step vouches for. */
export function vouched(value, step) {
  const decimals = Math.floor(-Math.log10(step));
  if (decimals > 9 || decimals < 0) return significant(value, 5);
  return value.toFixed(decimals).replace(/^-(0\.?0*)$/, "$1").replace("-", MINUS);
}

/** A length to a tenth of a micrometre. */
export function length(value) {
  return `${value.toFixed(4)}`.replace(/^-(0\.0+)$/, "$1").replace("-", MINUS);
}

/** A number with its unit. */
export function withUnit(text, unit) {
  return unit && text !== "not known" ? `${text}${unit === "°" ? "" : SPACE}${unit}` : text;
}

/** A whole number with its sign. */
export function whole(value) {
  return String(value).replace("-", MINUS);
}

/** What the picture of a state shows, and in place of which shape where the colouring chose it. */
export function caption(scene, { time, reference, times, instead }) {
  const before = Math.floor(time);
  const here = scene.poses[before];
  if (time !== before) return `Between \u201c${here.name}\u201d and \u201c${scene.poses[before + 1].name}\u201d: drawn only, not computed.`;
  const enlarged = times > 1 && here.references.has(reference) ? ` Moves from ${fromWhat(reference)} are drawn ${times} times as large.` : "";
  const chosen = instead ? ` Shown because the colouring is not told of \u201c${instead.name}\u201d.` : "";
  return `${here.name[0].toUpperCase()}${here.name.slice(1)}: ${here.told}.${chosen}${enlarged}`;
}

/** A reference in a sentence. */
export function fromWhat(name) {
  return name.startsWith("the ") ? name : `the shape \u201c${name}\u201d`;
}

/** Ticks of 1, 2 or 5 times a power of ten between two values, about so many and at least three. */
export function ticks(low, high, count = 4) {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const steps = [10, 5, 2, 1, 0.5].map((part) => part * power);
  const widest = steps.findLastIndex((one) => one >= rough * 0.999);
  return steps.slice(widest).map((step) => multiples(step, low, high)).find((found) => found.length >= 3) ?? [];
}

function multiples(step, low, high) {
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k += 1) found.push(k * step);
  return found.map((value) => Number(value.toPrecision(6)));
}

/** The largest of 1, 2, 5 times a power of ten that is not above a positive value. */
export function roundDown(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return Number((Math.max(...[1, 2, 5].filter((part) => part * power <= value)) * power).toPrecision(3));
}
