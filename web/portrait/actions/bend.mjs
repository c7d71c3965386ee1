// SPDX-License-Identifier: MIT
/**
 * Measures how a face in a pose differs from what the base's FAPs would do, by image registration: shifts the points of a
 * coarse grid over it (Rueckert and others, "Nonrigid registration using free-form deformations", 1999). Upper and lower lip
 * are shifted separately.
 */
import { lookAt } from '../planes.mjs';
import { solve } from '../solve.mjs';

const SPACING = 13; // mm between the points
const REACH = 20; // mm
const STEPS = [4, 4, 4]; // looks, from coarse to fine
const USUAL = 2; // mm, standard deviation of a shift
// as much counts what is usual: places beside each other say the same thing, and light that changes is no motion
const TRUST = 120;
const NOISE = 1; // of 255
const UNLIKE = 3; // deviations: what differs more is something else (teeth, a crease)
const LEAST = 12; // places that a point must have

const cosine = (t) => (t < 1 ? 0.5 + 0.5 * Math.cos(Math.PI * t) : 0);

/** 1 above the line of the lips, -1 below, 0 beside the mouth. */
export function sideOf({ '8.3': left, '8.4': right, '2.2': top, '2.3': bottom }) {
  const [middle, half] = [(left[0] + right[0]) / 2, (left[0] - right[0]) / 2];
  const [ends, centre] = [(left[1] + right[1]) / 2, (top[1] + bottom[1]) / 2];
  return (x, y) => {
    const t = (x - middle) / half;
    return Math.abs(t) > 1 ? 0 : Math.sign(y - (centre + (ends - centre) * t * t)) || 1;
  };
}

/** The points, and of each place which of them carry it, and how far. */
function gridOver({ count, place, skin: { fdp } }) {
  const side = sideOf(fdp);
  const sides = Int8Array.from({ length: count }, (_, i) => side(place[3 * i], place[3 * i + 1]));
  let [x0, y0, x1, y1] = [Infinity, Infinity, -Infinity, -Infinity];
  for (let i = 0; i < count; i++) {
    x0 = Math.min(x0, place[3 * i]); x1 = Math.max(x1, place[3 * i]);
    y0 = Math.min(y0, place[3 * i + 1]); y1 = Math.max(y1, place[3 * i + 1]);
  }
  const carried = Array.from({ length: count }, () => []);
  let points = 0;
  for (let y = y0; y < y1 + SPACING; y += SPACING)
    for (let x = x0; x < x1 + SPACING; x += SPACING)
      for (const of of side(x, y) ? [1, -1] : [0]) {
        const near = [];
        for (let i = 0; i < count; i++) {
          const share = sides[i] * of < 0 ? 0 : cosine(Math.hypot(place[3 * i] - x, place[3 * i + 1] - y) / REACH);
          if (share > 0.01) near.push([i, share]);
        }
        if (near.length < LEAST) continue;
        near.forEach(([i, share]) => carried[i].push([points, share]));
        points++;
      }
  return { carried, points };
}

/**
 * @param {import('../lay.mjs').Layer} layer
 * @param {object} picture
 * @param {number[][][]} rest of layer.seen
 * @param {{stand: object, q: Float64Array}} found by layer.lay
 * @returns {Float64Array} mm to the left and up for each place
 */
export function bend(layer, picture, rest, { stand, q }) {
  const { speaker } = layer;
  const { count } = speaker;
  const { carried, points } = gridOver(speaker);
  const levels = layer.planes(picture, stand);
  const from = layer.places(stand, q);
  const { turn: [a, b], scale } = stand;
  const gone = new Float64Array(2 * points);
  const shift = new Float64Array(2 * count);
  const sight = [0, 0, 0];
  STEPS.forEach((steps, l) => {
    for (let step = 0; step < steps; step++) {
      const looks = levels[l].planes.map((plane, k) => {
        const out = new Float64Array(3 * count).fill(NaN);
        for (let i = 0; i < count; i++) {
          const [dx, dy] = shift.subarray(2 * i, 2 * i + 2);
          const [u, v] = [scale * (a[0] * dx + a[1] * dy), scale * (b[0] * dx + b[1] * dy)];
          if (!lookAt(levels[l], plane, from[2 * i] + u, from[2 * i + 1] - v, sight)) continue;
          const [, gu, gv] = sight;
          out.set([sight[0] - rest[l][k][i], scale * (gu * a[0] - gv * b[0]), scale * (gu * a[1] - gv * b[1])], 3 * i);
        }
        return out;
      });
      const more = solve(...normal(looks, carried, gone));
      for (let n = 0; n < gone.length; n++) gone[n] += more[n];
      carried.forEach((list, i) => {
        for (let k = 0; k < 2; k++) shift[2 * i + k] = list.reduce((sum, [n, share]) => sum + share * gone[2 * n + k], 0);
      });
    }
  });
  return shift;
}

const middle = (list) => Float64Array.from(list).sort()[list.length >> 1] ?? 0;

function normal(looks, carried, gone) {
  const size = gone.length;
  const a = Array.from({ length: size }, (_, n) =>
    Float64Array.from({ length: size }, (__, m) => (n === m ? TRUST / USUAL ** 2 : 0)));
  const b = Float64Array.from(gone, (mm) => (-mm * TRUST) / USUAL ** 2);
  for (const look of looks) {
    const off = [];
    for (let i = 0; i < look.length; i += 3) if (look[i] === look[i]) off.push(Math.abs(look[i]));
    const spread = 1.5 * middle(off) + NOISE;
    carried.forEach((list, i) => {
      const r = look[3 * i];
      if (r !== r) return;
      const w = 1 / (spread * (1 + (r / spread / UNLIKE) ** 2)) ** 2;
      for (const [n, share] of list)
        for (let k = 0; k < 2; k++) {
          const j = share * look[3 * i + 1 + k];
          b[2 * n + k] -= w * j * r;
          for (const [m, other] of list) {
            a[2 * n + k][2 * m] += w * j * other * look[3 * i + 1];
            a[2 * n + k][2 * m + 1] += w * j * other * look[3 * i + 2];
          }
        }
    });
  }
  return [a, b];
}
