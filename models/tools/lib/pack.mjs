// SPDX-License-Identifier: GPL-3.0-or-later
/** Writing a head in the format of protocol/head-model.md. */
import { encode, encodeDeltas, encodePositions, round } from './codec.mjs';

export function packHead({ recipe, fapu, fdp, figures, turns, textures, materials, parts }) {
  const place = (p) => p.map((x) => round(x, 1e3));
  return {
    format: 'faccia-head',
    version: 1,
    name: recipe.name,
    title: recipe.title,
    licence: recipe.licence,
    credits: recipe.credits,
    ...(recipe.about ? { about: recipe.about } : {}),
    ...(recipe.voice ? { voice: recipe.voice } : {}),
    ...(recipe.rank === undefined ? {} : { rank: recipe.rank }),
    fapu: Object.fromEntries(Object.entries(fapu).map(([k, x]) => [k, round(x, 1e4)])),
    fdp: Object.fromEntries(Object.entries(fdp).map(([k, p]) => [k, place(p)])),
    mouth: Object.fromEntries(
      ['upperShown', 'lowerShown', 'overbite', 'overjet'].map((k) => [k, round(figures[k], 1e2)]),
    ),
    view: recipe.view,
    ...(recipe.body?.breath ? { breath: { shift: recipe.body.breath } } : {}),
    turns: turns.map(({ name, fap, pivot, axis, radians }) => ({
      name,
      fap,
      pivot: place(pivot),
      axis,
      radians: Number(radians.toPrecision(9)),
    })),
    textures: Object.fromEntries(
      Object.entries(textures).map(([name, t]) => [name, { ...t, data: t.data.toString('base64') }]),
    ),
    materials,
    parts: parts.map(packPart),
  };
}

function packPart(part) {
  const out = {
    name: part.name,
    material: part.material,
    vertices: part.position.length / 3,
    triangles: part.index.length / 3,
    position: encodePositions(part.position),
    uv: {
      data: encode(
        'uint16',
        part.uv.map((x) => Math.round(Math.min(1, Math.max(0, x)) * 65535)),
      ),
    },
    index: { data: encode('uint16', part.index) },
  };
  if (part.smooth) out.smooth = { data: encode('uint16', part.smooth) };
  out.moves = part.moves.map((m) => ({
    fap: m.fap,
    sign: m.sign,
    vertices: encode('uint16', m.vertices),
    deltas: encodeDeltas(m.deltas),
  }));
  out.turns = part.turns.map((t) =>
    t.vertices
      ? { turn: t.turn, vertices: encode('uint16', t.vertices), weights: encode('uint8', t.weights) }
      : { turn: t.turn, weight: t.weight },
  );
  if (part.breath) out.breath = { vertices: encode('uint16', part.breath.vertices), weights: encode('uint8', part.breath.weights) };
  if (part.sway) out.sway = { pivot: part.sway.pivot.map((x) => round(x, 1e3)), weights: encode('uint8', part.sway.weights.map((w) => 17 * Math.round(15 * w))) };
  return out;
}
