// SPDX-License-Identifier: GPL-3.0-or-later
// Chooses each head on the page by its picture, and makes a contact sheet (in the artefacts); choosing a head changes voice and
// poster. The same without WebGL.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { PNG } from 'pngjs';
import { launch, openPage, picture } from '../../lib/browser.mjs';
import { models as built } from '../../lib/built-heads.mjs';
import { artefacts, Daemon } from '../../lib/daemon.mjs';

let daemon, browser, page, models;
before(async () => {
  daemon = await Daemon.start();
  browser = await launch();
  ({ models } = await (await daemon.get('/v1/models')).json());
});
after(async () => {
  await browser?.close();
  assert.equal((await daemon.stop()).code, 0);
});

const ready = (title) =>
  page.waitForFunction((name) => document.querySelector('#credits').textContent.includes(name) && document.querySelector('talking-head').debug().state !== 'loading', title, { timeout: 120000 });

test('every head can be selected by its picture, and no two look alike', async () => {
  page = await openPage(browser, daemon.url, { viewport: { width: 1000, height: 800 } });
  const choices = page.locator('#head-box input');
  assert.equal(await choices.count(), models.length);
  const tiles = [];
  for (const [i, { name, title }] of models.entries()) {
    if (i) await choices.nth(i).check({ force: true });
    await ready(title);
    await page.waitForFunction(() => document.querySelector('talking-head').shadowRoot.querySelector('.poster').hidden);
    tiles.push(await picture(page, `person-${name}`, Array(69).fill(0)));
  }
  const { width, height } = tiles[0];
  const sheet = new PNG({ width: width * 4, height: height * Math.ceil(tiles.length / 4) });
  tiles.forEach((tile, i) => PNG.bitblt(tile, sheet, 0, 0, Math.min(width, tile.width), Math.min(height, tile.height), (i % 4) * width, Math.floor(i / 4) * height));
  fs.writeFileSync(path.join(artefacts, 'people.png'), PNG.sync.write(sheet));
  for (const [i, one] of tiles.entries())
    for (const other of tiles.slice(i + 1)) {
      let sum = 0;
      for (let k = 0; k < one.data.length; k++) sum += Math.abs(one.data[k] - (other.data[k] ?? one.data[k])); // one may be a row higher
      assert.ok(sum / one.data.length > 4, `${models[i].name}: ${(sum / one.data.length).toFixed(1)} of 255 from another`);
    }
  assert.deepEqual(page.problems, []);
});

test('the selected head speaks with a voice that suits it', async () => {
  const voices = (await (await daemon.get('/v1/voices')).json()).voices;
  for (const name of ['bruno', 'rosa']) {
    const { title, voice } = models.find((model) => model.name === name);
    await page.evaluate((wanted) => { document.querySelector('talking-head').model = wanted; }, name);
    await ready(title);
    const id = await page.evaluate(() => new Promise((resolve) => {
      const head = document.querySelector('talking-head');
      head.addEventListener('begin', ({ detail }) => resolve(detail.voice), { once: true });
      head.speak('Ciao.', { lang: 'it' });
    }));
    assert.equal(voices.find((one) => one.id === id).gender, voice.gender, `${name}: ${id}`);
  }
});

test('the page speaks with a voice that suits the selected head', async () => {
  const { voices } = await (await daemon.get('/v1/voices')).json();
  for (const [i, { name, title, voice }] of models.entries()) {
    if (!['bruno', 'rosa'].includes(name)) continue;
    await page.locator('#head-box input').nth(i).check({ force: true });
    await ready(title);
    await page.fill('#text', 'Ciao.');
    const begun = page.evaluate(() => new Promise((resolve) => document.querySelector('talking-head').addEventListener('begin', ({ detail }) => resolve(detail.voice), { once: true })));
    await page.click('#speak');
    const id = await begun;
    assert.equal(voices.find((one) => one.id === id).gender, voice.gender, `${name}: ${id}`);
  }
});

test('shows the poster until the head has loaded', async () => {
  const slow = await browser.newPage({ viewport: { width: 700, height: 600 }, locale: 'it-IT' });
  let release;
  const held = new Promise((resolve) => (release = resolve));
  await slow.route('**/v1/models/mara?v=*', async (route) => {
    await held;
    await route.continue();
  });
  await slow.goto(daemon.url);
  const poster = slow.locator('talking-head .poster');
  await poster.waitFor({ state: 'visible' });
  const stage = slow.locator('talking-head .stage');
  const [box, own] = [await stage.boundingBox(), await poster.boundingBox()];
  assert.ok(Math.abs(own.x + own.width / 2 - box.x - box.width / 2) < 1 && Math.abs(own.height - box.height) < 1, 'where the head will be');
  const bar = await slow.locator('#loading').boundingBox();
  assert.ok(bar.y > box.y + 0.7 * box.height, 'that it is being loaded is said below the face');
  await slow.evaluate(() => document.querySelector('#loading').remove());
  const shot = async (name) => PNG.sync.read(await stage.screenshot({ path: path.join(artefacts, `instead-${name}.png`) }));
  const before = await shot('poster');
  await slow.evaluate(() => document.querySelector('talking-head').pose({}));
  release();
  await poster.waitFor({ state: 'hidden', timeout: 120000 });
  const after = await shot('head');
  const [one, other] = [outline(before), outline(after)];
  for (const side of Object.keys(one)) assert.ok(Math.abs(one[side] - other[side]) < 0.03 * box.height, `${side}: ${one[side]}, ${other[side]}`);
  await slow.close();
});

/** Bounding box of hair and face: everything but background in the upper two thirds. */
function outline(png) {
  const box = { left: png.width, right: 0, top: png.height };
  const apart = (x, y) => [0, 1, 2].some((k) => Math.abs(png.data[4 * (y * png.width + x) + k] - png.data[4 * (y * png.width + 2) + k]) > 60);
  for (let y = 0; y < (png.height * 2) / 3; y++)
    for (let x = 0; x < png.width * 0.8; x++) // excludes the button
      if (apart(x, y)) Object.assign(box, { left: Math.min(box.left, x), right: Math.max(box.right, x), top: Math.min(box.top, y) });
  return box;
}

/** How much of the picture is skin: redder than hair, cloth and the wall behind. */
function skinShare({ width, height, data }) {
  let count = 0;
  for (let at = 0; at < data.length; at += 4) {
    const [red, green, blue] = data.subarray(at, at + 3);
    if (green < 0.85 * red && blue < 0.75 * red && blue <= green) count++;
  }
  return count / width / height;
}

test('each view shows a different part of the head', async () => {
  const shares = {};
  for (const view of ['bust', 'face', 'mouth']) {
    await page.evaluate((name) => { document.querySelector('talking-head').view = name; }, view);
    shares[view] = skinShare(await picture(page, `view-${view}`, Array(69).fill(0)));
  }
  assert.ok(shares.mouth > 0.6 && shares.mouth > 1.7 * shares.face, `the mouth fills its picture: ${JSON.stringify(shares)}`);
  assert.ok(shares.face > 0.2 && shares.face > 1.7 * shares.bust, JSON.stringify(shares));
  assert.ok(shares.bust > 0.05, JSON.stringify(shares));
  await page.close();
});

/** The built models, but for Bruno's set of pictures. */
function modelsWithoutSet() {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-models-'));
  fs.cpSync(built, folder, { recursive: true, filter: (file) => !/pictures\/bruno|\.glb$/.test(file) });
  return folder;
}

test('shows a picture of the speaker without WebGL, where there is no set of pictures', async () => {
  const folder = modelsWithoutSet();
  const other = await Daemon.start([], { FACCIA_MODELS: folder });
  const blind = await launch({ webgl: false });
  try {
    const plain = await blind.newPage();
    await plain.goto(other.url);
    const poster = plain.locator('talking-head .poster');
    const message = plain.locator('talking-head .message');
    // Mara has a picture set, Bruno has none here.
    await plain.waitForFunction(() => document.querySelector('talking-head').debug?.().level === 'pictures', null, { timeout: 60000 });
    await poster.waitFor({ state: 'hidden', timeout: 30000 });
    assert.match(await poster.getAttribute('src'), /\/v1\/models\/mara\.webp$/);
    await plain.evaluate(() => { document.querySelector('talking-head').model = 'bruno'; });
    await plain.waitForFunction(() => /bruno\.webp$/.test(document.querySelector('talking-head').shadowRoot.querySelector('.poster').src));
    await poster.waitFor({ state: 'visible', timeout: 60000 });
    assert.ok((await poster.evaluate((image) => image.naturalWidth)) > 200);
    await message.waitFor({ state: 'visible' });
    await plain.evaluate(() => new Promise((resolve) => {
      const head = document.querySelector('talking-head');
      const captions = head.shadowRoot.querySelector('.captions');
      new MutationObserver(() => /Buongiorno/.test(captions.textContent) && resolve()).observe(captions, { childList: true, characterData: true, subtree: true });
      head.speak('Buongiorno a tutti.', { lang: 'it' });
    }));
    assert.ok(await poster.isVisible(), 'and what is said is read under it');
    const stand = (wish) => plain.evaluate((value) => { document.querySelector('talking-head').poster = value; }, wish);
    await stand(`${other.url}/v1/models/rosa.webp`);
    await plain.waitForFunction(() => {
      const image = document.querySelector('talking-head').shadowRoot.querySelector('.poster');
      return /rosa\.webp$/.test(image.src) && !image.hidden && image.naturalWidth > 200;
    });
    await stand(`${other.url}/nobody.webp`);
    await poster.waitFor({ state: 'hidden' });
    assert.ok(await message.isVisible(), 'where the picture cannot be had, either, one is told');
    await stand(null);
    await poster.waitFor({ state: 'visible' });
    await stand('off');
    await poster.waitFor({ state: 'hidden' });
  } finally {
    await blind.close();
    await other.stop();
    fs.rmSync(folder, { recursive: true });
  }
});
