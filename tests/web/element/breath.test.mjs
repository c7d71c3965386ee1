// SPDX-License-Identifier: MIT
// The breath of chest and shoulders: at rest, before phrases, with nods, and on which vertices.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import test from 'node:test';
import { Breath } from '../../../web/element/face/breath.mjs';
import { faceValues } from '../../../web/element/face/face-mixer.mjs';
import { FaceTrack } from '../../../web/element/face/face-track.mjs';
import { calibrate } from '../../../web/element/head/model/calibrate.mjs';
import { deform } from '../../../web/element/head/mesh/deform.mjs';
import { Drive, influencesOf } from '../../../web/element/head/mesh/influences.mjs';
import { BREATH, ModelError, readModel } from '../../../web/element/head/model/model.mjs';
import { heads } from '../../lib/built-heads.mjs';

const FPS = 25;
const file = JSON.parse(fs.readFileSync(path.join(heads, 'mara.json')));

/** Levels over some seconds, every 40 ms. @param {(t: number) => object|null} speech @param {(t: number) => number} amount */
function levels(seconds, { speech = () => null, amount = () => 1, pitch = () => 0, breath = new Breath() } = {}) {
  return Array.from({ length: seconds * FPS }, (_, i) => breath.at(i / FPS, speech(i / FPS), amount(i / FPS), pitch(i / FPS)));
}

/** A mouth that opens and closes, but for the pauses. @param {number[][]} pauses from and to, s */
function spoken(seconds, pauses) {
  const track = new FaceTrack(FPS);
  const still = (t) => pauses.some(([from, to]) => t >= from && t < to);
  const frames = Array.from({ length: seconds * FPS }, (_, i) => Int32Array.from(faceValues({ 3: still(i / FPS) ? 0 : 300 + 300 * Math.sin(i * 1.3) })));
  track.put(0, frames);
  return (t) => ({ track, seconds: t });
}

const peaks = (list) => list.flatMap((x, i) => (x > 0.4 && x >= (list[i - 1] ?? 0) && x > (list[i + 1] ?? 0) ? [i / FPS] : []));

test('at rest a breath takes 3 to 4.5 seconds, and goes out more slowly than it comes', () => {
  const list = levels(60);
  assert.ok(list.every((x) => x >= 0 && x <= 1), 'within 0 and 1');
  const tops = peaks(list);
  const periods = tops.slice(1).map((t, i) => t - tops[i]);
  assert.ok(periods.length > 11 && periods.every((p) => p > 3 && p < 4.7), periods.map((p) => p.toFixed(2)).join());
  assert.ok(new Set(periods.map((p) => p.toFixed(1))).size > 3, 'no two alike for long');
  const rising = list.slice(1).filter((x, i) => x > list[i] + 1e-4).length;
  const falling = list.slice(1).filter((x, i) => x < list[i] - 1e-4).length;
  assert.ok(falling > 1.15 * rising, `${rising} rising, ${falling} falling`);
  assert.ok(Math.max(...list.slice(1).map((x, i) => Math.abs(x - list[i]))) < 0.07, 'nothing jumps');
});

test('a breath is drawn before a phrase, and used while it is spoken', () => {
  const list = levels(10, { speech: spoken(12, [[0, 0.3], [5, 5.6]]) });
  const at = (t) => list[Math.round(t * FPS)];
  assert.ok(at(0.4) > 0.5, `before the first: ${at(0.4)}`);
  assert.ok(at(4.6) < at(0.6) - 0.25, `used: ${at(0.6)}, ${at(4.6)}`);
  assert.ok(at(5.6) > at(4.6) + 0.2, `drawn again: ${at(4.6)}, ${at(5.6)}`);
  const whole = levels(10, { speech: spoken(12, [[0, 0.3]]) });
  assert.ok(whole[140] < at(5.6) - 0.2, 'not without a pause');
});

test('a nod of emphasis goes through the shoulders, and only then', () => {
  const speech = spoken(12, [[0, 0.3]]);
  const nod = (t) => (t > 3 && t < 3.4 ? 6000 : 0);
  const [plain, nodded] = [levels(6, { speech }), levels(6, { speech, pitch: nod })];
  assert.ok(plain[80] - nodded[80] > 0.05, `${plain[80]}, ${nodded[80]}`);
  assert.ok(Math.abs(plain[70] - nodded[70]) < 1e-9);
});

test('a still face breathes out and has no breath; half a life, half of it', () => {
  const stopped = levels(12, { amount: (t) => (t < 3 ? 1 : 0) });
  assert.ok(stopped[50] > 0.4 && stopped.slice(-FPS).every((x) => x === 0), 'ends at 0');
  assert.deepEqual(levels(5, { amount: () => 0, speech: spoken(6, []), pitch: () => 4000 }), Array(5 * FPS).fill(0));
  assert.ok(Math.abs(Math.max(...levels(20, { amount: () => 0.5 })) / Math.max(...levels(20)) - 0.5) < 0.01);
});

/** How far each vertex of a part goes with full lungs, mm. */
function risen(model, name) {
  const drive = new Drive(model);
  const part = model.parts.find((one) => one.name === name);
  const influences = influencesOf(part, drive);
  drive.slotValues = new Float32Array(drive.slots.length);
  const values = new Float32Array(69);
  values[BREATH] = 1;
  const { position } = deform(part, influences, drive.set(values));
  return Array.from({ length: part.vertices }, (_, v) => [1, 2].map((k) => position[3 * v + k] - part.position[3 * v + k]));
}

test('shoulders and chest rise by 2 to 5 mm, the face stays', () => {
  const model = readModel(file);
  const skin = model.parts.find(({ name }) => name === 'skin');
  risen(model, 'skin').forEach(([up, forward], v) => {
    if (skin.position[3 * v + 1] > model.fdp['2.1'][1]) assert.deepEqual([up, forward], [0, 0], `vertex ${v} of the face`);
  });
  const [ups, ahead] = [0, 1].map((k) => risen(model, 'clothes').map((shift) => shift[k]));
  assert.ok(Math.max(...ups) > 2 && Math.max(...ups) < 5 && Math.min(...ups) >= 0, `${Math.max(...ups)} mm up`);
  assert.ok(Math.max(...ahead) > 0.5, 'and forward');
  const clothes = model.parts.find(({ name }) => name === 'clothes');
  const shoulder = ups.filter((_, v) => Math.abs(clothes.position[3 * v]) > 140 && clothes.position[3 * v + 1] > -260);
  assert.ok(shoulder.length && shoulder.every((up) => up > 2), 'shoulders rise');
  for (const name of ['hair', 'eye_l', 'teeth_upper']) assert.ok(risen(model, name).every(([up]) => up === 0), name);
});

test('a head that does not say what a breath moves keeps still; calibration keeps the breath', () => {
  const { breath: _, ...without } = file;
  const bare = readModel({ ...without, parts: file.parts.map(({ breath, ...part }) => part) });
  assert.ok(risen(bare, 'clothes').every(([up]) => up === 0));
  const model = readModel(file);
  const other = calibrate(model, { featurePointsCoord: { '8.3': model.fdp['8.3'].map((x, k) => x + (k ? 0 : 1)) } });
  assert.ok(Math.max(...risen(other, 'clothes').map(([up]) => up)) > 2);
});

test('a breath that does not fit its part is refused with its place', () => {
  const i = file.parts.findIndex(({ name }) => name === 'clothes');
  const refused = (change, place) => {
    const parts = file.parts.map((part, k) => (k === i ? { ...part, breath: { ...part.breath, ...change } } : part));
    assert.throws(() => readModel({ ...file, parts }), (error) => error instanceof ModelError && error.message.includes(place));
  };
  refused({ weights: 'AAA=' }, `parts[${i}].breath`);
  refused({ vertices: '//8=', weights: 'AA==' }, `parts[${i}].breath`);
  refused({ weights: 7 }, `parts[${i}].breath.weights`);
  assert.throws(() => readModel({ ...file, breath: { shift: [0, 1] } }), /breath\.shift/);
});
