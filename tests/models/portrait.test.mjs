// SPDX-License-Identifier: GPL-3.0-or-later
// Heads from pictures: of a person (NASA's public-domain portrait from Debian's python3-skimage), and of our own heads, whose
// landmarks must be recovered; and pictures without a face.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import { createRequire } from 'node:module';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { drawPoster } from '../../models/tools/lib/poster.mjs';
import { openEye } from '../../models/tools/portrait/eye.mjs';
import { flat, textures } from '../../models/tools/portrait/images.mjs';
import { align, upright } from '../../web/portrait/align.mjs';
import { hairOf } from '../../web/portrait/hair.mjs';
import { lab } from '../../web/portrait/lab.mjs';
import { lipLine, partedLips } from '../../web/portrait/fit.mjs';
import { STEADY, withMoved } from '../../web/portrait/landmarks.mjs';
import { toneOf, tonesOf } from '../../web/portrait/skin.mjs';
import { toneOfBoth } from '../../web/portrait/tone.mjs';
import { inOrder, makeHead, nearest } from '../../web/portrait/portrait.mjs';
import { photograph } from '../lib/drawn-photographs.mjs';
import { further } from '../lib/long.mjs';
import { violations } from '../lib/schema.mjs';
import { readModel } from '../../web/element/head/model/model.mjs';

const sharp = createRequire(new URL('../../models/package.json', import.meta.url))('sharp');
const tool = (name) => fileURLToPath(new URL(`../../models/tools/${name}`, import.meta.url));
const built = fileURLToPath(new URL('../../build/', import.meta.url));
const astronaut = '/usr/lib/python3/dist-packages/skimage/data/astronaut.png';
const poster = (name) => path.join(built, 'models/heads', `${name}.webp`);
const table = JSON.parse(fs.readFileSync(path.join(built, 'web/face-points.json'), 'utf8'));
let folder, eye, person;

before(async () => {
  folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-portrait-'));
  eye = await openEye();
  const picture = await flat(astronaut);
  person = { picture, landmarks: await eye(picture) };
});
after(() => fs.rmSync(folder, { recursive: true, force: true }));

const file = (name) => path.join(folder, name);
const height = (p) => Math.hypot(p[10][0] - p[152][0], p[10][1] - p[152][1]);

/** Mean distance of landmarks from others, after alignment, in per cent of the face's height. */
function apart(some, others) {
  const [a, b] = [upright(some), upright(others)];
  const { apply } = align(b, a, STEADY);
  const sum = a.reduce((total, p, i) => total + Math.hypot(...apply(b[i]).slice(0, 2).map((x, k) => x - p[k])), 0);
  return (100 * sum) / a.length / height(some);
}

test('the tool makes a head from a photograph that passes the checks of a head', () => {
  const out = file('person.json');
  const make = (...more) => spawnSync('node', [tool('portrait/make-portrait.mjs'), astronaut, '-o', out, ...more], { encoding: 'utf8' });
  const asked = make();
  assert.deepEqual([asked.status, fs.existsSync(out)], [2, false], 'no head is made with hair that nobody chose');
  assert.match(asked.stderr, /--like HEAD: whose sex, ears and clothes .* There are .*mara.*; nearest in face is \w+\nin the picture: glasses: no, .*most similar hairstyles: \w+, \w+, \w+/);
  for (const [wear, what] of [['hat=mara', /there are hair, beard, glasses/], ['beard=mara', /there are none, stubble, moustache, goatee, short, full/], ['hair=nobody', /there are none, amina/]]) {
    const refused = make('--like', 'mara', '--wear', wear);
    assert.equal(refused.status, 2, refused.stdout);
    assert.match(refused.stderr, what);
  }
  const made = make('--like', 'mara', '--wear', 'seen,hair=mei,glasses=some');
  assert.equal(made.status, 0, made.stderr);
  assert.match(made.stdout, /like mara; .*lips are parted/);
  assert.match(made.stdout, /\nLook at it: nothing of this is known for certain\.\n$/);
  const checked = spawnSync('node', [tool('check-head.mjs'), out], { encoding: 'utf8' });
  assert.equal(checked.status, 0, checked.stdout);
  const head = JSON.parse(fs.readFileSync(out, 'utf8'));
  assert.equal(violations('head-model', head), null);
  assert.equal(head.name, 'person');
  assert.deepEqual(['hair', 'beard', 'glasses'].map((word) => head.parts.filter(({ name }) => name.startsWith(word)).length), [1, 0, 1]);
  assert.notEqual(head.licence, 'CC0-1.0');
  assert.match(head.credits.at(-1), /rights/);
});

test('reports a picture without a portrait with its file, and writes nothing', async () => {
  await sharp({ create: { width: 300, height: 300, channels: 3, background: '#68a' } }).png().toFile(file('sky.png'));
  const failed = spawnSync('node', [tool('portrait/make-portrait.mjs'), file('sky.png'), '-o', file('sky.json')], { encoding: 'utf8' });
  assert.equal(failed.status, 1);
  assert.match(failed.stderr, /sky\.png: there is no face to be found in the picture \(no_face\)/);
  assert.deepEqual(fs.readdirSync(folder).filter((name) => name.startsWith('sky.json')), []);
  for (const [args, what] of [[[], /usage/], [['x.png', '-o', 'X Y.json'], /--name/], [['x.png', '-o', 'x.json', '--like', 'nobody'], /there are .*mara/]]) {
    const refused = spawnSync('node', [tool('portrait/make-portrait.mjs'), ...args], { encoding: 'utf8' });
    assert.equal(refused.status, 2);
    assert.match(refused.stderr, what);
  }
});

test('reports two faces, a broken or truncated file, too many and too few pixels', async () => {
  const whole = fs.readFileSync(astronaut);
  const two = await sharp({ create: { width: 1024, height: 512, channels: 3, background: '#000' } })
    .composite([{ input: whole, left: 0, top: 0 }, { input: whole, left: 512, top: 0 }]).png().toBuffer();
  await assert.rejects(async () => eye(await flat(two)), { code: 'several_faces' });
  await assert.rejects(flat(Buffer.from('GIF89a no picture')), { code: 'no_picture' });
  await assert.rejects(flat(whole.subarray(0, whole.length / 2)), { code: 'no_picture' });
  const huge = await sharp({ create: { width: 11000, height: 10000, channels: 3, background: '#fff' } }).png({ compressionLevel: 1 }).toBuffer();
  await assert.rejects(flat(huge), { code: 'too_large' });
  await assert.rejects(async () => eye(await flat(await sharp(whole).resize(60).png().toBuffer())), { code: 'too_small' });
  await assert.rejects(async () => eye(await flat(await sharp(whole).resize(200).png().toBuffer())), { code: /too_small|no_face/ });
});

test('reads 16 bits, grey, and rotated pictures as the same face', async () => {
  const variants = {
    '16 bits': sharp(astronaut).toColourspace('rgb16').png(),
    grey: sharp(astronaut).greyscale().png(),
    turned: sharp(astronaut).rotate(90).withMetadata({ orientation: 8 }).jpeg({ quality: 95 }),
  };
  for (const [name, image] of Object.entries(variants)) {
    const bytes = await image.toBuffer();
    if (name === '16 bits') assert.equal((await sharp(bytes).metadata()).depth, 'ushort');
    const off = apart(person.landmarks, await eye(await flat(bytes)));
    assert.ok(off < 1, `${name}: ${off.toFixed(2)} %`);
  }
});

test('recognises our own heads: each is closest to itself, and another head with its face has its landmarks', further, async () => {
  const views = {};
  for (const name of ['bruno', 'mara']) {
    const picture = await flat(poster(name));
    views[name] = { picture, landmarks: await eye(picture) };
    assert.equal(nearest(views[name], table).toSorted((a, b) => a.mm - b.mm)[0].name, name);
  }
  assert.ok(partedLips(views.mara.landmarks) < partedLips(person.landmarks) / 1.5, 'closed lips are not taken for parted ones');
  const base = JSON.parse(fs.readFileSync(path.join(built, 'models/heads/mara.json'), 'utf8'));
  const { head, parted } = await makeHead(base, table.mara, [views.bruno], textures);
  assert.equal(parted, false);
  const again = await eye(await flat(await drawPoster(head, false)));
  const [before, now] = [apart(views.bruno.landmarks, views.mara.landmarks), apart(views.bruno.landmarks, again)];
  console.log(`Bruno on Mara: landmarks ${before.toFixed(2)} % of the face's height apart, then ${now.toFixed(2)} %`);
  assert.ok(now < 0.6 * before && now < 1.2, `${now.toFixed(2)} % of ${before.toFixed(2)} %`);
});

test('skin keeps its tone on a base with another: light on dark, dark on light, and a person', async () => {
  for (const [base, name] of [['luca', 'samuel'], ['luca', 'person'], ['amina', 'samuel'], ['samuel', 'person']]) {
    const picture = name === 'person' ? person.picture : await flat(poster(name));
    const landmarks = name === 'person' ? person.landmarks : await eye(picture);
    const json = JSON.parse(fs.readFileSync(path.join(built, `models/heads/${base}.json`), 'utf8'));
    const { head } = await makeHead(json, table[base], [{ picture, landmarks }], textures);
    const drawn = await flat(await drawPoster(head)); // with its shadows, as the table's tone is measured
    const [is, was] = [tonesOf(drawn, await eye(drawn)), tonesOf(picture, landmarks)].map(toneOfBoth);
    const off = is.map((x, k) => Math.log2(x / was[k]));
    console.log(`${name} on ${base}: red, green and blue of the drawn skin are ${off.map((x) => x.toFixed(2))} stops from the picture's`);
    assert.ok(off.every((x) => Math.abs(x) < 0.3), `${name} on ${base}: ${off}`);
  }
});

test('recognises the colour of hair, where there is some, and gives it to a head', async () => {
  const seen = {};
  for (const name of ['ettore', 'samuel', 'luca', 'mara']) {
    const picture = await flat(poster(name));
    seen[name] = hairOf(picture, await eye(picture));
    assert.equal(seen[name].kind, 'hair', name);
  }
  const [grey, black, blond] = ['ettore', 'samuel', 'luca'].map((name) => lab(seen[name].colour));
  assert.ok(grey[0] > 55 && Math.hypot(grey[1], grey[2]) < 20, `grey: ${grey}`);
  assert.ok(black[0] < 20, `black: ${black}`);
  assert.ok(blond[2] > 20 && blond[0] > 40, `blond: ${blond}`);
  const brown = hairOf(person.picture, person.landmarks);
  assert.ok(brown.kind === 'hair' && lab(brown.colour)[2] > 10, `the person's: ${JSON.stringify(brown)}`);

  const base = JSON.parse(fs.readFileSync(path.join(built, 'models/heads/mara.json'), 'utf8'));
  const alphaOf = async (head) => (await textures.read(head.textures.hair)).data.filter((_, i) => i % 4 === 3 && _ > 127).length;
  const made = async (options) => {
    const { head } = await makeHead(base, table.mara, [person], textures, options);
    const picture = await flat(await drawPoster(head, false));
    const landmarks = await eye(picture);
    return { head, hair: hairOf(picture, landmarks), tone: toneOf(picture, landmarks) };
  };
  const dyed = await made({ hair: seen.ettore.colour });
  const off = Math.hypot(...lab(dyed.hair.colour).map((x, k) => x - grey[k]));
  console.log(`Ettore's colour on Mara's hair: ${off.toFixed(1)} CIELAB apart`);
  assert.ok(dyed.hair.kind === 'hair' && off < 20, `${off}`);
  assert.ok(Math.abs((await alphaOf(dyed.head)) / (await alphaOf(base)) - 1) < 0.05, 'strands keep their ends');
  const bald = await made({ hair: 'none', light: -1 });
  assert.equal(bald.hair.kind, 'none');
  assert.ok(bald.head.parts.every(({ name }) => !name.startsWith('hair')));
  const darker = Math.log2(bald.tone[1] / (await made({ hair: 'none' })).tone[1]); // hair would shade the face
  console.log(`a stop darker: ${darker.toFixed(2)} stops`);
  assert.ok(darker < -0.45 && darker > -1.4, `${darker}`); // the sheen of skin stays, and the curve of tones lifts what is dark
});

test('does not paint the teeth of parted lips onto their closing edge', async () => {
  const base = JSON.parse(fs.readFileSync(path.join(built, 'models/heads/luca.json'), 'utf8'));
  const skin = readModel(base).parts.find(({ name }) => name === 'skin');
  const { head } = await makeHead(base, table.luca, [person], textures);
  const { data, width, height } = await textures.read(head.textures[head.materials[head.parts.find(({ name }) => name === 'skin').material].texture]);
  const line = lipLine(table.luca.at);
  const close = [...Array(skin.vertices).keys()].filter((v) => line.some((p) => Math.hypot(...p.map((x, k) => x - skin.position[3 * v + k])) < 2));
  const red = close.map((v) => {
    const at = 4 * (Math.round((1 - skin.uv[2 * v + 1]) * height) * width + Math.round(skin.uv[2 * v] * width));
    return data[at] / data[at + 1]; // white is 1
  }).sort((a, b) => a - b);
  const least = red[Math.floor(red.length / 10)];
  console.log(`within 2 mm of the line of the lips red is ${least.toFixed(2)} times green or more in nine tenths of ${red.length} places`);
  assert.ok(close.length > 40 && least > 1.2, `${least}`);
});

test('removed glasses leave no shadow on the temples', further, async () => {
  const base = JSON.parse(fs.readFileSync(path.join(built, 'models/heads/rosa.json'), 'utf8'));
  const picture = await photograph(path.join(built, 'models/heads'), 'mei', 0, undefined, { width: 480, height: 624 });
  const view = { picture, landmarks: await eye(picture) };
  const { parts } = readModel(base);
  const [skin, glasses] = ['skin', 'glasses'].map((name) => parts.find((part) => part.name.startsWith(name)));
  const far = (v) => {
    let least = Infinity;
    for (let i = 0; i < glasses.position.length; i += 3) least = Math.min(least, Math.hypot(...[0, 1, 2].map((k) => glasses.position[i + k] - skin.position[3 * v + k])));
    return least;
  };
  const temple = [...Array(skin.vertices).keys()].filter((v) => Math.abs(skin.position[3 * v]) > 55 && skin.position[3 * v + 2] > -45 && far(v) < 14);
  assert.ok(temple.length > 20, `${temple.length} vertices`);
  const darkest = async (keep) => {
    const { head } = await makeHead(base, table.rosa, [view], textures, { keep });
    const { data, width, height } = await textures.read(head.textures[head.materials[head.parts.find(({ name }) => name === 'skin').material].texture]);
    const bright = temple.flatMap((v) => [-6, -3, 0, 3, 6].map((dy) => { // texels about it: the shadow is a line
      const [x, y] = [Math.round(skin.uv[2 * v] * width), Math.round((1 - skin.uv[2 * v + 1]) * height) + dy];
      return data[4 * (y * width + x) + 1];
    })).sort((a, b) => a - b);
    return bright[Math.floor(bright.length / 20)] / bright[bright.length >> 1];
  };
  const [with_, without] = [await darkest(['glasses']), await darkest([])];
  console.log(`the darkest twentieth of the temples has ${with_.toFixed(2)} of their brightness with the glasses, ${without.toFixed(2)} without`);
  assert.ok(without > with_ + 0.1 && without > 0.8, `${with_} -> ${without}`);
});

test('sorts pictures, and rejects a side view alone', () => {
  const turn = (points, degrees) => {
    const [c, s] = [Math.cos((degrees * Math.PI) / 180), Math.sin((degrees * Math.PI) / 180)];
    const [mx, , mz] = points[168];
    return points.map(([x, y, z]) => [mx + c * (x - mx) + s * (z - mz), y, mz - s * (x - mx) + c * (z - mz)]);
  };
  const [left, right] = [35, -35].map((degrees) => ({ ...person, landmarks: turn(person.landmarks, degrees) }));
  assert.deepEqual(inOrder([left, person, right], table.mara), [person, left, right]);
  assert.throws(() => inOrder([left], table.mara), { code: 'turned' });
});

test('a moved landmark takes along only its neighbours', () => {
  const [x, y] = person.landmarks[152];
  const moved = withMoved(person.landmarks, new Map([[152, [x + 9, y]]]));
  assert.deepEqual(moved[152].slice(0, 2), [x + 9, y]);
  const near = moved[148][0] - person.landmarks[148][0];
  assert.ok(near > 1 && near < 9, `${near}`);
  assert.deepEqual(moved[10], person.landmarks[10]);
});
