// SPDX-License-Identifier: GPL-3.0-or-later
// Sets of pictures made from photographs of Rosa, who wears glasses, in frames of different sizes and light and slightly tilted, with unsuitable
// ones among them; from a video of the same; and invalid sources.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { unpack } from '../../models/tools/lib/deform.mjs';
import { inverse, mapped, placed, refined, similarity, evened } from '../../models/tools/pictures/frame.mjs';
import { nameOf, visemes } from '../../models/tools/pictures/names.mjs';
import { readPictures } from '../../web/element/pictures/set.mjs';
import { models as built } from '../lib/built-heads.mjs';
import { artefacts } from '../lib/daemon.mjs';
import { further } from '../lib/long.mjs';
import { openStudio } from '../lib/photographs.mjs';
import { violations } from '../lib/schema.mjs';

const root = fileURLToPath(new URL('../../', import.meta.url));
const tool = path.join(root, 'models/tools/pictures/make-set.mjs');
const TAKEN = ['rest', 'p1', 'u', 'a', 'i1', 't1', 'o', 'e', 'f2'];
const EXPECTED = { 'p1-1.png': /lips are apart/, 'u-1.png': /blurred/, 'a-1.png': /turned by \d\d degrees/, 'e-1.png': /hardly open/, 'i1-1.jpg': /no picture that can be read/, 'o-1.png': /no face/, 'f2-1.png': /darker/ };
let folder, photographs, made;

const run = (...args) => spawnSync('node', [tool, ...args], { encoding: 'utf8' });
const file = (name) => path.join(folder, name);

before(async () => {
  folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-set-'));
  photographs = file('rosa');
  fs.mkdirSync(photographs);
  const take = await openStudio(unpack(JSON.parse(fs.readFileSync(path.join(built, 'heads/rosa.json'), 'utf8'))));
  const { poses } = JSON.parse(fs.readFileSync(path.join(root, 'models/pictures/poses.json'), 'utf8'));
  const faps = Object.fromEntries(poses.map((pose) => [pose.name, pose.faps]));
  const put = (name, bytes) => fs.writeFileSync(path.join(photographs, name), bytes);
  for (const [i, name] of TAKEN.entries()) {
    const camera = name === 'rest' ? {} : { scale: 0.9 + 0.06 * i, tilt: (i % 5) - 2, shift: [17 * (i % 4) - 20, 30 - 13 * (i % 5)], light: 0.88 + 0.03 * i };
    put(`${name}.png`, await take(faps[name], camera));
  }
  put('blink.png', await take({ 19: 940, 20: 940, 21: 84, 22: 84 }, { tilt: 1.5 }));
  put('u-1.png', await take(faps.u, { blur: 4 }));
  put('a-1.png', await take(faps.a, { yaw: 25 }));
  put('f2-1.png', await take(faps.f2, { light: 0.4 }));
  for (const [name, as] of [['a', 'p1-1.png'], ['rest', 'e-1.png']]) fs.copyFileSync(path.join(photographs, `${name}.png`), path.join(photographs, as));
  put('i1-1.jpg', fs.readFileSync(path.join(photographs, 'i1.png')).subarray(0, 4000));
  put('o-1.png', await take(faps.o, { shift: [3000, 0] })); // beside the picture
  put('notes.txt', 'p1 was hard');
  made = run(photographs, '-o', file('rosa.json'), '--title', 'Rosa');
});
after(() => fs.rmSync(folder, { recursive: true, force: true }));

test('makes a set that matches its schema and its size limit from a folder of photographs', (t) => {
  t.diagnostic(made.stdout);
  assert.equal(made.status, 0, made.stderr + made.stdout);
  const set = JSON.parse(fs.readFileSync(file('rosa.json'), 'utf8'));
  fs.mkdirSync(artefacts, { recursive: true });
  fs.copyFileSync(file('rosa.json'), path.join(artefacts, 'rosa-set.json'));
  assert.equal(violations('pictures', set), null);
  readPictures(set);
  assert.equal(set.title, 'Rosa');
  assert.deepEqual(set.regions.map(({ name }) => name), ['mouth', 'eye_l', 'eye_r']);
  assert.deepEqual(set.regions[0].pictures.map(({ name }) => name).sort(), TAKEN.toSorted());
  assert.ok(Number(made.stdout.match(/(\d+) bytes compressed/)[1]) <= 765000);
  assert.match(made.stdout, new RegExp(`without ${visemes.filter((name) => !TAKEN.includes(name)).join(' ')}:`));
});

test('gives a reason for each unusable photograph, and only for those', () => {
  const unfits = new Map([...made.stdout.matchAll(/^(.*): unfit: (.*)$/gm)].map(([, name, reason]) => [name, reason]));
  for (const [name, reason] of Object.entries(EXPECTED)) assert.match(unfits.get(name) ?? '', reason, name);
  assert.deepEqual([...unfits.keys()].sort(), Object.keys(EXPECTED).sort());
  assert.match(made.stdout, /notes\.txt: left out/);
});

test('aligns the face regardless of the frame: pictures of a person differ only in their poses', () => {
  const { fapu, regions: [{ pictures }] } = JSON.parse(fs.readFileSync(file('rosa.json'), 'utf8'));
  const at = Object.fromEntries(pictures.map(({ name, anchors }) => [name, anchors]));
  const wide = (name) => at[name][1][0] - at[name][0][0];
  const middle = (name) => (at[name][0][0] + at[name][1][0]) / 2;
  for (const name of TAKEN) assert.ok(Math.abs(middle(name) - middle('rest')) < 0.03 * fapu.MW, `${name}: the mouth is ${(middle(name) - middle('rest')).toFixed(1)} pixels beside`);
  assert.ok(wide('u') < 0.98 * wide('rest') && wide('i1') > wide('rest'), `u ${wide('u') / wide('rest')}, i1 ${wide('i1') / wide('rest')}`);
  assert.ok(at.a[4][1] - at.rest[4][1] > 0.1 * fapu.MNS, 'the chin comes down');
});

test('registers a picture to another within a tenth of a pixel', () => {
  const dots = (u, v) => 128 + 50 * Math.sin(u / 7) * Math.cos(v / 9) + 30 * Math.sin((u + v) / 13);
  const picture = { width: 240, height: 200, data: new Uint8ClampedArray(4 * 240 * 200) };
  const onto = similarity([[0, 0], [100, 0]], [[-15, -22], [84.6, -18]], [0, 1]);
  const box = { x: 20, y: 20, width: 120, height: 90 };
  for (let i = 0; i < 240 * 200; i++) picture.data.fill(dots(...mapped(onto, [(i % 240) + 0.5, Math.floor(i / 240) + 0.5])), 4 * i, 4 * i + 4);
  const still = { width: box.width, height: box.height, data: new Uint8ClampedArray(4 * box.width * box.height) };
  for (let i = 0; i < box.width * box.height; i++) still.data.fill(dots(box.x + (i % box.width) + 0.5, box.y + Math.floor(i / box.width) + 0.5), 4 * i, 4 * i + 4);
  const first = { ...onto, c: onto.c + 1.7, d: onto.d - 1.2, b: onto.b + 0.006 };
  const found = refined(picture, first, box, evened(still));
  for (const corner of [[30, 30], [130, 100]]) {
    const [x, y] = mapped(found, mapped(inverse(onto), corner));
    assert.ok(Math.hypot(x - corner[0], y - corner[1]) < 0.1, `${[x, y]} for ${corner}`);
  }
  assert.deepEqual([...placed(picture, onto, { x: -300, y: 0, width: 2, height: 1 }).data], [0, 0, 0, 0, 0, 0, 0, 0], 'outside of the picture there is nothing');
});

test('accepts the names of the table, and their keyboard spellings', () => {
  assert.deepEqual(['sh1', 'ʃ1', 'LH2', 'p1', 'rest', 'blink'].map(nameOf), ['ʃ1', 'ʃ1', 'ʎ2', 'p1', 'rest', 'blink']);
  assert.equal(nameOf('__proto__'), null);
});

test('takes frames of a video by their times', further, (t) => {
  const frames = file('frames');
  fs.mkdirSync(frames);
  const shown = ['rest', 'p1', 'a', 'u', 'i1', 't1', 'o', 'e', 'f2'];
  shown.forEach((name, i) => fs.copyFileSync(path.join(photographs, `${name}.png`), path.join(frames, `${i}.png`)));
  const video = file('rosa.avi');
  execFileSync('ffmpeg', ['-v', 'error', '-framerate', '2', '-i', path.join(frames, '%d.png'), '-vf', 'scale=480:624', '-c:v', 'mjpeg', '-q:v', '2', video]);
  const times = { ...Object.fromEntries(shown.map((name, i) => [name, 0.5 * i + 0.1])), ih: 77, a: [0.1, 1.1] };
  fs.writeFileSync(file('times.json'), JSON.stringify(times));
  const { status, stdout, stderr } = run(video, '--times', file('times.json'), '-o', file('film.json'));
  t.diagnostic(stdout);
  assert.equal(status, 0, stderr + stdout);
  assert.match(stdout, /a at 0\.1 s: unfit: the mouth is hardly open/);
  assert.match(stdout, /at 77 s: unfit: the video has no picture/);
  const set = JSON.parse(fs.readFileSync(file('film.json'), 'utf8'));
  assert.equal(violations('pictures', set), null);
  assert.deepEqual(set.regions.map(({ name }) => name), ['mouth'], 'without a picture of closed eyes it does not blink');

  fs.writeFileSync(file('hollow.mp4'), 'this is no video');
  const hollow = run(file('hollow.mp4'), '--times', file('times.json'), '-o', file('hollow.json'));
  assert.equal(hollow.status, 1);
  assert.match(hollow.stdout + hollow.stderr, /hollow\.mp4: /);
  fs.writeFileSync(file('far.m3u8'), '#EXTM3U\n#EXTINF:1,\nhttp://127.0.0.1:9/a.ts\n');
  assert.equal(run(file('far.m3u8'), '--times', file('times.json'), '-o', file('far.json')).status, 1, 'nothing is fetched for a list of addresses');
});

test('rejects an invalid source with its position, and writes nothing', () => {
  const empty = file('empty');
  fs.mkdirSync(empty);
  fs.writeFileSync(file('bad.json'), '{"rest": 0.1, "zz": 1}');
  fs.writeFileSync(file('early.json'), '{"rest": 0.1, "a": [0.2, -1]}');
  fs.writeFileSync(file('broken.json'), '{"rest": ');
  const video = file('rosa.json'); // it is not looked into before the times are
  const cases = [
    [[empty, '-o', file('x.json')], 1, /'rest' is wanted/],
    [[file('nothing'), '-o', file('x.json')], 1, /there is none/],
    [[video, '-o', file('x.json')], 1, /--times/],
    [[video, '--times', file('bad.json'), '-o', file('x.json')], 1, /bad\.json: zz: no viseme/],
    [[video, '--times', file('early.json'), '-o', file('x.json')], 1, /early\.json: a\[1\]: seconds/],
    [[video, '--times', file('broken.json'), '-o', file('x.json')], 1, /broken\.json: .*JSON/],
    [[empty], 2, /--output/],
    [[empty, '-o', 'X Y.json'], 2, /--name/],
  ];
  for (const [args, status, what] of cases) {
    const refused = run(...args);
    assert.equal(refused.status, status, refused.stderr);
    assert.match(refused.stderr, what);
  }
  assert.deepEqual(fs.readdirSync(folder).filter((name) => name.startsWith('x.json')), []);
});
