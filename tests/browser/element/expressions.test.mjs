// SPDX-License-Identifier: GPL-3.0-or-later
// Contact sheets of the head in the artefacts: the six basic emotions at three intensities, all affects, and gestures of the other
// kinds. The test checks that the six differ from each other and from a face at rest in pixels.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { PNG } from 'pngjs';
import { launch, openPage, picture } from '../../lib/browser.mjs';
import { artefacts, build, Daemon, root } from '../../lib/daemon.mjs';
import { parseFap } from '../../lib/fapfile.mjs';
import { label, reduce } from '../../lib/sheet.mjs';

const faccia = (...args) => execFileSync(path.join(build, 'server/cli/faccia'), ['expressions', ...args]).toString();
const all = JSON.parse(faccia('--json')).expressions;
const affects = all.filter((e) => e.kind === 'affect').map((e) => e.name);
const basics = all.filter((e) => e.basic).map((e) => e.name);

let daemon, browser, page;
before(async () => {
  daemon = await Daemon.start();
  browser = await launch();
  page = await openPage(browser, daemon.url, { quality: 'high' });
  await page.setViewportSize({ width: 560, height: 560 }); // small, because there are about a hundred pictures
});
after(async () => {
  await browser?.close();
  assert.equal((await daemon.stop()).code, 0);
});

const pictures = new Map();
/** Takes a picture of the head with an expression; '' = at rest. */
async function look(what) {
  if (!pictures.has(what)) {
    const values = what ? parseFap(faccia('--fap', what)).frames[0] : Array(69).fill(0);
    pictures.set(what, await picture(page, `expression-${what.replace(/[:=]/g, '-') || 'rest'}`, values));
  }
  return pictures.get(what);
}

/** Crops the head from a picture, at half size. */
function head(png) {
  const side = Math.min(png.width, png.height);
  const cut = new PNG({ width: side, height: side });
  PNG.bitblt(png, cut, Math.round((png.width - side) / 2), Math.round((png.height - side) / 2), side, side, 0, 0);
  return reduce(cut, Math.max(1, Math.floor(side / 220)));
}

async function sheet(name, wishes, columns) {
  const tiles = [];
  for (const what of wishes) tiles.push(label(head(await look(what)), what || 'rest'));
  const { width, height } = tiles[0];
  const out = new PNG({ width: width * columns, height: height * Math.ceil(tiles.length / columns) });
  tiles.forEach((tile, i) => PNG.bitblt(tile, out, 0, 0, width, height, (i % columns) * width, Math.floor(i / columns) * height));
  fs.writeFileSync(path.join(artefacts, `${name}.png`), PNG.sync.write(out));
}

/** Mean difference of two pictures in the face, 0 to 255. */
function distance(a, b) {
  const [one, other] = [head(a), head(b)];
  let sum = 0;
  for (let i = 0; i < one.data.length; i++) sum += Math.abs(one.data[i] - other.data[i]);
  return (sum / one.data.length) * (4 / 3); // the fourth channel is opacity
}

test('a classifier distinguishes the six basic emotions from rest, from each other, and by intensity', async () => {
  assert.deepEqual([...basics].sort(), ['anger', 'disgust', 'fear', 'joy', 'sadness', 'surprise']);
  await sheet('expressions-basic', basics.flatMap((name) => [0.33, 0.66, 1].map((i) => `${name}=${i}`)), 3);
  const rest = await look('');
  for (const [i, name] of basics.entries()) {
    const whole = await look(`${name}=1`);
    const d = distance(rest, whole);
    const part = distance(rest, await look(`${name}=0.33`));
    assert.ok(d > 2, `${name} differs from rest by ${d.toFixed(2)} of 255`);
    assert.ok(part > 0.2 * d && part < 0.8 * d, `${name} at a third: ${part.toFixed(2)} of ${d.toFixed(2)}`);
    for (const other of basics.slice(i + 1)) {
      const between = distance(whole, await look(`${other}=1`));
      assert.ok(between > 2, `${name} and ${other} differ by ${between.toFixed(2)} of 255`);
    }
  }
});

test('no two affects look alike', async () => {
  assert.deepEqual([...affects].sort(), Object.keys(JSON.parse(fs.readFileSync(path.join(root, 'models/expressions.json'), 'utf8')).affect).sort());
  await sheet('expressions-affects', affects, 6);
  for (const [i, name] of affects.entries())
    for (const other of ['', ...affects.slice(i + 1)]) {
      const d = distance(await look(name), await look(other));
      assert.ok(d > 0.5, `${name} and ${other || 'rest'} differ by ${d.toFixed(2)} of 255`);
    }
});

test('every other kind of gesture moves the face', async () => {
  const others = ['performative:greet', 'performative:refuse', 'performative:warn', 'performative:question', 'certainty:uncertain', 'meta-cognitive:thinking',
    'belief-relation:contrast', 'turn:give', 'emphasis:strong', 'pitch-accent:lstar', 'boundary:hh', 'deictic:left', 'adjectival:small', 'adjectival:big'];
  await sheet('expressions-gestures', others, 7);
  const rest = await look('');
  for (const what of others) {
    const d = distance(rest, await look(what));
    assert.ok(d > 0.2, `${what} differs from rest by ${d.toFixed(2)} of 255`);
  }
  assert.deepEqual(page.problems, []);
});
