// SPDX-License-Identifier: MIT
import { breathDeltas } from './breath-deltas.mjs';
import { pictureTrouble } from './picture-size.mjs';
import { checkModel, ModelError } from './check.mjs';
import { readOnce, shared } from './cache.mjs';

export { ModelError };

/** @returns {Uint8Array} */
function bytes(base64) {
  const binary = atob(base64);
  const out = new Uint8Array(binary.length);
  for (let i = 0; i < out.length; i++) out[i] = binary.charCodeAt(i);
  return out;
}

const as = (Type, base64) => new Type(bytes(base64).buffer);

/** Little-endian integers times a scale, plus an offset for each of three axes. */
function vectors({ data, scale = 1, offset = [0, 0, 0] }) {
  return Float32Array.from(as(Int16Array, data), (value, i) => value * scale + offset[i % 3]);
}

/**
 * @typedef {{fap: number, sign: 'both'|'positive'|'negative', from: number, vertices: Uint16Array, deltas: Float32Array}} Move
 * @typedef {{turn: number, vertices: Uint16Array|null, weights: Float32Array|null, weight: number}} PartTurn
 * @typedef {{name: string, material: string, vertices: number, position: Float32Array, uv: Float32Array|null,
 *   index: Uint16Array, smooth: Uint16Array|null, moves: Move[], turns: PartTurn[],
 *   sway: {pivot: number[], weights: Uint8Array}|null}} Part
 * @typedef {{name: string, fap: number, pivot: number[], axis: number[], radians: number,
 *   sways?: boolean}} Turn sways: its axis and angle are those of Sway
 */

/** Vertex numbers. */
const list = (base64) => shared('list', base64, () => as(Uint16Array, base64));

/** In the place of a FAP's number, of the moves that a breath makes: its value is 1 when the lungs are full. */
export const BREATH = 0;

/** The move of a part that a breath makes. @returns {Move[]} */
function breathMoves({ vertices, weights }, { shift }) {
  const deltas = Float32Array.from(breathDeltas(bytes(weights), shift));
  return [{ fap: BREATH, sign: 'both', from: 0, vertices: list(vertices), deltas }];
}

/** @returns {Part} */
function part(json, turnNumbers, breath) {
  const uv = json.uv
    ? shared('uv', json.uv.data, () => Float32Array.from(as(Uint16Array, json.uv.data), (value) => value / 65535))
    : null;
  return {
    name: json.name,
    material: json.material,
    vertices: json.vertices,
    position: vectors(json.position),
    uv,
    index: list(json.index.data),
    smooth: json.smooth ? list(json.smooth.data) : null,
    moves: [
      ...(json.moves ?? []).map((move) => ({
        fap: move.fap,
        sign: move.sign ?? 'both',
        from: move.from ?? 0,
        vertices: list(move.vertices),
        deltas: vectors(move.deltas),
      })),
      ...(json.breath && breath ? breathMoves(json.breath, breath) : []),
    ],
    turns: (json.turns ?? []).map((turn) => ({
      turn: turnNumbers.get(turn.turn),
      vertices: turn.vertices ? list(turn.vertices) : null,
      weights: turn.weights ? Float32Array.from(bytes(turn.weights), (value) => value / 255) : null,
      weight: turn.weight ?? 1,
    })),
    sway: json.sway ? { pivot: json.sway.pivot, weights: bytes(json.sway.weights) } : null,
  };
}

/** Checks what a schema cannot: that the arrays of a part fit each other. @param {Part} part */
function checkCounts({ vertices, position, uv, index, smooth, moves, turns, sway }, i) {
  const wrong = (where, what) => {
    throw new ModelError(`parts[${i}].${where}`, what);
  };
  const past = (numbers) => numbers?.some((vertex) => vertex >= vertices);
  if (position.length !== 3 * vertices) wrong('position', `must have ${vertices} vertices`);
  if (uv && uv.length !== 2 * vertices) wrong('uv', `must have ${vertices} vertices`);
  if (index.length % 3 || past(index)) wrong('index', 'must be triangles of the vertices');
  if (smooth && (smooth.length !== vertices || past(smooth))) wrong('smooth', 'must name a vertex for each');
  moves.forEach((move, k) => {
    const where = move.fap === BREATH ? 'breath' : `moves[${k}]`;
    if (past(move.vertices) || move.deltas.length !== 3 * move.vertices.length) wrong(where, move.fap === BREATH ? 'vertices and weights do not fit' : 'vertices and deltas do not fit');
  });
  if (sway && sway.weights.length !== vertices) wrong('sway.weights', `must be ${vertices}`);
  turns.forEach((turn, k) => {
    if (turn.turn === undefined) wrong(`turns[${k}].turn`, 'there is no such turn');
    if (past(turn.vertices) || turn.vertices?.length !== turn.weights?.length) wrong(`turns[${k}]`, 'vertices and weights do not fit');
  });
}

/** Those that turn the whole head come last, pitch before yaw before roll. */
export const HEAD_FAPS = [48, 49, 50];

/**
 * Unpacks a head model. Sorts its turns into the order of application: the last `headTurns` of them turn the whole head.
 * @param {object} json see protocol/head-model.md
 * @throws {ModelError} with the place of what is wrong
 */
export function readModel(json) {
  return readOnce(json, read);
}

function read(json) {
  checkModel(json);
  const order = (turn) => HEAD_FAPS.indexOf(turn.fap) + 1;
  const turns = [...(json.turns ?? [])].sort((a, b) => order(a) - order(b));
  const numbers = new Map(turns.map((turn, i) => [turn.name, i]));
  const parts = json.parts.map((one) => part(one, numbers, json.breath));
  parts.forEach(checkCounts);
  const headTurns = turns.filter(order).length;
  turns.splice(turns.length - headTurns, 0, ...swayTurns(parts, turns.length - headTurns));
  return {
    name: json.name,
    title: json.title ?? json.name,
    credits: json.credits ?? [],
    fapu: json.fapu,
    fdp: json.fdp ?? {},
    view: { target: [0, -20, 0], distance: 620, fov: 26, ...json.view },
    turns,
    headTurns,
    calibration: json.calibration ?? null,
    materials: json.materials ?? {},
    textures: json.textures ?? {},
    parts,
  };
}

/**
 * Makes a turn for each part with free ends, before those of the head.
 * @param {Part[]} parts @param {number} first its number
 */
function swayTurns(parts, first) {
  const free = parts.filter(({ sway }) => sway);
  if (!free.length) return [];
  for (const part of parts) for (const share of part.turns) if (share.turn >= first) share.turn += free.length;
  return free.map(({ name, sway, turns: shares }, i) => {
    const vertices = Uint16Array.from(sway.weights.keys()).filter((v) => sway.weights[v]);
    shares.push({ turn: first + i, vertices, weights: Float32Array.from(vertices, (v) => sway.weights[v] / 255), weight: 1 });
    return { name: `sway of ${name}`, fap: HEAD_FAPS[1], pivot: sway.pivot, axis: [0, 1, 0], radians: 0, sways: true };
  });
}

const decoded = new WeakMap(); // image -> its promise, which is looked for, and kept while the image is

/** The image of a texture, for all heads that have it. @returns {Promise<ImageBitmap>} */
export function decodeTexture(texture, options) {
  const decode = () => {
    const data = bytes(texture.data);
    const trouble = pictureTrouble(data);
    if (trouble) throw new ModelError('textures', `one ${trouble}`);
    const coming = createImageBitmap(new Blob([data], { type: texture.type }), options);
    coming.then((image) => decoded.set(image, coming), () => {});
    return coming;
  };
  return shared(`image ${Object.values(options ?? {}).join()}`, texture.data, decode);
}
