// SPDX-License-Identifier: GPL-3.0-or-later
/** Writes a model read by the client (web/element/head/model/model.mjs) in the format of protocol/head-model.md. */
import { BREATH } from '../../../web/element/head/model/model.mjs';
import { encode, encodeDeltas, encodePositions, round } from '../lib/codec.mjs';

const place = (p) => [...p].map((x) => round(x, 1e3));
const shares = (weights) => Array.from(weights, (w) => Math.round(255 * Math.min(1, Math.max(0, w))));

const breathOf = (part) => part.moves.find(({ fap }) => fap === BREATH);

/** A breath of the size that its moves have now: that of the file was scaled with the head. @returns {null|{shift: number[], weights: Function}} */
function breathNow(told, parts) {
  if (!told) return null;
  const k = told.shift.reduce((best, x, i) => (Math.abs(x) > Math.abs(told.shift[best]) ? i : best), 0);
  const ways = (move) => Array.from(move.vertices, (_, v) => move.deltas[3 * v + k] / told.shift[k]);
  const most = parts.map(breathOf).filter(Boolean).flatMap(ways).reduce((a, b) => Math.max(a, b), 0) || 1;
  return { shift: told.shift.map((x) => round(x * most, 1e3)), weights: (move) => encode('uint8', shares(ways(move).map((x) => x / most))) };
}

function packPart(part, turns, breath) {
  const breathing = breath && breathOf(part);
  return {
    name: part.name,
    material: part.material,
    vertices: part.position.length / 3,
    triangles: part.index.length / 3,
    position: encodePositions(part.position),
    uv: { data: encode('uint16', Array.from(part.uv ?? new Float32Array((2 * part.position.length) / 3), (x) => Math.round(Math.min(1, Math.max(0, x)) * 65535))) },
    index: { data: encode('uint16', part.index) },
    ...(part.smooth ? { smooth: { data: encode('uint16', part.smooth) } } : {}),
    moves: part.moves.filter(({ fap }) => fap !== BREATH).map(({ fap, sign, from, vertices, deltas }) => ({ fap, sign, ...(from ? { from } : {}), vertices: encode('uint16', vertices), deltas: encodeDeltas(deltas) })),
    turns: part.turns.filter(({ turn }) => !turns[turn]?.sways).map(({ turn, vertices, weights, weight }) =>
      vertices
        ? { turn: turns[turn]?.name ?? turn, vertices: encode('uint16', vertices), weights: encode('uint8', shares(weights)) }
        : { turn: turns[turn]?.name ?? turn, weight },
    ),
    ...(breathing ? { breath: { vertices: encode('uint16', breathing.vertices), weights: breath.weights(breathing) } } : {}),
    ...(part.sway ? { sway: { pivot: place(turns.find(({ name }) => name === `sway of ${part.name}`)?.pivot ?? part.sway.pivot), weights: encode('uint8', part.sway.weights) } } : {}),
  };
}

/**
 * @param {object} about name, title, licence, credits and what else the file says of itself; breath: how far a full one shifts
 * @param {ReturnType<import('../../../web/element/head/model/model.mjs').readModel>} model
 */
export function packModel(about, model) {
  const { view, turns } = model;
  const breath = breathNow(about.breath, model.parts);
  return {
    format: 'faccia-head',
    version: 1,
    ...about,
    ...(breath ? { breath: { shift: breath.shift } } : {}),
    fapu: Object.fromEntries(Object.entries(model.fapu).map(([name, x]) => [name, round(x, 1e4)])),
    fdp: Object.fromEntries(Object.entries(model.fdp).map(([name, p]) => [name, place(p)])),
    view: { target: place(view.target), distance: round(view.distance, 10), fov: view.fov },
    turns: turns.filter(({ sways }) => !sways).map(({ name, fap, pivot, axis, radians }) => ({ name, fap, pivot: place(pivot), axis, radians: Number(radians.toPrecision(9)) })),
    textures: model.textures,
    materials: model.materials,
    parts: model.parts.map((part) => packPart(part, turns, breath)),
  };
}
