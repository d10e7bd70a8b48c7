// The panel beside the picture: the numbers of the picked node or wire piece in the shape that is shown.

import { element } from "./element.js";
import { figure, place, quantitiesOf, stepOf } from "./shapes.js";
import { length, vouched, whole, withUnit } from "./wording.js";

const HINT = "Click or tap a node or a wire to read its numbers. With the keyboard: choose the picture with Tab, then the arrow keys walk from node to node.";

/** The panel; `show` fills it. */
export function panel(scene) {
  const root = element("div", { class: "pf-panel", role: "region", "aria-label": "Numbers of what is picked", "aria-live": "polite", tabindex: "0" });
  const quantities = quantitiesOf(scene);
  root.append(element("p", { class: "pf-hint" }, HINT));
  return {
    root,
    show(picked, pose) {
      if (!picked) root.replaceChildren(element("p", { class: "pf-hint" }, HINT));
      else root.replaceChildren(...(picked.kind === "node" ? ofNode : ofPiece)(scene, quantities, pose, picked.number));
    },
  };
}

function ofNode(scene, quantities, pose, node) {
  const [i, j, between] = [scene.i[node], scene.j[node], scene.between[node]];
  const title = between ? `Node ${between} beyond (${whole(i)}, ${whole(j)})` : `Node (${whole(i)}, ${whole(j)})`;
  const through = piecesAt(scene, node);
  const wires = [...new Set(through.map((piece) => wireName(scene, piece)))].join("; ");
  const rows = quantities.filter((one) => one.place === "node").map((one) => row(one.key, one.label, figure(pose, one, node), one.unit, stepOf(pose, one)));
  const forces = quantities.filter((one) => one.place === "wire" && pose.figures.has(one.of));
  return [
    element("h3", {}, title),
    element("p", { class: "pf-soft" }, wires),
    table(pose.name, coordinates(pose, node)),
    table("flat", coordinates(scene.poses[0], node, ["x0", "y0"])),
    table(null, rows.filter(Boolean)),
    ...through.map((piece) => table(
      `${wireName(scene, piece)}, piece to ${other(scene, piece, node)}`,
      forces.map((one) => row(`${one.key}:${piece}`, one.label, figure(pose, one, piece), one.unit, stepOf(pose, one))).filter(Boolean),
    )).filter((made) => forces.length && made),
  ];
}

function ofPiece(scene, quantities, pose, piece) {
  const ends = [scene.start[piece], scene.end[piece]];
  const rows = quantities.filter((one) => one.place === "wire").map((one) => row(one.key, one.label, figure(pose, one, piece), one.unit, stepOf(pose, one)));
  const [a, b] = ends.map((node) => place(pose, node));
  if (a && b) rows.push(row("chord", "distance of its ends", Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]), "mm", 1e-4));
  return [
    element("h3", {}, `Wire piece ${name(scene, ends[0])} to ${name(scene, ends[1])}`),
    element("p", { class: "pf-soft" }, wireName(scene, piece)),
    table(pose.name, rows.filter(Boolean)),
    ...ends.map((node) => table(`end ${name(scene, node)}, ${pose.name}`, coordinates(pose, node))),
    ...ends.map((node) => table(`end ${name(scene, node)}, flat`, coordinates(scene.poses[0], node, ["x0", "y0"]))),
  ];
}

function coordinates(pose, node, names = ["x", "y", "z"]) {
  const found = place(pose, node);
  if (!found) return [element("tr", {}, element("td", { colspan: 2 }, "not there any more"))];
  return names.map((axis, k) => line(axis, axis, found[k], withUnit(length(found[k]), "mm")));
}

function row(key, label, value, unit, step) {
  return Number.isFinite(value) ? line(key, label, value, withUnit(vouched(value, step), unit)) : null;
}

function line(key, label, value, text) {
  return element("tr", { "data-key": key, "data-value": value }, element("th", { scope: "row" }, label), element("td", {}, text));
}

function table(caption, rows) {
  const made = element("table", {}, element("tbody", {}, ...rows));
  if (caption) made.prepend(element("caption", {}, caption));
  return made;
}

const name = (scene, node) => `(${whole(scene.i[node])}, ${whole(scene.j[node])})${scene.between[node] ? ` + ${scene.between[node]}` : ""}`;
const other = (scene, piece, node) => name(scene, scene.start[piece] === node ? scene.end[piece] : scene.start[piece]);

/** Which wire a piece belongs to: wires along x are numbered by their j, those along y by their i. */
function wireName(scene, piece) {
  const along = scene.family[piece] === 1 ? "x" : "y";
  const number = along === "x" ? scene.j[scene.start[piece]] : scene.i[scene.start[piece]];
  return `wire along ${along}, number ${along === "x" ? "j" : "i"} = ${whole(number)}`;
}

function piecesAt(scene, node) {
  const found = [];
  for (let piece = 0; piece < scene.pieces; piece += 1) {
    if (scene.start[piece] === node || scene.end[piece] === node) found.push(piece);
  }
  return found;
}
