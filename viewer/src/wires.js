// The wires of one family as one draw call: ribbons of some pixels for small grids, plain lines for large ones.

import {
  BufferAttribute, BufferGeometry, DynamicDrawUsage, GLSL3, InterleavedBuffer, InterleavedBufferAttribute, LineSegments,
  Mesh, RawShaderMaterial,
} from "three";
import { NOTHING } from "./shapes.js";

/** More wire pieces than this are drawn as lines of one pixel. */
export const RIBBONS = 30000;
const GONE = 1e7;

const SHADE = `precision highp float;
in float shade;
out vec4 ink;
uniform sampler2D map;
uniform vec2 range;
uniform vec3 plain, missing;
uniform bool coloured;
void main() {
  float share = clamp((shade - range.x) / (range.y - range.x), 0.0, 1.0);
  vec3 told = texture(map, vec2((share * 255.0 + 0.5) / 256.0, 0.5)).rgb;
  ink = vec4(!coloured ? plain : shade < ${NOTHING.toExponential(1)} * 0.5 ? missing : told, 1.0);
}`;

const LINE = `precision highp float;
in vec3 position;
in float value;
out float shade;
uniform mat4 modelViewMatrix, projectionMatrix;
uniform float nearer;
void main() {
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  gl_Position.z -= nearer;
  shade = value;
}`;

const RIBBON = `precision highp float;
in vec2 corner;
in vec3 origin, tip;
in vec2 value;
out float shade;
uniform mat4 modelViewMatrix, projectionMatrix;
uniform vec2 pixels;
uniform float nearer, width;
void main() {
  mat4 seen = projectionMatrix * modelViewMatrix;
  vec4 a = seen * vec4(origin, 1.0), b = seen * vec4(tip, 1.0);
  vec2 along = (b.xy - a.xy) * pixels;
  float size = length(along);
  along = size > 1e-6 ? along / size : vec2(1.0, 0.0);
  vec2 aside = vec2(-along.y, along.x);
  gl_Position = corner.x < 0.5 ? a : b;
  // Ends overlap a little, so that a bent wire has no gaps.
  gl_Position.xy += width * (aside * corner.y + along * (corner.x - 0.5) * 0.6) / pixels;
  gl_Position.z -= nearer;
  shade = corner.x < 0.5 ? value.x : value.y;
}`;

/** The wires of a family: `object` for the scene, `place` moves them, `colour` gives them their figures. */
export function wiresOf(scene, family, uniforms) {
  const pieces = inOrder(scene, family);
  const ribbons = scene.pieces <= RIBBONS;
  const corners = new Float32Array(6 * pieces.all.length);
  const values = new Float32Array(2 * pieces.all.length);
  const { geometry, changed } = (ribbons ? ribbonGeometry : lineGeometry)(corners, values);
  const material = new RawShaderMaterial({
    glslVersion: GLSL3, vertexShader: ribbons ? RIBBON : LINE, fragmentShader: SHADE,
    uniforms: { ...uniforms, plain: { value: uniforms.plains.value[family - 1] } },
  });
  const object = ribbons ? new Mesh(geometry, material) : new LineSegments(geometry, material);
  object.frustumCulled = false;
  return {
    object,
    material,
    place(points) {
      pieces.all.forEach((piece, k) => {
        const [from, to] = [3 * scene.start[piece], 3 * scene.end[piece]];
        const there = points[from] + points[to];
        for (let axis = 0; axis < 3; axis += 1) {
          corners[6 * k + axis] = there === there ? points[from + axis] : GONE;
          corners[6 * k + 3 + axis] = there === there ? points[to + axis] : GONE;
        }
      });
      changed("corners");
    },
    colour(quantity, told) {
      pieces.all.forEach((piece, k) => {
        const atNodes = quantity?.place === "node";
        let first = told ? told[atNodes ? scene.start[piece] : piece] : NOTHING;
        let second = told ? told[atNodes ? scene.end[piece] : piece] : NOTHING;
        if (first <= NOTHING / 2 || second <= NOTHING / 2) first = second = NOTHING;
        values[2 * k] = first;
        values[2 * k + 1] = second;
      });
      changed("values");
    },
    quarter(only) {
      const shown = only ? pieces.quarter : pieces.all.length;
      geometry.setDrawRange(0, (ribbons ? 6 : 2) * shown);
    },
  };
}

/** The pieces of a family, those of the quarter x, y >= 0 of the flat grid first, and how many these are. */
function inOrder(scene, family) {
  const [x, y] = scene.poses[0].positions;
  const inQuarter = [];
  const others = [];
  for (let piece = 0; piece < scene.pieces; piece += 1) {
    if (scene.family[piece] !== family) continue;
    const [a, b] = [scene.start[piece], scene.end[piece]];
    const inside = x.whole[a] + x.whole[b] >= 0 && y.whole[a] + y.whole[b] >= 0;
    (inside ? inQuarter : others).push(piece);
  }
  return { all: Int32Array.from([...inQuarter, ...others]), quarter: inQuarter.length };
}

function lineGeometry(corners, values) {
  const geometry = new BufferGeometry();
  const attributes = { corners: new BufferAttribute(corners, 3), values: new BufferAttribute(values, 1) };
  geometry.setAttribute("position", attributes.corners.setUsage(DynamicDrawUsage));
  geometry.setAttribute("value", attributes.values.setUsage(DynamicDrawUsage));
  return { geometry, changed: (which) => { attributes[which].needsUpdate = true; } };
}

/** Four corners for each piece, every one with both ends: instances of a quad would be slow without a graphics card. */
function ribbonGeometry(corners, values) {
  const count = corners.length / 6;
  const ends = new InterleavedBuffer(new Float32Array(4 * corners.length), 6).setUsage(DynamicDrawUsage);
  const told = new BufferAttribute(new Float32Array(4 * values.length), 2).setUsage(DynamicDrawUsage);
  const sides = new Float32Array(8 * count);
  const triangles = new Uint32Array(6 * count);
  for (let k = 0; k < count; k += 1) {
    sides.set([0, -1, 1, -1, 1, 1, 0, 1], 8 * k);
    triangles.set([0, 1, 2, 0, 2, 3].map((corner) => 4 * k + corner), 6 * k);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("corner", new BufferAttribute(sides, 2));
  geometry.setIndex(new BufferAttribute(triangles, 1));
  geometry.setAttribute("origin", new InterleavedBufferAttribute(ends, 3, 0));
  geometry.setAttribute("tip", new InterleavedBufferAttribute(ends, 3, 3));
  geometry.setAttribute("value", told);
  return {
    geometry,
    changed(which) {
      if (which === "corners") fourfold(corners, 6, ends);
      else fourfold(values, 2, told);
    },
  };
}

function fourfold(from, size, to) {
  for (let k = 0; k < from.length; k += size) {
    for (let part = 0; part < size; part += 1) {
      const value = from[k + part];
      for (let copy = 0; copy < 4; copy += 1) to.array[4 * k + copy * size + part] = value;
    }
  }
  to.needsUpdate = true;
}
