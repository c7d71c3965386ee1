// SPDX-License-Identifier: MIT
// Glasses made to measure: frames without lenses, by the eyes, the bridge of the nose and the ears of a head.
import { packNumbers, packPositions } from './pack.mjs';

const APART = 62; // mm between the pupils, for which the sizes hold
const BEFORE = 13; // mm from the cornea to the rim
const CLEAR = 2.5; // mm from the bridge of the nose to the frame
const BENT = 0.0042; // 1/mm: how the frame bends around the face
const LOW = 2.5; // mm that rims stand lower than the pupils
const AROUND = 6; // sides of a tube
const STEPS = 40; // of a rim
const HALF = [-0.08, 1.08]; // of a half turn: the part of a rim that a half rim has
const HINGE = 5; // mm above the pupils
const EAR = 4; // mm that temples run above the ears' tops, outside of them

/** Sizes in mm; square: exponent of the rim's outline, 2 is a circle. */
const KINDS = {
  dark: { wide: 25, high: 17, square: 3.2, thick: 1.7, look: { color: [0.02, 0.018, 0.018], roughness: 0.3, specular: 0.5 } },
  metal: { wide: 24.5, high: 16, square: 2.7, thick: 0.55, look: { color: [0.32, 0.31, 0.3], roughness: 0.25, specular: 0.9 } },
  round: { wide: 22, high: 21, square: 2, thick: 0.95, look: { color: [0.09, 0.045, 0.025], roughness: 0.35, specular: 0.5 } },
  half: { wide: 25, high: 16.5, square: 3, thick: 1.25, half: true,
    look: { color: [0.03, 0.03, 0.035], roughness: 0.3, specular: 0.6 } },
};
export const FRAMES = Object.keys(KINDS);
const MATERIAL = 'frames';

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (v) => v.map((x) => x / (Math.hypot(...v) || 1));

/** A tube along a path. @param {number[][]} path @param {(i: number) => number} thick radius in mm */
function tube({ position, index }, path, thick, closed) {
  const first = position.length / 3;
  path.forEach((p, i) => {
    const at = (j) => (closed ? path[(j + path.length) % path.length] : path[Math.min(path.length - 1, Math.max(0, j))]);
    const [before, after] = [at(i - 1), at(i + 1)];
    const way = unit(after.map((x, k) => x - before[k]));
    const side = unit(cross(way, Math.abs(way[2]) < 0.8 ? [0, 0, 1] : [0, 1, 0]));
    const up = cross(side, way);
    for (let j = 0; j < AROUND; j++) {
      const [c, s] = [Math.cos((2 * Math.PI * j) / AROUND), Math.sin((2 * Math.PI * j) / AROUND)];
      position.push(...p.map((x, k) => x + thick * (c * side[k] + s * up[k])));
    }
  });
  const rings = closed ? path.length : path.length - 1;
  for (let i = 0; i < rings; i++)
    for (let j = 0; j < AROUND; j++) {
      const [here, there] = [first + i * AROUND, first + ((i + 1) % path.length) * AROUND];
      const next = (j + 1) % AROUND;
      const [a, b, c, d] = [here + j, here + next, there + j, there + next];
      index.push(a, b, c, b, d, c);
    }
}

/**
 * @param {'dark'|'metal'|'round'|'half'} kind @param {Record<string, number[]>} fdp feature points of the head
 * @param {ArrayLike<number>} skin positions @param {{turn: string}[]} turns of the whole head
 * @returns {{part: object, material: object, name: string}} in the form of protocol/head-model.md
 */
export function glasses(kind, fdp, skin, turns) {
  const { wide, high, square, thick, half = false, look } = KINDS[kind];
  const [left, right] = [fdp['3.5'], fdp['3.6']];
  const size = Math.abs(left[0] - right[0]) / APART;
  let bridge = Math.max(left[2], right[2]);
  for (let v = 0; v < skin.length; v += 3)
    if (Math.abs(skin[v]) < 8 && Math.abs(skin[v + 1] - left[1]) < 8) bridge = Math.max(bridge, skin[v + 2]);
  const front = Math.max(Math.max(left[2], right[2]) + BEFORE, bridge + CLEAR);
  const bent = (x, y) => [x, y, front - BENT * x * x];
  const mesh = { position: [], index: [] };
  const power = (x) => Math.sign(x) * Math.abs(x) ** (2 / square);
  for (const eye of [left, right]) {
    const rim = (share) => {
      const [c, s] = [Math.cos(Math.PI * share), Math.sin(Math.PI * share)].map(power);
      return bent(eye[0] + size * wide * c, eye[1] - LOW + size * high * s);
    };
    const turn = (i) => (half ? HALF[0] + ((HALF[1] - HALF[0]) * i) / (STEPS - 1) : (2 * i) / STEPS);
    const path = Array.from({ length: STEPS }, (_, i) => rim(turn(i)));
    tube(mesh, path, thick, !half);
    const sign = Math.sign(eye[0]);
    const [outer, ear] = [eye[0] + sign * size * (wide - 0.5), fdp[sign > 0 ? '10.1' : '10.2']];
    const hinge = bent(outer, eye[1] + HINGE);
    const aside = [Math.abs(hinge[0]), Math.abs(ear[0]) - EAR];
    const temple = [0, 0.06, 0.2, 0.45, 0.75, 1].map((t) => {
      const out = aside[0] + (aside[1] - aside[0]) * Math.min(1, 0.35 * Math.min(1, 8 * t) + 0.65 * t);
      return [sign * out, hinge[1] + (ear[1] + EAR - hinge[1]) * t, hinge[2] + (ear[2] + 8 - hinge[2]) * t];
    });
    tube(mesh, temple, thick * 0.9, false);
  }
  const inner = size * wide - 1;
  tube(mesh, Array.from({ length: 9 }, (_, i) => {
    const t = i / 8;
    const [x, arch] = [right[0] + inner + (left[0] - right[0] - 2 * inner) * t, 2.2 * Math.sin(Math.PI * t)];
    return bent(x, (left[1] + right[1]) / 2 + 3 + arch);
  }), thick, false);
  const vertices = mesh.position.length / 3;
  const part = { name: 'glasses', material: MATERIAL, vertices, triangles: mesh.index.length / 3, position: packPositions(mesh.position),
    uv: { data: packNumbers(Array.from({ length: 2 * vertices }, () => 0)) }, index: { data: packNumbers(mesh.index) },
    moves: [], turns: turns.map(({ name }) => ({ turn: name, weight: 1 })) };
  return { part, name: MATERIAL, material: { ...look, alpha: 'opaque', double_sided: true, subsurface: 0 } };
}
