// SPDX-License-Identifier: GPL-3.0-or-later
// Finds meshes of a head that penetrate each other in a pose. Poses only the triangles near mouth and eyes, and only visible hair; shallower
// penetration than the tolerance counts as contact, because soft parts yield.
import { createRequire } from 'node:module';
import { crossings } from '../../models/tools/lib/crossing.mjs';
import { pose } from '../../models/tools/lib/deform.mjs';

const sharp = createRequire(new URL('../../models/package.json', import.meta.url))('sharp');

/**
 * [part, other part, tolerance in mm]. Teeth hardly penetrate each other (in anger the lower ones press against the upper ones). The tongue presses against them (its sides against the molars at
 * /s/, its tip between the incisors at /θ/), the inside of the lips even more (on the incisors at /f/). Nothing may come through the lips.
 */
const AT_THE_MOUTH = [
  ['teeth_upper', 'teeth_lower', 1.2],
  ['teeth_upper', 'skin', 1.2],
  ['teeth_lower', 'skin', 1.2],
  ['teeth_upper', 'mouth', 2.5],
  ['teeth_lower', 'mouth', 2.5],
  ['tongue', 'teeth_upper', 2],
  ['tongue', 'teeth_lower', 2],
  ['tongue', 'skin', 1.2],
  ['beard', 'teeth_upper', 0.8],
  ['beard', 'teeth_lower', 0.8],
  ['beard', 'tongue', 0.8],
];

/** The same at the eyes. Hair and lenses are hard; hair in hair yields (bushy brows on lashes). Lashes are rooted in their lids, so they are checked only against the other lid, whose margin is about 2 mm thick. */
const AT_THE_EYES = [
  ['brows', 'hair', 0.5],
  ['lashes', 'hair', 0.5],
  ['lids', 'hair', 0.5],
  ['lashes', 'brows', 3],
  ['lid_upper', 'lid_lower', 1.5],
  ['lash_upper', 'lid_lower', 1.5],
  ['lash_lower', 'lid_upper', 1.5],
  ['brows', 'glasses', 0.5],
  ['lashes', 'glasses', 0.5],
  ['lids', 'glasses', 0.5],
];

/** Tolerance of lids and lashes in an eyeball, mm: the cornea bulges, and lid margins are thick. */
const IN_EYE_MM = 0.8;

const MOUTH_BOX = { x: 34, y: 26, behind: 45 }; // mm around the lips
const EYES_BOX = { x: 75, y: 32, behind: 40 }; // mm around the eyes; brows are about 20 above

/** FAPs that move something there; poses that differ only in others are equivalent. */
export const MOUTH_FAPS = [3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 39, 40, 41, 42, 43, 44, 45, 46, 47, 51, 52, 53, 54, 55, 56, 57, 58, 59, 60, 61, 62, 63, 64];
export const EYE_FAPS = [19, 20, 21, 22, 23, 24, 25, 26, 31, 32, 33, 34, 35, 36, 37, 38, 41, 42, 61, 62, 63, 64];

/** Makes a part of the triangles whose corners are all wanted. @param {(v: number) => boolean} wanted */
export function cut(part, wanted) {
  const number = new Map();
  const index = [];
  for (let t = 0; t < part.index.length; t += 3) {
    const three = [0, 1, 2].map((i) => part.index[t + i]);
    if (!three.every(wanted)) continue;
    for (const v of three) index.push(number.get(v) ?? (number.set(v, number.size), number.size - 1));
  }
  const kept = (vertices) => [...vertices.keys()].filter((i) => number.has(vertices[i]));
  const renamed = (vertices, those) => those.map((i) => number.get(vertices[i]));
  return {
    ...part,
    index: Uint16Array.from(index),
    position: Float64Array.from([...number.keys()].flatMap((v) => [0, 1, 2].map((k) => part.position[v * 3 + k]))),
    moves: part.moves
      .map((move) => {
        const those = kept(move.vertices);
        return { ...move, vertices: renamed(move.vertices, those), deltas: those.flatMap((i) => [0, 1, 2].map((k) => move.deltas[i * 3 + k])) };
      })
      .filter(({ vertices }) => vertices.length),
    turns: part.turns.map((turn) => {
      if (!turn.vertices) return turn;
      const those = kept(turn.vertices);
      return { ...turn, vertices: renamed(turn.vertices, those), weights: those.map((i) => turn.weights[i]) };
    }),
  };
}

const inside = ({ position: p }, [x, y, z], box) => (v) =>
  Math.abs(p[v * 3] - x) < box.x && Math.abs(p[v * 3 + 1] - y) < box.y && p[v * 3 + 2] > z - box.behind;

/** Largest weight of each vertex in the turns whose names match `start`. */
function weights(part, start) {
  const out = new Float64Array(part.position.length / 3);
  for (const { turn, vertices, weights: of } of part.turns)
    if (start.test(turn)) vertices.forEach((v, i) => (out[v] = Math.max(out[v], of[i])));
  return out;
}

const SEEN = 100; // opacity of 255; fainter hair hides nothing

/** Removes triangles whose texture is transparent at the corners, the middles of the edges and the centre. */
async function onlySeen(head, part) {
  const { texture, alpha } = head.materials[part.material];
  if (!texture || !['blend', 'cutout'].includes(alpha)) return part;
  const image = sharp(Buffer.from(head.textures[texture].data, 'base64')).ensureAlpha().extractChannel(3).raw();
  const { data, info } = await image.toBuffer({ resolveWithObject: true });
  const at = (u, v) => {
    const [x, y] = [u * (info.width - 1), (1 - v) * (info.height - 1)].map((value) => Math.round(value));
    return data[y * info.width + x];
  };
  const shares = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [0.5, 0.5, 0], [0.5, 0, 0.5], [0, 0.5, 0.5], [1 / 3, 1 / 3, 1 / 3]];
  const index = [];
  for (let t = 0; t < part.index.length; t += 3) {
    const three = [...part.index.slice(t, t + 3)];
    const uv = (share, k) => three.reduce((sum, v, i) => sum + share[i] * part.uv[v * 2 + k], 0);
    if (shares.some((share) => at(uv(share, 0), uv(share, 1)) > SEEN)) index.push(...three);
  }
  return { ...part, index };
}

/** Checks the meshes of a head in poses. */
export class Sweep {
  /** @param head as returned by unpack() */
  static async of(head) {
    const parts = await Promise.all(head.parts.map((part) => onlySeen(head, part)));
    return new Sweep(head, parts);
  }

  constructor(head, parts) {
    this.head = head;
    this.still = new Map();
    const part = (name) => parts.find((one) => one.name === name);
    const near = (at, box, pairs, special) => {
      const names = [...new Set(pairs.flatMap(([a, b]) => [a, b]))];
      const parts = names.map((name) => [name, special[name] ?? (part(name) && cut(part(name), inside(part(name), at, box)))]);
      return Object.fromEntries(parts.filter(([, one]) => one));
    };
    this.mouthParts = near(head.fdp['2.2'], MOUTH_BOX, AT_THE_MOUTH, {});
    this.eyeParts = near([0, 4, head.fdp['3.5'][2]], EYES_BOX, AT_THE_EYES, this.#lids(part('skin'), part('lashes')));
    this.balls = ['l', 'r'].map((side) => this.#ball(part(`eye_${side}`), [part('skin'), part('lashes')]));
  }

  #lids(skin, lashes) {
    const of = (one, start, least) => {
      const weight = weights(one, start);
      return cut(one, (v) => weight[v] > least);
    };
    return {
      lids: of(skin, /^lid_/, 0.02),
      lid_upper: of(skin, /^lid_._upper/, 0.3),
      lid_lower: of(skin, /^lid_._lower/, 0.3),
      lash_upper: of(lashes, /^lid_._upper/, 0.5),
      lash_lower: of(lashes, /^lid_._lower/, 0.5),
    };
  }

  /** Describes an eyeball by its radius as a function of the angle from its gaze, and lists vertices of lids and lashes in front of it. */
  #ball(eye, covers) {
    const { pivot } = this.head.turns.find(({ name }) => eye.turns.some((t) => t.turn === name));
    const away = (p, v) => pivot.map((c, k) => p[v * 3 + k] - c);
    const rings = Array.from({ length: eye.position.length / 3 }, (_, v) => {
      const d = away(eye.position, v);
      const length = Math.hypot(...d);
      return { angle: Math.acos(d[2] / length), length, v };
    }).sort((a, b) => a.angle - b.angle);
    const radius = (angle) => {
      let [low, high] = [0, rings.length - 1];
      while (high - low > 1) {
        const middle = (low + high) >> 1;
        if (rings[middle].angle < angle) low = middle;
        else high = middle;
      }
      return rings[low].length;
    };
    const front = { name: eye.name, turns: eye.turns, moves: [], position: eye.position.slice(rings[0].v * 3, rings[0].v * 3 + 3) };
    const before = covers.map((part) => {
      const margin = cut(part, inside(part, [pivot[0], pivot[1], pivot[2] + 3], { x: 24, y: 24, behind: 0 }));
      const p = margin.position;
      const mine = [];
      for (let v = 0; v < p.length / 3; v++) {
        const d = away(p, v);
        const length = Math.hypot(...d);
        const out = length - radius(Math.acos(d[2] / length));
        // Only vertices outside at rest: deeper ones belong to the socket behind the lids.
        if (out > 0.3 && out < 12) mine.push(v);
      }
      return { margin, mine };
    });
    return { name: eye.name, pivot, radius, front, before };
  }

  /** @returns {{pair: string, count: number, mm: number, at: number[]}[]} pairs that penetrate, number of edges (for an eye: vertices), depth in mm */
  mouth(faps) {
    return this.#pairs(AT_THE_MOUTH, this.mouthParts, faps);
  }

  /** The same at the eyes. */
  eyes(faps) {
    return [...this.#pairs(AT_THE_EYES, this.eyeParts, faps), ...this.balls.flatMap((ball) => this.#pressed(ball, faps))];
  }

  #pairs(pairs, parts, faps) {
    const posed = {};
    const place = (part) => ({ position: pose(this.head, part, faps), index: part.index });
    const at = (name) => (posed[name] ??= this.#moves(parts[name], faps) ? place(parts[name]) : this.#still(parts[name], place));
    return pairs.flatMap(([a, b, tolerance]) => {
      if (!parts[a] || !parts[b]) return [];
      const { count, deepest, at: place } = crossings(at(a), at(b), tolerance);
      return count ? [{ pair: `${a} through ${b}`, count, mm: deepest, at: place }] : [];
    });
  }

  /** Tells whether the FAPs move the part. */
  #moves(part, faps) {
    const turning = (name) => this.head.turns.find((turn) => turn.name === name).fap;
    return part.moves.some(({ fap }) => faps[fap]) || part.turns.some(({ turn }) => faps[turning(turn)]);
  }

  /** Caches a part at rest, because precomputed data is stored with the mesh. */
  #still(part, place) {
    if (!this.still.has(part)) this.still.set(part, place(part));
    return this.still.get(part);
  }

  #pressed({ name, pivot, radius, front, before }, faps) {
    const looks = pose(this.head, front, faps).map((x, k) => x - pivot[k]);
    const length = Math.hypot(...looks);
    return before.flatMap(({ margin, mine }) => {
      const p = pose(this.head, margin, faps);
      let [worst, count, at] = [0, 0, null];
      for (const v of mine) {
        const d = pivot.map((c, k) => p[v * 3 + k] - c);
        const far = Math.hypot(...d);
        const cosine = d.reduce((sum, x, k) => sum + x * looks[k], 0) / far / length;
        const deep = radius(Math.acos(Math.min(1, Math.max(-1, cosine)))) - far;
        if (deep > IN_EYE_MM) count++;
        if (deep > worst) [worst, at] = [deep, [...p.slice(v * 3, v * 3 + 3)]];
      }
      return count ? [{ pair: `${margin.name} into ${name}`, count, mm: worst, at }] : [];
    });
  }
}
