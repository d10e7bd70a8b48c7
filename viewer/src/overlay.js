// What lies over the picture: the directions x, y, z, a bar for the scale, and a ring around what is picked.

import { Vector3 } from "three";
import { roundDown } from "./wording.js";

const SVG = "http://www.w3.org/2000/svg";
const ARM = 24;
const LONGEST = 140;

/** The overlay; `show` draws it anew. */
export function overlay() {
  const root = drawn("svg", { class: "pf-overlay", "aria-hidden": "true" });
  const arms = ["x", "y", "z"].map((name) => {
    const line = drawn("line", { class: "pf-arm" });
    const text = drawn("text", { class: "pf-arm-name", "text-anchor": "middle", dy: "0.35em" });
    text.textContent = name;
    root.append(line, text);
    return { line, text };
  });
  const bar = drawn("path", { class: "pf-scale" });
  const size = drawn("text", { class: "pf-scale-name" });
  const ring = drawn("circle", { class: "pf-ring", r: 8 });
  root.append(bar, size, ring);
  return {
    root,
    show(stage, width, height, spot) {
      root.setAttribute("viewBox", `0 0 ${width} ${height}`);
      const [cx, cy] = [46, height - 46];
      arms.forEach(({ line, text }, axis) => {
        const way = new Vector3().setComponent(axis, 1).transformDirection(stage.camera.matrixWorldInverse);
        set(line, { x1: cx, y1: cy, x2: cx + ARM * way.x, y2: cy - ARM * way.y });
        set(text, { x: cx + (ARM + 10) * way.x, y: cy - (ARM + 10) * way.y, opacity: Math.hypot(way.x, way.y) < 0.25 ? 0 : 1 });
      });
      const longest = Math.min(LONGEST, width / 3) / stage.scale;
      const length = roundDown(longest);
      const [right, base] = [width - 16, height - 18];
      bar.setAttribute("d", `M${right - length * stage.scale} ${base - 5}v5H${right}v-5`);
      size.textContent = `${length} mm`;
      set(size, { x: right - (length * stage.scale) / 2, y: base - 7, "text-anchor": "middle" });
      ring.style.display = spot ? "" : "none";
      if (spot) set(ring, { cx: spot[0], cy: spot[1] });
    },
  };
}

function drawn(tag, attributes) {
  const made = document.createElementNS(SVG, tag);
  set(made, attributes);
  return made;
}

function set(node, attributes) {
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
}
