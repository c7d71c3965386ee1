// SPDX-License-Identifier: GPL-3.0-or-later
/** Deforms a head as a client does (protocol/head-model.md), on the CPU: for checks and pictures. */
import { decode } from './codec.mjs';
import { FAPS } from './faps.mjs';

/** The head with its binary arrays as plain arrays. */
export function unpack(head) {
  return { ...head, parts: head.parts.map(unpackPart) };
}

function unpackPart(part) {
  const q = part.position;
  const position = Float64Array.from(decode('int16', q.data), (x, i) => x * q.scale + q.offset[i % 3]);
  return {
    ...part,
    position,
    uv: decode('uint16', part.uv.data).map((x) => x / 65535),
    index: decode('uint16', part.index.data),
    smooth: part.smooth ? decode('uint16', part.smooth.data) : null,
    moves: part.moves.map((m) => ({
      ...m,
      vertices: decode('uint16', m.vertices),
      deltas: decode('int16', m.deltas.data).map((x) => x * m.deltas.scale),
    })),
    turns: part.turns.map((t) => ({
      turn: t.turn,
      vertices: t.vertices ? decode('uint16', t.vertices) : null,
      weights: t.weights ? decode('uint8', t.weights).map((w) => w / 255) : null,
      weight: t.weight,
    })),
    ...(part.sway ? { sway: { ...part.sway, weights: decode('uint8', part.sway.weights).map((w) => w / 255) } } : {}),
  };
}

/** @param {Object<number, number>} faps values by FAP number @returns {Float64Array} positions in mm */
export function pose(head, part, faps) {
  const p = part.position;
  const out = Float64Array.from(p);
  for (const move of part.moves) {
    const value = faps[move.fap] ?? 0;
    const from = move.from ?? 0;
    const past = move.sign === 'both' ? value : move.sign === 'positive' ? Math.max(0, value - from) : Math.min(0, value + from);
    if (!past) continue;
    const amount = past * unitLength(head, move.fap);
    move.vertices.forEach((v, i) => {
      for (let k = 0; k < 3; k++) out[v * 3 + k] += amount * move.deltas[i * 3 + k];
    });
  }
  const last = [];
  for (const t of part.turns) {
    const turn = head.turns.find((x) => x.name === t.turn);
    const value = faps[turn.fap] ?? 0;
    if (!value) continue;
    if (FAPS[turn.fap].headTurn) {
      last.push({ t, turn, value });
      continue;
    }
    eachVertex(part, t, (v, w) => {
      const q = rotate(turn, value * turn.radians * w, p[v * 3], p[v * 3 + 1], p[v * 3 + 2]);
      for (let k = 0; k < 3; k++) out[v * 3 + k] += q[k] - p[v * 3 + k];
    });
  }
  last.sort((a, b) => a.turn.fap - b.turn.fap);
  for (const { t, turn, value } of last) {
    eachVertex(part, t, (v, w) => {
      const q = rotate(turn, value * turn.radians * w, out[v * 3], out[v * 3 + 1], out[v * 3 + 2]);
      for (let k = 0; k < 3; k++) out[v * 3 + k] = q[k];
    });
  }
  return out;
}

/** Size of one unit of a FAP, mm. */
export function unitLength(head, fap) {
  const unit = FAPS[fap].unit;
  return unit === 'AU' ? 1e-5 : head.fapu[unit] / 1024;
}

/** Rodrigues' formula about an axis through the turn's pivot. */
function rotate(turn, angle, x, y, z) {
  const [ax, ay, az] = turn.axis;
  const px = x - turn.pivot[0],
    py = y - turn.pivot[1],
    pz = z - turn.pivot[2];
  const c = Math.cos(angle),
    s = Math.sin(angle);
  const d = (ax * px + ay * py + az * pz) * (1 - c);
  return [
    turn.pivot[0] + px * c + (ay * pz - az * py) * s + ax * d,
    turn.pivot[1] + py * c + (az * px - ax * pz) * s + ay * d,
    turn.pivot[2] + pz * c + (ax * py - ay * px) * s + az * d,
  ];
}

function eachVertex(part, t, fn) {
  if (t.vertices) t.vertices.forEach((v, i) => fn(v, t.weights[i]));
  else for (let v = 0; v < part.position.length / 3; v++) fn(v, t.weight);
}
