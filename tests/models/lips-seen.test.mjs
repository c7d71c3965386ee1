// SPDX-License-Identifier: GPL-3.0-or-later
// Lips measured in pictures of one of our heads with known FAPs: in a folder, as a film (with a stand-in for ffmpeg that returns pictures), and in
// files that are not films. For the accuracy of the curves see tests/bench/seen-lips.mjs.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import { createRequire } from 'node:module';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { film, headOf } from '../lib/film.mjs';
import { further } from '../lib/long.mjs';

const sharp = createRequire(new URL('../../models/package.json', import.meta.url))('sharp');
const tool = fileURLToPath(new URL('../../models/tools/lips/faccia-lips.mjs', import.meta.url));
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-seen-'));
after(() => fs.rmSync(folder, { recursive: true, force: true }));
const head = headOf('samuel'); // laid onto another's lips
const mm = (fap, x) => (x * 1024) / (fap === 'MW' ? head.fapu.MW : head.fapu.MNS);
const all = (faps, value) => Object.fromEntries(faps.map((fap) => [fap, value]));
const OPEN = { ...all([5, 10, 11, 52, 57, 58], -mm('MNS', 9)), ...all([4, 8, 9, 51, 55, 56], -mm('MNS', 2)), 3: mm('MNS', 7), 49: 6000 };
const SPREAD = all([6, 7, 53, 54], mm('MW', 4));
const ROUND = { ...all([6, 7, 53, 54], -mm('MW', 5)), ...all([16, 17], mm('MNS', 2)) };
const FRAMES = [{}, { 49: 3000 }, OPEN, SPREAD, null, ROUND]; // null: no face
const pictures = path.join(folder, 'pictures');
const file = (n) => path.join(pictures, `${String(n).padStart(4, '0')}.png`);

const run = (args, env = {}) => spawnSync(process.execPath, [tool, ...args], { encoding: 'utf8', env: { ...process.env, ...env } });
function curves(text) {
  const [names, ...rows] = text.trim().split('\n').map((line) => line.split(','));
  return rows.map((row) => Object.fromEntries(names.map((name, i) => [name, Number(row[i])])));
}

before(async () => {
  fs.mkdirSync(pictures);
  const { width, height } = await film(head, FRAMES.filter(Boolean), path.join(folder, 'drawn'), { height: 380 }).then(() => sharp(path.join(folder, 'drawn/0001.png')).metadata());
  let n = 0;
  for (const [i, faps] of FRAMES.entries())
    if (faps) fs.copyFileSync(path.join(folder, 'drawn', `${String(++n).padStart(4, '0')}.png`), file(i + 1));
    else await sharp({ create: { width, height, channels: 3, background: '#68a' } }).png().toFile(file(i + 1));
});

test('pictures in a folder: measures opening, spread and rounding, and reports pictures without a face', (t) => {
  const { status, stdout, stderr } = run([pictures, '--fps', '10', '--rest', '0-0.15']);
  assert.equal(status, 0, stderr);
  assert.match(stderr, /1 frames without \(from frame 5\): there is no face to be found/);
  const [rest, turned, open, spread, nobody, round] = curves(stdout);
  t.diagnostic(stdout);
  for (const row of [rest, turned]) for (const name of ['LI', 'LS', 'AR', 'PI', 'PS']) assert.ok(Math.abs(row[name]) < 0.3, `${name} at rest: ${row[name]}`);
  assert.ok(open.LI > 8 && open.LI < 12.5 && open.LS > 1.5 && open.LS < 5 && open.EM > 6 && open.EM < 12, JSON.stringify(open)); // a jump within one picture, two pixels a mm
  assert.ok(Math.abs(spread.LI) < 0.5 && Math.abs(round.LI) < 1.2, JSON.stringify([spread, round]));
  assert.ok(spread.AR > 6.3 && spread.AR < 9, JSON.stringify(spread));
  assert.ok(round.AR < -7 && round.AR > -11 && round.PS > 0.5 && round.PS < 3, JSON.stringify(round));
  assert.deepEqual([nobody.confidence, nobody.LI_confidence, nobody.AR_confidence], [0, 0, 0]);
  assert.ok(open.LI_confidence > 0.7 && open.EM_confidence > 0.7 && rest.EM_confidence === 0 && round.LI_confidence === 0, 'what a front shows of each');
  for (const row of [rest, open, round]) assert.deepEqual([row.PI_confidence, row.PS_confidence], [0, 0]);
  assert.ok(Math.min(open.confidence, spread.confidence, rest.confidence) > 0.7);
});

test('a film that begins in mid-speech: rest is where the lips are closed, unless it is given', () => {
  const spoken = path.join(folder, 'spoken');
  fs.mkdirSync(spoken);
  for (const [i, n] of [3, 3, 6, 4, 1, 2, 3].entries()) fs.copyFileSync(file(n), path.join(spoken, `${i}.png`));
  const { status, stdout, stderr } = run([spoken, '--fps', '10']);
  assert.equal(status, 0, stderr);
  const [, from, to] = /does not rest at the beginning: (\d\.\d\d) to (\d\.\d\d) s, where the lips are closed/.exec(stderr) ?? assert.fail(stderr);
  assert.ok(Number(from) >= 0.17 && Number(to) <= 0.53, `${from} to ${to}`);
  const rows = curves(stdout);
  assert.equal(rows.length, 7);
  for (const i of [0, 6]) assert.ok(rows[i].LI > 7 && rows[i].LI < 13.5, JSON.stringify(rows[i]));
  assert.match(run([spoken, '--fps', '10', '--rest', '0.39-0.5']).stderr, /^(?!.*does not rest)/s);
  const open = path.join(folder, 'open');
  fs.mkdirSync(open);
  for (const i of [1, 2, 3]) fs.copyFileSync(file(3), path.join(open, `${i}.png`));
  assert.match(run([open, '--fps', '10']).stderr, /the lips are closed in no picture: /);
});

test('a video goes through ffmpeg (here a stub) with the same curves; a missing ffmpeg is reported', further, async () => {
  const bytes = [];
  for (let n = 1; n <= 4; n++) {
    const { data, info } = await sharp(file(n)).removeAlpha().raw().toBuffer({ resolveWithObject: true });
    bytes.push(Buffer.from(`P6\n${info.width} ${info.height}\n255\n`), data);
  }
  const bin = path.join(folder, 'bin');
  fs.mkdirSync(bin);
  const video = path.join(folder, 'her.mp4');
  fs.writeFileSync(video, Buffer.concat(bytes));
  const missing = run([video], { PATH: bin });
  assert.equal(missing.status, 1);
  assert.match(missing.stderr, /her\.mp4: a video is taken apart by ffmpeg, which is not there/);
  const standIn = (script) => fs.writeFileSync(path.join(bin, 'ffmpeg'), `#!/bin/sh\n${script}\n`, { mode: 0o755 });
  standIn(`exec /bin/cat '${video}'`);
  const args = ['--fps', '10', '--rest', '0-0.15'];
  const [seen, from] = [run([video, ...args], { PATH: bin }), run([pictures, ...args])];
  assert.equal(seen.status, 0, seen.stderr);
  const [a, b] = [curves(seen.stdout), curves(from.stdout)];
  assert.equal(a.length, 4);
  assert.ok(Math.abs(a[2].LI - b[2].LI) < 1.5 && Math.abs(a[3].AR - b[3].AR) < 2, JSON.stringify([a, b]));
  standIn(`/usr/bin/head -c 5000 '${video}'`);
  assert.match(run([video], { PATH: bin }).stderr, /her\.mp4: its last picture is cut off/);
  standIn("echo 'moov atom not found' >&2; exit 1");
  assert.match(run([video], { PATH: bin }).stderr, /her\.mp4: ffmpeg: moov atom not found/);
});

test('reports an empty folder, a broken picture with its number, and a film without a face', () => {
  const empty = path.join(folder, 'empty');
  fs.mkdirSync(empty);
  const out = path.join(folder, 'never.csv');
  const told = (what) => {
    const { status, stderr } = run([empty, '--fps', '25', '-o', out]);
    assert.equal(status, 1, stderr);
    assert.match(stderr, what);
    assert.ok(!fs.existsSync(out));
  };
  told(/empty: there are no pictures in it/);
  fs.copyFileSync(file(5), path.join(empty, '1.png'));
  told(/empty: there is no face from 0 to 0.2 s, while the mouth rests \(there is no face to be found/);
  fs.writeFileSync(path.join(empty, '10.png'), 'GIF89a no picture');
  told(/empty: frame 2 \(10\.png\): this is no picture that can be read/);
});
