// SPDX-License-Identifier: GPL-3.0-or-later
/** Corrects files of left-handed programs, which are mirrored or wound the other way, so that only the inside would be visible. */
import { turnedOver } from './corners.mjs';

const CLEAR = 0.02; // minimum of the ratio below

/** Signed volume relative to a ball of the same surface area; negative: inside out. */
function held({ position, index }) {
  const middle = [0, 0, 0];
  for (let i = 0; i < position.length; i++) middle[i % 3] += (3 * position[i]) / position.length;
  let [volume, area] = [0, 0];
  for (let t = 0; t < index.length; t += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => middle.map((m, j) => position[3 * index[t + k] + j] - m));
    const [u, v] = [b, c].map((p) => p.map((x, k) => x - a[k]));
    const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    volume += (a[0] * n[0] + a[1] * n[1] + a[2] * n[2]) / 6;
    area += Math.hypot(...n) / 2;
  }
  return volume / ((area / Math.PI) ** 1.5 * (Math.PI / 6) || 1);
}

/** Reverses the winding of the whole scene if its face is inside out. @returns {string[]} notes */
export function faceOutward(scene) {
  const skin = scene.meshes.filter(({ part }) => part === 'skin').sort((a, b) => b.index.length - a.index.length)[0];
  if (!skin || held(skin) > -CLEAR) return [];
  for (const mesh of scene.meshes) mesh.index = turnedOver(mesh.index);
  return ['its surfaces were wound inside out: they were turned over'];
}
