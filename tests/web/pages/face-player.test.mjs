// SPDX-License-Identifier: MIT
// The Face Player without a page: its files, its curves.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import test from 'node:test';
import { FapcEncoder, fapcFrame } from '../../../protocol/fapc/fapc.mjs';
import { isFba, readFba } from '../../../protocol/fba/fba.mjs';
import { readFapcFile } from '../../../protocol/fapc/fapcfile.mjs';
import { drawnOver, History, keysOf, mirrored, smooth, spline } from '../../../web/pages/player/curve.js';
import { prosody } from '../../../web/pages/player/prosody.js';
import { gestureText, makeGesture } from '../../../web/pages/player/gesture.js';
import { FbaWriter } from '../../lib/fba-writer.mjs';
import { parseFap } from '../../lib/fapfile.mjs';
import { emptyFaps, FRAMES_MAX, isFapc, readCoded, readFap, writeFap } from '../../../web/pages/player/file.js';

const table = JSON.parse(fs.readFileSync(new URL('../../../protocol/fap-table.json', import.meta.url))).faps;

test('reads a .fap file, and writes it unchanged', () => {
  const flags = (on) => Array.from({ length: 68 }, (_, i) => (on.includes(i + 1) ? 1 : 0)).join(' ');
  const text = `2.1 ciao 25 3\n${flags([1, 3, 51])}\n0 0 6 63 0 120 -7\n${flags([3])}\n1 130\n${flags([])}\n2\n`;
  const faps = readFap(text);
  assert.deepEqual([faps.name, faps.fps, faps.frames.length], ['ciao', 25, 3]);
  assert.deepEqual(faps.frames.map((frame) => [frame[3], frame[51]]), [[120, -7], [130, -7], [130, -7]], 'what is masked stays as it was');
  const again = readFap(writeFap(faps));
  assert.deepEqual(again.frames, faps.frames);
  assert.deepEqual(again.high[0][0], [0, 6, 63, 0]);
  assert.throws(() => readFap('2.1 a 25 1\n1 0 1\n0 1'), { code: 'bad-fap', line: 2 });
  assert.throws(() => readFap(`2.1 a 25 1\n${flags([3, 4])}\n0 1`), { code: 'bad-fap', line: 3 });
  assert.throws(() => readFap('2.1 a 0 1\n'), { line: 1 });
});

test('reads a .fapc file; rejects a truncated one with its position', () => {
  const encoder = new FapcEncoder(0);
  const frames = [10, 60, 110].map((value) => {
    const frame = fapcFrame();
    frame.mask[3] = 1;
    frame.values[3] = value;
    frame.mask[2] = 1;
    frame.expression = [1, value, 0, 0, 0, 0];
    return frame;
  });
  const packet = encoder.encode(frames, true);
  const bytes = Uint8Array.from([70, 80, 67, 49, 196, 9, 0, 0, 3, packet.length & 255, packet.length >> 8, ...packet]);
  assert.ok(isFapc(bytes));
  const { fps, frames: read } = readCoded(bytes, readFapcFile);
  assert.equal(fps, 25);
  read.forEach((frame, k) => assert.ok(Math.abs(frame[3] - frames[k].values[3]) <= 8, `${frame[3]}`));
  assert.throws(() => readCoded(bytes.subarray(0, -1), readFapcFile), { code: 'bad-fap', message: 'the file ends within a packet', byte: 8 });
});

test('reads FBA bitstreams', () => {
  const writer = new FbaWriter();
  const types = [3, ...Array(9).fill(3)];
  const high = { viseme: [1, 2, 60, 0], expression: [1, 63, 0, 0, 0, 0] };
  const shown = [0, 1, 2].map((k) => writer.frame({ intra: !k, types, rate: [25, 0, 0], quant: 2, levels: { 3: 5, 48: -1 }, ...high }));
  const bytes = Uint8Array.from(writer.end());
  assert.ok(isFba(bytes) && !isFapc(bytes));
  const read = readCoded(bytes, readFba);
  assert.equal(read.fps, 25);
  assert.deepEqual(read.frames.map((frame) => [...frame]), shown.map(({ values }) => values));
  assert.deepEqual(read.high[2], [high.viseme, high.expression]);
  assert.equal(parseFap(writeFap(read)).frames[2][48], -2 * 170 * 3);
  assert.throws(() => readCoded(bytes.subarray(0, 40), readFba), { code: 'bad-fap', message: 'the stream ends within a frame', byte: 40 });
});

test('splines pass through their keys, and never overshoot', () => {
  const [x, y] = [[0, 4, 9, 12, 20], [0, 100, 90, 90, -40]];
  const curve = spline(x, y);
  assert.equal(curve.length, 21);
  x.forEach((k, i) => assert.ok(Math.abs(curve[k] - y[i]) < 1e-9));
  for (let i = 0; i + 1 < x.length; i++)
    for (let k = x[i]; k < x[i + 1]; k++) assert.ok((curve[k + 1] - curve[k]) * Math.sign(y[i + 1] - y[i] || 1) >= -1e-9, `${k}`);
  const wave = Array.from({ length: 100 }, (_, k) => 50 * Math.sin(k / 7));
  const keys = keysOf(wave, 1);
  assert.ok(keys.length < 50 && keys[0] === 0 && keys.at(-1) === 99, `${keys}`);
  const back = spline(keys, keys.map((k) => wave[k]));
  assert.ok(back.every((value, k) => Math.abs(value - wave[k]) < 4));
  assert.deepEqual(smooth([0, 0, 10, 0, 0], 1), [0, 10 / 3, 10 / 3, 10 / 3, 0]);
});

test('mirrors FAPs to the other side of the face', () => {
  const names = new Set(table.map(({ name }) => name));
  for (const { name } of table) {
    assert.ok(names.has(mirrored(name)), `${name} ${mirrored(name)}`);
    assert.equal(mirrored(mirrored(name)), name);
  }
  assert.equal(mirrored('raise_l_i_eyebrow'), 'raise_r_i_eyebrow');
  assert.equal(mirrored('lower_t_lip_lm_o'), 'lower_t_lip_rm_o');
  assert.equal(mirrored('open_jaw'), 'open_jaw');
});

test('undoes and redoes changes in order', () => {
  const history = new History();
  history.add([{ number: 3, before: [1], after: [2] }]);
  history.add([{ number: 3, before: [2], after: [3] }]);
  assert.deepEqual(history.undo(), [{ number: 3, before: [3], after: [2] }]);
  assert.deepEqual(history.undo()[0].after, [1]);
  assert.equal(history.undo(), undefined);
  assert.deepEqual(history.redo()[0].after, [2]);
  history.add([{ number: 3, before: [2], after: [9] }]);
  assert.equal(history.redo(), undefined, 'another way was taken');
});

test('a drawn line replaces the curve in its range', () => {
  assert.deepEqual(drawnOver([1, 1, 1, 1, 1, 1], new Map([[4, 30], [2, 10]])), [1, 1, 10, 20, 30, 1]);
  assert.deepEqual(drawnOver([1, 2], new Map()), [1, 2]);
});

test('turns a range into a gesture of the selected groups; rejects one without movement', () => {
  const frames = Array.from({ length: 20 }, (_, k) => Array.from({ length: 69 }, (_, n) => (n === 3 || n === 48 ? k : 0)));
  const wish = { name: 'mio', from: 2, to: 6, groups: [7] };
  const made = makeGesture({ fps: 25, frames }, table, wish);
  assert.deepEqual(made.curves, { head_pitch: [2, 3, 4, 5, 6] });
  assert.deepEqual(JSON.parse(gestureText(made)), made);
  assert.equal(makeGesture({ fps: 25, frames }, table, { ...wish, groups: [4] }), null);
  assert.equal(makeGesture({ fps: 25, frames }, table, { ...wish, to: 3 }), null);
  assert.equal(makeGesture({ fps: 1, frames }, table, { ...wish, to: 19 }), null);
});

test('rejects a .fapc with more frames than a player holds before decoding one', () => {
  const packet = Buffer.from([64, 2, 0, 0, 0]); // which cannot be decoded: whoever tries says so at byte 8
  const header = Buffer.from('FPC1\xc4\x09\0\0', 'latin1');
  const of = (frames) => new Uint8Array(Buffer.concat([header, ...Array(Math.ceil(frames / 64)).fill(packet)]));
  const place = 8 + 5 * Math.floor(FRAMES_MAX / 64);
  assert.throws(() => readCoded(of(FRAMES_MAX + 64), readFapcFile), { code: 'bad-fap', message: 'more frames than one file may have', byte: place });
  assert.throws(() => readCoded(of(64 * Math.floor(FRAMES_MAX / 64)), readFapcFile), { code: 'bad-fap', byte: 8 }, 'as many are decoded');
});

test('an empty stream has the chosen rate and length, and can be written and read', () => {
  const faps = emptyFaps(30, 2.5);
  assert.deepEqual([faps.fps, faps.frames.length], [30, 75]);
  faps.frames[10][4] = 120;
  const again = readFap(writeFap(faps));
  assert.deepEqual([again.fps, again.frames.length, again.frames[10][4], again.frames[11][4]], [30, 75, 120, 0]);
  assert.equal(emptyFaps(25, 0).frames.length, 1);
  assert.equal(emptyFaps(60, 1e6).frames.length, FRAMES_MAX);
});

test('finds pitch and intensity of voiced sound, and no pitch in noise and silence', () => {
  const rate = 22050;
  const sound = (seconds, wave) => Float32Array.from({ length: seconds * rate }, (_, i) => wave(i / rate, i));
  const middle = (values) => values.slice(5, -5);
  for (const hertz of [80, 123, 210, 340]) {
    // pulses with falling overtones, as a voice has; the second is the strongest
    const voice = sound(0.5, (t) => [0.5, 1, 0.4, 0.3, 0.2].reduce((sum, a, k) => sum + 0.1 * a * Math.sin(2 * Math.PI * hertz * (k + 1) * t), 0));
    const { pitch, intensity } = prosody(voice, rate);
    for (const one of middle(pitch)) assert.ok(Math.abs(one / hertz - 1) < 0.02, `${one} instead of ${hertz} Hz`);
    for (const one of middle(intensity)) assert.ok(Math.abs(one + 21.1) < 1, `${one} dB`);
  }
  let state = 1;
  const noise = prosody(sound(0.5, () => ((state = (Math.imul(state, 1664525) + 1013904223) >>> 0) / 2 ** 31 - 1) * 0.3), rate);
  assert.ok(noise.pitch.filter((one) => one !== null).length < noise.pitch.length / 10);
  const silence = prosody(sound(0.3, () => 0), rate);
  assert.ok(silence.pitch.every((one) => one === null) && silence.intensity.every((one) => one === -80));
  assert.ok(prosody(new Float32Array(rate * 600), rate).times.length <= 2000, 'a long sound has no more columns');
});
