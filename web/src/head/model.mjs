// SPDX-License-Identifier: MIT

import { shared } from './shared.mjs';

export class ModelError extends Error {}

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
 * @typedef {{fap: number, sign: 'both'|'positive'|'negative', vertices: Uint16Array, deltas: Float32Array}} Move
 * @typedef {{turn: number, vertices: Uint16Array|null, weights: Float32Array|null, weight: number}} PartTurn
 * @typedef {{name: string, material: string, vertices: number, position: Float32Array, uv: Float32Array|null,
 *   index: Uint16Array, smooth: Uint16Array|null, moves: Move[], turns: PartTurn[]}} Part
 * @typedef {{name: string, fap: number, pivot: number[], axis: number[], radians: number}} Turn
 */

/** Vertex numbers. */
const list = (base64) => shared('list', base64, () => as(Uint16Array, base64));

/** @returns {Part} */
function part(json, turnNumbers) {
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
    moves: (json.moves ?? []).map((move) => ({
      fap: move.fap,
      sign: move.sign ?? 'both',
      vertices: list(move.vertices),
      deltas: vectors(move.deltas),
    })),
    turns: (json.turns ?? []).map((turn) => ({
      turn: turnNumbers.get(turn.turn),
      vertices: turn.vertices ? list(turn.vertices) : null,
      weights: turn.weights ? Float32Array.from(bytes(turn.weights), (value) => value / 255) : null,
      weight: turn.weight ?? 1,
    })),
  };
}

/** Those that turn the whole head come last, pitch before yaw before roll. */
export const HEAD_FAPS = [48, 49, 50];

/**
 * Unpacks a head model. Its turns are put in the order in which they are applied: `headTurns` says how many of them, at
 * the end, turn the head.
 * @param {object} json see protocol/head-model.md
 */
export function readModel(json) {
  if (json?.format !== 'faccia-head' || json.version !== 1) throw new ModelError('not a head model of version 1');
  const order = (turn) => HEAD_FAPS.indexOf(turn.fap) + 1;
  const turns = [...(json.turns ?? [])].sort((a, b) => order(a) - order(b));
  const numbers = new Map(turns.map((turn, i) => [turn.name, i]));
  const parts = json.parts.map((one) => part(one, numbers));
  for (const { name, turns: used, vertices, position } of parts)
    if (used.some((turn) => turn.turn === undefined) || position.length !== 3 * vertices)
      throw new ModelError(`part ${name} is damaged`);
  return {
    name: json.name,
    title: json.title ?? json.name,
    credits: json.credits ?? [],
    fapu: json.fapu,
    fdp: json.fdp ?? {},
    view: { target: [0, -20, 0], distance: 620, fov: 26, ...json.view },
    turns,
    headTurns: turns.filter(order).length,
    materials: json.materials ?? {},
    textures: json.textures ?? {},
    parts,
  };
}

/** The image of a texture, for all heads that have it. @returns {Promise<ImageBitmap>} */
export function decodeTexture(texture, options) {
  const decode = () => createImageBitmap(new Blob([bytes(texture.data)], { type: texture.type }), options);
  return shared(`image ${Object.values(options ?? {}).join()}`, texture.data, decode);
}
