// SPDX-License-Identifier: MIT
// Free ends of hair come after the head, swing and come to rest; roots stay.
import assert from 'node:assert/strict';
import test from 'node:test';
import { faceValues } from '../../../../web/element/face/face-mixer.mjs';
import { deform, SoftwareDeform } from '../../../../web/element/head/mesh/deform.mjs';
import { Drive, influencesOf } from '../../../../web/element/head/mesh/influences.mjs';
import { Sway } from '../../../../web/element/head/mesh/sway.mjs';
import { ModelError, readModel } from '../../../../web/element/head/model/model.mjs';

const base64 = (array) => Buffer.from(array.buffer).toString('base64');
const YAW = 49;
const yawed = (radians) => faceValues({ [YAW]: radians * 1e5 });

/** The lags of yaw, 60 pictures a second, while the head stands at `angleAt(seconds)`. */
function followed(angleAt, seconds, sway = new Sway()) {
  return Array.from({ length: Math.round(60 * seconds) }, (_, i) => sway.follow(yawed(angleAt(i / 60)), i / 60)[1]);
}

test('ends are behind a head that turns, swing past it, and rest', () => {
  const sway = new Sway();
  const lags = followed((t) => Math.min(0.3, t), 4, sway); // 0.3 s of 1 radian a second
  assert.equal(Math.sign(Math.min(...lags.slice(1, 18))), -1);
  assert.ok(Math.min(...lags) < -0.05, `${Math.min(...lags)}`);
  assert.ok(Math.max(...lags) > 0.01 && Math.max(...lags) < 0.06, `they swing past: ${Math.max(...lags)}`);
  assert.equal(lags.at(-1), 0);
  assert.ok(!sway.moves, 'no picture is drawn for hair that rests');
});

test('the lag has a bound, and a cut, a pause or no time is no movement', () => {
  const fast = followed((t) => 0.29 * Math.sin(12 * t), 3);
  assert.ok(Math.max(...fast.map(Math.abs)) <= 0.13 && Math.max(...fast.map(Math.abs)) > 0.09, `${Math.max(...fast)}`);
  const sway = new Sway();
  const turnedTo = (radians, seconds) => sway.follow(yawed(radians), seconds);
  turnedTo(0, 0);
  assert.notEqual(turnedTo(0.05, 0.02)[1], 0);
  assert.equal(turnedTo(0.6, 0.04)[1], 0, 'a cut');
  assert.notEqual(turnedTo(0.65, 0.06)[1], 0);
  assert.equal(turnedTo(0.7, 5)[1], 0, 'a pause');
  assert.notEqual(turnedTo(0.75, 5.02)[1], 0);
  assert.equal(turnedTo(0.8, null)[1], 0, 'still');
  assert.equal(turnedTo(0.82, 5.06)[1], 0, 'and afterwards it begins anew');
});

test('swings alike at 20 and at 60 pictures a second', () => {
  const at = (rate) => {
    const sway = new Sway();
    let lag;
    for (let i = 0; i <= rate; i++) lag = sway.follow(yawed(Math.min(0.2, i / rate)), i / rate);
    return lag[1];
  };
  assert.ok(Math.abs(at(20) - at(60)) < 0.01, `${at(20)}, ${at(60)}`);
});

const TURNS = [
  { name: 'yaw', fap: YAW, pivot: [0, 0, 0], axis: [0, 1, 0], radians: 1e-5 },
  { name: 'jaw', fap: 3, pivot: [0, 0, 0], axis: [1, 0, 0], radians: 0.001 },
];

/** A strand of four vertices, 10 mm apart downwards, 10 mm in front of the middle. */
function strand(sway, { turns = [{ turn: 'yaw', weight: 1 }] } = {}) {
  return {
    format: 'faccia-head', version: 1, name: 'tiny', turns: TURNS, fdp: {},
    fapu: { IRISD: 10.24, ES: 10.24, ENS: 10.24, MNS: 20.48, MW: 40.96 },
    parts: [{
      name: 'hair', material: 'hair', vertices: 4, turns, ...(sway ? { sway } : {}),
      position: { data: base64(Int16Array.of(0, 0, 100, 0, -100, 100, 0, -200, 100, 0, -300, 100)), scale: 0.1, offset: [0, 0, 0] },
      index: { data: base64(Uint16Array.of(0, 1, 2, 1, 3, 2)) },
    }],
  };
}

const SWAY = { pivot: [0, 0, 0], weights: base64(Uint8Array.of(0, 51, 153, 255)) };

/** Positions with the head turned, and a lag. */
function placed(json, radians, lag) {
  const model = readModel(json);
  const drive = new Drive(model);
  const influences = influencesOf(model.parts[0], drive);
  drive.slotValues = new Float32Array(Math.max(1, drive.slots.length));
  drive.set(yawed(radians), lag);
  const soft = new SoftwareDeform(model.parts[0], influences, influences.normals, drive, false);
  soft.update(drive);
  const { position } = deform(model.parts[0], influences, drive);
  soft.position.forEach((x, i) => assert.ok(Math.abs(x - position[i]) < 1e-3, 'software and hardware agree'));
  return Array.from({ length: 4 }, (_, v) => [...position.subarray(3 * v, 3 * v + 3)]);
}

test('each vertex lags by its weight, seen from the head; roots do not', () => {
  const [stands, lags] = [placed(strand(SWAY), 0, [0, 0, 0]), placed(strand(SWAY), 0, [0, -0.1, 0])];
  const aside = lags.map((q, v) => q[0] - stands[v][0]);
  [0, 0.2, 0.6, 1].forEach((weight, v) => assert.ok(Math.abs(aside[v] + 10 * Math.sin(0.1 * weight)) < 1e-3, `${aside}`));
  const turned = placed(strand(SWAY), 0.5, [0, -0.1, 0]);
  assert.ok(Math.abs(Math.atan2(turned[3][0], turned[3][2]) - 0.4) < 1e-3, 'the tip is at the angle that the spring is');
  assert.ok(Math.abs(Math.atan2(turned[0][0], turned[0][2]) - 0.5) < 1e-3, 'the root at the head\'s');
});

test('a head without sway is read as ever', () => {
  const plain = readModel(strand(null));
  assert.deepEqual([plain.turns.length, plain.headTurns, plain.parts[0].sway, plain.parts[0].turns.length], [2, 1, null, 1]);
  assert.deepEqual(placed(strand(null), 0.3, [0, -0.1, 0]), placed(strand(null), 0.3));
  const swaying = readModel(strand(SWAY));
  assert.deepEqual(swaying.turns.map(({ name }) => name), ['jaw', 'sway of hair', 'yaw']);
  assert.deepEqual(placed(strand(SWAY), 0.3), placed(strand(null), 0.3), 'at rest neither differs');
});

test('names what is wrong with a sway', () => {
  const wrong = (sway) => {
    try {
      readModel(strand(sway));
    } catch (error) {
      assert.ok(error instanceof ModelError);
      return error.place;
    }
    return null;
  };
  assert.equal(wrong({ ...SWAY, weights: base64(Uint8Array.of(1, 2, 3)) }), 'parts[0].sway.weights');
  assert.equal(wrong({ weights: SWAY.weights }), 'parts[0].sway.pivot');
  assert.equal(wrong({ ...SWAY, pivot: [0, 'x', 0] }), 'parts[0].sway.pivot');
});
