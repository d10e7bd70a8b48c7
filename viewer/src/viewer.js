// One viewer: its state, and what follows from a change of it.

import { ClampToEdgeWrapping, DataTexture, LinearFilter, RGBAFormat } from "three";
import { colourMap, mapFor, rgb } from "./colours.js";
import { controls } from "./controls.js";
import { element } from "./element.js";
import { factors } from "./enlarging.js";
import { KEYS, nextOf, pressed } from "./keys.js";
import { legend } from "./legend.js";
import { overlay } from "./overlay.js";
import { panel } from "./panel.js";
import { unpack } from "./payload.js";
import { crossings, neighbour, pick, spotOf } from "./picking.js";
import { play } from "./playing.js";
import { alongWires, drawn, figures, quantitiesOf, rangeOf } from "./shapes.js";
import { skinOf } from "./skins.js";
import { canDraw, stageOn } from "./stage.js";
import { watchTheme } from "./theme.js";
import { wiresOf } from "./wires.js";

const WITHOUT = "The 3D view needs WebGL 2, which this browser does not have or has switched off. Everything below is complete without it.";
/** Up to so many wire pieces edges are smoothed. */
const SMOOTH = 30000;
/** Ribbons take this share of the distance between wires, within limits [pixels]. */
const SHARE = 0.17;
const THINNEST = 1.1;
const WIDEST = 3;
/** How much a surface covers what is behind it. */
const COVER = 0.72;

/** Show the scene of a packed text in an element; the promise of the viewer. group: of viewers that are linked. */
export async function mount(root, text, group) {
  if (!canDraw()) {
    root.replaceChildren(element("p", { class: "pf-message" }, WITHOUT));
    return null;
  }
  const scene = await unpack(text);
  return new Viewer(root, scene, group);
}

class Viewer {
  constructor(root, scene, group) {
    this.root = root;
    this.scene = scene;
    this.group = group;
    this.quantities = quantitiesOf(scene);
    this.table = crossings(scene);
    this.points = new Float32Array(3 * scene.nodes);
    this.ranges = new Map();
    this.enlargings = new Map();
    this.state = this.first();
    this.farther = false;
    this.build();
    // The layout of a viewer that is there, so that the picture knows its size.
    root.dataset.ready = "true";
    this.dress();
    this.stage.look("oblique", this.reach());
    this.theme = watchTheme(root, () => this.coloursOfTheGround());
    this.coloursOfTheGround();
    group.join(this);
    this.stage.begin();
    root.viewer = this;
    this.refresh();
    group.refresh(this);
  }

  first() {
    const { scene } = this;
    const begun = scene.poses[scene.begin];
    const show = Object.fromEntries(scene.skins.map((skin) => [skin.key, skin.key !== "target"]));
    for (const family of [1, 2]) if (scene.family.includes(family)) show[`family${family}`] = true;
    return {
      time: scene.begin, colour: scene.colour ?? "", robust: true, steady: false, times: 1, quarter: false,
      reference: [...begun.references.keys()].pop() ?? "", show, picked: null, playing: null, instead: null,
    };
  }

  build() {
    const { scene, root } = this;
    const act = {
      play: () => this.play(),
      reset: () => this.reset(),
      look: (name) => this.look(name),
      turn: (across, up) => { this.stage.turn(across, up); },
      zoom: (factor) => this.stage.zoom(factor),
      enlarge: () => this.ask({ times: nextOf(this.factors(), this.state.times) }),
      walk: (axis, step) => this.walk(axis, step),
    };
    this.canvas = element("canvas", {
      class: "pf-canvas", tabindex: "0", role: "application", "aria-label": `3D view of ${scene.title}: the wires of the grid. Arrow keys walk from node to node; the keys are listed below.`,
    });
    this.overlay = overlay();
    this.legend = legend(scene);
    this.panel = panel(scene);
    this.controls = controls(scene, (asked) => this.ask(asked), act);
    const views = [["oblique", "Oblique"], ["top", "Top"], ["side", "Side"]].map(([name, label]) =>
      element("button", { type: "button", onclick: () => this.look(name) }, label));
    const tools = element("div", { class: "pf-tools", role: "group", "aria-label": "Views" }, ...views,
      element("button", { type: "button", onclick: () => this.reset(), title: "all as at first" }, "Reset"),
      element("button", { type: "button", onclick: () => this.save(), title: "save the picture as PNG" }, "Save"));
    this.still = element("img", { class: "pf-still", alt: "", hidden: true });
    this.controls.head.append(this.legend.root);
    root.replaceChildren(
      this.controls.head,
      element("div", { class: "pf-stage" }, this.canvas, this.overlay.root, tools, this.still),
      this.panel.root,
      this.controls.foot,
      element("details", { class: "pf-help" }, element("summary", {}, "Mouse, touch and keys"),
        element("p", {}, "Drag to turn, drag with the right button or two fingers to move, wheel (after a click) or two fingers to come nearer; a click or tap picks. With the picture chosen:"),
        element("dl", {}, ...KEYS.flatMap(([keys, what]) => [element("dt", {}, keys), element("dd", {}, what)]))),
    );
    this.listen(act);
  }

  listen(act) {
    const { canvas } = this;
    let down = null;
    canvas.addEventListener("pointerdown", (event) => { down = [event.clientX, event.clientY]; });
    canvas.addEventListener("pointerup", (event) => {
      if (down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < 5) this.pickAt(event);
      down = null;
    });
    canvas.addEventListener("keydown", (event) => {
      if (pressed(event, this.scene, this.state, (asked) => this.ask(asked), act)) event.preventDefault();
    });
    window.addEventListener("beforeprint", () => {
      this.lighten(true);
      this.hold();
    });
    window.addEventListener("afterprint", () => this.lighten(false));
  }

  dress() {
    const { scene } = this;
    this.stage = stageOn(this.canvas, {
      smooth: scene.pieces <= SMOOTH,
      drawnOnce: () => this.over(),
      turned: () => this.group.turned(this, this.stage.pose),
    });
    this.map = new DataTexture(colourMap("rising", "light"), 256, 1, RGBAFormat);
    Object.assign(this.map, { minFilter: LinearFilter, magFilter: LinearFilter, wrapS: ClampToEdgeWrapping });
    const uniforms = {
      map: { value: this.map }, range: { value: [0, 1] }, coloured: { value: false }, missing: { value: [0.5, 0.5, 0.5] },
      nearer: { value: 0.004 }, width: { value: 2 }, pixels: this.stage.pixels, plains: { value: [[0, 0, 0], [0, 0, 0]] },
    };
    this.uniforms = uniforms;
    this.families = [1, 2].filter((family) => scene.family.includes(family)).map((family) => [`family${family}`, wiresOf(scene, family, uniforms)]);
    this.skins = scene.skins.map((skin, k) => [skin.key, skinOf(skin, 1 + k)]);
    for (const [, part] of [...this.families, ...this.skins]) this.stage.scene.add(part.object);
  }

  /** Change the state as asked and show it. A colouring that is not told of this shape takes one of which it is, until
   * another is told of this shape again. */
  ask(asked) {
    const before = this.state;
    this.change(asked);
    if ("time" in asked && !asked.byPlay && before.playing) before.playing.stop();
    this.showAsked(asked);
    this.group.changed(this, this.named(asked));
  }

  /** What is asked, with shapes by their names so that other scenes understand it. */
  named(asked) {
    const told = { ...asked };
    delete told.picked;
    if ("time" in told) {
      const first = Math.floor(told.time);
      told.time = { from: this.scene.poses[first].name, share: told.time - first };
    }
    return told;
  }

  askNamed(asked) {
    const told = { ...asked };
    if (told.time) {
      const first = this.scene.poses.findIndex((pose) => pose.name === asked.time.from);
      if (first < 0) delete told.time;
      else told.time = Math.min(first + asked.time.share, this.scene.poses.length - 1);
    }
    if (told.colour && !this.quantities.some((one) => one.key === told.colour)) delete told.colour;
    if (told.reference && !this.scene.poses.some((pose) => pose.references.has(told.reference))) delete told.reference;
    this.change(told);
    this.showAsked(told);
  }

  change(asked) {
    const instead = "time" in asked ? null : this.state.instead;
    this.state = { ...this.state, ...asked, instead, show: { ...this.state.show, ...asked.show } };
    if ("colour" in asked) this.goWhereTold(asked.colour);
  }

  goWhereTold(key) {
    const { state, scene: { poses } } = this;
    const quantity = this.quantity(key);
    const wanted = state.instead?.time ?? state.time;
    const can = (time) => !quantity || poses[Math.round(time)].figures.has(quantity.of);
    const found = [wanted, state.time].find(can) ?? poses.findLastIndex((_, number) => can(number));
    if (found < 0) return;
    state.instead = found === wanted ? null : { time: wanted, name: poses[Math.round(wanted)].name };
    state.time = found;
  }

  quantity(key) {
    return this.quantities.find((one) => one.key === key) ?? null;
  }

  refresh() {
    const { state, scene, uniforms } = this;
    const offered = this.factors();
    state.times = offered.findLast((factor) => factor <= state.times);
    const quantity = this.quantity(state.colour);
    const shape = Math.round(state.time);
    const pose = scene.poses[shape];
    drawn(scene, state.time, state.reference, state.times, this.points);
    const key = `${state.colour}|${shape}`;
    let told = quantity ? figures(pose, quantity) : null;
    if (told && quantity.place === "node") told = alongWires(scene, told);
    this.told = told;
    for (const [name, wires] of this.families) {
      wires.place(this.points);
      if (this.coloured !== key) wires.colour(quantity, told);
      wires.object.visible = state.show[name];
      wires.quarter(state.quarter);
    }
    this.coloured = key;
    this.sinkSkins();
    const own = quantity && this.ownRange(state.colour, state.robust, state.steady, pose.name);
    const range = quantity && told && this.group.range(this, own, state.colour, state.robust, state.steady, pose.name);
    if (range) uniforms.range.value = [range.low, range.high];
    uniforms.coloured.value = Boolean(quantity);
    const bytes = colourMap(range ? mapFor(quantity.signed, range) : "rising", this.ground ?? "light");
    this.map.image.data.set(bytes);
    this.map.needsUpdate = true;
    this.legend.show(quantity, range, bytes, pose.name);
    this.controls.show(state, offered);
    this.panel.show(state.picked, pose);
    this.stage.again();
  }

  sinkSkins() {
    const { state, scene } = this;
    const first = Math.floor(state.time);
    const next = scene.poses[Math.min(first + 1, scene.poses.length - 1)];
    const share = scene.poses[first].share + (state.time - first) * (next.share - scene.poses[first].share);
    // Where the punch has gone, no more than a breath of it is left beside the wires.
    const gone = scene.poses[Math.round(state.time)].tool ? 1 : 0.4;
    for (const [name, skin] of this.skins) {
      skin.sink(share);
      skin.cover.value = COVER * (skin.falls ? gone : 0.7);
      skin.object.visible = state.show[name];
    }
  }

  ownRange(key, robust, steady, poseName) {
    const name = [key, robust, steady || poseName].join("|");
    if (!this.ranges.has(name)) {
      const quantity = this.quantity(key);
      const poses = this.scene.poses.filter((pose) => steady || pose.name === poseName);
      this.ranges.set(name, quantity && rangeOf(poses, quantity, robust));
    }
    return this.ranges.get(name);
  }

  factors() { return this.group.factors(this, this.state.reference); }

  ownFactors(reference) {
    if (!this.enlargings.has(reference)) this.enlargings.set(reference, factors(this.scene, reference));
    return this.enlargings.get(reference);
  }

  coloursOfTheGround() {
    const { colours, ground } = this.theme;
    this.ground = ground;
    this.stage.ground(rgb(colours.stage));
    this.uniforms.missing.value = rgb(colours.missing);
    this.families.forEach(([name, wires]) => { wires.material.uniforms.plain.value = rgb(colours[name]); });
    for (const [name, skin] of this.skins) {
      skin.tint.value = rgb(colours[name]);
    }
    this.refresh();
  }

  /** The points that the picture has to hold: the shape at the end, and the one that is shown as it is drawn. */
  reach() {
    const { scene, state } = this;
    const size = 3 * scene.nodes;
    const both = new Float32Array(2 * size);
    drawn(scene, scene.begin, "", 1, both.subarray(0, size));
    drawn(scene, state.time < 1 ? 0 : state.time, state.reference, state.times, both.subarray(size));
    return both;
  }

  /** Show what was asked: where enlarged moves drive the shape out of the picture, from farther off, and nearer again
   * when they are enlarged less. */
  showAsked(asked) {
    const { stage } = this;
    const enlarging = "times" in asked || "reference" in asked;
    const held = (enlarging || this.state.times > 1) && stage.holds(this.points);
    this.refresh();
    if (!held || (stage.holds(this.points) && !(enlarging && this.farther))) return;
    stage.fit(this.reach());
    this.farther = this.state.times > 1;
  }

  look(name) {
    this.stage.look(name, this.reach());
    this.farther = this.state.times > 1;
    this.group.turned(this, this.stage.pose);
  }

  reset() {
    this.state.playing?.stop();
    this.ask(this.first());
    this.look("oblique");
  }

  follow(pose) { this.stage.pose = pose; }

  play() {
    if (this.state.playing) return this.state.playing.stop();
    const playing = play(this.scene, this.state.time, (time) => this.ask({ time, byPlay: true }), () => {
      this.state.playing = null;
      this.refresh();
    });
    this.state.playing = playing;
    return this.refresh();
  }

  pickAt(event) {
    const box = this.canvas.getBoundingClientRect();
    const { scene, state } = this;
    const family = (piece) => state.show[`family${scene.family[piece]}`] && (!state.quarter || this.inQuarter(scene.start[piece]));
    const node = (number) => !state.quarter || this.inQuarter(number);
    const spot = [event.clientX - box.left, event.clientY - box.top];
    this.ask({ picked: pick(scene, this.points, this.stage.camera, [box.width, box.height], spot, { node, piece: family }) });
  }

  inQuarter(node) {
    const [x, y] = this.scene.poses[0].positions;
    return x.whole[node] >= 0 && y.whole[node] >= 0;
  }

  walk(axis, step) {
    const { scene, state } = this;
    const here = state.picked?.kind === "node" ? state.picked.number : null;
    const next = here === null ? this.middle() : neighbour(scene, this.table, here, axis, step);
    if (next !== null) this.ask({ picked: { kind: "node", number: next } });
  }

  /** The crossing nearest to the axis in the flat grid. */
  middle() {
    const [x, y] = this.scene.poses[0].positions;
    const away = (node) => Math.hypot(x.whole[node], y.whole[node]);
    return [...this.table.values()].reduce((a, b) => (away(b) < away(a) ? b : a));
  }

  /** After each picture: what lies over it, and how wide ribbons are the next time. */
  over() {
    const { state, stage, canvas } = this;
    const width = Math.max(this.scene.diameter * stage.scale, Math.min(WIDEST, Math.max(THINNEST, SHARE * this.apart() * stage.scale)));
    if (Math.abs(width - this.uniforms.width.value) > 0.01) {
      this.uniforms.width.value = width;
      stage.again();
    }
    const spot = state.picked && spotOf(this.scene, this.points, state.picked);
    const seen = spot && spot.every(Number.isFinite) ? stage.seen(spot) : null;
    this.overlay.show(stage, canvas.clientWidth, canvas.clientHeight, seen);
  }

  /** A typical distance of neighbouring wires [mm]. */
  apart() {
    if (this.between === undefined) {
      const { scene } = this;
      const [x, y] = scene.poses[0].positions;
      const lengths = [];
      for (let piece = 0; piece < scene.pieces; piece += Math.ceil(scene.pieces / 200)) {
        const [a, b] = [scene.start[piece], scene.end[piece]];
        lengths.push(x.step * Math.hypot(x.whole[a] - x.whole[b], y.whole[a] - y.whole[b]));
      }
      this.between = lengths.sort((a, b) => a - b)[lengths.length >> 1] ?? 1;
    }
    return this.between;
  }

  /** Paper is light whatever the theme of the screen. */
  lighten(on) {
    this.root.classList.toggle("pf-light", on);
    this.theme.read();
    this.coloursOfTheGround();
  }

  picture() {
    this.stage.draw();
    return this.canvas.toDataURL("image/png");
  }

  hold() {
    this.still.src = this.picture();
    this.still.alt = `${this.scene.title}, ${this.scene.poses[Math.round(this.state.time)].name}`;
  }

  save() {
    element("a", { href: this.picture(), download: `${this.scene.poses[Math.round(this.state.time)].name}.png` }).click();
  }
}
