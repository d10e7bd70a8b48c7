// The controls around the picture. They only ask for changes of the state and show it; the viewer does the rest.

import { element } from "./element.js";
import { quantitiesOf } from "./shapes.js";
import { caption, fromWhat } from "./wording.js";

/** Nearer than this to a computed shape the slider takes that. */
const CATCH = 0.06;

/** All controls of a scene; `ask` takes the changes of the state that a user wants, `act` what is no state. */
export function controls(scene, ask, act) {
  const last = scene.poses.length - 1;
  const colour = element("select", { onchange: () => ask({ colour: colour.value }) },
    ...quantitiesOf(scene).map((one) => element("option", { value: one.key }, capital(one.label))),
    element("option", { value: "" }, "Families of wires"));
  const robust = check("Without the extremes", "colours of the middle 96 % of the values", (on) => ask({ robust: on }));
  const steady = check("One range for all shapes", "", (on) => ask({ steady: on }));
  const slider = element("input", {
    type: "range", min: 0, max: last, step: 0.01, class: "pf-slider", "aria-label": "Shape, from flat onwards",
    oninput: () => ask({ time: caught(Number(slider.value)) }),
    onkeydown: (event) => steps(event, Number(slider.value), last, ask),
  });
  const play = element("button", { type: "button", class: "pf-play", onclick: act.play }, "Play");
  const chips = scene.poses.map((pose, number) =>
    pose.stroke ? null : element("button", { type: "button", class: "pf-chip", onclick: () => ask({ time: number }) }, pose.name));
  const said = element("p", { class: "pf-caption", "aria-live": "polite" });
  const shown = [
    ...scene.skins.map((skin) => [skin.key, capital(skin.label), skin]),
    ...[1, 2].filter((family) => scene.family.includes(family)).map((family) => [`family${family}`, `Wires along ${"xy"[family - 1]}`]),
  ].map(([key, label, skin]) => [key, check(label, "", (on) => ask({ show: { [key]: on } })), skin]);
  const quarter = check("Quarter", "only x, y from 0 upwards", (on) => ask({ quarter: on }));
  const names = [...new Set(scene.poses.flatMap((pose) => [...pose.references.keys()]))];
  const reference = element("select", { "aria-label": "Moves from", onchange: () => ask({ reference: reference.value }) },
    ...names.map((name) => element("option", { value: name }, fromWhat(name))));
  const times = element("input", {
    type: "range", min: 0, step: 1, "aria-label": "How many times moves are enlarged",
    oninput: () => ask({ times: offered[Number(times.value)] }),
  });
  let offered = [1];
  const enlarged = element("output", {}, "\u00d71");
  const enlarging = element("div", { class: "pf-enlarge" }, element("span", {}, "Enlarge moves from"), reference, times, enlarged);
  return {
    head: element("div", { class: "pf-head" },
      element("div", { class: "pf-choice" }, element("label", {}, "Colour ", colour),
        element("div", { class: "pf-checks" }, robust.root, steady.root))),
    foot: element("div", { class: "pf-foot" },
      element("div", { class: "pf-time" }, play, slider),
      element("div", { class: "pf-chips", role: "group", "aria-label": "Computed shapes" }, ...chips.filter(Boolean)),
      said,
      element("div", { class: "pf-checks" }, ...shown.map(([, made]) => made.root), quarter.root),
      ...(names.length ? [enlarging] : [])),
    show(state, factors) {
      offered = factors;
      colour.value = state.colour;
      robust.box.checked = state.robust;
      steady.box.checked = state.steady;
      slider.value = state.time;
      slider.setAttribute("aria-valuetext", caption(scene, state));
      chips.forEach((chip, number) => chip?.setAttribute("aria-pressed", String(state.time === number)));
      for (const [key, made] of shown) made.box.checked = state.show[key];
      const there = scene.poses[Math.round(state.time)].tool;
      for (const [, made, skin] of shown) if (skin?.falls) made.name.textContent = `${capital(skin.label)}${there ? "" : " (where it stood)"}`;
      quarter.box.checked = state.quarter;
      reference.value = state.reference;
      times.max = offered.length - 1;
      times.disabled = offered.length < 2;
      times.value = offered.indexOf(state.times);
      enlarged.textContent = `\u00d7${state.times}`;
      const can = scene.poses[Math.round(state.time)].references.has(state.reference);
      enlarging.classList.toggle("pf-off", !can);
      said.textContent = caption(scene, state);
      play.textContent = state.playing ? "Stop" : "Play";
    },
  };
}

function steps(event, time, last, ask) {
  const way = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
  if (!way) return;
  event.preventDefault();
  ask({ time: stepped(time, way, last) });
}

/** The next computed shape in a direction. */
export function stepped(time, way, last) {
  const next = way > 0 ? Math.floor(time + 1e-9) + 1 : Math.ceil(time - 1e-9) - 1;
  return Math.min(last, Math.max(0, next));
}

function caught(time) {
  return Math.abs(time - Math.round(time)) < CATCH ? Math.round(time) : time;
}

function check(label, title, changed) {
  const box = element("input", { type: "checkbox", onchange: () => changed(box.checked) });
  const name = element("span", {}, label);
  return { box, name, root: element("label", { class: "pf-check", title: title || null }, box, name) };
}

const capital = (text) => text[0].toUpperCase() + text.slice(1);
