// SPDX-License-Identifier: GPL-3.0-or-later
// Visibility in the mouth: for each sound of each language, and for emotions that open it, the opening between the lips and its shares of
// upper teeth, lower teeth, tongue and darkness, counted in pictures with flat colours per part.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { PNG } from 'pngjs';
import { launch } from '../../lib/browser.mjs';
import { heads as models } from '../../lib/built-heads.mjs';
import { artefacts } from '../../lib/daemon.mjs';
import { headPage } from '../../lib/head-page.mjs';
import { expressionPose, LANGUAGES, soundPoses } from '../../lib/mouth-poses.mjs';
import { heading, misses, mouthCamera, paint, row, seen, seenIn } from '../../lib/mouth-seen.mjs';

const EMOTIONS = ['joy', 'fear', 'surprise'];
let browser, page, head;
before(async () => {
  browser = await launch();
  page = await headPage(browser);
  head = JSON.parse(fs.readFileSync(path.join(models, 'mara.json')));
  await page.load('flat', head, paint);
  await page.load('drawn', head);
});
after(async () => {
  await browser?.close();
});

const sounds = {}; // by language
const posesOf = (lang) => (sounds[lang] ??= soundPoses(lang));
const seenOf = (name, faps, yaw) => seen(page, 'flat', head, name, faps, yaw);

const measured = {};
for (const lang of Object.keys(LANGUAGES))
  test(`${lang}: each sound shows as much of teeth and tongue as a lip reader expects`, async () => {
    const poses = posesOf(lang);
    const wrong = [];
    for (const [ipa, faps] of Object.entries(poses)) {
      const found = (measured[`${lang} ${ipa}`] = await seenOf(`${lang}-${ipa}`, faps));
      wrong.push(...misses(ipa, found, head.mouth));
    }
    write();
    assert.deepEqual(wrong, []);
  });

test('Italian /a/, /u/ and /i/ differ in the outline of the opening, and /l/ shows the tongue', () => {
  const [a, u, i, l] = ['a', 'u', 'i', 'l'].map((ipa) => measured[`it ${ipa}`]);
  assert.ok(u.width < 0.8 * a.width, `/u/ ${u.width.toFixed(1)} mm wide, /a/ ${a.width.toFixed(1)}`);
  assert.ok(u.area < 0.35 * a.area, `/u/ ${u.area.toFixed(0)} mm², /a/ ${a.area.toFixed(0)}`);
  assert.ok(i.width / i.height > 1.5 * (a.width / a.height), '/i/ is a slit beside /a/');
  assert.ok(l.tongue > 0.08, `/l/: ${l.tongue.toFixed(2)} of the opening is tongue`);
});

test('joy, fear and surprise show the expected share of teeth and tongue', async () => {
  const wrong = [];
  for (const name of EMOTIONS) {
    measured[name] = await seenOf(name, expressionPose(`${name}=1`));
    wrong.push(...misses(name, measured[name], head.mouth));
  }
  write();
  assert.deepEqual(wrong, []);
});

/** The other heads; expectations depend on their age (models/README.md). */
const OTHERS = fs.readdirSync(models).filter((file) => file.endsWith('.json') && file !== 'mara.json').map((file) => file.slice(0, -5));
for (const name of OTHERS)
  test(`${name}: sounds and emotions show the expected share of teeth and tongue in every language`, async () => {
    const other = JSON.parse(fs.readFileSync(path.join(models, `${name}.json`)));
    await page.load(name, other, paint);
    const said = Object.keys(LANGUAGES).flatMap((lang) => Object.entries(posesOf(lang)).map(([ipa, faps]) => ({ lang, what: ipa, faps })));
    const felt = EMOTIONS.map((what) => ({ lang: 'any', what, faps: expressionPose(`${what}=1`) }));
    const faces = [...said, ...felt];
    const found = await seenIn(page, name, other, faces.map(({ faps }) => faps));
    const wrong = faces.flatMap(({ lang, what }, i) => misses(what, found[i], other.mouth).map((miss) => `${lang} ${miss}`));
    assert.deepEqual(wrong, []);
  });

test('the sounds show their teeth in a side view', async () => {
  const poses = posesOf('it');
  for (const yaw of [-0.5, 0.5])
    for (const ipa of ['a', 'i', 'f']) {
      const found = await seenOf(`it-${ipa}-${yaw}`, poses[ipa], yaw);
      assert.ok(found.upper > 0.2, `/${ipa}/ from ${yaw} rad: ${JSON.stringify(found)}`);
      assert.ok(found.dark < 0.45, `/${ipa}/ from ${yaw} rad: ${JSON.stringify(found)}`);
    }
});

/** Mean difference of two drawn mouths, 0 to 255. */
async function difference(one, other, level) {
  const pictures = [];
  for (const faps of [one, other]) pictures.push(PNG.sync.read(await page.shot('drawn', faps, { ...mouthCamera(head), level })));
  let sum = 0;
  for (let i = 0; i < pictures[0].data.length; i++) sum += Math.abs(pictures[0].data[i] - pictures[1].data[i]);
  return (sum / pictures[0].data.length) * (4 / 3);
}

test('visemes differ in the picture in low quality too', async () => {
  const poses = posesOf('it');
  for (const level of ['high', 'low'])
    for (const [x, y, least] of [['p', 'f', 2.5], ['a', 'u', 6], ['i', 'u', 4], ['f', 's', 1.5]]) {
      const d = await difference(poses[x], poses[y], level);
      assert.ok(d > least, `${level}: /${x}/ and /${y}/ differ by ${d.toFixed(2)} of 255`);
    }
  // Pressed lips are thinner and rolled in, so the picture differs from a mouth at rest.
  const d = await difference(poses.p, [], 'high');
  assert.ok(d > 1, `/p/ differs from rest by ${d.toFixed(2)} of 255`);
});

test('the inside of the mouth is neither a black hole nor as bright as the skin', async () => {
  const poses = posesOf('it');
  const light = (png, i) => 0.2126 * png.data[i] + 0.7152 * png.data[i + 1] + 0.0722 * png.data[i + 2];
  for (const [level, ...views] of [['high', ['a', 0], ['o', 0], ['l', 0], ['a', 0.5], ['l', -0.5]], ['low', ['a', 0], ['l', 0]]])
    for (const [ipa, yaw] of views) {
      const shot = { ...mouthCamera(head, yaw), level: level === 'high' ? 'fine' : level };
      const [flat, drawn] = [PNG.sync.read(await page.shot('flat', poses[ipa], shot)), PNG.sync.read(await page.shot('drawn', poses[ipa], shot))];
      let [black, inside, brightest] = [0, 0, 0];
      const skin = [];
      for (let i = 0; i < flat.data.length; i += 4) {
        if (flat.data[i + 2] > 200) skin.push(light(drawn, i));
        else if (flat.data[i + 3] && flat.data[i + 1] < 60) {
          inside++; // tongue and dark
          if (light(drawn, i) < 14) black++;
          brightest = Math.max(brightest, light(drawn, i));
        }
      }
      const usual = skin.sort((a, b) => a - b)[skin.length >> 1];
      assert.ok(black < 0.1 * inside, `${level} /${ipa}/: ${black} of ${inside} points are black`);
      assert.ok(brightest < usual * 1.15, `${level} /${ipa}/: ${brightest.toFixed(0)} inside, skin ${usual.toFixed(0)}`);
    }
  assert.deepEqual(page.page.problems, []);
});

/** Writes the results as a Markdown table. */
const write = () => fs.writeFileSync(path.join(artefacts, 'mouth.md'), [heading, ...Object.entries(measured).map(([name, m]) => row(name, m)), ''].join('\n'));
