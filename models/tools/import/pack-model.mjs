// SPDX-License-Identifier: GPL-3.0-or-later
/** Writes a model read by the client (web/element/head/model/model.mjs) in the format of protocol/head-model.md. */
import { encode, encodeDeltas, encodePositions, round } from '../lib/codec.mjs';

const place = (p) => [...p].map((x) => round(x, 1e3));
const shares = (weights) => Array.from(weights, (w) => Math.round(255 * Math.min(1, Math.max(0, w))));

function packPart(part, turns) {
  return {
    name: part.name,
    material: part.material,
    vertices: part.position.length / 3,
    triangles: part.index.length / 3,
    position: encodePositions(part.position),
    uv: { data: encode('uint16', Array.from(part.uv ?? new Float32Array((2 * part.position.length) / 3), (x) => Math.round(Math.min(1, Math.max(0, x)) * 65535))) },
    index: { data: encode('uint16', part.index) },
    ...(part.smooth ? { smooth: { data: encode('uint16', part.smooth) } } : {}),
    moves: part.moves.map(({ fap, sign, vertices, deltas }) => ({ fap, sign, vertices: encode('uint16', vertices), deltas: encodeDeltas(deltas) })),
    turns: part.turns.map(({ turn, vertices, weights, weight }) =>
      vertices
        ? { turn: turns[turn]?.name ?? turn, vertices: encode('uint16', vertices), weights: encode('uint8', shares(weights)) }
        : { turn: turns[turn]?.name ?? turn, weight },
    ),
  };
}

/**
 * @param {object} about name, title, licence, credits and what else the file says of itself
 * @param {ReturnType<import('../../../web/element/head/model/model.mjs').readModel>} model
 */
export function packModel(about, model) {
  const { view, turns } = model;
  return {
    format: 'faccia-head',
    version: 1,
    ...about,
    fapu: Object.fromEntries(Object.entries(model.fapu).map(([name, x]) => [name, round(x, 1e4)])),
    fdp: Object.fromEntries(Object.entries(model.fdp).map(([name, p]) => [name, place(p)])),
    view: { target: place(view.target), distance: round(view.distance, 10), fov: view.fov },
    turns: turns.map(({ name, fap, pivot, axis, radians }) => ({ name, fap, pivot: place(pivot), axis, radians: Number(radians.toPrecision(9)) })),
    textures: model.textures,
    materials: model.materials,
    parts: model.parts.map((part) => packPart(part, turns)),
  };
}
