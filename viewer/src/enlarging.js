// By how much moves can be enlarged: as far as the shape can still be made out.

import { at } from "./shapes.js";

const STEPS = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000];
/** The largest enlarged move, as a share of the flat grid's width. */
const MOST = 0.3;

/** The factors, from 1 on, that moves from a named reference can be enlarged by. */
export function factors(scene, reference) {
  const moves = scene.poses.map((pose) => pose.references.get(reference)).filter(Boolean);
  const largest = Math.max(0, ...moves.map(largestOf));
  return STEPS.filter((factor) => factor === 1 || factor * largest <= MOST * widthOf(scene.poses[0].positions));
}

function largestOf(away) {
  let most = 0;
  for (let k = 0; k < away[0].whole.length; k += 1) {
    const move = Math.hypot(at(away[0], k), at(away[1], k), at(away[2], k));
    if (move > most) most = move;
  }
  return most;
}

function widthOf(positions) {
  return Math.max(...positions.map((column) => {
    let [low, high] = [Infinity, -Infinity];
    for (let k = 0; k < column.whole.length; k += 1) {
      const value = at(column, k);
      if (value < low) low = value;
      if (value > high) high = value;
    }
    return high - low;
  }));
}
