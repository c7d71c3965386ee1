// SPDX-License-Identifier: GPL-3.0-or-later
// `faccia fap`: inspects, converts, encodes and draws face animation files; and .fapc as a speech format.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { FapcDecoder } from '../../../protocol/fapc/fapc.mjs';
import { faccia } from '../../lib/command.mjs';
import { Daemon, ordinary, root } from '../../lib/daemon.mjs';
import { parseFap } from '../../lib/fapfile.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-fap-'));
after(() => fs.rmSync(folder, { recursive: true }));
const file = (name) => path.join(folder, name);
const vectors = path.join(root, 'protocol/vectors');

const fap = (...args) => faccia(['fap', ...args]);
/** Runs the ordinary build, for many files; the fuzz targets fap and fapc cover their parsing with sanitizers. */
const fast = (args, input) => faccia(['fap', ...args], { input, from: ordinary });
const well = (result) => {
  assert.equal(result.status, 0, result.stderr);
  return result;
};
const done = (...args) => well(fap(...args));

/** A .fap with a moving mouth: FAPs 3, 4 and 48. */
const moving = (frames, fps = 25) => {
  const mask = Array.from({ length: 68 }, (_, i) => ([3, 4, 48].includes(i + 1) ? 1 : 0)).join(' ');
  const line = (k) => `${k} ${Math.round(300 + 300 * Math.sin(k / 5))} ${Math.round(-90 * Math.cos(k / 7))} ${40 * k}`;
  return `2.1 moving ${fps} ${frames}\n${Array.from({ length: frames }, (_, k) => `${mask}\n${line(k)}\n`).join('')}`;
};
fs.writeFileSync(file('moving.fap'), moving(600));

/** Splits an .fapc file into packets: {frames, data, begin}. */
function packets(bytes) {
  assert.equal(bytes.toString('latin1', 0, 4), 'FPC1');
  const list = [];
  for (let at = 8; at < bytes.length; at += 3 + bytes.readUInt16LE(at + 1)) {
    const data = bytes.subarray(at + 3, at + 3 + bytes.readUInt16LE(at + 1));
    list.push({ frames: bytes[at], data, begin: data[0] >= 128 });
  }
  return list;
}

test('reads every file of the test vectors as specified, or rejects it at its line and column', () => {
  const cases = JSON.parse(fs.readFileSync(path.join(vectors, 'fap.json'), 'utf8'));
  assert.ok(cases.length > 40);
  for (const { file: name, error, version, name: title, fps, frames, note } of cases) {
    const at = path.join(vectors, 'fap', name);
    const { status, stdout, stderr } = fast(['info', at]);
    if (error) {
      assert.equal(status, 1, name);
      assert.ok(stderr.startsWith(`faccia: ${at}:${error.line}:${error.column}: `), `${name}: ${stderr}`);
      continue;
    }
    assert.equal(status, 0, `${name}: ${stderr}`);
    assert.equal(stderr, note ? `faccia: ${at}:${note.line}:${note.column}: warning: 69 flags, the last is ignored\n` : '', name);
    const said = (key) => stdout.match(new RegExp(`^${key} +(.*)$`, 'm'))?.[1];
    assert.equal(said('version'), version || '(no header)', name);
    assert.equal(said('name'), title || '(none)', name);
    assert.equal(Number(said('fps')), fps, name);
    assert.equal(Number(said('frames')), frames.length, name);
    // the converted file is version 2.1 with the same contents
    const anew = well(fast(['convert', at])).bytes;
    assert.ok(anew.toString().startsWith('2.1 '), name);
    assert.deepEqual(fast(['convert', '-'], anew).bytes, anew, name);
    // lossless coding keeps it, too
    if (!frames.length) continue;
    const coded = well(fast(['encode', '--quality', '0', at])).bytes;
    const name_ = title || 'faccia';
    if (Math.abs(fps * 100 - Math.round(fps * 100)) < 1e-6 && name !== 'limits.fap')
      assert.deepEqual(fast(['decode', '--name', name_, '-'], coded).stdout.split('\n').slice(1).map((l) => l.trim()), anew.toString().split('\n').slice(1).map((l) => l.trim()), name);
  }
});

test('info counts, measures and reports the coded size', () => {
  const { stdout } = done('info', file('moving.fap'));
  assert.match(stdout, /^duration +24\.000 s$/m);
  assert.match(stdout, /^ *3 +open_jaw +600 +0 +600 +\d+\.\d$/m);
  assert.match(stdout, /^ *48 +head_pitch +600 +0 +23960 +11980\.0$/m);
  const [coarse, exact] = [...stdout.matchAll(/^coded +(\S+) kbit/gm)].map((m) => Number(m[1]));
  assert.ok(coarse > 0 && coarse < exact, stdout);
  // the reported bit rate is that of the file that encode writes
  assert.equal(coarse.toFixed(2), ((done('encode', file('moving.fap')).bytes.length * 8) / 1000 / 24).toFixed(2));
});

test('convert changes the frame rate', () => {
  const original = parseFap(fs.readFileSync(file('moving.fap'), 'utf8'));
  done('convert', '--fps', '50', '--name', 'twice as many', file('moving.fap'), file('twice.fap'));
  const text = fs.readFileSync(file('twice.fap'), 'utf8');
  assert.ok(text.startsWith('2.1 twice as many 50 1200\n'));
  const twice = parseFap(text);
  original.frames.forEach((frame, k) => assert.deepEqual(twice.frames[2 * k], frame));
  for (let k = 0; k < 599; k++)
    assert.ok(Math.abs(twice.frames[2 * k + 1][3] - (original.frames[k][3] + original.frames[k + 1][3]) / 2) <= 0.5);
  assert.equal(parseFap(done('convert', '--fps', '10', file('moving.fap')).stdout).frames.length, 240);
});

test('a coded file lets readers start every 10 s, and decodes with the accuracy of its quality', () => {
  const coded = done('encode', file('moving.fap')).bytes;
  assert.equal(coded.readUInt32LE(4), 2500);
  const list = packets(coded);
  assert.equal(list.reduce((sum, p) => sum + p.frames, 0), 600);
  assert.deepEqual(list.flatMap((p, i) => (p.begin ? [i] : [])), [0, 50, 100]);
  assert.ok(list.every((p) => p.frames === 5));
  const original = parseFap(fs.readFileSync(file('moving.fap'), 'utf8')).frames;
  fs.writeFileSync(file('moving.fapc'), coded);
  const back = parseFap(done('decode', file('moving.fapc')).stdout);
  assert.equal(back.fps, 25);
  assert.equal(back.frames.length, 600);
  const off = Math.max(...back.frames.map((frame, k) => Math.abs(frame[3] - original[k][3])));
  assert.ok(off > 0 && off <= 12, `${off}`);
  // packets of 120 ms if that is more than 5 frames
  fs.writeFileSync(file('fast.fap'), moving(300, 100));
  assert.equal(packets(done('encode', file('fast.fap')).bytes)[0].frames, 12);
  // the JavaScript decoder agrees
  const decoder = new FapcDecoder();
  const frames = list.flatMap((p) => decoder.decode(p.data, p.frames));
  frames.forEach((frame, k) => assert.equal(frame.values[3] ?? frame[3], back.frames[k][3]));
});

test('reports damage with its byte', () => {
  const coded = done('encode', file('moving.fap')).bytes;
  const refused = (bytes, pattern) => {
    const { status, stderr } = faccia(['fap', 'info', '-'], { input: bytes });
    assert.equal(status, 1);
    assert.match(stderr, pattern);
  };
  refused(coded.subarray(0, 6), /^faccia: -: byte 6: the file ends within its header/);
  refused(coded.subarray(0, coded.length - 1), /^faccia: -: byte \d+: the file ends within a packet/);
  refused(Buffer.concat([coded, Buffer.from([5])]), new RegExp(`byte ${coded.length}: the file ends within the head`));
  const without = (at, ...values) => Buffer.concat([coded.subarray(0, at), Buffer.from(values), coded.subarray(at + values.length)]);
  refused(without(4, 0, 0, 0, 0), /byte 4: the frame rate/);
  refused(without(8, 0), /byte 8: a packet must have 1 to 64 frames/);
  refused(without(8, 65), /byte 8: a packet must have 1 to 64 frames/);
  const first = 3 + coded.readUInt16LE(9);
  refused(Buffer.concat([coded.subarray(0, 8), coded.subarray(8 + first)]), /byte 8: /); // with a packet missing
  // far more frames than bytes: refused before allocating memory
  refused(Buffer.concat([coded.subarray(0, 8), Buffer.alloc(3 * 20000, Buffer.from([64, 0, 0]))]), /byte \d+: more frames than one file may have/);
  // corrupts any byte: gives a result or an error, never a crash
  for (let at = 8; at < 1000; at += 7) {
    const { status } = fast(['decode', '-'], without(at, coded[at] ^ 0x55));
    assert.ok(status === 0 || status === 1, `byte ${at}: ${status}`);
  }
});

test('plot draws the requested FAPs, by default those that move most', () => {
  done('plot', file('moving.fap'), file('most.svg'));
  const svg = fs.readFileSync(file('most.svg'), 'utf8');
  for (const name of ['3 open_jaw', '4 lower_t_midlip', '48 head_pitch']) assert.ok(svg.includes(name), name);
  assert.ok(!svg.includes('raise_b_midlip'));
  const one = done('plot', '--fap', 'open_jaw,5', '--from', '1', '--to', '2', file('moving.fap')).stdout;
  assert.ok(one.includes('3 open_jaw') && one.includes('5 raise_b_midlip') && !one.includes('48 '));
  for (const [args, pattern] of [
    [['--fap', 'nose'], /--fap: 'nose' is not a low-level FAP/], [['--fap', '1'], /--fap: '1'/], [['--from', 'x'], /--from: 'x'/],
    [['--from', '100'], /nothing between/],
  ]) {
    const { status, stderr } = fap('plot', ...args, file('moving.fap'));
    assert.ok(status === 1 || status === 2);
    assert.match(stderr, pattern);
  }
});

test('reports wrong usage', () => {
  for (const [args, pattern] of [
    [[], /Usage/], [['nonsense'], /unknown command 'nonsense'/], [['info'], /no file/], [['encode'], /Usage/],
    [['encode', '--quality', '32', file('moving.fap')], /--quality: '32'/], [['convert', '--fps', '0', file('moving.fap')], /--fps: '0'/],
  ]) {
    const { status, stderr } = fap(...args);
    assert.equal(status, 2, args.join(' '));
    assert.match(stderr, pattern);
  }
  assert.equal(fap('info', file('none.fap')).status, 1);
  for (const [strange, pattern] of [['/dev/null', /1:1: the file is empty/], [folder, /[Dd]irectory/], ['/dev/zero', /larger than/], [process.execPath, /1:1: neither a header/]]) {
    const { status, stderr } = fap('convert', strange);
    assert.equal(status, 1);
    assert.match(stderr, pattern);
  }
});

test('command line and daemon write speech as .fapc, with the same values that encode makes of its .fap', async () => {
  const said = faccia(['say', '-l', 'it', '--fap', file('say.fap'), '--fapc', file('say.fapc'), 'La mamma parla piano. Poi tace.']);
  assert.equal(said.status, 0, said.stderr);
  const coded = fs.readFileSync(file('say.fapc'));
  const faces = [coded, done('encode', file('say.fap')).bytes].map((bytes) => parseFap(faccia(['fap', 'decode', '-'], { input: bytes }).stdout).frames);
  assert.ok(faces[0].length > 40);
  assert.deepEqual(faces[0], faces[1]);
  const daemon = await Daemon.start();
  try {
    const answer = await daemon.get('/v1/speech?lang=it&format=fapc', { method: 'POST', body: 'La mamma parla piano. Poi tace.', headers: { 'content-type': 'text/plain' } });
    assert.equal(answer.headers.get('content-type'), 'application/octet-stream');
    assert.deepEqual(Buffer.from(await answer.arrayBuffer()), coded);
  } finally {
    assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  }
});
