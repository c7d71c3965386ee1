// SPDX-License-Identifier: GPL-3.0-or-later
// What is seen in the mouth: for each sound of each language, and for the emotions that open it, the opening between the lips and the
// shares of upper teeth, lower teeth, tongue and dark in it, counted in pictures with each part in one flat colour.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { PNG } from 'pngjs';
import { launch } from '../lib/browser.mjs';
import { artefacts } from '../lib/daemon.mjs';
import { headPage } from '../lib/head-page.mjs';
import { expressionPose, LANGUAGES, soundPoses } from '../lib/mouth-poses.mjs';

const root = fileURLToPath(new URL('../../', import.meta.url));
const models = path.join(process.env.FACCIA_MODELS ?? path.join(root, 'build/models'), 'heads');
const COLOURS = { skin: [0, 0, 255], teeth_upper: [255, 255, 0], teeth_lower: [0, 255, 0], tongue: [255, 0, 0], mouth: [0, 0, 0] };
const [WIDTH, HEIGHT] = [360, 260];
const SPAN = 65; // mm that the picture is wide

let browser, page, head;
before(async () => {
  browser = await launch();
  page = await headPage(browser);
  head = JSON.parse(fs.readFileSync(path.join(models, 'mara.json')));
  await page.load('flat', head, Object.entries(COLOURS).map(([name, colour]) => [name, ...colour]));
  await page.load('drawn', head);
});
after(async () => {
  await browser?.close();
});

const camera = (yaw = 0) => ({
  yaw, target: [0, head.fdp['2.2'][1] - 4, head.fdp['2.2'][2]], distance: 600, fov: (2 * Math.atan((SPAN * HEIGHT) / WIDTH / 2 / 600) * 180) / Math.PI,
  width: WIDTH, height: HEIGHT, level: 'fine',
});

/** mm² of the opening, and what of it is upper teeth, lower teeth, tongue and dark; how wide and high it is, mm. */
async function seen(name, faps, yaw) {
  const png = PNG.sync.read(await page.shot('flat', faps, camera(yaw)));
  const parts = Object.keys(COLOURS);
  const count = Object.fromEntries(parts.map((part) => [part, 0]));
  const box = { left: WIDTH, right: -1, top: HEIGHT, bottom: -1 };
  for (let i = 0; i < png.data.length; i += 4) {
    if (!png.data[i + 3]) continue;
    const part = parts.find((one) => COLOURS[one].every((x, k) => Math.abs(x - png.data[i + k]) < 40));
    if (!part) continue;
    count[part]++;
    if (part === 'skin') continue;
    const [x, y] = [(i / 4) % png.width, Math.floor(i / 4 / png.width)];
    Object.assign(box, { left: Math.min(box.left, x), right: Math.max(box.right, x), top: Math.min(box.top, y), bottom: Math.max(box.bottom, y) });
  }
  fs.mkdirSync(artefacts, { recursive: true });
  fs.writeFileSync(path.join(artefacts, `mouth-${name}.png`), PNG.sync.write(png));
  const mm = SPAN / png.width;
  const all = count.teeth_upper + count.teeth_lower + count.tongue + count.mouth;
  const share = (n) => (all ? n / all : 0);
  return {
    area: all * mm * mm, width: Math.max(0, box.right - box.left + 1) * mm, height: Math.max(0, box.bottom - box.top + 1) * mm,
    upper: share(count.teeth_upper), lower: share(count.teeth_lower), tongue: share(count.tongue), dark: share(count.mouth),
  };
}

// [what, least, most]: shares of the opening; area in mm², height and width in mm.
const TABLE = [
  { of: ['p', 'b', 'm'], why: 'the lips are closed: nothing is seen between them', must: [['area', 0, 2]] },
  { of: ['f', 'v'], why: 'the lower lip is at the edge of the upper incisors, which show above it, and nothing else does',
    must: [['area', 5, 130], ['upper', 0.8, 1], ['lower', 0, 0.02]] },
  { of: ['s', 'ʃ', 'tʃ'], why: 'air goes between edges that are near each other: teeth, and hardly anything behind them',
    must: [['area', 5, 200], ['upper', 0.4, 1], ['dark', 0, 0.25]] },
  { of: ['i'], why: 'spread lips with the jaw high: mostly upper teeth', must: [['area', 40, 300], ['upper', 0.45, 1], ['dark', 0, 0.2]] },
  { of: ['e'], why: 'as /i/, wider open: upper teeth over the tongue', must: [['upper', 0.3, 0.9], ['tongue', 0.05, 0.6]] },
  { of: ['a'], why: 'the edge of the upper teeth under the upper lip, the tongue flat in the floor, the lower teeth behind the lip or just seen',
    must: [['area', 120, 700], ['upper', 0.2, 0.75], ['tongue', 0.15, 0.75], ['lower', 0, 0.12]] },
  { of: ['u', 'o'], why: 'pushed lips hide the teeth: less than half of a small opening', must: [['upper', 0, 0.46], ['lower', 0, 0.05]] },
  { of: ['l', 'n', 't'], why: 'the tip of the tongue is behind the upper incisors: seen under them as far as the lips are open',
    must: [['upper', 0.3, 1], ['dark', 0, 0.25]] },
  { of: ['θ'], why: 'the tip of the tongue is between the teeth', must: [['tongue', 0.04, 0.6], ['upper', 0.3, 0.95]] },
];

const measured = {};
for (const lang of Object.keys(LANGUAGES))
  test(`${lang}: each sound shows of teeth and tongue what a lip reader looks for`, async () => {
    const poses = soundPoses(lang);
    const wrong = [];
    for (const [ipa, faps] of Object.entries(poses)) {
      const found = (measured[`${lang} ${ipa}`] = await seen(`${lang}-${ipa}`, faps));
      for (const { of, why, must } of TABLE)
        if (of.includes(ipa))
          for (const [what, least, most] of must)
            if (!(found[what] >= least && found[what] <= most))
              wrong.push(`/${ipa}/: ${what} ${found[what].toFixed(2)}, not ${least} to ${most}: ${why}`);
    }
    write();
    assert.deepEqual(wrong, []);
  });

test('Italian /a/, /u/ and /i/ are told apart by the outline of the opening, /l/ shows the tongue', () => {
  const [a, u, i, l] = ['a', 'u', 'i', 'l'].map((ipa) => measured[`it ${ipa}`]);
  assert.ok(u.width < 0.8 * a.width, `/u/ ${u.width.toFixed(1)} mm wide, /a/ ${a.width.toFixed(1)}`);
  assert.ok(u.area < 0.35 * a.area, `/u/ ${u.area.toFixed(0)} mm², /a/ ${a.area.toFixed(0)}`);
  assert.ok(i.width / i.height > 1.5 * (a.width / a.height), '/i/ is a slit beside /a/');
  assert.ok(l.tongue > 0.08, `/l/: ${l.tongue.toFixed(2)} of the opening is tongue`);
});

test('joy shows the upper incisors, fear and surprise what opens', async () => {
  const [joy, fear, surprise] = await Promise.all(
    ['joy', 'fear', 'surprise'].map(async (name) => (measured[name] = await seen(name, expressionPose(`${name}=1`)))),
  );
  write();
  // In a full smile the upper incisors are seen as good as whole, the lower ones hardly.
  assert.ok(joy.upper > 0.6 && joy.lower < 0.12 && joy.area > 120, JSON.stringify(joy));
  // Fear draws the mouth wide: both edges may be seen, in a slit.
  assert.ok(fear.width > 2.5 * fear.height && fear.upper + fear.lower > 0.4, JSON.stringify(fear));
  // Surprise lets the jaw fall: an opening as high as it can be, the upper edge under the lip, no fangs at the sides.
  assert.ok(surprise.height > 9 && surprise.upper < 0.6 && surprise.lower < 0.15, JSON.stringify(surprise));
});

test('seen from the side the sounds still show their teeth', async () => {
  const poses = soundPoses('it');
  for (const yaw of [-0.5, 0.5])
    for (const ipa of ['a', 'i', 'f']) {
      const found = await seen(`it-${ipa}-${yaw}`, poses[ipa], yaw);
      assert.ok(found.upper > 0.2, `/${ipa}/ from ${yaw} rad: ${JSON.stringify(found)}`);
      assert.ok(found.dark < 0.45, `/${ipa}/ from ${yaw} rad: ${JSON.stringify(found)}`);
    }
});

/** Mean difference of two drawn mouths, 0 to 255. */
async function difference(one, other, level) {
  const pictures = [];
  for (const faps of [one, other]) pictures.push(PNG.sync.read(await page.shot('drawn', faps, { ...camera(), level })));
  let sum = 0;
  for (let i = 0; i < pictures[0].data.length; i++) sum += Math.abs(pictures[0].data[i] - pictures[1].data[i]);
  return (sum / pictures[0].data.length) * (4 / 3);
}

test('what lips tell apart differs in the picture, in low quality, too', async () => {
  const poses = soundPoses('it');
  for (const level of ['high', 'low'])
    for (const [x, y, least] of [['p', 'f', 2.5], ['a', 'u', 6], ['i', 'u', 4], ['f', 's', 1.5]]) {
      const d = await difference(poses[x], poses[y], level);
      assert.ok(d > least, `${level}: /${x}/ and /${y}/ differ by ${d.toFixed(2)} of 255`);
    }
  // Lips that press are thinner and rolled in: not the picture of a mouth at rest.
  const d = await difference(poses.p, [], 'high');
  assert.ok(d > 1, `/p/ differs from rest by ${d.toFixed(2)} of 255`);
});

test('the inside of the mouth is never a black hole and never as bright as the skin', async () => {
  const poses = soundPoses('it');
  const light = (png, i) => 0.2126 * png.data[i] + 0.7152 * png.data[i + 1] + 0.0722 * png.data[i + 2];
  for (const [level, ...views] of [['high', ['a', 0], ['o', 0], ['l', 0], ['a', 0.5], ['l', -0.5]], ['low', ['a', 0], ['l', 0]]])
    for (const [ipa, yaw] of views) {
      const shot = { ...camera(yaw), level: level === 'high' ? 'fine' : level };
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

/** The table of what was seen, for people. */
function write() {
  const percent = (x) => `${Math.round(100 * x)} %`;
  const rows = Object.entries(measured).map(
    ([name, m]) => `| ${name} | ${m.area.toFixed(0)} | ${m.width.toFixed(0)} x ${m.height.toFixed(0)} | ${percent(m.upper)} | ${percent(m.lower)} | ${percent(m.tongue)} | ${percent(m.dark)} |`,
  );
  fs.writeFileSync(path.join(artefacts, 'mouth.md'), ['| | mm² | mm | upper teeth | lower teeth | tongue | dark |', '|---|---|---|---|---|---|---|', ...rows, ''].join('\n'));
}
