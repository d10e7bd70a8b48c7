// From the text of a packed scene to typed arrays; the counterpart of report/viewer/payload.py and coding.py.

const VERSION = 1;

/** The scene in a packed text, as a promise. Throws when the text is of another version. */
export async function unpack(text) {
  const header = JSON.parse(text);
  if (header.version !== VERSION) throw new Error(`the scene is of version ${header.version}, this viewer reads ${VERSION}`);
  const bytes = await inflated(header.blob);
  if (bytes.length !== header.size) throw new Error("the scene is not complete");
  const read = (told) => numbers(bytes, told);
  const [first, away] = header.ends.map((told) => read(told).whole);
  return {
    title: header.title,
    nodes: header.nodes,
    pieces: header.pieces,
    diameter: header.diameter,
    begin: header.begin,
    colour: header.colour,
    i: read(header.index[0]).whole,
    j: read(header.index[1]).whole,
    between: read(header.between).whole,
    start: first,
    end: first.map((node, piece) => node + away[piece]),
    family: read(header.family).whole,
    poses: header.poses.map((pose) => ({
      ...pose,
      positions: pose.positions.map(read),
      figures: new Map(Object.entries(pose.figures).map(([key, told]) => [key, read(told)])),
      references: new Map(pose.references.map((one) => [one.name, one.away.map(read)])),
    })),
    quantities: header.quantities,
    skins: header.skins.map((skin) => ({ ...skin, points: skin.points.map(read) })),
  };
}

async function inflated(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let k = 0; k < text.length; k += 1) bytes[k] = text.charCodeAt(k);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Whole numbers, the step of one, and which of them stand for nothing: value k is whole[k] * step. */
function numbers(bytes, told) {
  const whole = new Int32Array(told.n);
  told.planes.forEach((plane, place) => {
    const at = told.at + place * told.n;
    const shift = 8 * plane;
    for (let k = 0; k < told.n; k += 1) whole[k] |= bytes[at + k] << shift;
  });
  for (let k = 0; k < told.n; k += 1) whole[k] = (whole[k] >>> 1) ^ -(whole[k] & 1);
  foretold(whole, told.foretold);
  const missing = told.missing === undefined ? null : bits(bytes, told.missing, told.n);
  return { whole, step: told.step ?? 1, missing };
}

function foretold(whole, how) {
  if (how === 1) for (let k = 1; k < whole.length; k += 1) whole[k] += whole[k - 1];
  if (how === 2) for (let k = 2; k < whole.length; k += 1) whole[k] += whole[k - 2];
  if (how === 3) for (let k = 2; k < whole.length; k += 1) whole[k] += 2 * whole[k - 1] - whole[k - 2];
}

function bits(bytes, at, count) {
  const set = new Uint8Array(count);
  for (let k = 0; k < count; k += 1) set[k] = (bytes[at + (k >> 3)] >> (k & 7)) & 1;
  return set;
}
