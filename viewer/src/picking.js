// What lies under a finger or the pointer: the nearest node, or the wire piece where no node is near.

import { Vector3 } from "three";

const NEAR = 14;
/** So much farther away on the screen [pixels] a node may be for being nearer to the eye. */
const AS_NEAR = 4;

/** {kind: "node" | "wire", number} at a place of the canvas [pixels], null when nothing is there. */
export function pick(scene, points, camera, size, spot, shown) {
  const screen = projected(points, camera, size);
  const node = nearestNode(screen, spot, shown.node);
  const wire = nearestPiece(scene, screen, spot, shown.piece);
  const piece = wire && Math.hypot(
    screen[3 * scene.start[wire.number]] - screen[3 * scene.end[wire.number]],
    screen[3 * scene.start[wire.number] + 1] - screen[3 * scene.end[wire.number] + 1],
  );
  if (node && (!wire || node.away <= Math.max(6, 0.3 * piece))) return { kind: "node", number: node.number };
  return wire && wire.away <= NEAR / 2 ? { kind: "wire", number: wire.number } : null;
}

/** x, y in pixels and the depth of every node (3 n). */
function projected(points, camera, [width, height]) {
  const e = camera.projectionMatrix.clone().multiply(camera.matrixWorldInverse).elements;
  const screen = new Float32Array(points.length);
  for (let k = 0; k < points.length; k += 3) {
    const [x, y, z] = [points[k], points[k + 1], points[k + 2]];
    screen[k] = 0.5 * width * (1 + e[0] * x + e[4] * y + e[8] * z + e[12]);
    screen[k + 1] = 0.5 * height * (1 - e[1] * x - e[5] * y - e[9] * z - e[13]);
    screen[k + 2] = e[2] * x + e[6] * y + e[10] * z + e[14];
  }
  return screen;
}

function nearestNode(screen, [x, y], shown) {
  const near = [];
  let least = NEAR;
  for (let k = 0; k < screen.length; k += 3) {
    const away = Math.hypot(screen[k] - x, screen[k + 1] - y);
    if (away < least + AS_NEAR && shown(k / 3)) {
      near.push({ number: k / 3, away, depth: screen[k + 2] });
      least = Math.min(least, away);
    }
  }
  const best = near.filter((one) => one.away <= least + AS_NEAR && one.away < NEAR).sort((a, b) => a.away - b.away);
  if (!best.length) return null;
  // Of nodes at one spot, as on the near and the far side of a dome, the one towards the eye.
  const spread = Math.max(...best.map((one) => one.depth)) - Math.min(...best.map((one) => one.depth));
  return spread < 0.02 ? best[0] : best.reduce((a, b) => (b.depth < a.depth - 0.01 ? b : a));
}

function nearestPiece(scene, screen, [x, y], shown) {
  let best = null;
  for (let piece = 0; piece < scene.pieces; piece += 1) {
    const [a, b] = [3 * scene.start[piece], 3 * scene.end[piece]];
    const [ax, ay] = [screen[a], screen[a + 1]];
    const [dx, dy] = [screen[b] - ax, screen[b + 1] - ay];
    const along = Math.min(1, Math.max(0, ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1)));
    const away = Math.hypot(ax + along * dx - x, ay + along * dy - y);
    if (away < NEAR && shown(piece) && (!best || away < best.away)) best = { number: piece, away };
  }
  return best;
}

/** The node one step from a node along i or j, null at the edge. */
export function neighbour(scene, table, node, axis, step) {
  const wanted = [scene.i[node], scene.j[node]];
  wanted[axis] += step;
  return table.get(`${wanted[0]},${wanted[1]}`) ?? null;
}

/** Node numbers of all crossings by "i,j". */
export function crossings(scene) {
  const table = new Map();
  for (let node = 0; node < scene.nodes; node += 1) {
    if (scene.between[node] === 0) table.set(`${scene.i[node]},${scene.j[node]}`, node);
  }
  return table;
}

/** The middle of a piece, or the place of a node, among drawn points. */
export function spotOf(scene, points, picked) {
  const nodes = picked.kind === "node" ? [picked.number] : [scene.start[picked.number], scene.end[picked.number]];
  const sum = new Vector3();
  for (const node of nodes) sum.add(new Vector3().fromArray(points, 3 * node));
  return sum.divideScalar(nodes.length).toArray();
}
