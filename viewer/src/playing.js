// Playing through the shapes: moving from one to the next, or one after the other where motion is unwelcome.

const SHAPE = 1100;
const STROKE = 260;
const REST = 700;

/** Starts at `time` and calls `move` with the next times until the last shape or until `stop` is called. */
export function play(scene, time, move, ended) {
  const last = scene.poses.length - 1;
  const still = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
  let now = time >= last ? 0 : time;
  let running = true;
  let before = null;
  let rest = 0;

  function frame(moment) {
    if (!running) return;
    const passed = before === null ? 0 : Math.min(moment - before, 100);
    before = moment;
    if (rest > 0) rest -= passed;
    else {
      const next = Math.floor(now + 1e-9) + 1;
      now = Math.min(next, now + passed / (scene.poses[next].stroke ? STROKE : SHAPE));
      move(now);
      if (now >= last) return end();
      if (now === next && !scene.poses[next].stroke) rest = REST;
    }
    requestAnimationFrame(frame);
  }

  function hop() {
    if (!running) return;
    now = Math.floor(now + 1e-9) + 1;
    move(now);
    if (now >= last) end();
    else setTimeout(hop, SHAPE);
  }

  function end() {
    running = false;
    ended();
  }

  move(now);
  if (still) setTimeout(hop, REST);
  else requestAnimationFrame(frame);
  return { stop() { if (running) end(); } };
}
