// Colour maps of even steps to the eye: one for what begins at zero, one that parts at zero; for light and dark ground.
// On both grounds small values are near the ground and large ones stand out.

const RISING = {
  light: ["#c5cdb9", "#86bf94", "#3f9f8c", "#2b7a8c", "#355a8a", "#43307a", "#3a0a52"],
  dark: ["#3b3f7a", "#31688e", "#21918c", "#35b779", "#90d743", "#fde725"],
};
const PARTED = {
  light: ["#0a2f66", "#2f73b8", "#aab0b8", "#cf5a34", "#7a1210"],
  dark: ["#a6d4ff", "#4690d8", "#4c545e", "#e07440", "#ffd3ad"],
};
const SHADES = 256;

/** The map for a range: parted for a signed quantity on both sides of zero, else away from zero to the side it lies on. */
export function mapFor(signed, { low, high }) {
  if (signed && low < 0 && high > 0) return "parted";
  return high > 0 ? "rising" : "falling";
}

/** The colours (256 x 4 bytes) of a map, "parted", "rising" or "falling", on a ground, "light" or "dark". */
export function colourMap(kind, ground) {
  const parted = kind === "parted";
  const stops = (parted ? PARTED : RISING)[ground].map((stop) => toLab(rgb(stop).map(toLinear)));
  if (kind === "falling") stops.reverse();
  const middle = (stops.length - 1) / 2;
  const halves = parted ? [stops.slice(0, middle + 1), stops.slice(middle)] : [stops];
  const bytes = new Uint8Array(4 * SHADES);
  for (let k = 0; k < SHADES; k += 1) {
    const share = (halves.length * k) / (SHADES - 1);
    const half = Math.min(Math.floor(share), halves.length - 1);
    bytes.set([...fromLab(evenly(halves[half], share - half)).map(toByte), 255], 4 * k);
  }
  return bytes;
}

/** A map as stops of a CSS gradient. */
export function asGradient(map) {
  const stops = [];
  for (let k = 0; k < SHADES; k += 15) stops.push(`rgb(${map[4 * k]},${map[4 * k + 1]},${map[4 * k + 2]})`);
  return `linear-gradient(to right, ${stops.join(", ")})`;
}

/** [r, g, b] from 0 to 1 of a colour such as #1d2733 or rgb(29, 39, 51). */
export function rgb(text) {
  const hex = /^#([0-9a-f]{6})$/i.exec(text.trim());
  if (hex) return [0, 2, 4].map((k) => parseInt(hex[1].slice(k, k + 2), 16) / 255);
  const parts = text.match(/[\d.]+/g) ?? [];
  return parts.length < 3 ? [0.5, 0.5, 0.5] : parts.slice(0, 3).map((part) => Number(part) / 255);
}

/** The colour after a share of the way along stops, the way as long as it looks. */
function evenly(stops, share) {
  const steps = stops.slice(1).map((stop, k) => Math.hypot(...stop.map((value, axis) => value - stops[k][axis])));
  let left = share * steps.reduce((a, b) => a + b, 0);
  let k = 0;
  while (k < steps.length - 1 && left > steps[k]) {
    left -= steps[k];
    k += 1;
  }
  return stops[k].map((value, axis) => value + Math.min(1, left / steps[k]) * (stops[k + 1][axis] - value));
}

const toByte = (value) => Math.round(255 * toGamma(Math.min(1, Math.max(0, value))));

// Oklab: steps of equal size look equally large.
function toLab([r, g, b]) {
  const l = Math.cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const m = Math.cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const s = Math.cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return [
    0.2104542553 * l + 0.793617785 * m - 0.0040720468 * s,
    1.9779984951 * l - 2.428592205 * m + 0.4505937099 * s,
    0.0259040371 * l + 0.7827717662 * m - 0.808675766 * s,
  ];
}

function fromLab([L, a, b]) {
  const l = (L + 0.3963377774 * a + 0.2158037573 * b) ** 3;
  const m = (L - 0.1055613458 * a - 0.0638541728 * b) ** 3;
  const s = (L - 0.0894841775 * a - 1.291485548 * b) ** 3;
  return [
    4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
    -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
    -0.0041960863 * l - 0.7034186147 * m + 1.707614701 * s,
  ];
}

const toLinear = (value) => (value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4);
const toGamma = (value) => (value <= 0.0031308 ? 12.92 * value : 1.055 * value ** (1 / 2.4) - 0.055);
