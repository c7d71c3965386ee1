// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Converts vertex colours to a picture, because heads have only pictures. Projects the surface from its middle in all directions; of overlapping
 * surfaces paints the outermost.
 */
import { png } from './png.mjs';

const SIDE = { least: 64, most: 1024 };
const FINE = 3; // pixels for each vertex, one way
const FRONT = 0.6; // extra share of the picture for the front
const INSIDE = [0, -10, -75]; // mm from between the eyeballs to the middle of an adult's head
const USUAL_ES = 62;
const EDGE = 3; // pixels of padding

/** Converts linear values to sRGB (IEC 61966-2-1). */
export function fromLinear(x) {
  const y = Math.min(1, Math.max(0, x));
  return y <= 0.0031308 ? 12.92 * y : 1.055 * y ** (1 / 2.4) - 0.055;
}

function middleOf(part, meshes, fapu) {
  if (part === 'skin') return INSIDE.map((x) => (x * fapu.ES) / USUAL_ES);
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (const { position } of meshes)
    for (let i = 0; i < position.length; i++) {
      low[i % 3] = Math.min(low[i % 3], position[i]);
      high[i % 3] = Math.max(high[i % 3], position[i]);
    }
  return low.map((x, k) => (x + high[k]) / 2);
}

/** Computes texture coordinates; duplicates vertices at the seam behind. */
function unwrap(mesh, middle) {
  const count = mesh.position.length / 3;
  const order = Array.from({ length: count }, (_, v) => v);
  const [uv, far] = [[], []];
  for (const v of order) {
    const [x, y, z] = middle.map((m, k) => mesh.position[3 * v + k] - m);
    const r = Math.hypot(x, y, z) || 1;
    const t = Math.atan2(x, z) / Math.PI;
    uv.push(0.5 + 0.5 * t * (1 + FRONT * (1 - Math.abs(t))), 0.5 + Math.asin(y / r) / Math.PI);
    far.push(r);
  }
  const doubled = new Map();
  const index = Uint32Array.from(mesh.index);
  for (let t = 0; t < index.length; t += 3) {
    const corners = [...index.subarray(t, t + 3)];
    const across = corners.map((v) => uv[2 * v]);
    if (Math.max(...across) - Math.min(...across) < 0.5) continue;
    corners.forEach((v, k) => {
      if (across[k] > 0.5) return;
      if (!doubled.has(v)) {
        doubled.set(v, order.push(v) - 1);
        uv.push(1, uv[2 * v + 1]);
        far.push(far[v]);
      }
      index[t + k] = doubled.get(v);
    });
  }
  const gather = (list) => Float64Array.from({ length: 3 * order.length }, (_, i) => list[3 * order[Math.floor(i / 3)] + (i % 3)]);
  Object.assign(mesh, {
    position: gather(mesh.position), uv: Float64Array.from(uv), index, colors: gather(mesh.colors), from: order.map((v) => mesh.from?.[v] ?? v),
    targets: Object.fromEntries(Object.entries(mesh.targets).map(([name, deltas]) => [name, gather(deltas)])),
  });
  return far;
}

/** Draws all triangles with a depth buffer. */
function draw({ uv, index, colors }, far, { side, depth, data }) {
  const set = (at, r, color) => {
    if (r <= depth[at]) return;
    depth[at] = r;
    for (let k = 0; k < 3; k++) data[4 * at + k] = 255 * color(k);
  };
  const u = (v) => Math.min(side - 1, uv[2 * v] * side - 0.5);
  const w = (v) => Math.min(side - 1, Math.max(0, (1 - uv[2 * v + 1]) * side - 0.5));
  for (let v = 0; v < far.length; v++) set(Math.round(w(v)) * side + Math.max(0, Math.round(u(v))), far[v] - 1e-3, (k) => colors[3 * v + k]);
  for (let t = 0; t < index.length; t += 3) {
    const [a, b, c] = index.subarray(t, t + 3);
    const area = (u(b) - u(a)) * (w(c) - w(a)) - (w(b) - w(a)) * (u(c) - u(a));
    if (!area) continue;
    for (let y = Math.ceil(Math.min(w(a), w(b), w(c))); y <= Math.max(w(a), w(b), w(c)); y++)
      for (let x = Math.max(0, Math.ceil(Math.min(u(a), u(b), u(c)))); x <= Math.max(u(a), u(b), u(c)); x++) {
        const sb = ((x - u(a)) * (w(c) - w(a)) - (y - w(a)) * (u(c) - u(a))) / area;
        const sc = ((u(b) - u(a)) * (y - w(a)) - (w(b) - w(a)) * (x - u(a))) / area;
        if (sb < 0 || sc < 0 || sb + sc > 1) continue;
        const of = (p, q, r) => (1 - sb - sc) * p + sb * q + sc * r;
        set(y * side + x, of(far[a], far[b], far[c]), (k) => of(colors[3 * a + k], colors[3 * b + k], colors[3 * c + k]));
      }
  }
}

/** Extends painted areas by EDGE pixels, because textures are filtered. */
function spread({ side, depth, data }) {
  for (let round = 0; round < EDGE; round++) {
    const before = Float32Array.from(depth);
    for (let at = 0; at < before.length; at++) {
      if (before[at] >= 0) continue;
      const near = [at - 1, at + 1, at - side, at + side].find((one) => before[one] >= 0);
      if (near === undefined) continue;
      depth[at] = 0;
      data.copyWithin(4 * at, 4 * near, 4 * near + 4);
    }
  }
}

/** Converts the colours of meshes whose material has no picture. @param {object} scene in a head's mm and axes @returns {string[]} notes */
export function paintColors(scene, fapu) {
  const wanted = scene.meshes.filter(({ colors, material }) => colors && !scene.materials[material]?.picture);
  return [...new Set(wanted.map(({ part }) => part))].map((part) => {
    const meshes = wanted.filter((mesh) => mesh.part === part);
    const middle = middleOf(part, meshes, fapu);
    const vertices = meshes.reduce((sum, { position }) => sum + position.length / 3, 0);
    const side = Math.min(SIDE.most, Math.max(SIDE.least, 2 ** Math.ceil(Math.log2(FINE * Math.sqrt(vertices)))));
    const sheet = { side, depth: new Float32Array(side * side).fill(-1), data: new Uint8ClampedArray(4 * side * side).fill(255) };
    for (const mesh of meshes) draw(mesh, unwrap(mesh, middle), sheet);
    spread(sheet);
    const picture = { type: 'image/png', width: side, height: side, data: png({ width: side, height: side, data: sheet.data }) };
    const look = scene.materials[meshes[0].material] ?? { name: part, roughness: 0.6, alpha: 'opaque', double_sided: false };
    const material = scene.materials.push({ ...look, color: [1, 1, 1], picture }) - 1;
    for (const mesh of meshes) mesh.material = material;
    return `${part}: the colours of its vertices were painted on a picture of ${side} x ${side}; of what lies one behind the other, the outermost`;
  });
}
