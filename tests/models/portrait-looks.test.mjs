// SPDX-License-Identifier: GPL-3.0-or-later
// What a portrait may look like: hairstyles alone, cut beards, frames, irises, age, tinted light, covered hair; on drawn heads, whose truth
// is known.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { openEye } from '../../models/tools/portrait/eye.mjs';
import { flat, textures } from '../../models/tools/portrait/images.mjs';
import { readModel } from '../../web/element/head/model/model.mjs';
import { ageing, drawLines, linesOf } from '../../web/portrait/age.mjs';
import { beardOfKind, dress } from '../../web/portrait/dress.mjs';
import { FRAMES, glasses } from '../../web/portrait/glasses.mjs';
import { isNatural } from '../../web/portrait/hair.mjs';
import { similarEyes } from '../../web/portrait/iris.mjs';
import { lab, unlab } from '../../web/portrait/lab.mjs';
import { inWhiteLight } from '../../web/portrait/light.mjs';
import { offerOf, wornOf } from '../../web/portrait/offer.mjs';
import { makeHead } from '../../web/portrait/portrait.mjs';
import { coded, linear, toneOf } from '../../web/portrait/skin.mjs';
import { violations } from '../lib/schema.mjs';

const built = fileURLToPath(new URL('../../build/', import.meta.url));
const read = (name) => JSON.parse(fs.readFileSync(path.join(built, name), 'utf8'));
const head = (name) => read(`models/heads/${name}.json`);
const [table, styles] = ['web/face-points.json', 'web/face-wear.json'].map(read);
const views = {};

before(async () => {
  const eye = await openEye();
  for (const name of Object.keys(table)) {
    const picture = await flat(path.join(built, `models/heads/${name}.webp`));
    views[name] = { picture, landmarks: await eye(picture) };
  }
});

const partOf = (json, word) => readModel(json).parts.find(({ name }) => name.startsWith(word));
const repainted = ({ picture, landmarks }, change) => {
  const data = Uint8ClampedArray.from(picture.data);
  for (let i = 0; i < data.length; i += 4) change(data.subarray(i, i + 4), i / 4);
  return { picture: { ...picture, data }, landmarks };
};

test('each hairstyle sits on another skull, and short ones end above long ones', () => {
  const luca = head('luca');
  const lowest = {};
  for (const name of Object.keys(styles)) {
    const dressed = dress(luca, read(`web/wear-${name}.json`), 'hair');
    assert.equal(violations('head-model', dressed), null, name);
    assert.equal(dressed.parts.filter((part) => part.name.startsWith('hair')).length, 1, name);
    const { position } = partOf(dressed, 'hair');
    lowest[name] = position.reduce((least, y, i) => (i % 3 === 1 ? Math.min(least, y) : least), Infinity);
  }
  assert.ok(lowest.shoulder < lowest.bob && lowest.bob < lowest.crop, JSON.stringify(lowest));
});

test('a beard is cut or shortened, and a short one lies nearer to the skin', () => {
  const bruno = head('bruno');
  const skin = partOf(bruno, 'skin').position;
  const far = (json) => {
    const { position } = partOf(json, 'beard');
    let sum = 0;
    for (let i = 0; i < position.length; i += 30) {
      let least = Infinity;
      for (let v = 0; v < skin.length; v += 3) least = Math.min(least, Math.hypot(skin[v] - position[i], skin[v + 1] - position[i + 1], skin[v + 2] - position[i + 2]));
      sum += least;
    }
    return sum;
  };
  assert.ok(far(beardOfKind(bruno, 'short')) < 0.7 * far(bruno));
  const count = (kind) => beardOfKind(bruno, kind).parts.find(({ name }) => name === 'beard').triangles;
  assert.ok(count('moustache') < count('goatee') && count('goatee') < count('full'));
});

test('frames stand before the eyes and the nose of each head, and reach its ears', () => {
  for (const name of Object.keys(table)) {
    const model = readModel(head(name));
    const skin = model.parts.find((part) => part.name === 'skin');
    for (const kind of FRAMES) {
      const { part } = glasses(kind, model.fdp, skin.position, model.turns.slice(-model.headTurns));
      const { data, scale, offset } = part.position;
      const numbers = new Int16Array(Uint8Array.from(atob(data), (c) => c.charCodeAt(0)).buffer);
      const points = Array.from({ length: part.vertices }, (_, v) => [0, 1, 2].map((k) => numbers[3 * v + k] * scale + offset[k]));
      const [pupil, ear] = [model.fdp['3.5'], model.fdp['10.1']];
      const front = points.filter((p) => Math.abs(p[0]) < Math.abs(pupil[0]) + 15 && p[2] > pupil[2] - 20);
      assert.ok(front.every((p) => p[2] > pupil[2] + 3), `${name}, ${kind}: a rim is in the eye`);
      assert.ok(points.some((p) => Math.hypot(p[1] - ear[1], p[2] - ear[2]) < 14), `${name}, ${kind}: no temple at the ear`);
    }
  }
});

test('irises are those of the head that has them; scarves are not taken for hair', () => {
  const dark = ['amina', 'samuel', 'mei'];
  for (const name of dark) assert.ok(dark.includes(similarEyes(views[name], table)[0]), name);
  assert.equal(similarEyes(views.rosa, table)[0], 'rosa');
  const of = (...bytes) => bytes.map((byte) => linear[byte]);
  for (const colour of [of(20, 17, 15), of(90, 60, 40), of(225, 200, 150), of(160, 70, 35), of(235, 235, 238)]) assert.ok(isNatural(colour), String(colour));
  for (const colour of [of(40, 70, 180), of(30, 130, 80), of(200, 40, 140)]) assert.ok(!isNatural(colour), String(colour));
  const { picture, landmarks } = views.mei;
  const covered = repainted(views.mei, (pixel, i) => {
    const hair = lab([0, 1, 2].map((k) => linear[pixel[k]]))[0] < 30 && Math.floor(i / picture.width) < landmarks[10][1] + 40;
    if (hair) pixel.set([40, 70, 180]);
  });
  const offer = offerOf(covered, { ...table, ...styles });
  assert.ok(offer.unsure.includes('covered'), String(offer.unsure));
  assert.equal(offer.first.hair, null, 'it is asked');
  assert.ok(!offer.colour || isNatural(offer.colour));
  assert.ok(!offerOf(views.mei, table).unsure.includes('covered'));
});

test('tinted light is taken out in part, white light is left as it is', () => {
  const far = (a, b) => Math.hypot(...lab(a).map((x, k) => x - lab(b)[k]));
  let white = 0;
  for (const [name, view] of Object.entries(views)) {
    const tone = toneOf(view.picture, view.landmarks);
    if (inWhiteLight(view) === view) white++;
    const lamp = repainted(view, (pixel) => [1.5, 1, 0.55].forEach((x, k) => (pixel[k] = coded(Math.min(1, linear[pixel[k]] * x)))));
    const [as, mended] = [lamp, inWhiteLight(lamp)].map((one) => far(toneOf(one.picture, one.landmarks), tone));
    assert.ok(mended < as, `${name}: ${mended.toFixed(1)} instead of ${as.toFixed(1)}`);
  }
  assert.ok(white >= 6, `${white} of the heads' pictures are lit white`);
});

test('age deepens lines from middle age on, off the scalp, and colours come back out of CIELAB', () => {
  assert.deepEqual([20, 45, null].map(ageing), [0, 0, 0]);
  assert.ok(ageing(60) < ageing(75) && ageing(75) === 1);
  const size = 64;
  const flatSkin = () => ({ width: size, height: size, data: Uint8ClampedArray.from({ length: 4 * size * size }, (_, i) => (i % 4 === 3 ? 255 : 180)) });
  const old = flatSkin();
  for (let x = 0; x < size; x++) old.data.fill(120, 4 * (30 * size + x), 4 * (30 * size + x) + 3);
  const lines = linesOf(old, linear);
  const none = new Float32Array(size * size);
  const drawn = flatSkin();
  drawLines(drawn, lines, { share: 1, shown: none, bald: none.map((_, i) => Number(i % size < 32)) }, { linear, coded });
  const at = (x, y) => drawn.data[4 * (y * size + x)];
  assert.ok(at(50, 30) < 165 && at(50, 50) > 170, `${at(50, 30)}, ${at(50, 50)}`);
  assert.equal(at(10, 30), 180, 'a scalp has none');
  for (const colour of [[0.2, 0.1, 0.05], [0.7, 0.5, 0.4]]) unlab(lab(colour)).forEach((x, k) => assert.ok(Math.abs(x - colour[k]) < 2e-3));
});

test('a portrait wears stubble and frames that were chosen, and stays a valid head', async () => {
  const all = { ...table, ...styles };
  const worn = await wornOf({ hair: 'crop', beard: 'stubble', glasses: 'half' }, 'luca', all, async (name) => (styles[name] ? read(`web/wear-${name}.json`) : head(name)));
  const { head: made } = await makeHead(head('luca'), table.luca, [views.luca], textures, { ...worn, hair: [0.05, 0.03, 0.02], age: 70, old: head('ettore') });
  assert.equal(violations('head-model', made), null);
  assert.deepEqual(['beard', 'glasses', 'hair'].map((word) => made.parts.filter(({ name }) => name.startsWith(word)).length), [0, 1, 1]);
  const { relief } = made.materials[made.parts.find(({ name }) => name === 'skin').material];
  assert.ok(relief > 1, `relief ${relief}`);
});
