// The legend: name and unit of what is coloured, the colours, ticks, and what lies beyond them.

import { asGradient } from "./colours.js";
import { element } from "./element.js";
import { significant, ticks, withUnit } from "./wording.js";

/** An end of the bar that a value passes by less than a rounding is not passed. */
const WITHIN = 1 + 1e-6;

/** The legend of a scene; `show` fills it. */
export function legend(scene) {
  const name = element("div", { class: "pf-legend-name" });
  const bar = element("div", { class: "pf-bar" });
  const marks = element("div", { class: "pf-ticks", "aria-hidden": "true" });
  const extent = element("div", { class: "pf-extent" });
  const families = element("div", { class: "pf-families" }, ...[1, 2].filter((family) => scene.family.includes(family))
    .map((family) => element("span", {}, element("i", { class: `pf-swatch pf-swatch${family}` }), ` wires along ${"xy"[family - 1]}`)));
  const root = element("div", { class: "pf-legend", role: "group", "aria-label": "Legend" }, name, families, bar, marks, extent);
  return {
    root,
    show(quantity, range, map, poseName) {
      root.classList.toggle("pf-empty", !range);
      families.hidden = Boolean(quantity);
      if (!quantity) {
        name.textContent = "One colour for each family of wires";
        extent.textContent = "";
        return;
      }
      const unit = quantity.unit ? ` [${quantity.unit}]` : "";
      name.textContent = `${capital(quantity.label)}${unit}`;
      if (!range) {
        extent.textContent = `not told of the shape \u201c${poseName}\u201d`;
        return;
      }
      bar.style.background = asGradient(map);
      const share = (value) => (value - range.low) / (range.high - range.low);
      const told = ticks(range.low, range.high).map((value) => tick(share(value), significant(value, 4), "pf-tick"));
      const noted = quantity.marks.filter((one) => share(one.value) > 0 && share(one.value) < 1)
        .map((one) => element("span", { class: "pf-mark", style: `left:${100 * share(one.value)}%`, title: one.label }));
      const beyond = [["low", range.least < range.low * WITHIN], ["high", range.largest > range.high * WITHIN]].filter(([, is]) => is);
      bar.replaceChildren(...noted, ...beyond.map(([end]) => arrow(end, map)));
      marks.replaceChildren(...told);
      const [least, largest] = [significant(range.least, 4), withUnit(significant(range.largest, 4), quantity.unit)];
      const words = [`all values from ${least} to ${largest}${beyond.length ? " (arrow: off the bar)" : ""}`];
      const named = quantity.marks.find((one) => one.label);
      if (named) {
        const value = withUnit(significant(Math.abs(named.value), 4), quantity.unit);
        words.push(noted.length ? `line: ${named.label} ${value}` : `${named.label} ${value} is farther off`);
      }
      if (quantity.note) words.push(quantity.note);
      extent.textContent = words.join("; ");
    },
  };
}

/** The pointed end of a bar beyond which there are values. */
function arrow(end, map) {
  const [r, g, b] = end === "low" ? map : map.slice(-4);
  return element("span", { class: `pf-beyond pf-beyond-${end}`, style: `background:rgb(${r},${g},${b})` });
}

function tick(share, text, kind) {
  const side = share < 0.04 ? " pf-first" : share > 0.96 ? " pf-last" : "";
  return element("span", { class: kind + side, style: `left:${100 * share}%` }, text);
}

const capital = (text) => text[0].toUpperCase() + text.slice(1);
