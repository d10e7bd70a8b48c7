// The picture: renderer, parallel camera and turning. It draws only when something has changed.

import { Color, OrthographicCamera, Scene, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

const DIRECTIONS = { oblique: [-0.62, -1.0, 0.78], top: [0, -1e-4, 1], side: [0, -1, 0.0] };
const MARGIN = 1.1;
const TURN = Math.PI / 24;

/** Whether this browser can draw the picture at all. */
export function canDraw() {
  const trial = document.createElement("canvas").getContext("webgl2");
  trial?.getExtension("WEBGL_lose_context")?.loseContext();
  return Boolean(trial);
}

/** The stage on a canvas. `drawnOnce` is called after each picture, `turned` when the user has turned or moved it. */
export function stageOn(canvas, { smooth, drawnOnce, turned }) {
  const renderer = new WebGLRenderer({ canvas, antialias: smooth, powerPreference: "high-performance" });
  const scene = new Scene();
  const camera = new OrthographicCamera(-1, 1, 1, -1, 0.01, 100);
  camera.up.set(0, 0, 1);
  const controls = new OrbitControls(camera, canvas);
  Object.assign(controls, { minZoom: 0.2, maxZoom: 200, zoomToCursor: true, rotateSpeed: 0.8, enableZoom: false });
  // The wheel belongs to the page until the picture has been chosen.
  canvas.addEventListener("focus", () => { controls.enableZoom = true; });
  canvas.addEventListener("blur", () => { controls.enableZoom = false; });
  canvas.addEventListener("touchstart", () => { controls.enableZoom = true; }, { passive: true });
  const pixels = { value: [1, 1] };
  let waiting = false;
  let radius = 1;
  let height = 1;
  let pictures = 0;
  let ready = false;

  function draw() {
    waiting = false;
    renderer.render(scene, camera);
    pictures += 1;
    drawnOnce();
  }

  function again() {
    if (waiting || !ready) return;
    waiting = true;
    requestAnimationFrame(() => { if (waiting) draw(); });
  }

  const aspect = () => canvas.clientWidth / Math.max(canvas.clientHeight, 1);

  function shape() {
    camera.top = height;
    camera.bottom = -height;
    camera.right = height * aspect();
    camera.left = -camera.right;
    camera.updateProjectionMatrix();
  }

  function aim(way, points) {
    const { middle, size } = boundsOf(points);
    radius = size;
    controls.target.set(...middle);
    camera.position.set(...middle).addScaledVector(way, 4 * radius);
    camera.near = 0.5 * radius;
    camera.far = 7.5 * radius;
    camera.zoom = 1;
    camera.lookAt(controls.target);
    camera.updateMatrixWorld();
    height = MARGIN * heightFor(points, camera, aspect());
    shape();
    controls.update();
    again();
  }

  function resize() {
    const [width, tall] = [canvas.clientWidth, canvas.clientHeight];
    if (!width || !tall) return;
    renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    renderer.setSize(width, tall, false);
    pixels.value = [width / 2, tall / 2];
    shape();
    if (ready) draw();
  }

  controls.addEventListener("change", () => { again(); turned(); });
  resize();
  new ResizeObserver(resize).observe(canvas);

  return {
    scene, camera, controls, pixels, renderer, again, draw,
    get pictures() { return pictures; },
    /** From now on there is something to draw. */
    begin() {
      ready = true;
      again();
    },
    /** Pixels of the page per mm. */
    get scale() { return (camera.zoom * canvas.clientHeight) / (2 * height); },
    ground(colour) { scene.background = new Color().setRGB(...colour, renderer.outputColorSpace); },
    /** Look at points (3 n, NaN left out) from a direction so that all are seen. */
    look(name, points) { aim(new Vector3(...DIRECTIONS[name]).normalize(), points); },
    /** Look at points from where one looks, so that all are seen. */
    fit(points) { aim(camera.position.clone().sub(controls.target).normalize(), points); },
    /** Whether all points are seen. */
    holds(points) { return heightFor(points, camera, aspect()) * camera.zoom <= height; },
    /** Turn about the upright axis and up or down, in steps. */
    turn(across, up) {
      const from = camera.position.clone().sub(controls.target);
      from.applyAxisAngle(camera.up, -across * TURN);
      const polar = Math.acos(from.z / from.length());
      const wanted = Math.min(Math.PI - 0.01, Math.max(0.01, polar - up * TURN));
      const level = Math.hypot(from.x, from.y) || 1;
      const length = from.length();
      from.set((from.x / level) * Math.sin(wanted), (from.y / level) * Math.sin(wanted), Math.cos(wanted)).setLength(length);
      camera.position.copy(controls.target).add(from);
      controls.update();
      again();
    },
    zoom(factor) {
      camera.zoom = Math.min(controls.maxZoom, Math.max(controls.minZoom, camera.zoom * factor));
      camera.updateProjectionMatrix();
      controls.update();
      again();
      turned();
    },
    /** The way one looks, in terms that mean the same for a larger grid. */
    get pose() {
      const way = camera.position.clone().sub(controls.target).normalize();
      return { way: way.toArray(), zoom: camera.zoom, target: controls.target.clone().divideScalar(radius).toArray() };
    },
    set pose({ way, zoom, target }) {
      controls.target.set(...target).multiplyScalar(radius);
      camera.position.copy(controls.target).addScaledVector(new Vector3(...way), 4 * radius);
      camera.zoom = zoom;
      camera.lookAt(controls.target);
      camera.updateProjectionMatrix();
      again();
    },
    /** Where a point is on the canvas, in pixels of the page. */
    seen(point) {
      const { x, y } = new Vector3(...point).project(camera);
      return [((x + 1) / 2) * canvas.clientWidth, ((1 - y) / 2) * canvas.clientHeight];
    },
  };
}

function boundsOf(points) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let k = 0; k < points.length; k += 1) {
    const value = points[k];
    if (value < low[k % 3]) low[k % 3] = value;
    if (value > high[k % 3]) high[k % 3] = value;
  }
  const middle = low.map((value, axis) => (value + high[axis]) / 2);
  return { middle, size: 0.5 * Math.hypot(...high.map((value, axis) => value - low[axis])) || 1 };
}

/** Half the height of a picture with points (3 n) in it about the middle that the camera looks at. */
function heightFor(points, camera, wide) {
  const right = new Vector3().setFromMatrixColumn(camera.matrixWorld, 0);
  const up = new Vector3().setFromMatrixColumn(camera.matrixWorld, 1);
  const away = camera.position;
  let most = 1e-6;
  for (let k = 0; k < points.length; k += 3) {
    const [x, y, z] = [points[k] - away.x, points[k + 1] - away.y, points[k + 2] - away.z];
    const across = Math.abs(x * right.x + y * right.y + z * right.z) / wide;
    const upwards = Math.abs(x * up.x + y * up.y + z * up.z);
    if (across > most) most = across;
    if (upwards > most) most = upwards;
  }
  return most;
}
