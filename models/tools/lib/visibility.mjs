// SPDX-License-Identifier: GPL-3.0-or-later
/** Finds the visible parts of a head from a direction: draws a small picture of part numbers with a depth buffer. */
import { pose } from './deform.mjs';

const STEP = 0.25; // mm for a point of the picture
const WINDOW = { left: -50, right: 50, bottom: -95, top: 20 };
/** Transparent or loose parts do not count as cover. */
const COVER = ['skin', 'eye_l', 'eye_r', 'teeth_upper', 'teeth_lower', 'tongue'];

/** @param {{yaw: number, pitch: number}} from viewing direction; 0, 0 = straight in front of the face */
export function view(head, faps, { yaw, pitch }) {
  const width = Math.round((WINDOW.right - WINDOW.left) / STEP),
    height = Math.round((WINDOW.top - WINDOW.bottom) / STEP);
  const depth = new Float32Array(width * height).fill(-Infinity);
  const owner = new Int8Array(width * height).fill(-1);
  const cy = Math.cos(yaw),
    sy = Math.sin(yaw),
    cp = Math.cos(pitch),
    sp = Math.sin(pitch);
  const project = (x, y, z) => {
    const a = x * cy - z * sy,
      b = x * sy + z * cy;
    return [(a - WINDOW.left) / STEP, (y * cp - b * sp - WINDOW.bottom) / STEP, b * cp + y * sp];
  };
  COVER.forEach((name, number) => {
    const part = head.parts.find((p) => p.name === name);
    const p = pose(head, part, faps);
    const q = [];
    for (let v = 0; v < p.length; v += 3) q.push(project(p[v], p[v + 1], p[v + 2]));
    for (let t = 0; t < part.index.length; t += 3) {
      draw(depth, owner, width, height, number, q[part.index[t]], q[part.index[t + 1]], q[part.index[t + 2]]);
    }
  });
  return { count: (name) => owner.reduce((n, o) => n + (o === COVER.indexOf(name) ? 1 : 0), 0) };
}

function draw(depth, owner, width, height, number, a, b, c) {
  const area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  if (area <= 1e-9) return; // turned away
  const x0 = Math.max(0, Math.floor(Math.min(a[0], b[0], c[0]))),
    x1 = Math.min(width - 1, Math.floor(Math.max(a[0], b[0], c[0])));
  const y0 = Math.max(0, Math.floor(Math.min(a[1], b[1], c[1]))),
    y1 = Math.min(height - 1, Math.floor(Math.max(a[1], b[1], c[1])));
  for (let y = y0; y <= y1; y++) {
    for (let x = x0; x <= x1; x++) {
      const wa = ((b[0] - x - 0.5) * (c[1] - y - 0.5) - (b[1] - y - 0.5) * (c[0] - x - 0.5)) / area;
      const wb = ((c[0] - x - 0.5) * (a[1] - y - 0.5) - (c[1] - y - 0.5) * (a[0] - x - 0.5)) / area;
      const wc = 1 - wa - wb;
      if (wa < 0 || wb < 0 || wc < 0) continue;
      const z = wa * a[2] + wb * b[2] + wc * c[2];
      const i = y * width + x;
      if (z > depth[i]) {
        depth[i] = z;
        owner[i] = number;
      }
    }
  }
}
