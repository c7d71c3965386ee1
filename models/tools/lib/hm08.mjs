// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Landmarks of the base mesh hm08: closed edge loops round the mouth and round each eye, walked from a start vertex and its neighbour.
 * Column 0 of the mouth is the upper lip's middle, the last column the lower lip's; the loops on the right mirror those on the left.
 */
import { neighbours } from './mesh.mjs';

/**
 * From the skin round the lips (0) over the outer contour (1), the lips, the line of contact (7) into the
 * mouth (17).
 */
const MOUTH_STARTS = [
  362, 455, 466, 467, 509, 468, 474, 520, 537, 554, 571, 588, 605, 622, 639, 656, 673, 690,
];
export const MOUTH_OUTER = 1;
export const MOUTH_CONTACT = 7;
const MOUTH_COLUMNS = 20;

/**
 * From below the brow (0) over the lids' skin and margin (6) to the socket (14); walked outward over the
 * upper lid.
 */
const EYE_STARTS = [
  [6929, 6931],
  [6873, 6875],
  [11514, 11494],
  [6788, 6792],
  [6786, 6791],
  [11466, 11467],
  [6784, 6790],
  [13353, 13358],
  [7747, 7749],
  [7773, 7775],
  [7799, 7801],
  [7825, 7827],
  [7851, 7853],
  [7877, 7879],
  [7903, 7905],
];
export const EYE_MARGIN = 6;

export function readTopology(base) {
  const group = base.groups.indexOf('body');
  const faces = base.faces.filter((f) => f.group === group);
  const near = neighbours(faces, base.positions.length / 3);
  const facesOf = new Map();
  faces.forEach((f, i) => f.v.forEach((v) => (facesOf.get(v) ?? facesOf.set(v, []).get(v)).push(i)));
  const mirror = mirrorMap(base.positions);

  /** Returns the next vertex straight on after `from`, `at`: the one that shares no face with `from`. */
  const straight = (from, at) => {
    const beside = new Set(
      facesOf
        .get(at)
        .filter((i) => faces[i].v.includes(from))
        .flatMap((i) => faces[i].v),
    );
    const on = near[at].filter((v) => !beside.has(v));
    if (on.length !== 1) throw new Error(`edge loop ${from}-${at} does not go on`);
    return on[0];
  };
  const walk = (start, next, count) => {
    const loop = [start, next];
    while (loop.length < count) loop.push(straight(loop[loop.length - 2], loop[loop.length - 1]));
    return loop;
  };
  const x = (v) => base.positions[v * 3];
  const mouthLeft = MOUTH_STARTS.map((s) =>
    walk(
      s,
      near[s].find((v) => x(v) > 1e-4),
      MOUTH_COLUMNS,
    ),
  );
  const eyeLeft = EYE_STARTS.map(([s, n]) => walk(s, n, 28));
  const flip = (loops) => loops.map((loop) => loop.map((v) => mirror[v]));
  return {
    faces,
    near,
    mirror,
    mouth: { l: mouthLeft, r: flip(mouthLeft) },
    eye: { l: eyeLeft, r: flip(eyeLeft) },
  };
}

/** For each vertex the one on the other side: the mesh is symmetric up to rounding. */
function mirrorMap(p) {
  const cells = new Map();
  const key = (x, y, z) => `${Math.round(x * 50)},${Math.round(y * 50)},${Math.round(z * 50)}`;
  for (let v = 0; v < p.length / 3; v++) {
    const k = key(p[v * 3], p[v * 3 + 1], p[v * 3 + 2]);
    (cells.get(k) ?? cells.set(k, []).get(k)).push(v);
  }
  const out = new Int32Array(p.length / 3);
  for (let v = 0; v < out.length; v++) {
    const q = [-p[v * 3], p[v * 3 + 1], p[v * 3 + 2]];
    let best = -1,
      least = Infinity;
    for (let dx = -0.02; dx < 0.03; dx += 0.02)
      for (let dy = -0.02; dy < 0.03; dy += 0.02)
        for (let dz = -0.02; dz < 0.03; dz += 0.02) {
          for (const w of cells.get(key(q[0] + dx, q[1] + dy, q[2] + dz)) ?? []) {
            const d = (p[w * 3] - q[0]) ** 2 + (p[w * 3 + 1] - q[1]) ** 2 + (p[w * 3 + 2] - q[2]) ** 2;
            if (d < least) {
              least = d;
              best = w;
            }
          }
        }
    out[v] = best;
  }
  return out;
}
