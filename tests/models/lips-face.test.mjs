// SPDX-License-Identifier: GPL-3.0-or-later
// A face with 28 markers: its FAPs, from places in space and from the pictures of two cameras. One of our heads moves by known FAPs and turns.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { triangulate } from '../../models/tools/lips/stereo.mjs';
import { pose, unpack } from '../../models/tools/lib/deform.mjs';
import { parseFap } from '../lib/fapfile.mjs';
import { toCsv } from './lips/write-tracks.mjs';

const root = fileURLToPath(new URL('../../', import.meta.url));
const tool = path.join(root, 'models/tools/lips/faccia-lips.mjs');
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-face-'));
after(() => fs.rmSync(folder, { recursive: true, force: true }));
const head = unpack(JSON.parse(fs.readFileSync(path.join(root, 'build/models/heads/mara.json'), 'utf8')));
const skin = head.parts.find(({ name }) => name === 'skin');
const EIGHT = { nose: '9.3', upperLip: '8.1', leftCorner: '8.3', rightCorner: '8.4', lowerLip: '8.2', chin: '2.1', leftEar: '10.5', rightEar: '10.6' };
const MORE = ['2.10', '4.1', '4.2', '4.3', '4.4', '4.5', '4.6', '5.1', '5.2', '5.3', '5.4', '8.5', '8.6', '8.7', '8.8', '9.1', '9.2', '3.1', '3.2', '2.2'];
const points = [...Object.values(EIGHT), ...MORE];
const names = [...Object.keys(EIGHT), ...MORE.map((point) => `P${point}`)];
const vertices = points.map((point) => {
  let [best, least] = [0, Infinity];
  for (let v = 0; v < skin.position.length / 3; v++) {
    const far = Math.hypot(...head.fdp[point].map((x, k) => x - skin.position[3 * v + k]));
    if (far < least) [best, least] = [v, far];
  }
  return best;
});
const RATE = 50;
const COUNT = 100;
const TOLD = { 31: 120, 32: 60, 33: 150, 34: 40, 35: 90, 36: 160, 53: 60, 54: 40, 59: 130, 60: 80, 3: 500, 41: 90, 61: 60 };
const HEAD = { 48: 9000, 49: 15000, 50: 6000 };
const share = (i, period) => (i < 15 ? 0 : Math.sin((i - 15) / period) ** 2);
const told = Array.from({ length: COUNT }, (_, i) => Object.fromEntries([...Object.entries(TOLD).map(([fap, value], k) => [fap, value * share(i, 9 + 2 * k)]), ...Object.entries(HEAD).map(([fap, value], k) => [fap, value * share(i, 14 + 4 * k)])]));
const posedAt = (faps) => {
  const posed = pose(head, skin, faps);
  return vertices.map((v) => [...posed.slice(3 * v, 3 * v + 3)]);
};
const places = told.map(posedAt);
/** What each point does while the head stands still: FAPs of neighbours move it, too. */
const still = told.map((faps) => posedAt({ ...faps, 48: 0, 49: 0, 50: 0 }));
const AXIS = { 31: ['4.1', 1, 'ENS'], 34: ['4.4', 1, 'ENS'], 36: ['4.6', 1, 'ENS'], 53: ['8.3', 0, 'MW'], 59: ['8.3', 1, 'MNS'], 60: ['8.4', 1, 'MNS'], 3: ['2.1', 1, 'MNS', -1], 41: ['5.3', 1, 'ENS'], 61: ['9.1', 0, 'ENS'] };
const map = path.join(folder, 'map.json');
fs.writeFileSync(map, JSON.stringify({ ...Object.fromEntries(Object.keys(EIGHT).map((name) => [name, name])), ...Object.fromEntries(MORE.map((point) => [point, `P${point}`])) }));
const run = (...args) => spawnSync('node', [tool, ...args], { encoding: 'utf8' });
const put = (name, text) => {
  fs.writeFileSync(path.join(folder, name), text);
  return path.join(folder, name);
};
const tilt = `--tilt=${(Math.atan2((head.fdp['10.5'][1] + head.fdp['10.6'][1]) / 2 - head.fdp['9.3'][1], head.fdp['9.3'][2] - (head.fdp['10.5'][2] + head.fdp['10.6'][2]) / 2) * 180) / Math.PI}`;
const fapu = `--fapu=${['ES', 'ENS', 'MNS', 'MW'].map((name) => `${name}=${head.fapu[name].toFixed(3)}`).join(',')}`;

/** Compares FAPs with how far each marker went, in mm. */
function check(frames, tolerance, t) {
  assert.equal(frames.length, COUNT);
  for (const [fap, [point, axis, length, sign = 1]] of Object.entries(AXIS)) {
    const m = points.indexOf(point);
    const errors = frames.map((frame, i) => Math.abs((frame[fap] * head.fapu[length]) / 1024 - sign * (still[i][m][axis] - still[0][m][axis])));
    const went = Math.max(...still.map((frame) => Math.abs(frame[m][axis] - still[0][m][axis])));
    t.diagnostic(`FAP ${fap} at ${point}: moves ${went.toFixed(1)} mm, error at most ${Math.max(...errors).toFixed(2)} mm`);
    assert.ok(went > 0.5, `${point} moves by ${went} mm`);
    assert.ok(Math.max(...errors) < tolerance * went + 0.3, `FAP ${fap}: ${Math.max(...errors)} mm of ${went}`);
  }
  for (const fap of [48, 49, 50]) {
    const worst = Math.max(...frames.map((frame, i) => Math.abs(frame[fap] - told[i][fap])));
    assert.ok(worst < 1200, `FAP ${fap} is off by ${worst}`);
  }
}

test('28 markers become FAPs, whatever the head does', (t) => {
  const tracks = put('face.csv', toCsv({ names, rate: RATE, places }));
  const { status, stderr, stdout } = run(tracks, '--markers', map, '--rest', '0-0.25', '--fps', String(RATE), tilt, fapu, '--fap', path.join(folder, 'face.fap'));
  assert.equal(status, 0, stderr);
  assert.equal(stdout, '', 'no curves unless they are asked for');
  assert.match(stderr, /25 markers/);
  const { fps, frames } = parseFap(fs.readFileSync(path.join(folder, 'face.fap'), 'utf8'));
  assert.equal(fps, RATE);
  check(frames, 0.12, t);
  const open = spawnSync(path.join(root, 'build/server/cli/faccia'), ['fap', 'info', path.join(folder, 'face.fap')], { encoding: 'utf8' });
  assert.equal(open.status, 0, open.stderr);
});

/* two cameras, half a metre apart, one metre before the face */
const camera = (angle) => {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const rotation = [[c, 0, -s], [0, -1, 0], [-s, 0, -c]]; // looks at the face, y down
  const centre = [1000 * s, 30, 1000 * c];
  const k = [[1800, 0, 960], [0, 1800, 540], [0, 0, 1]];
  const shift = rotation.map((row) => -row.reduce((sum, x, j) => sum + x * centre[j], 0));
  const outer = rotation.map((row, i) => [...row, shift[i]]);
  return k.map((row) => [0, 1, 2, 3].map((j) => row.reduce((sum, x, i) => sum + x * outer[i][j], 0)));
};
const cameras = [camera(-0.25), camera(0.25)];
const seen = (projection, p) => {
  const [x, y, w] = projection.map((row) => row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3]);
  return [x / w, y / w];
};
const flat = (projection, hidden = () => false) =>
  `${['time', ...names.flatMap((name) => [`${name}_x`, `${name}_y`])].join(',')}\n${places.map((frame, i) => [(i / RATE).toFixed(4), ...frame.flatMap((p, m) => (hidden(i, m) ? ['', ''] : seen(projection, p).map((x) => x.toFixed(3))))].join(',')).join('\n')}\n`;

test('the tracks of two cameras become places, curves and FAPs', (t) => {
  const files = cameras.map((one, i) => put(`camera${i}.csv`, flat(one, (frame, m) => i === 1 && m === 2 && frame >= 40 && frame < 43)));
  const setup = put('cameras.json', JSON.stringify({ cameras: cameras.map((projection) => ({ projection })) }));
  const { status, stderr } = run(...files, '--cameras', setup, '--markers', map, '--rest', '0-0.25', '--fps', String(RATE), tilt, fapu, '--fap', path.join(folder, 'two.fap'), '-o', path.join(folder, 'two.csv'), '--all');
  assert.equal(status, 0, stderr);
  const text = fs.readFileSync(path.join(folder, 'two.fap'), 'utf8');
  const { frames } = parseFap(text);
  const flags = text.split('\n')[1 + 2 * 41].split(' ');
  assert.deepEqual([flags[52], flags[53], flags[30]], ['0', '1', '1'], 'what one camera does not see is left out, and nothing else');
  for (let i = 40; i < 43; i++) for (const fap of [53, 59]) frames[i][fap] = parseFap(fs.readFileSync(path.join(folder, 'face.fap'), 'utf8')).frames[i][fap];
  check(frames, 0.12, t);
  const inSpace = run(put('space.csv', toCsv({ names, rate: RATE, places })), '--markers', map, '--rest', '0-0.25', tilt, '--all').stdout.trim().split('\n');
  const curves = fs.readFileSync(path.join(folder, 'two.csv'), 'utf8').trim().split('\n');
  assert.match(curves[0], /^time,LI,LS,AR,PI,PS,EM,AL,AM,EAS,EAD,confidence/);
  const row = (line) => line.split(',').map(Number);
  for (let i = 1; i < curves.length; i++)
    if (i < 40 || i > 44) for (let k = 1; k <= 10; k++) assert.ok(Math.abs(row(curves[i])[k] - row(inSpace[i])[k]) < 0.02, `row ${i}, column ${k}`);
});

test('a place on which the cameras do not agree is not seen', () => {
  const p = [10, 20, 30];
  const both = cameras.map((one) => seen(one, p));
  assert.ok(Math.hypot(...triangulate(cameras, both).map((x, k) => x - p[k])) < 1e-6);
  assert.equal(triangulate(cameras, [both[0], [both[1][0], both[1][1] + 40]]), null);
});

test('refuses what does not fit together', () => {
  const one = path.join(folder, 'camera0.csv');
  const setup = path.join(folder, 'cameras.json');
  for (const [args, wanted, message] of [
    [[one, '--cameras', setup], 2, /the tracks of two cameras/],
    [[one, put('short.csv', flat(cameras[1]).split('\n').slice(0, 20).join('\n')), '--cameras', setup], 1, /100 and 19 frames/],
    [[one, one, '--cameras', put('bad.json', '{"cameras": [{"projection": [[1]]}, {}]}')], 1, /cameras\[0\]\.projection: three rows/],
    [[path.join(folder, 'face.csv'), '--markers', put('map2.json', JSON.stringify({ '99.1': 'a' })), '--fap', path.join(folder, 'x.fap')], 1, /99\.1: there is no such marker/],
    [[path.join(folder, 'face.csv'), '--fapu', 'MW=0', '--fap', path.join(folder, 'x.fap'), '--markers', map], 2, /--fapu MW=0/],
  ]) {
    const { status, stderr } = run(...args);
    assert.equal(status, wanted, stderr);
    assert.match(stderr, message);
  }
});
