// Punch and target as half-transparent surfaces, made of rings of points.

import { BufferAttribute, BufferGeometry, DoubleSide, GLSL3, Mesh, RawShaderMaterial } from "three";
import { at } from "./shapes.js";

const VERTEX = `precision highp float;
in vec3 position, normal;
out vec3 facing;
uniform mat4 modelViewMatrix, projectionMatrix;
uniform mat3 normalMatrix;
void main() {
  facing = normalMatrix * normal;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

const FRAGMENT = `precision highp float;
in vec3 facing;
out vec4 ink;
uniform vec3 tint;
uniform float cover;
void main() {
  vec3 n = normalize(facing);
  float light = 0.72 + 0.28 * dot(gl_FrontFacing ? n : -n, normalize(vec3(-0.4, 0.6, 0.7)));
  ink = vec4(tint * light, cover);
}`;

/** A surface of the scene: `object` for the scene, `tint` its colour, `sink` scales its heights. */
export function skinOf(skin, order) {
  const { rings, around } = skin;
  const corners = new Float32Array(3 * rings * around);
  for (let k = 0; k < rings * around; k += 1) {
    for (let axis = 0; axis < 3; axis += 1) corners[3 * k + axis] = at(skin.points[axis], k);
  }
  const triangles = [];
  for (let ring = 0; ring + 1 < rings; ring += 1) {
    for (let k = 0; k < around; k += 1) {
      const [a, b] = [ring * around + k, ring * around + ((k + 1) % around)];
      triangles.push(a, a + around, b + around, a, b + around, b);
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(corners, 3));
  geometry.setIndex(triangles);
  geometry.computeVertexNormals();
  const tint = { value: [0.5, 0.5, 0.5] };
  const cover = { value: 0.6 };
  const material = new RawShaderMaterial({
    glslVersion: GLSL3, vertexShader: VERTEX, fragmentShader: FRAGMENT, uniforms: { tint, cover },
    side: DoubleSide, transparent: true, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 4,
  });
  const object = new Mesh(geometry, material);
  object.frustumCulled = false;
  // After the wires: what lies behind a surface is then veiled by it, what lies before it is not.
  object.renderOrder = order;
  return {
    object,
    tint,
    cover,
    falls: skin.falls,
    sink(share) { object.scale.z = skin.falls ? Math.max(share, 1e-4) : 1; },
  };
}
