// SPDX-License-Identifier: MIT
import assert from 'node:assert/strict';
import test from 'node:test';
import { FaceMixer, faceValues } from '../../../web/element/face/face-mixer.mjs';
import { FaceTrack, FAP_VALUES } from '../../../web/element/face/face-track.mjs';

const frame = (faps) => Int32Array.from(faceValues(faps));

/** A track of one FAP. */
function track(values, fps = 25, first = 0) {
  const made = new FaceTrack(fps);
  made.put(first, values.map((value) => frame({ 5: value })));
  return made;
}

function at(made, seconds) {
  const out = new Float32Array(FAP_VALUES);
  assert.ok(made.sample(seconds, out), `there is a face at ${seconds}`);
  return out[5];
}

test('the face passes through every frame', () => {
  const values = [0, 100, 0, 0, -300, -200, 50, 50];
  for (const fps of [25, 50, 12.5])
    values.forEach((value, k) => assert.ok(Math.abs(at(track(values, fps), k / fps) - value) < 1e-3));
});

test('interpolates smoothly within the range of the frames: a closure stays closed', () => {
  const values = [400, 380, 0, 0, 10, 500, 480];
  const made = track(values);
  for (let k = 0; k + 1 < values.length; k++)
    for (let t = 0; t <= 1; t += 0.05) {
      const value = at(made, (k + t) / 25);
      assert.ok(value >= Math.min(values[k], values[k + 1]) - 1e-3 && value <= Math.max(values[k], values[k + 1]) + 1e-3);
    }
  const slopeBefore = at(made, 1 / 25) - at(made, 0.999 / 25);
  const slopeAfter = at(made, 1.001 / 25) - at(made, 1 / 25);
  assert.ok(Math.abs(slopeBefore - slopeAfter) < 0.02, 'no corner at a frame of a monotone stretch');
});

test('a straight line stays straight', () => {
  const made = track([0, 100, 200, 300]);
  assert.ok(Math.abs(at(made, 1.3 / 25) - 130) < 1e-3);
});

test('shows no face without frames', () => {
  const made = track([10, 20], 25, 5);
  const out = new Float32Array(FAP_VALUES);
  assert.equal(made.sample(3 / 25, out), false);
  assert.equal(made.sample(8 / 25, out), false);
  assert.equal(new FaceTrack(25).sample(0, out), false);
});

test('drops frames that lie behind, and keeps audible ones', () => {
  const made = track(Array.from({ length: 1000 }, (_, k) => k));
  made.forgetBefore(30);
  assert.ok(made.frames.size < 320);
  assert.equal(at(made, 30), 750);
});

const heard = (made, seconds, running = true) => ({ track: made, seconds, running });

test('when speech stops the face is at rest within a tenth of a second, without a jump', () => {
  const mixer = new FaceMixer();
  const made = track(Array.from({ length: 50 }, () => 500));
  for (let now = 0; now < 500; now += 16) mixer.update(now, heard(made, now / 1000));
  assert.equal(mixer.values[5], 500);
  let before = 500;
  for (let now = 512; now <= 512 + 100; now += 8) {
    mixer.update(now, null);
    assert.ok(mixer.values[5] <= before && before - mixer.values[5] < 120, `smooth: ${before} to ${mixer.values[5]}`);
    before = mixer.values[5];
  }
  assert.equal(mixer.values[5], 0);
  assert.equal(mixer.update(700, null), false, 'nothing changes any more');
  assert.equal(mixer.changing(800), false);
});

test('waits for late frames; without them the face goes to rest, and returns smoothly', () => {
  const mixer = new FaceMixer();
  const made = track(Array.from({ length: 50 }, () => 500));
  let now = 0;
  for (; now < 300; now += 16) mixer.update(now, heard(made, now / 1000));
  for (const end = now + 130; now < end; now += 16) {
    mixer.update(now, heard(made, 0.3, false));
    assert.equal(mixer.values[5], 500, 'holds');
  }
  for (const end = now + 250; now < end; now += 16) mixer.update(now, heard(made, 0.3, false));
  assert.equal(mixer.values[5], 0, 'rests');
  mixer.update(now, heard(made, 0.32));
  assert.ok(mixer.values[5] < 300, 'does not jump back');
  for (const end = now + 120; now < end; now += 16) mixer.update(now, heard(made, 0.4));
  assert.equal(mixer.values[5], 500);
});

test('keeping still, only jaw, lips and tongue move', () => {
  const mixer = new FaceMixer();
  mixer.still = true;
  const made = new FaceTrack(25);
  made.put(0, Array.from({ length: 10 }, () => new Int32Array(FAP_VALUES).fill(100)));
  for (let now = 0; now < 300; now += 16) mixer.update(now, heard(made, 0.1));
  const moved = [...mixer.values.keys()].filter((n) => mixer.values[n]);
  const lips = [...Array(16).keys()].map((i) => i + 3);
  const tongue = [43, 44, 45, 46, 47];
  const outer = [...Array(10).keys()].map((i) => i + 51);
  assert.deepEqual(moved, [...lips, ...tongue, ...outer]);
});

test('keeping still shows the mood, also during speech, without gaze or head turns', () => {
  const mixer = new FaceMixer();
  mixer.still = true;
  const idle = new FaceTrack(25);
  idle.put(0, Array.from({ length: 10 }, () => faceValues({ 31: 80, 12: 40, 48: 900, 23: 300 })));
  const speech = new FaceTrack(25);
  speech.put(0, Array.from({ length: 10 }, () => faceValues({ 31: -500, 3: 200, 48: -700 })));
  const left = { track: idle, seconds: 0.1 };
  let now = 0;
  for (; now < 3000; now += 16) mixer.update(now, null, left);
  const shown = () => [31, 12, 48, 23, 3].map((n) => Math.round(mixer.values[n]));
  assert.deepEqual(shown(), [80, 40, 0, 0, 0]);
  assert.equal(mixer.update(now, null, left), false, 'nothing changes any more');
  for (const end = now + 400; now < end; now += 16) mixer.update(now, heard(speech, 0.1), null);
  assert.deepEqual(shown(), [80, 0, 0, 0, 200], 'brows of the mood, lips of the speech');
  for (const end = now + 3000; now < end; now += 16) mixer.update(now, null, null);
  assert.deepEqual(shown(), [0, 0, 0, 0, 0], 'no mood any more');
});

test('keeping still shows the affects of a text that is spoken so, and nothing else of it', () => {
  const mixer = new FaceMixer();
  mixer.still = true;
  const speech = new FaceTrack(25);
  speech.put(0, Array.from({ length: 10 }, () => faceValues({ 31: -500, 3: 200, 48: -700, 23: 300 })));
  const shown = (still) => {
    for (let now = 0; now < 800; now += 16) mixer.update(now, { ...heard(speech, 0.1), still }, null);
    return [31, 3, 48, 23].map((n) => Math.round(mixer.values[n]));
  };
  assert.deepEqual(shown(true), [-500, 200, 0, 0]);
  assert.deepEqual(shown(false), [0, 200, 0, 0], 'made to move: its brows may be accents and blinks');
});

test('fades to a pose on request', () => {
  const mixer = new FaceMixer();
  mixer.pose = faceValues({ 3: 250 });
  mixer.ease = true;
  mixer.update(0, null);
  mixer.update(16, null);
  assert.ok(mixer.values[3] < 200, `${mixer.values[3]}`);
  mixer.update(140, null);
  assert.equal(mixer.values[3], 250);
});

test('a pose replaces speech at once', () => {
  const mixer = new FaceMixer();
  mixer.update(0, heard(track([100, 100, 100]), 0.04));
  mixer.pose = faceValues({ 3: 250, 49: -1000 });
  mixer.update(16, heard(track([100, 100, 100]), 0.06));
  assert.deepEqual([mixer.values[3], mixer.values[49]], [250, -1000]);
  mixer.pose = null;
  for (let now = 32; now < 600; now += 16) mixer.update(now, null);
  assert.ok(mixer.values.every((value) => value === 0));
});
