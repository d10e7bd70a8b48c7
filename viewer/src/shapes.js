// What the numbers of a scene say: where nodes are in a pose, what figures they have there, and where they are drawn.

/** A value that stands for nothing, far below every figure. */
export const NOTHING = -1e30;
/** From this share of a mark on, figures come near it and the colours go beyond it by some room. */
const NEAR = 0.5;
const ROOM = 1.05;
/** A share of the largest figure that is no sign of its own but rounding. */
const SLIGHT = 1e-4;

/** Coordinate or figure k of told numbers, NaN where nothing is known. */
export function at(told, k) {
  return told.missing && told.missing[k] ? NaN : told.whole[k] * told.step;
}

/** Where a node is in a pose, [x, y, z] in mm; null where it is not there. */
export function place(pose, node) {
  const found = pose.positions.map((column) => at(column, node));
  return found.every(Number.isFinite) ? found : null;
}

/** All quantities a user can choose, those over another value included. */
export function quantitiesOf(scene) {
  return scene.quantities.flatMap((one) => {
    const own = { ...one, of: one.key, divisor: 1 };
    if (!one.over) return [own];
    const over = {
      ...own, key: `${one.key}_over`, label: one.over.label, unit: "", divisor: one.over.value,
      marks: one.marks.map((mark) => ({ ...mark, value: mark.value / one.over.value })),
    };
    return [own, over];
  });
}

/** The figure of a quantity at node or wire piece k of a pose, NaN where none is known. */
export function figure(pose, quantity, k) {
  const told = pose.figures.get(quantity.of);
  return told ? at(told, k) / quantity.divisor : NaN;
}

/** The step in which a pose tells a quantity: figures are right to half of it. */
export function stepOf(pose, quantity) {
  return (pose.figures.get(quantity.of)?.step ?? 1) / quantity.divisor;
}

/** All figures of a quantity in a pose as floats, NOTHING where none is known; null when the pose has none. */
export function figures(pose, quantity) {
  const told = pose.figures.get(quantity.of);
  if (!told) return null;
  const factor = told.step / quantity.divisor;
  const values = new Float32Array(told.whole.length);
  for (let k = 0; k < values.length; k += 1) {
    values[k] = told.missing && told.missing[k] ? NOTHING : told.whole[k] * factor;
  }
  return values;
}

/** Figures of nodes for drawing: nodes between crossings, of which none is known, take the mean of their neighbours. */
export function alongWires(scene, values) {
  const rounds = scene.between.reduce((most, one) => Math.max(most, one), 0);
  for (let round = 0; round < rounds; round += 1) {
    const known = values.slice();
    const sum = new Float32Array(values.length);
    const count = new Uint8Array(values.length);
    for (let piece = 0; piece < scene.pieces; piece += 1) {
      const [a, b] = [scene.start[piece], scene.end[piece]];
      for (const [node, other] of [[a, b], [b, a]]) {
        if (scene.between[node] === 0 || known[node] > NOTHING / 2 || known[other] <= NOTHING / 2) continue;
        sum[node] += known[other];
        count[node] += 1;
      }
    }
    for (let node = 0; node < values.length; node += 1) if (count[node]) values[node] = sum[node] / count[node];
  }
  return values;
}

/** Positions of all nodes for drawing (3 n), NaN where a node is not there: pose number `time` and part of the way on,
 * moves from the named reference enlarged. */
export function drawn(scene, time, reference, times, into) {
  const before = Math.floor(time);
  const share = time - before;
  const here = scene.poses[before];
  const next = share > 0 ? scene.poses[before + 1] : here;
  for (let axis = 0; axis < 3; axis += 1) {
    fill(into, axis, here, reference, times, 1 - share, false);
    if (share > 0) fill(into, axis, next, reference, times, share, true);
  }
  return into;
}

function fill(into, axis, pose, reference, times, weight, more) {
  const { whole, step, missing } = pose.positions[axis];
  const away = times === 1 ? undefined : pose.references.get(reference)?.[axis];
  const enlarged = times - 1;
  for (let k = 0; k < whole.length; k += 1) {
    let value = whole[k] * step;
    if (away) value -= enlarged * (away.missing && away.missing[k] ? NaN : away.whole[k] * away.step);
    if (missing && missing[k]) value = NaN;
    const slot = 3 * k + axis;
    into[slot] = (more ? into[slot] : 0) + weight * value;
  }
}

/** Least and largest figure of a quantity in some poses, and the range for the colours: from zero, and as far on both
 * sides for signed ones that lie on both; without the outermost fiftieth on each side when `robust`, but not without
 * a mark that figures come near. Null when nothing is known. */
export function rangeOf(poses, quantity, robust) {
  const known = [];
  for (const pose of poses) {
    const values = figures(pose, quantity);
    if (values) for (const value of values) if (value > NOTHING / 2) known.push(value);
  }
  if (!known.length) return null;
  const sorted = Float32Array.from(known).sort();
  const [least, largest] = [sorted[0], sorted[sorted.length - 1]];
  const rank = (share) => sorted[Math.round(share * (sorted.length - 1))];
  const [low, high] = robust ? [rank(0.02), rank(0.98)] : [least, largest];
  const marks = quantity.marks.map((one) => one.value);
  const up = Math.max(high, ...marks.filter((mark) => mark > 0 && largest >= NEAR * mark).map((mark) => ROOM * mark));
  const down = Math.min(low, ...marks.filter((mark) => mark < 0 && least <= NEAR * mark).map((mark) => ROOM * mark));
  const most = Math.max(Math.abs(least), Math.abs(largest));
  const reach = Math.max(-down, up) || most || 1;
  if (!quantity.signed) return { least, largest, low: Math.min(0, down), high: Math.max(0, up) || reach };
  const [below, above] = [least < -SLIGHT * most, largest > SLIGHT * most];
  return { least, largest, low: below ? -reach : 0, high: above || !below ? reach : 0 };
}
