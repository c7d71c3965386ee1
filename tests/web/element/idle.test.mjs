// SPDX-License-Identifier: MIT
import assert from 'node:assert/strict';
import test from 'node:test';
import { readMix } from '../../../web/element/face/expression.mjs';
import { FaceMixer } from '../../../web/element/face/face-mixer.mjs';
import { FAP_VALUES } from '../../../web/element/face/face-track.mjs';
import { IdleController, IdleFace } from '../../../web/element/face/idle.mjs';
import { IdleLife } from '../../../web/element/recording/idle-life.mjs';

const RATE = 8000;
const CHUNK = 0.12;

/** A chunk that begins at that second of the idle clock; FAP 48 of every frame is its time in milliseconds. */
function chunk(begin, fps = 25) {
  const first = Math.ceil(begin * fps - 1e-9);
  const end = Math.ceil((begin + CHUNK) * fps - 1e-9);
  const frames = [];
  for (let k = first; k < end; k++) frames.push(Int32Array.from({ length: FAP_VALUES }, (_, n) => (n === 48 ? (1000 * k) / fps : 0)));
  return { utterance: 0, sampleRate: RATE, fps, start: Math.round(begin * RATE), samples: CHUNK * RATE, firstFrame: first, frames };
}

const shown = (idle, now) => {
  const at = idle.at(now);
  const out = new Float32Array(FAP_VALUES);
  assert.ok(at.track.sample(at.seconds, out));
  return out[48] / 1000;
};

/** Chunks as the server sends them: each 0.08 s before its time, with some jitter. */
function feed(idle, from, to, origin, late = () => 0) {
  for (let begin = from; begin < to - 1e-9; begin += CHUNK) idle.take(chunk(begin), origin + begin - 0.08 + late(begin));
}

test('plays idle media evenly on the page clock in spite of jitter', () => {
  const idle = new IdleFace();
  let begin = 0;
  let before = null;
  for (let now = 100; now < 110; now += 0.02) {
    for (; 100 + begin - 0.08 + 0.03 * Math.sin(begin * 77) <= now; begin += CHUNK) idle.take(chunk(begin), now);
    const time = shown(idle, now);
    if (before !== null) assert.ok(time - before > -1e-6 && time - before < 0.05, `${before} to ${time} at ${now}`);
    before = time;
  }
  assert.ok(before > 9.6, `${before} of 10 s have been shown`);
});

test('holds the face while media are late, and continues from there', () => {
  const idle = new IdleFace();
  feed(idle, 0, 0.6, 10);
  const held = shown(idle, 12);
  assert.ok(held > 0.5 && held < 0.61);
  idle.take(chunk(0.6), 12);
  assert.ok(Math.abs(shown(idle, 12.02) - held) < 0.08);
});

test('resumes at the idle clock after an utterance, however late that is heard', () => {
  const idle = new IdleFace();
  feed(idle, 0, 1.2, 10);
  idle.leave();
  feed(idle, 3.36, 4.2, 10); // comes while the utterance is still heard
  idle.leave();
  const back = idle.at(13.6);
  assert.ok(Math.abs(back.seconds - 3.36) < 1e-6, `${back.seconds}`);
  assert.ok(Math.abs(idle.at(13.8).seconds - 3.56) < 1e-6);
});

test('withholds idle media after an utterance until it was heard', () => {
  const idle = new IdleFace();
  feed(idle, 0, 1.2, 10);
  idle.take(chunk(1.7), 11);
  assert.ok(idle.at(11.05).seconds < 1.2);
});

test('follows an idle clock that is reset to 0', () => {
  const idle = new IdleFace();
  feed(idle, 5, 6, 10);
  idle.at(14.9);
  feed(idle, 0, 1.2, 18);
  assert.ok(idle.at(18.5).seconds < 1);
});

test('the face does not jump between idling and speech', () => {
  const mixer = new FaceMixer();
  const idle = new IdleFace();
  feed(idle, 0, 2.4, 0);
  const speech = new IdleFace();
  feed(speech, 0, 2.4, 0.9); // another face, 0.9 s behind
  let before = null;
  for (let now = 0.2; now < 2; now += 0.01) {
    const heard = now > 0.9 && now < 1.5 ? { ...speech.at(now), running: true } : null;
    mixer.update(1000 * now, heard, idle.at(now));
    if (before !== null) assert.ok(Math.abs(mixer.values[48] - before) < 110, `${before} to ${mixer.values[48]} at ${now}`);
    before = mixer.values[48];
  }
});

test('switching to still does not cause a jump', () => {
  const mixer = new FaceMixer();
  const idle = new IdleFace();
  feed(idle, 1, 3, 0);
  for (let now = 1; now < 1.5; now += 0.016) mixer.update(1000 * now, null, idle.at(now));
  const before = mixer.values[48];
  mixer.still = true;
  mixer.update(1512, null, idle.at(1.512));
  assert.ok(mixer.values[48] > before / 2);
  for (let now = 1.52; now < 1.9; now += 0.016) mixer.update(1000 * now, null, idle.at(now));
  assert.equal(mixer.values[48], 0);
});

test('accepts a mixture as a list, an object or a text', () => {
  const joy = [{ name: 'joy', intensity: 0.6 }];
  assert.deepEqual(readMix('joy 0.6'), joy);
  assert.deepEqual(readMix({ joy: 0.6 }), joy);
  assert.deepEqual(readMix(joy), joy);
  assert.deepEqual(readMix('fear-confirmed'), [{ name: 'fear-confirmed', intensity: 1 }]);
  assert.deepEqual(readMix('joy 0.2, anger 3 ,fear'), [
    { name: 'anger', intensity: 1 },
    { name: 'fear', intensity: 1 },
    { name: 'joy', intensity: 0.2 },
  ]);
  for (const none of ['', '  ', null, undefined, [], {}, { joy: 0 }, 'joy much']) assert.deepEqual(readMix(none), []);
  assert.equal(readMix({ a: 0.1, b: 0.2, c: 0.3, d: 0.4, e: 0.5 }).length, 4);
});

test('requests idling and mood once, and again on a new link', () => {
  const sent = [];
  let up = false;
  const life = new IdleController((message) => up && sent.push(message) > 0);
  life.idle({ life: 0.5 });
  life.express('joy 0.4');
  assert.deepEqual(sent, []);
  up = true;
  life.linked();
  const idle = { type: 'idle', on: true, life: 0.5 };
  assert.deepEqual(sent, [{ type: 'express', mix: [{ name: 'joy', intensity: 0.4 }], ease: 0 }, idle]);
  life.idle({ life: 0.5 });
  assert.equal(sent.length, 2);
  life.take(chunk(0), 10);
  assert.ok(life.face.at(10.05));
  life.idle(null);
  assert.deepEqual(sent.at(-1), { type: 'idle', on: false });
  life.take(chunk(CHUNK), 10.1);
  assert.equal(life.face.at(10.15), null, 'what was under way is not shown');
  life.unlinked();
  life.linked();
  assert.equal(sent.length, 4, 'no idling is asked for that is not wanted');
  life.express([], { ease: 1 });
  assert.deepEqual(sent.at(-1), { type: 'express', mix: [], ease: 1 });
});

/** Numbers between 0 and 1, the same in each run. */
function dice(seed) {
  let state = seed;
  return () => (state = (state * 16807) % 2147483647) / 2147483647;
}

test('a face without a server blinks, glances and moves as people do', () => {
  const life = new IdleLife(1, dice(7));
  const frames = Array.from({ length: 25 * 600 }, (_, k) => life.face(k / 25));
  const begins = (holds) => frames.filter((frame, k) => k && holds(frame) && !holds(frames[k - 1])).length / 10; // a minute
  const blinks = begins((frame) => frame[19] > 450);
  assert.ok(blinks > 10 && blinks < 30, `${blinks} blinks a minute`);
  assert.ok(frames.every((frame) => frame[19] + frame[21] <= 1024 && frame[19] >= 0), 'lids do not cross');
  const away = (frame) => Math.hypot(frame[23], frame[25]) > 3 * 1745;
  const share = frames.filter(away).length / frames.length;
  assert.ok(share > 0.15 && share < 0.45, `${share} of the time away`);
  assert.ok(begins(away) > 8 && begins(away) < 25, `${begins(away)} glances a minute`);
  for (const frame of frames) assert.ok(frame[23] === frame[24] && frame[25] === frame[26] && Math.hypot(frame[48], frame[49]) < 8 * 1745);
  const moved = frames.map((frame, k) => (k ? Math.max(...[48, 49, 50].map((n) => Math.abs(frame[n] - frames[k - 1][n]))) : 0));
  assert.ok(Math.max(...moved) < 700 && moved.filter((step) => step > 0).length > frames.length / 2, 'the head moves slowly, and is never quite still');
  const still = new IdleLife(0, dice(7));
  assert.ok([0, 1, 5, 9].every((time) => still.face(time).every((value) => value === 0)));
});

test('the short chunks of a driven face are shown sooner', () => {
  const delay = (length) => {
    const idle = new IdleFace();
    const first = { utterance: 0, sampleRate: RATE, fps: 25, start: 0, samples: length * RATE, firstFrame: 0, frames: [new Int32Array(FAP_VALUES)] };
    idle.take(first, 100);
    return idle.base - 100;
  };
  assert.ok(delay(0.04) < 0.07 && delay(CHUNK) > 0.14, `${delay(0.04)} ${delay(CHUNK)}`);
});
