// SPDX-License-Identifier: GPL-3.0-or-later
// Heads of photographs, measured: the skin's distance from the picture's (CIELAB), on cheeks and forehead and of the whole face
// above the mouth, by the picture's ITA class; the landmarks' from the picture's before and after (per cent of the face's
// height); the detector's own age and sex before and after, by decade; and what was recognised. Draws each photograph beside its head, without
// names. The photographs lie in a folder of one's own with people.json: of each file the base head, whose skin must not matter,
// how old the person is, what it shows and what a person would choose for it: {"a.jpg": {"like": "ettore", "age": 61, "shows": {"beard": true,
// "bald": null}, "wears": {"hair": "ring", "beard": "short", "glasses": "none"}}}; null: not judged. Without wears, what is worn is the first
// proposal (web/portrait/offer.mjs), as if its user changed nothing; asked whether they are bald or have long hair, they answer.
// FACCIA_BUILD=build node tests/bench/run.mjs portraits FOLDER OUT.png [FILE...]
import fs from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { drawPoster } from '../../models/tools/lib/poster.mjs';
import { openEye } from '../../models/tools/portrait/eye.mjs';
import { flat, textures } from '../../models/tools/portrait/images.mjs';
import { align, upright } from '../../web/portrait/align.mjs';
import { detectorSettings, piece } from '../../web/portrait/detect.mjs';
import { lab } from '../../web/portrait/lab.mjs';
import { STEADY } from '../../web/portrait/landmarks.mjs';
import { isLong, offerOf, OLDEST, wornOf } from '../../web/portrait/offer.mjs';
import { makeHead } from '../../web/portrait/portrait.mjs';
import { PortraitError } from '../../web/portrait/problem.mjs';
import { toneOf, wholeFace } from '../../web/portrait/skin.mjs';
import { heads } from '../lib/built-heads.mjs';
import { root } from '../lib/daemon.mjs';

const [folder, out, ...only] = process.argv.slice(2);
if (!out) throw new Error('usage: run.mjs portraits FOLDER OUT.png [FILE...]');
const sharp = createRequire(path.join(root, 'models/package.json'))('sharp');
const web = path.join(process.env.FACCIA_BUILD ?? path.join(root, 'build'), 'web');
const table = JSON.parse(fs.readFileSync(path.join(web, 'face-points.json'), 'utf8'));
const styles = JSON.parse(fs.readFileSync(path.join(web, 'face-wear.json'), 'utf8'));
const all = { ...table, ...styles };
const people = Object.entries(JSON.parse(fs.readFileSync(path.join(folder, 'people.json'), 'utf8'))).filter(([file]) => !only.length || only.includes(file));
const SIZE = [300, 360];
const eye = await openEye();
const judge = await openJudge();

/** The detector's net of ages and sexes, which faccia does not use. @returns {Promise<(picture: object, landmarks: number[][]) => Promise<{age: number, gender: string}>>} */
async function openJudge() {
  const packages = new URL('../../web/node_modules/', import.meta.url);
  const at = (name) => new URL(name, packages).href;
  const { Human } = createRequire(new URL('../package.json', packages))(fileURLToPath(at('@vladmandic/human/dist/human.node-wasm.js')));
  const settings = detectorSettings(at('@vladmandic/human/models/'), at('@tensorflow/tfjs-backend-wasm/dist/'));
  settings.face.description = { enabled: true };
  const human = new Human(settings);
  await human.load();
  return async (picture, landmarks) => {
    const tall = 3 * Math.hypot(landmarks[10][0] - landmarks[152][0], landmarks[10][1] - landmarks[152][1]);
    const [x, y] = [0, 1].map((k) => (landmarks[10][k] + landmarks[152][k] - tall) / 2);
    const { data, width, height } = piece(picture, { x, y, size: [tall, tall] }, 640);
    const tensor = human.tf.tensor3d(data, [height, width, 3], 'int32');
    const { face } = await human.detect(tensor);
    human.tf.dispose(tensor);
    return { age: face[0]?.age ?? NaN, gender: face[0]?.gender ?? '' };
  };
}

/** Mean distance of landmarks after alignment, in per cent of the face's height. */
function apart(some, others) {
  const [a, b] = [upright(some), upright(others)];
  const { apply } = align(b, a, STEADY);
  const sum = a.reduce((total, p, i) => total + Math.hypot(...apply(b[i]).slice(0, 2).map((x, k) => x - p[k])), 0);
  return (100 * sum) / a.length / Math.hypot(some[10][0] - some[152][0], some[10][1] - some[152][1]);
}

/** The head in a picture, as large as in a poster. */
async function cropped(file, landmarks, { width, height }) {
  const [top, chin] = [landmarks[10], landmarks[152]];
  const tall = Math.hypot(top[0] - chin[0], top[1] - chin[1]) * 2;
  const [x, y] = [(top[0] + chin[0]) / 2, (top[1] + chin[1]) / 2 - 0.05 * tall];
  const box = { left: Math.max(0, Math.round(x - (tall * SIZE[0]) / SIZE[1] / 2)), top: Math.max(0, Math.round(y - tall / 2)) };
  const [w, h] = [Math.min(width - box.left, Math.round((tall * SIZE[0]) / SIZE[1])), Math.min(height - box.top, Math.round(tall))];
  return sharp(file).rotate().extract({ ...box, width: w, height: h }).resize(...SIZE, { fit: 'contain', background: '#c8ccd0' }).png().toBuffer();
}

const json = (name) => JSON.parse(fs.readFileSync(Object.hasOwn(styles, name) ? path.join(web, `wear-${name}.json`) : path.join(heads, `${name}.json`), 'utf8'));

/** The class of a skin by its individual typology angle (Chardon et al. 1991). */
function classOf(tone) {
  const [l, , b] = lab(tone);
  const angle = (Math.atan2(l - 50, b) * 180) / Math.PI;
  const at = [55, 41, 28, 10, -30].findIndex((least) => angle > least);
  return ['very light', 'light', 'intermediate', 'tan', 'brown', 'dark'][at < 0 ? 5 : at];
}
const decadeOf = (age) => (age === undefined ? '' : `${Math.floor(age / 10) * 10} to ${Math.floor(age / 10) * 10 + 9} years`);
const before = {};
for (const like of new Set(people.map(([, one]) => one.like))) {
  const picture = await flat(path.join(heads, `${like}.webp`));
  const landmarks = await eye(picture);
  before[like] = { picture, landmarks, seen: await judge(picture, landmarks) };
}

console.log('| photograph | group | base | ITA | skin, ΔE of the base | of the head | face, ΔE of the base | of the head | landmarks before, % | after, % | age of the photograph | of the base | of the head | proposed | not sure |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|');
const proposals = {};
/** Counts what was proposed as its user would choose. */
function count(what, first, { styles: best }, wears) {
  const sum = (proposals[what] ??= [0, 0, 0]);
  sum[0] += Number(first[what] === wears[what]);
  sum[1] += Number(what !== 'hair' || [...best, 'none'].includes(wears[what]));
  sum[2]++;
}
const rows = [];
const tiles = [];
const answers = {};
for (const [name, { like, group = '', age = null, shows = {}, wears = null }] of people) {
  const file = path.join(folder, name);
  const number = tiles.length / 2 + 1;
  try {
    const picture = await flat(file);
    const landmarks = await eye(picture);
    const offer = offerOf({ picture, landmarks }, all);
    for (const [trait, is] of Object.entries(shows)) {
      if (is === null) continue;
      answers[trait] ??= { true: { yes: 0, unsure: 0, no: 0 }, false: { yes: 0, unsure: 0, no: 0 } };
      answers[trait][is][offer.traits[trait]]++;
    }
    const { first } = offer;
    const isWanted = (name) => shows.long === null || shows.long === undefined || isLong(all[name]) === shows.long;
    const hairLike = first.hair ?? (shows.bald ? 'none' : (offer.styles.find(isWanted) ?? offer.styles[0])); // what is asked is answered
    const choice = { ...first, hair: hairLike, ...wears };
    const worn = await wornOf(choice, like, all, async (from) => json(from));
    const own = json(like);
    const { head } = await makeHead(own, table[like], [{ picture, landmarks }], textures, {
      hair: choice.hair === 'none' ? 'none' : offer.colour, brows: offer.brows, beard: offer.beard, ...worn,
      eyes: json(offer.eyes), age, old: json(OLDEST[own.voice.gender]),
    });
    const poster = await drawPoster(head);
    const drawn = await flat(poster);
    const found = await eye(drawn);
    const far = (a, b) => Math.hypot(...lab(a).map((x, k) => x - lab(b)[k]));
    const [tone, face] = [toneOf, wholeFace].map((measure) => measure(picture, landmarks));
    const [seen, seenBefore, seenAfter] = [await judge(picture, landmarks), before[like].seen, await judge(drawn, found)];
    if (wears) for (const what of ['hair', 'beard', 'glasses']) count(what, first, offer, wears);
    const one = {
      group, ita: classOf(tone), decade: decadeOf(age ?? undefined), skinBefore: far(toneOf(before[like].picture, before[like].landmarks), tone),
      faceBefore: far(wholeFace(before[like].picture, before[like].landmarks), face), face: far(wholeFace(drawn, found), face), real: age, sex: seen.gender, sexBefore: seenBefore.gender, sexAfter: seenAfter.gender,
      skin: far(toneOf(drawn, found), tone), before: apart(landmarks, before[like].landmarks), after: apart(landmarks, found),
      age: seen.age, ageBefore: seenBefore.age, ageAfter: seenAfter.age,
    };
    rows.push(one);
    const text = [one.skinBefore, one.skin, one.faceBefore, one.face].map((x) => x.toFixed(1)).concat([one.before, one.after].map((x) => x.toFixed(2)), [one.age, one.ageBefore, one.ageAfter].map((x) => x.toFixed(0)));
    console.log(`| ${number} | ${group} | ${like} | ${one.ita} | ${text.join(' | ')} | ${first.hair ?? 'asked'} (${offer.styles.join(' ')}), ${first.beard} beard, ${first.glasses} glasses | ${offer.unsure.join(', ')} |`);
    const right = await sharp(poster).flatten({ background: '#c8ccd0' }).resize(...SIZE, { fit: 'contain', background: '#c8ccd0' }).png().toBuffer();
    tiles.push(await cropped(file, landmarks, picture), right);
  } catch (error) {
    if (!(error instanceof PortraitError)) throw error;
    console.log(`| ${group}, refused: ${error.code} |`);
  }
}

const mean = (list) => list.reduce((sum, x) => sum + x, 0) / list.length;
for (const key of ['group', 'ita', 'decade']) for (const group of [...new Set(rows.map((one) => one[key])), ...(key === 'group' ? ['all'] : [])].toSorted()) {
  const some = rows.filter((one) => group === 'all' || one[key] === group);
  const of = (name, digits = 1) => mean(some.map((one) => one[name])).toFixed(digits);
  const years = (name) => mean(some.filter((one) => one[name] >= 0).map((one) => Math.abs(one[name] - one.age))).toFixed(1);
  const same = (name) => some.filter((one) => one[name] === one.sex).length;
  console.log(`${group || 'without'}: ${some.length}; skin ΔE ${of('skinBefore')}, then ${of('skin')} (at most ${Math.max(...some.map(({ skin }) => skin)).toFixed(1)}); face ΔE ${of('faceBefore')}, then ${of('face')}; landmarks ${of('before', 2)} %, then ${of('after', 2)} %; age: photograph ${of('age')}, base ${of('ageBefore')}, head ${of('ageAfter')}; off by ${years('ageBefore')} years, then ${years('ageAfter')}; sex as of the photograph ${same('sexBefore')}, then ${same('sexAfter')}`);
}
for (const [what, [right, offered, of]] of Object.entries(proposals)) console.log(`${what}: proposed first as chosen ${right} of ${of}${what === 'hair' ? `, among the best three or none ${offered}` : ''}`);
for (const [trait, { true: shown, false: not }] of Object.entries(answers))
  console.log(`${trait}, yes, unsure, no: with it ${Object.values(shown).join(', ')}; without ${Object.values(not).join(', ')}`);
const wide = 8;
await sharp({ create: { width: wide * SIZE[0], height: Math.ceil(tiles.length / wide) * SIZE[1], channels: 3, background: '#c8ccd0' } })
  .composite(tiles.map((input, i) => ({ input, left: (i % wide) * SIZE[0], top: Math.floor(i / wide) * SIZE[1] }))).png().toFile(out);
