// The keyboard on the picture.

import { stepped } from "./controls.js";
import { quantitiesOf } from "./shapes.js";

/** The keys in words, for the help below the picture. */
export const KEYS = [
  ["Arrow keys", "the next node along i or j"],
  ["Shift + arrow keys", "turn"],
  ["+ and \u2212", "nearer and farther"],
  ["[ and ]", "the shape before and after"],
  ["Space", "play and stop"],
  ["C", "the next colouring"],
  ["M", "enlarge moves more, after the most not at all"],
  ["P, T, X, Y", "punch, target, wires along x, wires along y"],
  ["Q", "quarter or whole"],
  ["1, 2, 3", "oblique, top, side"],
  ["0", "all as at first"],
  ["Escape", "nothing picked"],
];

const WAYS = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowDown: [1, -1], ArrowUp: [1, 1] };
const VIEWS = { 1: "oblique", 2: "top", 3: "side" };
const PARTS = { p: "punch", t: "target", x: "family1", y: "family2" };

/** Carry out a key; whether it meant anything here. */
export function pressed(event, scene, state, ask, act) {
  if (event.ctrlKey || event.metaKey || event.altKey) return false;
  const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  const last = scene.poses.length - 1;
  if (WAYS[key]) {
    const [axis, step] = WAYS[key];
    if (event.shiftKey) act.turn(axis === 0 ? step : 0, axis === 1 ? step : 0);
    else act.walk(axis, step);
  } else if (key === "+" || key === "=") act.zoom(1.25);
  else if (key === "-") act.zoom(0.8);
  else if (key === "[" || key === "]") ask({ time: stepped(state.time, key === "]" ? 1 : -1, last) });
  else if (key === " ") act.play();
  else if (key === "c") ask({ colour: nextOf([...quantitiesOf(scene).map((one) => one.key), ""], state.colour) });
  else if (key === "m") act.enlarge();
  else if (key === "q") ask({ quarter: !state.quarter });
  else if (key === "0") act.reset();
  else if (key === "Escape") ask({ picked: null });
  else if (VIEWS[key]) act.look(VIEWS[key]);
  else if (PARTS[key] && PARTS[key] in state.show) ask({ show: { [PARTS[key]]: !state.show[PARTS[key]] } });
  else return false;
  return true;
}

/** The next of all, after the last the first. */
export const nextOf = (all, one) => all[(all.indexOf(one) + 1) % all.length];
