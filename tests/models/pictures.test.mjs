// SPDX-License-Identifier: GPL-3.0-or-later
// The set of pictures that is built from the default head: all context visemes, closed where they must be, anchors where the FAPs put them.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';
import zlib from 'node:zlib';
import { faceValues } from '../../web/element/face/face-mixer.mjs';
import { readPictures } from '../../web/element/pictures/set.mjs';
import { displacements } from '../../web/element/pictures/space.mjs';
import { violations } from '../lib/schema.mjs';

const root = fileURLToPath(new URL('../../', import.meta.url));
const file = path.join(process.env.FACCIA_BUILD ?? path.join(root, 'build'), 'models/pictures/mara.json');
const text = fs.readFileSync(file);
const set = JSON.parse(text);
const [mouth, ...eyes] = set.regions;
const { visemes } = JSON.parse(fs.readFileSync(path.join(root, 'models/speech/visemes/pt.json')));

test('matches its schema, and is small enough', () => {
  assert.equal(violations('pictures', set), null);
  readPictures(set);
  const packed = fs.readFileSync(`${file}.gz`);
  assert.ok(packed.length <= 765000, `${packed.length} bytes`);
  assert.ok(zlib.gunzipSync(packed).equals(text));
});

test('every context viseme has its picture; only those of /p b m/ and rest are closed', () => {
  const names = Object.keys(visemes);
  assert.equal(names.length, 34);
  for (const name of names) {
    const { faps } = mouth.pictures.find((picture) => picture.name === name);
    const closed = (faps[4] ?? 0) + (faps[5] ?? 0) >= 0;
    assert.equal(closed, name === 'rest' || visemes[name].phone === 'p', name);
  }
});

test('the lips lie within the inner contour, the chin within the outer one, and the anchors move with the FAPs', () => {
  const rest = mouth.pictures.find(({ name }) => name === 'rest').anchors;
  const inside = (contour, [x, y]) =>
    [contour.some(([a]) => a < x), contour.some(([a]) => a > x), contour.some(([, c]) => c < y), contour.some(([, c]) => c > y)].every(Boolean);
  const offs = [];
  for (const { name, faps, anchors } of mouth.pictures) {
    const moved = displacements(faceValues(faps), set.fapu);
    anchors.forEach((point, i) => {
      assert.ok(inside(i < 4 ? mouth.mask.inner : mouth.mask.outer, point), `${name}: anchor ${i} at ${point}`);
      const off = Math.hypot(...point.map((value, k) => value - rest[i][k] - moved[i][k]));
      offs.push(off);
      assert.ok(off < 12, `${name}: anchor ${i} is ${off.toFixed(1)} pixels from where its FAPs put it`); // rounded lips roll
    });
  }
  const median = offs.sort((a, b) => a - b)[offs.length >> 1];
  assert.ok(median < 2.5, `${median.toFixed(2)} pixels in the middle`);
});

test('each eye has pictures from open to closed', () => {
  assert.deepEqual(eyes.map(({ name }) => name), ['eye_l', 'eye_r']);
  for (const { pictures } of eyes) assert.ok(pictures.length >= 3 && !Object.keys(pictures[0].faps).length);
});
