// SPDX-License-Identifier: GPL-3.0-or-later
// Recordings of articulographs as MATLAB and Carstens write them become the CSV that faccia fit reads.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { deflateSync } from 'node:zlib';
import { root } from '../lib/daemon.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
after(() => fs.rmSync(folder, { recursive: true }));
const convert = (name, data, ...args) => {
  const file = path.join(folder, name);
  fs.writeFileSync(file, data);
  const { status, stdout, stderr } = spawnSync(path.join(root, 'models/tools/articulograph.py'), [...args, file]);
  return { status, stderr: String(stderr), rows: String(stdout).trim().split('\n').map((line) => line.split(',')) };
};

const pad = (b) => Buffer.concat([b, Buffer.alloc((8 - (b.length % 8)) % 8)]);
const element = (kind, content) => {
  const tag = Buffer.alloc(8);
  tag.writeUInt32LE(kind, 0);
  tag.writeUInt32LE(content.length, 4);
  return pad(Buffer.concat([tag, content]));
};
const ints = (...values) => Buffer.from(Int32Array.from(values).buffer);
const doubles = (values) => Buffer.from(Float64Array.from(values).buffer);
const matrix = (kind, shape, name, ...parts) =>
  element(14, Buffer.concat([element(6, ints(kind, 0)), element(5, ints(...shape)), element(1, Buffer.from(name)), ...parts]));
const codes = (value) => Uint16Array.from([...value].map((c) => c.charCodeAt(0)));
/** Kinds of characters: unsigned numbers (4), UTF-8 (16), UTF-16 (17). */
const text = (value, kind = 4) => matrix(4, [1, value.length], '', element(kind, kind === 16 ? Buffer.from(value) : Buffer.from(codes(value).buffer)));
const number = (value) => matrix(6, [1, 1], '', element(9, doubles([value])));
/** Columns x, y, z of the given number of frames. */
const signal = (n, at) => matrix(6, [n, 3], '', element(9, doubles([0, 1, 2].flatMap((axis) => Array.from({ length: n }, (_, i) => at(axis, i))))));
const fields = ['NAME', 'SRATE', 'SIGNAL'];
const names = element(1, Buffer.from(fields.map((f) => f.padEnd(8, '\0')).join('')));
const sensors = [['AUDIO', 16000, matrix(6, [100, 1], '', element(9, doubles(Array(100).fill(0))))],
  ['UL', 200, signal(200, (axis, i) => [10, 0, i / 10][axis])],
  ['LL', 200, signal(200, (axis, i) => (i === 50 ? NaN : [8, 0, -i / 5][axis]))]];
const say = (kind) => matrix(2, [1, sensors.length], 'say', element(5, ints(8)), names, ...sensors.flatMap(([name, rate, values]) => [text(name, kind), number(rate), values]));
const data = say(4);
const header = Buffer.alloc(128, ' ');
header.write('MATLAB 5.0 MAT-file');
header.write('\x00\x01IM', 124, 'latin1');

for (const [kind, content] of [['plain', data], ['texts in UTF-8', say(16)], ['texts in UTF-16', say(17)], ['compressed', (() => {
  const packed = deflateSync(data);
  const tag = Buffer.alloc(8);
  tag.writeUInt32LE(15, 0);
  tag.writeUInt32LE(packed.length, 4);
  return Buffer.concat([tag, packed]);
})()]])
  test(`reads MATLAB files, ${kind}`, () => {
    const { status, stderr, rows } = convert('a.mat', Buffer.concat([header, content]));
    assert.equal(status, 0, stderr);
    assert.deepEqual(rows[0], ['time', 'ul_x', 'ul_z', 'll_x', 'll_z']);
    assert.equal(rows.length, 101, 'one second at 100 Hz');
    assert.deepEqual(rows[11].map(Number), [0.1, 10, 2, 8, -4]);
    assert.deepEqual(rows[26].map(Number), [0.25, 10, 5, 8, -10], 'the missing frame is bridged');
  });

test('reads Carstens files with a header', () => {
  const head = 'AG50xDATA_V003\n00000080\nNumberOfChannels=2\nSamplingFrequencyHz=250\n'.padEnd(79) + '\n';
  const frames = Float32Array.from(Array.from({ length: 250 }, (_, i) => [1, 2, i, 0, 0, 0, 0, 4, 5, -i, 0, 0, 0, 0]).flat());
  const { status, stderr, rows } = convert('a.pos', Buffer.concat([Buffer.from(head), Buffer.from(frames.buffer)]), '--sensors', '1=ul,2=ll', '--forward=-y', '--hz', '50');
  assert.equal(status, 0, stderr);
  assert.equal(rows.length, 51);
  assert.deepEqual(rows[11].map(Number), [0.2, -2, 50, -5, -50]);
});

test('reports errors', () => {
  assert.match(convert('a.mat', 'nothing').stderr, /no MATLAB 5 file/);
  assert.match(convert('a.mat', Buffer.concat([header, data]), '--sensors', 'XX=ul').stderr, /no sensor XX: there are UL, LL/);
  assert.match(convert('b.mat', Buffer.concat([header, data.subarray(0, 900)])).stderr, /ends too early/);
  assert.equal(convert('b.mat', Buffer.concat([header, data.subarray(0, 900)])).status, 1);
});
