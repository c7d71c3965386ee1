// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Checks of a built head against protocol/head-model.md. Each check takes the unpacked head and returns a list of errors as sentences.
 */
import { pose, unitLength } from './deform.mjs';
import { FAPS } from './faps.mjs';
import { view } from './visibility.mjs';

export * from './check-mouth.mjs';

const PARTS = ['skin', 'hair', 'eye_l', 'eye_r', 'teeth_upper', 'teeth_lower', 'tongue', 'mouth', 'lashes', 'brows'];
export const MOST_BYTES = 1.2e6;

/** Values that speech and expression really use; the table's extremes are far outside. */
const TRIAL = { MNS: 300, MW: 150, ENS: 200, ES: 100, IRISD: 300, AU: 20000 };
/**
 * A rotation moves its point on a circle, which deviates from the straight line by these shares at the trial values, in both directions.
 */
const CIRCLE = { forth: 0.035, back: 0.1 };

export function checkParts(head) {
  const out = PARTS.filter((name) => !head.parts.some((p) => p.name === name)).map(
    (name) => `part ${name} is missing`,
  );
  for (const part of head.parts) {
    const n = part.position.length / 3;
    const material = head.materials[part.material];
    if (!material) out.push(`${part.name}: no material ${part.material}`);
    else if (material.texture && !head.textures[material.texture])
      out.push(`${part.name}: no texture ${material.texture}`);
    if (part.vertices !== n || part.triangles !== part.index.length / 3)
      out.push(`${part.name}: counts do not agree`);
    if (part.uv.length !== n * 2)
      out.push(`${part.name}: ${part.uv.length} texture coordinates for ${n} vertices`);
    if (part.smooth && part.smooth.length !== n)
      out.push(`${part.name}: smooth has ${part.smooth.length} entries`);
    const lists = [
      ['index', part.index],
      ['smooth', part.smooth ?? []],
      ...part.moves.map((m) => [`FAP ${m.fap}`, m.vertices]),
      ...part.turns.map((t) => [t.turn, t.vertices ?? []]),
    ];
    for (const [name, list] of lists)
      if (list.some((v) => v >= n)) out.push(`${part.name}: ${name} points past the last vertex`);
    for (const m of part.moves)
      if (m.deltas.length !== m.vertices.length * 3) out.push(`${part.name}: FAP ${m.fap} is cut short`);
    for (const t of part.turns)
      if (!head.turns.some((x) => x.name === t.turn)) out.push(`${part.name}: no turn ${t.turn}`);
  }
  for (const t of head.turns)
    if (Math.abs(Math.hypot(...t.axis) - 1) > 1e-6) out.push(`${t.name}: the axis is not a unit vector`);
  return out;
}

/** No cracks: an open edge with a vertex in its middle shows as three open edges in a triangle. */
export function checkCracks(head) {
  const out = [];
  for (const part of head.parts) {
    const same = (v) => (part.smooth ? part.smooth[v] : v);
    const uses = new Map();
    for (let t = 0; t < part.index.length; t += 3) {
      for (let i = 0; i < 3; i++) {
        const a = same(part.index[t + i]),
          b = same(part.index[t + ((i + 1) % 3)]);
        const key = a < b ? `${a}/${b}` : `${b}/${a}`;
        uses.set(key, (uses.get(key) ?? 0) + 1);
      }
    }
    const open = new Map();
    for (const [key, n] of uses) {
      if (n !== 1) continue;
      const [a, b] = key.split('/').map(Number);
      for (const [x, y] of [
        [a, b],
        [b, a],
      ])
        (open.get(x) ?? open.set(x, new Set()).get(x)).add(y);
    }
    const size = (a, b) =>
      Math.hypot(...[0, 1, 2].map((k) => part.position[a * 3 + k] - part.position[b * 3 + k]));
    for (const [a, ends] of open)
      for (const b of ends)
        for (const m of ends) {
          if (a > b || m === b || !open.get(b).has(m)) continue;
          if (size(a, m) + size(m, b) < size(a, b) * 1.1)
            out.push(`${part.name}: a crack between vertices ${a} and ${b}`);
        }
  }
  return out;
}

/** Every FAP acts on something, and moves its feature point by value * FAPU / 1024 along its direction. */
export function checkFeaturePoints(head) {
  const out = [];
  for (const [number, fap] of Object.entries(FAPS)) {
    const acts = head.parts.some(
      (part) =>
        part.moves.some((m) => m.fap === Number(number)) ||
        part.turns.some((t) => head.turns.find((x) => x.name === t.turn)?.fap === Number(number)),
    );
    if (!acts) out.push(`FAP ${number} ${fap.name} acts on nothing`);
    if (!fap.direction) continue;
    const at = vertexAt(head, head.fdp[fap.point]);
    if (!at) {
      out.push(`FAP ${number}: no vertex at feature point ${fap.point}`);
      continue;
    }
    const turns = at.part.turns.some(
      (t) => head.turns.find((x) => x.name === t.turn)?.fap === Number(number),
    );
    for (const value of fap.bidirectional ? [TRIAL[fap.unit], -TRIAL[fap.unit]] : [TRIAL[fap.unit]]) {
      const moved = displacement(head, at, { [number]: value });
      const want = value * unitLength(head, number);
      const along = moved.reduce((sum, x, k) => sum + x * fap.direction[k], 0);
      const slack = Math.abs(want) * (turns ? CIRCLE[value > 0 ? 'forth' : 'back'] : 0.005) + 0.02;
      if (!(Math.abs(along - want) <= slack))
        out.push(
          `FAP ${number} at ${value} moves ${fap.point} by ${along.toFixed(3)} mm, not ${want.toFixed(3)}`,
        );
    }
  }
  return out;
}

/**
 * Inner and outer contour with the same value move the lips as one: each of their points by that value, no
 * less, no more.
 */
export function checkLipsMoveAsOne(head) {
  const groups = [
    [[5, 10, 11, 52, 57, 58], ['2.3', '2.8', '2.9', '8.2', '8.7', '8.8'], 1],
    [[4, 8, 9, 51, 55, 56], ['2.2', '2.6', '2.7', '8.1', '8.5', '8.6'], -1],
  ];
  const out = [];
  for (const [faps, points, up] of groups) {
    for (const value of [-500, 100]) {
      for (const point of points) {
        const at = vertexAt(head, head.fdp[point]);
        const y = displacement(head, at, Object.fromEntries(faps.map((f) => [f, value])))[1];
        const want = up * value * unitLength(head, faps[0]);
        if (Math.abs(y - want) > Math.abs(want) * 0.01 + 0.03)
          out.push(`${point} moves by ${y.toFixed(2)} mm with its lip, not ${want.toFixed(2)}`);
      }
    }
  }
  for (const point of ['2.2', '2.3', '8.2']) {
    const d = displacement(head, vertexAt(head, head.fdp[point]), { 3: 500 });
    if (Math.hypot(...d) > 0.3)
      out.push(`FAP 3 alone moves the lips: ${point} by ${Math.hypot(...d).toFixed(2)} mm`);
  }
  return out;
}

/**
 * Neutral face: the lips touch along the whole line, so the inside of the mouth is invisible from the front and the sides.
 */
export function checkNeutral(head) {
  const out = [];
  const gap = Math.hypot(...head.fdp['2.2'].map((x, k) => x - head.fdp['2.3'][k]));
  if (gap > 1.6) out.push(`the feature points of the lips are ${gap.toFixed(2)} mm apart`);
  for (const yaw of [-0.6, 0, 0.6]) {
    const seen = view(head, {}, { yaw, pitch: 0 });
    for (const part of ['teeth_upper', 'teeth_lower', 'tongue']) {
      if (seen.count(part))
        out.push(`${part} is seen between the closed lips at ${yaw} rad (${seen.count(part)} points)`);
    }
  }
  const front = view(head, {}, { yaw: 0, pitch: 0 });
  for (const eye of ['eye_l', 'eye_r'])
    if (front.count(eye) < 400) out.push(`${eye} is hidden on the neutral face`);
  return out;
}

/** The upper lid alone, both lids, and slightly beyond closure hide the eyes completely. */
export function checkEyelids(head) {
  const out = [];
  for (const [upper, lower] of [
    [1024, 0],
    [700, 324],
    [512, 512],
    [1080, 0],
  ]) {
    for (const yaw of [-0.5, 0, 0.5]) {
      const seen = view(head, { 19: upper, 20: upper, 21: lower, 22: lower }, { yaw, pitch: 0 });
      for (const eye of ['eye_l', 'eye_r']) {
        if (seen.count(eye) > 3)
          out.push(
            `${eye} shows through closed lids (${upper}, ${lower}) at ${yaw} rad: ${seen.count(eye)} points`,
          );
      }
    }
  }
  return out;
}

/**
 * FAPs of the left side mirror those of the right, up to the face's own asymmetry.
 */
export function checkSymmetry(head) {
  const pairs = [
    [6, 7],
    [8, 9],
    [10, 11],
    [12, 13],
    [19, 20],
    [21, 22],
    [31, 32],
    [33, 34],
    [35, 36],
    [37, 38],
    [39, 40],
    [41, 42],
    [53, 54],
    [55, 56],
    [57, 58],
    [59, 60],
    [61, 62],
    [65, 66],
    [67, 68],
  ];
  const skin = head.parts.find((p) => p.name === 'skin');
  const total = (fap) => {
    const moved = pose(head, skin, { [fap]: TRIAL[FAPS[fap].unit] });
    const sum = [0, 0, 0];
    for (let i = 0; i < moved.length; i++) sum[i % 3] += moved[i] - skin.position[i];
    return [Math.abs(sum[0]), sum[1], sum[2]];
  };
  return pairs.flatMap(([left, right]) => {
    const l = total(left),
      r = total(right);
    const size = Math.hypot(...l);
    const off = Math.hypot(...l.map((x, k) => x - r[k]));
    return off > size * 0.12
      ? [`FAPs ${left} and ${right} differ by ${((100 * off) / size).toFixed(0)} %`]
      : [];
  });
}

/** The nearest vertex of all parts, if it lies at the place. */
function vertexAt(head, place) {
  let best = null,
    least = 0.03;
  for (const part of head.parts) {
    for (let v = 0; v < part.position.length / 3; v++) {
      const d = Math.hypot(...place.map((x, k) => x - part.position[v * 3 + k]));
      if (d < least) {
        least = d;
        best = { part, v };
      }
    }
  }
  return best;
}

function displacement(head, { part, v }, faps) {
  const moved = pose(head, part, faps);
  return [0, 1, 2].map((k) => moved[v * 3 + k] - part.position[v * 3 + k]);
}
