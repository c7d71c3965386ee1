// SPDX-License-Identifier: MIT
// The deformation without a graphics processor against the plain one, on parts that move in every way.
import assert from 'node:assert/strict';
import test from 'node:test';
import { faceValues } from '../../../../web/element/face/face-mixer.mjs';
import { deform, SoftwareDeform } from '../../../../web/element/head/mesh/deform.mjs';
import { framed } from '../../../../web/element/head/framing.mjs';
import { Drive, influencesOf } from '../../../../web/element/head/mesh/influences.mjs';
import { readModel } from '../../../../web/element/head/model/model.mjs';

const base64 = (array) => Buffer.from(array.buffer).toString('base64');
const weights = (...list) => ({ vertices: base64(Uint16Array.from(list.map((_, i) => i))), weights: base64(Uint8Array.from(list)) });
const turns = [
  { name: 'yaw', fap: 49, pivot: [0, 0, -50], axis: [0, 1, 0], radians: 1e-5 },
  { name: 'jaw', fap: 3, pivot: [0, 0, -10], axis: [1, 0, 0], radians: 0.001 },
  { name: 'pitch', fap: 48, pivot: [0, 0, -50], axis: [1, 0, 0], radians: 1e-5 },
];

function setUp(part) {
  const model = readModel({
    format: 'faccia-head', version: 1, name: 'tiny', turns, fapu: { IRISD: 10, ES: 10, ENS: 10, MNS: 20, MW: 40 },
    parts: [{
      name: 'skin', material: 'skin', vertices: 4,
      position: { data: base64(Int16Array.of(0, 0, 0, 100, 0, 0, 100, 100, 20, 0, 100, 0)), scale: 0.1, offset: [0, 5, 0] },
      index: { data: base64(Uint16Array.of(0, 1, 2, 0, 2, 3)) },
      ...part,
    }],
  });
  const drive = new Drive(model);
  const [one] = model.parts;
  const influences = influencesOf(one, drive);
  drive.slotValues = new Float32Array(Math.max(1, drive.slots.length));
  return { drive, one, influences, soft: new SoftwareDeform(one, influences, influences.normals, drive) };
}

const moving = {
  moves: [
    { fap: 5, sign: 'both', vertices: base64(Uint16Array.of(0, 2)), deltas: { data: base64(Int16Array.of(0, 100, 20, 0, 50, 0)), scale: 0.01 } },
    { fap: 4, sign: 'negative', vertices: base64(Uint16Array.of(3)), deltas: { data: base64(Int16Array.of(0, 0, 100)), scale: 0.01 } },
  ],
  turns: [{ turn: 'jaw', ...weights(255, 128, 0, 40) }, { turn: 'yaw', ...weights(255, 200, 100, 0) }, { turn: 'pitch', ...weights(255, 200, 100, 0) }],
};

test('places vertices where the plain deformation does', () => {
  const { drive, one, influences, soft } = setUp(moving);
  assert.equal(soft.whole, false);
  assert.ok(soft.acts);
  for (const faps of [{ 5: 400 }, { 4: -300, 3: 200 }, { 4: 300 }, { 3: 500, 48: 20000, 49: -30000, 5: -200 }, {}]) {
    drive.set(faceValues(faps));
    const plain = deform(one, influences, drive);
    soft.update(drive);
    soft.position.forEach((value, i) => assert.ok(Math.abs(value - plain.position[i]) < 1e-3, `${JSON.stringify(faps)}: ${value}, ${plain.position[i]}`));
    for (let v = 0; v < 12; v += 3) {
      const n = soft.normal.subarray(v, v + 3);
      const length = Math.hypot(...n);
      n.forEach((value, k) => assert.ok(Math.abs(value / length - plain.normal[v + k]) < 1e-3, 'normal'));
    }
  }
});

test('updates nothing at rest, and once after returning to rest', () => {
  const { drive, soft } = setUp(moving);
  assert.equal(soft.update(drive.set(faceValues({}))), false);
  assert.equal(soft.update(drive.set(faceValues({ 5: 100 }))), true);
  assert.equal(soft.update(drive.set(faceValues({}))), true);
  assert.equal(soft.update(drive), false);
});

test('leaves parts that move entirely with the head to one matrix', () => {
  const { drive, soft } = setUp({ turns: [{ turn: 'yaw', weight: 1 }, { turn: 'pitch', weight: 1 }] });
  assert.equal(soft.whole, true);
  assert.equal(soft.acts, false);
  assert.equal(soft.update(drive.set(faceValues({ 49: 30000 }))), false);
});

test('turns such a part in software when its material requires it', () => {
  const { drive, one, influences } = setUp({ turns: [{ turn: 'yaw', weight: 1 }, { turn: 'pitch', weight: 1 }] });
  const soft = new SoftwareDeform(one, influences, influences.normals, drive, false);
  assert.equal(soft.whole, false);
  drive.set(faceValues({ 48: 20000, 49: 30000 }));
  assert.equal(soft.update(drive), true);
  const { position } = deform(one, influences, drive);
  soft.position.forEach((value, i) => assert.ok(Math.abs(value - position[i]) < 1e-3, `${value}, ${position[i]}`));
});

test('the mouth is in the middle of its view, and the bust shows more than the portrait', () => {
  const model = {
    view: { target: [0, -20, 0], distance: 600, fov: 26 }, fapu: { MW: 50 },
    fdp: { '2.1': [0, -90, 70], '2.2': [0, -66, 90], '2.3': [0, -68, 90] },
  };
  const width = ({ distance, fov, target }, z) => 2 * (distance - (z - target[2])) * Math.tan((fov * Math.PI) / 360);
  const portrait = framed(model, null, 0.8);
  const bust = framed(model, 'bust', 0.8);
  const face = framed(model, 'face', 0.8);
  const mouth = framed(model, 'mouth', 1.3);
  assert.deepEqual(portrait, model.view);
  assert.ok(width(bust, 0) > 1.2 * width(portrait, 0));
  assert.ok(width(face, 0) < width(portrait, 0));
  assert.ok(width(mouth, 90) < 3 * 50 && width(mouth, 90) > 2 * 50, `${width(mouth, 90)} mm`);
  assert.ok(mouth.target[1] < -60 && mouth.target[1] > -85, `${mouth.target}`);
  assert.ok(framed(model, 'mouth', 0.5).distance > mouth.distance, 'a narrow place sees it whole');
  assert.equal(framed({ ...model, fdp: {} }, 'mouth', 1).distance, 600, 'a head without feature points');
});
