// SPDX-License-Identifier: GPL-3.0-or-later
// A performer drives the face of a room: listeners see the performer's face instead of the idle one, and beside the mouth of speech.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { setTimeout as sleep } from 'node:timers/promises';
import { Daemon, eventually } from '../../lib/daemon.mjs';
import { violations } from '../../lib/schema.mjs';
import { bearer, sign } from '../../lib/tokens.mjs';

const [JAW, CORNER, BROW, ROLL] = [3, 12, 31, 50];
let daemon;
before(async () => {
  daemon = await Daemon.start(['--lang', 'it', '--open-seconds', '4']);
});
after(async () => assert.deepEqual(await daemon.stop(), { code: 0, signal: null }));

async function enter(room, more = '', options = {}) {
  const stream = await daemon.stream(`?room=${room}${more}`, options);
  await stream.wait({ type: 'joined' });
  return stream;
}
/** Follows a room that idles. */
async function screenOf(room) {
  const screen = await enter(room);
  screen.send({ type: 'idle', life: 0 });
  await screen.until(() => screen.chunks.length > 2);
  return screen;
}
/** Sends frames like a camera, each the result of face(seconds), until `end` is called. */
function perform(stream, face, { fps = 30, lateness = () => 0 } = {}) {
  const begin = performance.now();
  let on = true, k = 0;
  const done = (async () => {
    for (; on; k++) {
      const time = k / fps;
      await sleep(Math.max(0, begin + 1000 * (time + lateness(k)) - performance.now()));
      if (on) stream.send({ type: 'drive', frames: [{ time, faps: face(time) }] });
    }
  })();
  return { begin, end: () => { on = false; return done; } };
}
const idles = (stream) => stream.chunks.filter(({ utterance }) => utterance === 0);
const last = (stream, fap) => stream.chunks.at(-1)?.frames.at(-1)?.[fap];
const valid = (...streams) => streams.forEach(({ messages }) => messages.forEach(({ arrived: _, ...message }) => assert.equal(violations('server', message), null, JSON.stringify(message))));
const near = (a, b, most = 40) => Math.abs(a - b) <= most;

test('a driver moves the face of a room; when it stops, the face eases back', async () => {
  const [screen, driver] = [await screenOf('stage'), await enter('stage', '&watch=1')];
  const play = perform(driver, () => ({ [JAW]: 600, [CORNER]: 150, [BROW]: 200, [ROLL]: 9000 }));
  await screen.wait({ type: 'driven', on: true, by: (await driver.wait({ type: 'hello' })).stream });
  await screen.until(() => near(last(screen, JAW), 600) && near(last(screen, ROLL), 9000));
  assert.ok(near(last(screen, CORNER), 150) && near(last(screen, BROW), 200));
  const from = idles(screen).length;
  await screen.until(() => idles(screen).length > from + 10);
  for (const { samples, sampleRate, frames } of idles(screen).slice(from)) {
    assert.equal(samples / sampleRate, 0.04);
    assert.ok(frames.every((values) => near(values[JAW], 600)));
  }
  await play.end();
  const cut = screen.chunks.length;
  driver.send({ type: 'drive', on: false });
  await screen.wait({ type: 'driven', on: false });
  await screen.until(() => last(screen, JAW) === 0 && near(last(screen, ROLL), 0, 200));
  const jaws = screen.chunks.slice(cut).flatMap(({ frames }) => frames.map((values) => values[JAW]));
  assert.ok(jaws.every((jaw, i) => !i || jaw <= jaws[i - 1]), `it closes without a jump: ${jaws}`);
  assert.ok(jaws.some((jaw) => jaw > 50 && jaw < 550), `it eases: ${jaws}`);
  valid(screen, driver);
  await Promise.all([screen, driver].map((stream) => stream.close()));
});

test('movement keeps its time in spite of jitter, and its delay is bounded', async (t) => {
  const [screen, driver] = [await screenOf('wave'), await enter('wave', '&watch=1')];
  const hertz = 0.5, wave = (time) => Math.round(4000 * Math.sin(2 * Math.PI * hertz * time));
  const play = perform(driver, (time) => ({ [ROLL]: wave(time) }), { fps: 60, lateness: (k) => (k % 7 === 3 ? 0.05 : 0) });
  await screen.wait({ type: 'driven', on: true });
  const from = screen.chunks.length;
  await screen.until(() => screen.chunks.length > from + 130, 120000);
  await play.end();
  const rows = screen.chunks.slice(from + 25).flatMap(({ frames, arrived }) => frames.map((values) => [(arrived - play.begin) / 1000, values[ROLL]]));
  const misfit = (delay) => Math.sqrt(rows.reduce((sum, [at, value]) => sum + (value - wave(at - delay)) ** 2, 0) / rows.length);
  const delays = Array.from({ length: 80 }, (_, i) => i / 100);
  const best = delays.reduce((a, b) => (misfit(b) < misfit(a) ? b : a));
  t.diagnostic(`a frame leaves ${Math.round(1000 * best)} ms after it was made; misfit ${Math.round(misfit(best))} of 4000`);
  assert.ok(best < 0.6, `${best} s`);
  assert.ok(misfit(best) < 800, `${misfit(best)} at ${best} s`);
  await Promise.all([screen, driver].map((stream) => stream.close()));
});

test('a face that falls silent is let go, and so is one whose driver is gone', async () => {
  const [screen, first] = [await screenOf('drop'), await enter('drop', '&watch=1')];
  first.send({ type: 'drive', frames: [{ time: 7, faps: { [JAW]: 500 } }] });
  await screen.wait({ type: 'driven', on: true });
  await screen.wait({ type: 'driven', on: false });
  assert.equal(last(screen, JAW), 0);
  const from = screen.messages.length;
  const play = perform(first, () => ({ [JAW]: 500 }));
  await screen.until(() => near(last(screen, JAW), 500));
  await play.end();
  first.socket.terminate();
  await screen.wait({ type: 'driven', on: false }, { from });
  await screen.until(() => last(screen, JAW) === 0);
  await screen.close();
});

test('one drives at a time, late joiners are told, and a second gets an error', async () => {
  const [screen, first, second] = [await screenOf('two'), await enter('two', '&watch=1'), await enter('two', '&watch=1')];
  const play = perform(first, () => ({ [JAW]: 400 }));
  await screen.wait({ type: 'driven', on: true });
  second.send({ type: 'drive', id: 'late', frames: [{ time: 0, faps: { [JAW]: 900 } }] });
  await second.wait({ type: 'error', code: 'driven', id: 'late' });
  second.send({ type: 'drive', on: false }); // not its own to end
  const third = await enter('two');
  await third.wait({ type: 'driven', on: true });
  await screen.until(() => near(last(screen, JAW), 400));
  await play.end();
  first.send({ type: 'leave' });
  await screen.wait({ type: 'driven', on: false });
  const other = perform(second, () => ({ [JAW]: 900 }));
  await screen.until(() => near(last(screen, JAW), 900));
  await other.end();
  valid(screen, first, second, third);
  await Promise.all([screen, first, second, third].map((stream) => stream.close()));
});

test('speech keeps its own mouth; brows and head are the driver’s', async () => {
  const [screen, driver] = [await screenOf('both'), await enter('both', '&watch=1')];
  const play = perform(driver, () => ({ [JAW]: 1500, [BROW]: 300, [ROLL]: 12000 }));
  await screen.until(() => near(last(screen, JAW), 1500));
  screen.send({ type: 'speak', id: 's', text: 'Mamma, papà, e ora tutti insieme.', still: true });
  await screen.wait({ type: 'end', id: 's', reason: 'done' });
  const { utterance } = screen.messages.find(({ type, id }) => type === 'begin' && id === 's');
  const frames = screen.chunks.filter((chunk) => chunk.utterance === utterance).flatMap((chunk) => chunk.frames).slice(15);
  assert.ok(frames.length > 20);
  assert.ok(frames.some((values) => values[JAW] < 100), 'it closes for m and p');
  assert.ok(frames.every((values) => values[JAW] < 1200), 'the mouth is not the driver’s');
  assert.ok(frames.every((values) => near(values[BROW], 300) && near(values[ROLL], 12000, 400)));
  await screen.until(() => screen.chunks.at(-1).utterance === 0 && near(last(screen, JAW), 1500));
  await play.end();
  await Promise.all([screen, driver].map((stream) => stream.close()));
});

test('the driver’s own voice has the driver’s mouth', async () => {
  const [screen, driver] = [await screenOf('own'), await enter('own', '&watch=1')];
  const play = perform(driver, () => ({ [JAW]: 700 }));
  driver.send({ type: 'voice', id: 'v', codec: 'pcm_s16le', rate: 16000, lang: 'it' });
  for (let i = 0; i < 80; i++) {
    driver.socket.send(Buffer.alloc(640));
    await sleep(20);
  }
  driver.send({ type: 'close', id: 'v' });
  await screen.wait({ type: 'end', id: 'v', reason: 'done' });
  const { utterance } = screen.messages.find(({ type, id }) => type === 'begin' && id === 'v');
  const frames = screen.chunks.filter((chunk) => chunk.utterance === utterance).flatMap((chunk) => chunk.frames);
  assert.ok(frames.length > 10);
  assert.ok(frames.slice(-5).every((values) => near(values[JAW], 700)), `${frames.map((values) => values[JAW])}`);
  await play.end();
  await Promise.all([screen, driver].map((stream) => stream.close()));
});

test('bad frames are refused with their place, and values are limited', async () => {
  const screen = await screenOf('bad');
  for (const [frames, field, code] of [
    [undefined, 'frames', 'missing-field'], [[], 'frames', 'bad-field'], [Array(33).fill({ time: 0, faps: {} }), 'frames', 'bad-field'], ['x', 'frames', 'bad-field'],
    [[{ faps: {} }], 'frames.0.time', 'missing-field'], [[{ time: -1, faps: {} }], 'frames.0.time', 'bad-field'], [[{ time: 'x', faps: {} }], 'frames.0.time', 'bad-field'],
    [[{ time: 0 }], 'frames.0.faps', 'missing-field'], [[{ time: 0, faps: {} }, { time: 1, faps: [] }], 'frames.1.faps', 'bad-field'],
    [[{ time: 0, faps: { 2: 1 } }], 'frames.0.faps', 'bad-field'], [[{ time: 0, faps: { 69: 1 } }], 'frames.0.faps', 'bad-field'], [[{ time: 0, faps: { jaw: 1 } }], 'frames.0.faps', 'bad-field'],
    [[{ time: 0, faps: { 3: '1' } }], 'frames.0.faps', 'bad-field'],
  ]) {
    const from = screen.messages.length;
    screen.send({ type: 'drive', ...(frames === undefined ? {} : { frames }) });
    const { code: got, field: at } = await screen.wait({ type: 'error' }, { from });
    assert.deepEqual([got, at], [code, field], JSON.stringify(frames));
  }
  assert.ok(!screen.messages.some(({ type }) => type === 'driven'));
  const play = perform(screen, () => ({ [JAW]: 1e300, [ROLL]: -1e300, 67: 1 }));
  await screen.until(() => last(screen, JAW) > 1000);
  assert.ok(last(screen, JAW) <= 1080 * 20);
  await play.end();
  await screen.close();
});

test('needs the right to speak', async () => {
  const secret = 'a secret of at least thirty-two bytes';
  const file = path.join(fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-drive-')), 'secret');
  fs.writeFileSync(file, secret, { mode: 0o600 });
  const guarded = await Daemon.start(['--secret-file', file], {}, { voices: false });
  const guest = await guarded.stream('?room=door', bearer(sign({ secret, claims: { rights: 'listen' } })));
  await guest.wait({ type: 'joined' });
  guest.send({ type: 'drive', frames: [{ time: 0, faps: {} }] });
  await guest.wait({ type: 'error', code: 'forbidden' });
  await guest.close();
  assert.deepEqual(await guarded.stop(), { code: 0, signal: null });
  fs.rmSync(path.dirname(file), { recursive: true });
});

test('floods are cut to the rate of a room', async () => {
  const [screen, driver] = [await screenOf('flood'), await enter('flood', '&watch=1')];
  for (let i = 0; i < 1500; i++) driver.send({ type: 'drive', frames: [{ time: i / 1000, faps: { [JAW]: 300 } }] });
  await driver.wait({ type: 'error', code: 'too-many-requests' });
  await eventually(() => near(last(screen, JAW), 300, 301));
  await Promise.all([screen, driver].map((stream) => stream.close()));
});
