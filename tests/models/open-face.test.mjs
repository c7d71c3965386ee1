// SPDX-License-Identifier: GPL-3.0-or-later
// Faces of one surface: lips are cut apart along their line and nowhere else; eyes are made where there are holes for them.
import assert from 'node:assert/strict';
import test from 'node:test';
import { addEyes, cutLips } from '../../models/tools/import/face/open-face.mjs';

const STEPS = 41;
const WIDE = 80; // mm
const SIZE = 160; // pixels of the picture: two for a mm

/** A plate before the camera, in mm, with a furrow where lips meet, and `hole` of it missing. */
function plate(hole = () => false) {
  const depth = (x, y) => -3 * Math.exp(-((y / 3) ** 2));
  const [position, index] = [[], []];
  for (let r = 0; r < STEPS; r++) for (let c = 0; c < STEPS; c++) {
    const [x, y] = [c, r].map((i) => (WIDE * i) / (STEPS - 1) - WIDE / 2 + 0.37);
    position.push(x, y, depth(x, y));
    if (r && c) {
      const [a, b, d, e] = [(r - 1) * STEPS + c - 1, (r - 1) * STEPS + c, r * STEPS + c - 1, r * STEPS + c];
      if (!hole(x, y)) index.push(a, b, e, a, e, d);
    }
  }
  const place = (u, v) => [(u - SIZE / 2) / 2, (SIZE / 2 - v) / 2];
  const at = (u, v) => {
    const [x, y] = place(Math.round(u), Math.round(v));
    return Math.max(Math.abs(x), Math.abs(y)) > WIDE / 2 || hole(x, y) ? null : { mesh: 0, point: [x, y, depth(x, y)] };
  };
  const mesh = { name: 'plate', position: Float64Array.from(position), index: Uint32Array.from(index), uv: null, targets: { up: Float64Array.from(position, (_, i) => (i % 3 === 1 ? 1 : 0)) } };
  return { mesh, view: { at, place, scale: 2 } };
}

const pixel = ([x, y]) => [SIZE / 2 + 2 * x, SIZE / 2 - 2 * y];

test('cuts closed lips apart along the furrow, from corner to corner', () => {
  const { mesh, view } = plate();
  const before = mesh.position.length / 3;
  const marks = Array.from({ length: 478 }, () => [0, 0]);
  const row = (list, y) => list.forEach((i, k) => (marks[i] = pixel([-20 + 4 * k, y])));
  row([78, 191, 80, 81, 82, 13, 312, 311, 310, 415, 308], 1);
  row([78, 95, 88, 178, 87, 14, 317, 402, 318, 324, 308], -1);
  [marks[78], marks[308]] = [pixel([-20, 0]), pixel([20, 0])];
  assert.ok(cutLips(mesh, { view, marks }, 1));
  const count = mesh.position.length / 3;
  assert.ok(count > before + 20 && mesh.targets.up.length === mesh.position.length);
  for (let v = before; v < count; v++) {
    assert.ok(Math.abs(mesh.position[3 * v]) < 20.5 && Math.abs(mesh.position[3 * v + 1]) < 0.6, 'on the line');
    assert.ok(Math.abs(mesh.targets.up[3 * v + 1] - 1) < 1e-9, 'shapes go along');
  }
  // no triangle goes over the line between the corners, and beyond them nothing is cut
  const edges = new Map();
  let area = 0;
  for (let t = 0; t < mesh.index.length; t += 3) {
    const corners = [0, 1, 2].map((k) => [...mesh.position.subarray(3 * mesh.index[t + k], 3 * mesh.index[t + k] + 3)]);
    const [a, b, c] = corners;
    const twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    assert.ok(twice > -0.2, 'none is turned over');
    area += twice / 2;
    if (corners.every(([x]) => Math.abs(x) < 17)) assert.ok(corners.every(([, y]) => y > -0.6) || corners.every(([, y]) => y < 0.6), 'on one side');
    for (let k = 0; k < 3; k++) {
      const key = [mesh.index[t + k], mesh.index[t + ((k + 1) % 3)]].sort((x, y) => x - y).join();
      edges.set(key, (edges.get(key) ?? 0) + 1);
    }
  }
  assert.ok(Math.abs(area - WIDE * WIDE) < 4, `nothing is lost: ${area} mm²`);
  const open = [...edges].filter(([key, number]) => number === 1 && key.split(',').every((v) => Math.abs(mesh.position[3 * v]) < 39 && Math.abs(mesh.position[3 * v + 1]) < 39));
  const length = open.reduce((sum, [key]) => {
    const [a, b] = key.split(',').map((v) => mesh.position.subarray(3 * v, 3 * v + 3));
    return sum + Math.hypot(a[0] - b[0], a[1] - b[1]);
  }, 0);
  assert.ok(length > 2 * 34 && length < 2 * 46, `two borders of about 40 mm: ${length}`);
});

test('places eyes of one size in the eye holes, and none without holes', () => {
  const inHole = (x, y) => Math.hypot((Math.abs(x) - 20) / 1.6, y - 20) < 6;
  const lids = { 1: [263, 362, 386, 374, 385, 380, 387, 373, 384, 381, 388, 390], '-1': [33, 133, 159, 145, 158, 153, 160, 144, 157, 154, 161, 163] };
  const marks = Array.from({ length: 478 }, () => [0, 0]);
  const template = { at: Array(478).fill(null), fdp: { 3.5: [20, 20, 2], 3.6: [-20, 20, 2] } };
  for (const side of [1, -1]) lids[side].forEach((i, k) => {
    const at = [side * 20 + 10 * Math.cos((k * Math.PI) / 6), 20 + 6.5 * Math.sin((k * Math.PI) / 6), 0];
    template.at[i] = at;
    marks[i] = pixel(at);
  });
  for (const [i, x] of [[386, 20], [374, 20], [159, -20], [145, -20]]) marks[i] = pixel([x, 20]);
  const onto = { apply: (p) => [...p], scale: 1 };
  const holes = plate(inHole);
  const scene = { meshes: [holes.mesh], materials: [] };
  assert.deepEqual(addEyes(scene, { view: holes.view, marks }, { template, onto }), ['eye_l', 'eye_r']);
  const [, left, right] = scene.meshes;
  assert.ok(Math.abs(left.ball.centre[0] - 20) < 1 && Math.abs(right.ball.centre[0] + 20) < 1 && Math.abs(left.ball.centre[1] - 20) < 1);
  assert.equal(left.ball.radius, right.ball.radius);
  assert.ok(left.ball.radius >= 12 && left.ball.radius < 14 && Math.abs(left.ball.centre[2] + left.ball.radius - 2) < 1.5);
  assert.equal(scene.materials[0].picture.type, 'image/png');
  const drawn = { name: 'Face_4', materialName: 'EyeIris', position: Float64Array.from([20, 20, -4, -20, 20, -4, 20, 24, -4]), index: Uint32Array.from([0, 1, 2]) };
  assert.deepEqual(addEyes({ meshes: [plate(inHole).mesh, drawn], materials: [] }, { view: holes.view, marks }, { template, onto }), [], 'drawn eyes are there');
  const whole = plate();
  assert.deepEqual(addEyes({ meshes: [whole.mesh], materials: [] }, { view: whole.view, marks }, { template, onto }), []);
});
