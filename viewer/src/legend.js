// The legend: name and unit of what is coloured, the colours, ticks, and what lies beyond them.

import { asGradient } from "./colours.js";
import { element } from "./element.js";
import { significant, ticks, withUnit } from "./wording.js";

/** A legend; `show` fills it. */
export function legend() {
  const name = element("div", { class: "pf-legend-name" });
  const bar = element("div", { class: "pf-bar" });
  const marks = element("div", { class: "pf-ticks", "aria-hidden": "true" });
  const extent = element("div", { class: "pf-extent" });
  const root = element("div", { class: "pf-legend", role: "group", "aria-label": "Legend" }, name, bar, marks, extent);
  return {
    root,
    show(quantity, range, map, poseName) {
      root.classList.toggle("pf-empty", !range);
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
      bar.replaceChildren(...noted);
      marks.replaceChildren(...told);
      const [least, largest] = [significant(range.least, 4), withUnit(significant(range.largest, 4), quantity.unit)];
      const words = [`all values from ${least} to ${largest}`];
      const named = quantity.marks.filter((one) => one.label);
      if (named.length && noted.length) {
        words.push(`line: ${named[0].label} ${withUnit(significant(Math.abs(named[0].value), 4), quantity.unit)}`);
      }
      if (quantity.note) words.push(quantity.note);
      extent.textContent = words.join("; ");
    },
  };
}

function tick(share, text, kind) {
  const side = share < 0.04 ? " pf-first" : share > 0.96 ? " pf-last" : "";
  return element("span", { class: kind + side, style: `left:${100 * share}%` }, text);
}

const capital = (text) => text[0].toUpperCase() + text.slice(1);
