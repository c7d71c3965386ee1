// SPDX-License-Identifier: GPL-3.0-or-later
// Morphing a face made of pictures: the warp, the choice of pictures, the mask, the pixels.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import { test } from 'node:test';
import { faceValues } from '../../../web/element/face/face-mixer.mjs';
import { maskOf } from '../../../web/element/pictures/mask.mjs';
import { Region } from '../../../web/element/pictures/morph.mjs';
import { multiquadric } from '../../../web/element/pictures/multiquadric.mjs';
import { nearest } from '../../../web/element/pictures/nearest.mjs';
import { pictureSize } from '../../../web/element/head/model/picture-size.mjs';
import { readPictures } from '../../../web/element/pictures/set.mjs';
import { readPicture } from '../../../web/portrait/page.mjs';
import { openingOf, spaceOf } from '../../../web/element/pictures/space.mjs';

const ANCHORS = [[20, 40], [60, 40], [40, 30], [40, 52], [40, 75]];
const box = (inset, width, height) => [[inset, inset], [width - 1 - inset, inset], [width - 1 - inset, height - 1 - inset], [inset, height - 1 - inset]];

test('the warp maps each anchor exactly, and reproduces affine maps', () => {
  const to = ANCHORS.map(([x, y], i) => [x + 2 * i - 3, y - i * i]);
  const affine = ANCHORS.map(([x, y]) => [3 + 0.9 * x - 0.2 * y, -5 + 0.1 * x + 1.1 * y]);
  const warp = multiquadric(ANCHORS, [to, affine]);
  const out = new Float64Array(4);
  ANCHORS.forEach(([x, y], i) => {
    warp(x, y, out);
    assert.ok(Math.hypot(out[0] - to[i][0], out[1] - to[i][1]) < 1e-9, `anchor ${i}: ${out}`);
  });
  warp(11, 67, out);
  assert.ok(Math.hypot(out[2] - (3 + 9.9 - 13.4), out[3] - (-5 + 1.1 + 73.7)) < 1e-9, `${out}`);
});

const posesOf = () => JSON.parse(fs.readFileSync(new URL('../../../models/pictures/poses.json', import.meta.url))).poses.map(({ name, faps }) => ({ name, faps: faceValues(faps) }));
const inSpace = (poses) => poses.map(({ name, faps }) => ({ name, at: spaceOf('mouth')(faps), opening: openingOf(faps) }));

test('shows the picture of a matched pose', () => {
  const pictures = inSpace(posesOf());
  pictures.forEach(({ at, opening, name }, i) => {
    const [first, ...more] = nearest(at, pictures, opening);
    assert.ok(more.length === 0 && (first.index === i || Math.hypot(...pictures[first.index].at.map((x, k) => x - at[k])) < 1e-3), name);
  });
});

test('shows touching lips by pictures of touching lips, whatever else they do', () => {
  const poses = posesOf();
  const pictures = inSpace(poses);
  for (const { name, faps } of poses) {
    const closed = faps.slice();
    closed[5] = -closed[4]; // the lower lip follows the upper one
    for (const { index } of nearest(spaceOf('mouth')(closed), pictures, openingOf(closed)))
      assert.ok(pictures[index].opening <= 0, `${name} closed is shown by ${pictures[index].name}`);
  }
});

test('transitions between poses are continuous, even when the neighbours change', () => {
  const poses = posesOf();
  const pictures = inSpace(poses);
  const STEPS = 40000; // of a way that takes speech three frames at least
  let changes = 0;
  for (const [a, b] of [['p1', 'a'], ['u', 'i1'], ['f1', 'ɔ'], ['joy', 't1'], ['rest', 'surprise']]) {
    const [from, to] = [a, b].map((name) => poses.find((pose) => pose.name === name).faps);
    const weightsAt = (share) => {
      const faps = from.map((value, n) => value + share * (to[n] - value));
      const weights = new Float64Array(pictures.length);
      for (const { index, weight } of nearest(spaceOf('mouth')(faps), pictures, openingOf(faps))) weights[index] = weight;
      return weights;
    };
    /** The greatest change between two places; where it is great, in pieces of a hundredth: steep ways shrink with the step, jumps do not. */
    const change = (share, width, left, right) => {
      const step = Math.max(...right.map((weight, k) => Math.abs(weight - left[k])));
      if (step < 0.03 || width < 1e-8) return step;
      let [last, most] = [left, 0];
      for (let k = 1; k <= 100; k++) {
        const next = k < 100 ? weightsAt(share + (k * width) / 100) : right;
        most = Math.max(most, change(share + ((k - 1) * width) / 100, width / 100, last, next));
        last = next;
      }
      return most;
    };
    let before = weightsAt(0);
    for (let i = 1; i <= STEPS; i++) {
      const weights = weightsAt(i / STEPS);
      const step = change((i - 1) / STEPS, 1 / STEPS, before, weights);
      assert.ok(step < 0.03, `${a} to ${b}: a weight changes by ${step.toFixed(3)} at ${(i / STEPS).toFixed(3)}`);
      if (weights.some((weight, k) => (weight > 0) !== (before[k] > 0))) changes++;
      before = weights;
    }
  }
  assert.ok(changes > 10, `${changes} neighbours have changed`);
});

test('the mask is opaque inside, clear outside, and half way between half', () => {
  const mask = maskOf({ width: 41, height: 41, mask: { inner: box(12, 41, 41), outer: box(4, 41, 41) } });
  const at = (x, y) => mask[y * 41 + x];
  assert.equal(at(20, 20), 1);
  assert.equal(at(2, 20), 0);
  assert.ok(Math.abs(at(8, 20) - 0.5) < 1e-6, `${at(8, 20)}`);
});

/** A mouth of two pictures, closed (darker to the right) and open (all of one colour). */
function region(width = 80, height = 90) {
  const shade = (level) => (0xff000000 | (level << 16) | (level << 8) | level) >>> 0;
  const ramp = Uint32Array.from({ length: width * height }, (_, i) => shade(2 * (i % width)));
  const flat = new Uint32Array(width * height).fill(shade(200));
  const pictures = [{ name: 'closed', faps: {}, anchors: ANCHORS }, { name: 'open', faps: { 4: -120, 5: -460, 51: -100, 52: -390 }, anchors: ANCHORS.map(([x, y], i) => [x, y + [0, 0, -4, 16, 0][i]]) }];
  return new Region({ name: 'mouth', x: 0, y: 0, width, height, pictures, mask: { inner: box(6, width, height), outer: box(2, width, height) } }, [ramp, flat], { MNS: 42, MW: 100 });
}

test('shows a matched picture exactly, with the mask as its alpha', () => {
  const mouth = region();
  assert.equal(mouth.update(faceValues({})), true);
  assert.equal(mouth.update(faceValues({})), false, 'nothing has changed');
  for (let y = 10; y < 80; y++) for (let x = 10; x < 70; x++) assert.equal(mouth.output[y * 80 + x], mouth.sources[0][y * 80 + x], `${x}, ${y}`);
  assert.equal(mouth.output[0] >>> 24, 0);
});

test('moving a corner stretches the picture', () => {
  const mouth = region();
  const [width, by] = [80, 80]; // FAP units of MW
  mouth.update(faceValues({ 53: by }));
  assert.equal(mouth.chosen.length, 1, 'lips that touch have one picture here');
  const moved = (by / 1024) * 100; // pixels
  const at = (x, y) => mouth.output[y * width + Math.round(x)] & 255;
  const corner = ANCHORS[1][0];
  assert.ok(Math.abs(at(corner + moved, 40) - 2 * corner) <= 4, `${at(corner + moved, 40)}, not ${2 * corner}`);
  assert.ok(Math.abs(at(ANCHORS[0][0], 40) - 2 * ANCHORS[0][0]) <= 3, 'the other corner stays');
  assert.equal(at(3, 45), 6, 'the seam stays');
});

test('rejects a damaged set with the reason', () => {
  const image = { type: 'image/webp', data: 'AAAA' };
  const mouth = () => ({ name: 'mouth', x: 0, y: 0, width: 80, height: 90, columns: 1, sheet: image, mask: { inner: box(6, 80, 90), outer: box(2, 80, 90) }, pictures: [{ name: 'rest', faps: {}, anchors: ANCHORS }] });
  const set = () => ({ format: 'faccia-pictures', version: 1, name: 'x', width: 100, height: 100, fapu: { MNS: 42, MW: 100 }, pivot: [50, 50], reach: 10, base: image, regions: [mouth()] });
  assert.equal(readPictures(set()).title, 'x');
  for (const [damage, what] of [
    [(s) => { s.version = 2; }, /version 1/],
    [(s) => { s.fapu = {}; }, /measures/],
    [(s) => { s.regions[0].x = 30; }, /outside/],
    [(s) => { s.regions[0].name = 'nose'; }, /nose/],
    [(s) => { s.regions[0].pictures[0].anchors.pop(); }, /anchors of rest/],
    [(s) => { s.regions[0].mask = { inner: [], outer: [] }; }, /mask/],
    [(s) => { s.regions[0].width = s.width = 1e6; }, /large/],
  ]) {
    const damaged = structuredClone(set());
    damage(damaged);
    assert.throws(() => readPictures(damaged), what);
  }
});

/** The first bytes of a picture that says it is so large, of each kind that browsers decode and whose first bytes say it. */
function heads(width, height) {
  const of = (begin, more) => {
    const bytes = Buffer.alloc(64);
    Buffer.from(begin, 'latin1').copy(bytes);
    more(bytes);
    return bytes;
  };
  return {
    png: of('\x89PNG\r\n\x1a\n\0\0\0\rIHDR', (b) => b.writeUInt32BE(width, 16) && b.writeUInt32BE(height, 20)),
    gif: of('GIF89a', (b) => b.writeUInt16LE(width, 6) && b.writeUInt16LE(height, 8)),
    bmp: of('BM', (b) => b.writeUInt32LE(40, 14) && b.writeInt32LE(width, 18) && b.writeInt32LE(height, 22)),
    'bmp from the top': of('BM', (b) => b.writeUInt32LE(40, 14) && b.writeInt32LE(width, 18) && b.writeInt32LE(-height, 22)),
    'bmp of the old kind': of('BM', (b) => b.writeUInt32LE(12, 14) && b.writeUInt16LE(width, 18) && b.writeUInt16LE(height, 20)),
  };
}

test('reads the size of a photograph of any format from its header, before the browser decodes it', async () => {
  for (const [name, bytes] of Object.entries(heads(16000, 15000))) {
    assert.deepEqual(pictureSize(bytes), [16000, 15000], name);
    await assert.rejects(readPicture(new Blob([bytes])), { code: 'too_large' }, name); // Node.js cannot decode images: decoding would fail otherwise
  }
});
