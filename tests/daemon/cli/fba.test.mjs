// SPDX-License-Identifier: GPL-3.0-or-later
// FBA bitstreams of MPEG-4: the C of `faccia fap` against a second decoder (protocol/fba/fba.mjs) and a second encoder
// (tests/lib/fba-writer.mjs), which share no code with it; damage, limits, and what the coding costs.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { faps } from '../../../protocol/fap.mjs';
import { FbaError, isFba, readFba, supplyFba } from '../../../protocol/fba/fba.mjs';
import { faccia } from '../../lib/command.mjs';
import { Daemon, ordinary } from '../../lib/daemon.mjs';
import { parseFap } from '../../lib/fapfile.mjs';
import { FbaWriter } from '../../lib/fba-writer.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-fba-'));
after(() => fs.rmSync(folder, { recursive: true }));
const file = (name) => path.join(folder, name);
const FRAMES_MAX = 1 << 20;

function well(result) {
  assert.equal(result.status, 0, result.stderr);
  return result;
}

/** Mask lines and value lines of a .fap, as numbers. */
function fapLines(text) {
  const [header, ...lines] = text.trim().split('\n');
  const numbers = lines.map((line) => line.trim().split(' ').map(Number));
  const frames = [];
  for (let i = 0; i < numbers.length; i += 2) {
    const mask = [0, ...numbers[i]];
    const rest = numbers[i + 1].slice(1);
    const viseme = mask[1] ? rest.splice(0, 4) : undefined;
    const expression = mask[2] ? rest.splice(0, 6) : undefined;
    const values = mask.map((on, n) => (on && n > 2 ? rest.shift() : 0));
    frames.push({ mask, viseme, expression, values });
  }
  return { fps: Number(header.split(' ').at(-2)), frames };
}

/** Decodes with C and with JavaScript, and compares every value. */
function decode(bytes) {
  const c = fapLines(well(faccia(['fap', 'decode', '-'], { input: bytes })).stdout);
  const js = readFba(bytes, FRAMES_MAX);
  assert.ok(Math.abs(c.fps - js.fps) < 1e-6, `${c.fps} ${js.fps}`);
  assert.equal(c.frames.length, js.frames.length);
  c.frames.forEach((frame, k) => {
    assert.deepEqual(frame.mask.slice(1), [...js.masks[k]].slice(1), `mask of frame ${k}`);
    assert.deepEqual([frame.viseme, frame.expression], js.high[k], `FAP 1 and 2 of frame ${k}`);
    assert.deepEqual(frame.values, [...js.frames[k]].map((value, n) => (js.masks[k][n] ? value : 0)), `frame ${k}`);
  });
  return c;
}

/** Numbers that are the same on every run. */
function dice(seed) {
  let state = seed;
  return (below) => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return Math.floor((state / 2 ** 32) * below);
  };
}

test('speech, coded, reads the same by both decoders and errs by at most half a step', () => {
  const said = well(faccia(['say', '-l', 'it', '--fap', file('say.fap'), 'La mamma parla piano, il papà beve. Poi tacciono.']));
  assert.equal(said.status, 0);
  const original = fapLines(fs.readFileSync(file('say.fap'), 'utf8'));
  const sizes = [];
  for (const quant of [1, 2, 4, 8, 16, 31]) {
    well(faccia(['fap', 'encode', '--quant', String(quant), file('say.fap'), file('say.fba')]));
    const bytes = fs.readFileSync(file('say.fba'));
    const back = decode(bytes);
    assert.equal(back.fps, 25);
    back.frames.forEach((frame, k) => {
      assert.deepEqual(frame.mask, original.frames[k].mask);
      frame.values.forEach((value, n) => n > 2 && assert.ok(Math.abs(value - original.frames[k].values[n]) <= (quant * faps[n].quant_step) / 2 + 0.5, `FAP ${n} of frame ${k}`));
    });
    sizes.push(bytes.length);
  }
  assert.deepEqual(sizes, sizes.toSorted((a, b) => b - a), 'coarser is smaller');
  // info reports the size that encode writes
  const { stdout } = well(faccia(['fap', 'info', file('say.fap')]));
  well(faccia(['fap', 'encode', file('say.fap'), file('again.bits')]));
  const rate = (fs.statSync(file('again.bits')).size * 8) / 1000 / (original.frames.length / 25);
  assert.equal(stdout.match(/^FBA +(\S+) kbit\/s \(fap_quant 4\)/m)[1], rate.toFixed(2));
  assert.match(well(faccia(['fap', 'info', file('again.bits')])).stdout, /^format +fba$/m);
});

test('visemes, expressions, changing masks and leaps survive', () => {
  const roll = dice(7);
  const lines = Array.from({ length: 120 }, (_, k) => {
    const mask = Array.from({ length: 68 }, (_, i) => (i < 2 || (k >= 40 ? i % 3 === 0 : i % 2 === 0) ? 1 : 0));
    const values = mask.flatMap((on, i) => {
      if (!on || i < 2) return [];
      const { min, max } = faps[i + 1];
      return [k % 17 ? Math.trunc(((min + roll(max - min + 1)) * (k % 5)) / 9) : k % 2 ? max : min];
    });
    return `${mask.join(' ')}\n${[k, roll(15), roll(15), roll(64), roll(2), roll(7), roll(64), roll(7), roll(64), roll(2), roll(2), ...values].join(' ')}`;
  });
  fs.writeFileSync(file('wild.fap'), `2.1 wild 29.97002997 120\n${lines.join('\n')}\n`);
  const original = fapLines(fs.readFileSync(file('wild.fap'), 'utf8'));
  well(faccia(['fap', 'encode', '--quant', '1', '--intra', '0.5', file('wild.fap'), file('wild.fba')]));
  const back = decode(fs.readFileSync(file('wild.fba')));
  assert.ok(Math.abs(back.fps - 30000 / 1001) < 1e-6);
  back.frames.forEach((frame, k) => {
    const { mask, viseme, expression, values } = original.frames[k];
    assert.deepEqual([frame.mask, frame.viseme, frame.expression], [mask, viseme, expression], `frame ${k}`);
    values.forEach((value, n) => assert.ok(Math.abs(value - frame.values[n]) <= (faps[n]?.quant_step ?? 0) / 2, `FAP ${n} of frame ${k}`));
  });
});

test('values beyond what the stream can state are limited, with a warning', () => {
  const line = `${Array.from({ length: 68 }, (_, i) => (i === 47 ? 1 : 0)).join(' ')}\n0 700000\n`;
  fs.writeFileSync(file('far.fap'), `2.1 far 25 1\n${line}`);
  const { stderr } = well(faccia(['fap', 'encode', '--quant', '4', file('far.fap'), file('far.fba')]));
  assert.match(stderr, /1 values exceed what the bitstream can state at --quant 4/);
  assert.equal(decode(fs.readFileSync(file('far.fba'))).frames[0].values[48], 1860 * 170);
  fs.writeFileSync(file('fast.fap'), `2.1 fast 300 1\n${line}`);
  const fast = faccia(['fap', 'encode', file('fast.fap'), file('fast.fba')]);
  assert.equal(fast.status, 1);
  assert.match(fast.stderr, /at most 255 frames a second/);
  for (const [args, pattern] of [[['--quant', '32'], /--quant: '32'/], [['--intra', '0'], /--intra: '0'/]]) {
    const wrong = faccia(['fap', 'encode', ...args, file('far.fap'), file('no.fba')]);
    assert.equal(wrong.status, 2);
    assert.match(wrong.stderr, pattern);
  }
});

const FACE = [0, ...Array(9).fill(3)];

/** Streams that only the second encoder writes. Each returns [bytes, frames that must be shown]. */
const streams = {
  'no ranges, no rate, frames without start codes': () => {
    const roll = dice(1);
    const w = new FbaWriter();
    const shown = Array.from({ length: 60 }, (_, k) => {
      const intra = k % 20 === 0;
      const levels = Object.fromEntries(faps.flatMap((fap, n) => (n > 2 ? [[n, roll(9) - 4 + (intra ? roll(50) : 0)]] : [])));
      return w.frame({ intra, start: k === 0, types: FACE, quant: 3, levels });
    });
    return [w.end(), shown, 30];
  },
  'masks of every type, odd rate, time code': () => {
    const w = new FbaWriter();
    const types = [3, 1, 2, 0, 2, 3, 1, 1, 0, 2];
    const mask = [3, 5, 19, 22, 39, 48, 51, 60, 66];
    const shown = [0, 1, 2, 3].map((k) =>
      w.frame({ intra: !k, types, mask, rate: [12, 8, 1], time: [13, 59, 58], quant: 5, levels: { 3: k, 22: -k }, viseme: [k, 14 - k, 60 - 9 * k, k & 1], expression: [6, 63, k, 10 * k, 1, 0] }));
    return [w.end(), shown, 12.5 / 1.001];
  },
  'skipped frames, codes of the drafts, zeros at the end': () => {
    const w = new FbaWriter({ start: 0x101, plane: 0x103 });
    const [a, b, c] = [w.frame({ intra: true, types: FACE, quant: 2, levels: { 3: 10 }, skip: 2 }), w.frame({ levels: { 3: 1 }, skip: 15 }), w.frame({ levels: { 3: 1 }, skip: 0 })];
    return [w.end('zeros'), [a, a, a, ...Array(16).fill(b), c], 30];
  },
  'stuffing bits, a visual object before it, ones at the end': () => {
    const w = new FbaWriter({ before: [0, 0, 1, 0xb0, 0x62, 0, 0, 1, 0xb5, 0x20] });
    const shown = [w.frame({ intra: true, types: FACE, quant: 1, ranges: [31, 31, 31, 31], levels: {} })];
    // the highest value of every range: each symbol is at the end of the interval, and zeros follow one another
    for (let k = 0; k < 40; k++) shown.push(w.frame({ levels: Object.fromEntries(faps.flatMap((fap, n) => (n > 2 ? [[n, 1860 * (k % 2 ? -1 : 1)]] : []))) }));
    assert.ok(w.stuffed > 5, `${w.stuffed} stuffing bits`);
    return [w.end('ones'), shown, 30];
  },
  'frequencies halved, ranges that stay, new ranges': () => {
    const roll = dice(3);
    const w = new FbaWriter();
    const shown = [w.frame({ intra: true, types: FACE, quant: 0, ranges: [20, 20, 31, 31], levels: {} })];
    for (let k = 1; k < 900; k++) {
      const intra = k === 700 || k === 800;
      const levels = Object.fromEntries(faps.flatMap((fap, n) => (n > 2 ? [[n, k > 800 ? (n === 3 ? roll(2) : 0) : intra ? 7 : roll(31) - 15]] : [])));
      shown.push(w.frame({ intra, types: FACE, quant: 1, ranges: k === 800 ? [0, 0, 1, 0].map((range, i) => (i ? range : 1)) : [], levels: k === 800 ? {} : levels }));
    }
    return [w.end(), shown, 30];
  },
  'frames of 6 bits, a start code before each third': () => {
    const w = new FbaWriter();
    const types = [0, 1, ...Array(8).fill(0)];
    const shown = Array.from({ length: 60 }, (_, k) => w.frame({ intra: k % 3 === 0, types, mask: [3], ranges: [1 + (k % 5), k % 4, 0, 0], levels: { 3: k % 3 ? 0 : k } }));
    return [w.end(), shown, 30];
  },
  'FAP 1 and 2 alone': () => {
    const roll = dice(5);
    const w = new FbaWriter();
    const shown = Array.from({ length: 50 }, (_, k) =>
      w.frame({ intra: !(k % 25), types: [3, ...Array(9).fill(0)], quant: 17, viseme: [roll(15), roll(15), roll(64), roll(2)], expression: [roll(7), roll(64), roll(7), roll(64), roll(2), roll(2)] }));
    return [w.end(), shown, 30];
  },
};

for (const [name, make] of Object.entries(streams))
  test(`reads what others may send: ${name}`, () => {
    const [bytes, shown, fps] = make();
    assert.ok(isFba(bytes));
    const read = decode(bytes);
    assert.ok(Math.abs(read.fps - fps) < 1e-6, `${read.fps}`);
    assert.equal(read.frames.length, shown.length);
    read.frames.forEach((frame, k) => assert.deepEqual([frame.values, frame.viseme, frame.expression], [shown[k].values, shown[k].viseme, shown[k].expression], `frame ${k}`));
  });

test('names byte and bit of what is wrong, the same by both decoders', () => {
  const make = (frame, more = []) => {
    const w = new FbaWriter();
    w.frame({ intra: true, types: FACE, levels: {}, ...frame });
    more.forEach((next) => w.frame(next));
    return w.end();
  };
  const good = make({}, Array(20).fill({ levels: { 3: 5, 40: -3 } }));
  const flip = (bytes, bit) => {
    const out = Buffer.from(bytes);
    out[bit >> 3] ^= 128 >> (bit & 7);
    return out;
  };
  const refused = (bytes, pattern) => {
    const { status, stderr } = faccia(['fap', 'info', '-'], { input: bytes });
    assert.equal(status, 1, stderr);
    const [, byte, bit, message] = stderr.match(/^faccia: -: byte (\d+), bit (\d): (.*)\n$/) ?? assert.fail(stderr);
    assert.match(message, pattern);
    assert.throws(() => readFba(bytes, FRAMES_MAX), (error) => {
      assert.ok(error instanceof FbaError);
      assert.deepEqual([error.reason, error.at, error.bit], [message, Number(byte), Number(bit)]);
      return true;
    });
  };
  refused(make({ dct: true }), /segments of 16 frames/);
  refused(make({ body: 3 }), /body animation/);
  refused(make({ body: 0 }), /a frame without FAPs/);
  refused(make({ rate: [0, 0, 0] }), /the frame rate is 0/);
  refused(new FbaWriter().end(), /there are no frames/);
  refused(make({ rate: [25, 0, 0] }, [{ intra: true, types: FACE, rate: [24, 0, 0], levels: {} }]), /the frame rate changes/);
  refused(good.subarray(0, 30), /the stream ends within a frame/);
  const first = 9 * 8; // behind the start codes: is_intra, mask, is_frame_rate, is_time_code, skip_frames, fap_quant, marker
  refused(flip(good, first), /the first frame is no I frame/);
  refused(flip(good, first + 11), /a marker bit is 0/);
  // any damage and any end gives a result or an error; the two decoders agree which
  for (let at = 9; at < good.length; at += 3) {
    const damaged = flip(good, at * 8 + (at % 8));
    const { status, stderr } = faccia(['fap', 'decode', '-'], { input: damaged, from: ordinary });
    let js = 0;
    try {
      readFba(damaged, FRAMES_MAX);
    } catch (error) {
      js = 1;
      assert.ok(error instanceof FbaError, error.stack);
    }
    assert.equal(status, js, `byte ${at}: ${stderr}`);
  }
  // more frames than a reader takes are refused before memory is spent on them
  const w = new FbaWriter();
  w.frame({ intra: true, types: FACE, levels: {}, skip: 15 * 80000 });
  refused(w.end(), /more frames than one file may have/);
});

test('a stream that leaves FAPs to the receiver is played with the other lip, or the other side', () => {
  const w = new FbaWriter();
  const sent = [4, 10, 52, 6, 20, 31, 39, 48, 12];
  for (let k = 0; k < 5; k++)
    w.frame({ intra: !k, types: [0, 2, 2, 2, 1, 0, 1, 2, 2, 0], mask: sent, rate: [25, 0, 0], quant: 2, levels: { 4: 3, 10: 2 * k - 4, 52: -k, 6: 9, 20: 5, 31: k, 39: 2, 48: 1, 12: -1 } });
  const bytes = w.end();
  const { frames, masks } = readFba(bytes, FRAMES_MAX);
  const whole = supplyFba({ ...readFba(bytes, FRAMES_MAX) }).frames;
  fs.writeFileSync(file('left.fba'), bytes);
  const played = parseFap(well(faccia(['play', '--fap', '-', file('left.fba')])).stdout);
  whole.forEach((values, k) => assert.deepEqual(played.frames[k].slice(3), [...values].slice(3), `frame ${k}`));
  const last = played.frames[4];
  assert.deepEqual([last[51], last[57], last[58], last[11], last[5], last[53], last[54], last[7], last[19], last[32]], [4, 10, 10, 10, 52, 6, 6, 6, 20, 31].map((n) => last[n]));
  assert.equal(last[40], 0, 'a group whose mask leaves nothing to the receiver');
  assert.ok(frames[4][51] === 0 && !masks[4][51], 'the stream itself has none');
});

test('command line and daemon play a stream where they play a .fap', async () => {
  const w = new FbaWriter();
  w.frame({ intra: true, types: FACE, rate: [25, 0, 0], quant: 4, levels: {} });
  for (let k = 1; k < 50; k++) w.frame({ levels: { 3: k < 25 ? 1 : -1 } });
  const bytes = w.end();
  const jaw = [...readFba(bytes, FRAMES_MAX).frames].map((values) => values[3]);
  const media = file('media');
  fs.mkdirSync(media);
  for (const name of ['open.fba', 'both.fba']) fs.writeFileSync(path.join(media, name), bytes);
  fs.writeFileSync(path.join(media, 'broken.fba'), bytes.subarray(0, 40));
  fs.writeFileSync(path.join(media, 'both.fap'), well(faccia(['fap', 'decode', '-'], { input: bytes })).bytes);
  const played = parseFap(well(faccia(['play', '--fap', '-', path.join(media, 'open.fba')])).stdout);
  assert.deepEqual(played.frames.map((frame) => frame[3]), jaw);
  const refused = faccia(['play', '--fap', '-', path.join(media, 'broken.fba')]);
  assert.equal(refused.status, 1);
  assert.match(refused.stderr, /byte 40: the stream ends within a frame \(bit 0\)/);

  const daemon = await Daemon.start(['--media', media]);
  try {
    const list = await (await daemon.get('/v1/media')).json();
    assert.deepEqual(list.media.map(({ name }) => name).sort(), ['both', 'broken', 'open']);
    const stream = await daemon.stream('?lang=it&room=r');
    stream.send({ type: 'play', id: 'a', name: 'open' });
    await stream.wait({ type: 'end', id: 'a', reason: 'done' });
    stream.send({ type: 'play', id: 'b', name: 'broken' });
    const error = await stream.wait({ type: 'error', id: 'b' });
    assert.deepEqual([error.code, error.byte], ['bad-fap', 40]);
    const body = new FormData();
    body.append('fap', new Blob([bytes]), 'a.fba');
    const answer = await daemon.get('/v1/play?room=r&id=c', { method: 'POST', body });
    assert.equal(answer.status, 202, await answer.text());
    await stream.wait({ type: 'end', id: 'c', reason: 'done' });
    const shown = [...new Set(stream.chunks.map((chunk) => chunk.utterance))].map((n) => stream.chunks.filter((chunk) => chunk.utterance === n).flatMap((chunk) => chunk.frames.map((frame) => frame[3])));
    assert.deepEqual(shown.filter((frames) => frames.length), [jaw, jaw]);
    await stream.close();
  } finally {
    assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  }
});
