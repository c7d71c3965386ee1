// SPDX-License-Identifier: GPL-3.0-or-later
// The picture face in a real browser without WebGL: lips meet and part in pixels, it blinks, and its files are small. The artefacts contain the
// pictures.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { launch } from '../../lib/browser.mjs';
import { artefacts, build, Daemon } from '../../lib/daemon.mjs';
import { parseFap } from '../../lib/fapfile.mjs';
import { fiveLines, servePages } from '../../lib/page-server.mjs';
import { violations } from '../../lib/schema.mjs';

const TEXT = 'La mamma abbraccia il papà, e la bimba mangia una pera.';
const LABIALS = ['p', 'b', 'm'];
let daemon, browser, pages, set;

before(async () => {
  pages = await servePages({});
  daemon = await Daemon.start(['--origin', pages.url]);
  pages.files['/'] = fiveLines(daemon.url).replace(' quality="low"', '');
  browser = await launch({ webgl: false });
  set = await (await daemon.get('/v1/pictures/mara')).json();
});
after(async () => {
  await browser?.close();
  await pages?.close();
  assert.equal((await daemon.stop()).code, 0);
});

/** Opens a page with a picture face, and functions that measure its canvas. */
async function openFace() {
  const page = await browser.newPage({ viewport: { width: 600, height: 700 } });
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  await page.addInitScript(({ regions }) => {
    document.addEventListener('DOMContentLoaded', () => document.querySelector('talking-head').addEventListener('error', ({ detail }) => (window.errors ??= []).push(detail.code)));
    const region = (name) => regions.find((one) => one.name === name);
    const pixels = ({ x, y, width, height }) =>
      document.querySelector('talking-head').shadowRoot.querySelector('canvas').getContext('2d').getImageData(x, y, width, height);
    /** Rows between the lips in the middle of the mouth: non-red rows between the first and the last red one. */
    window.gap = () => {
      const { x, y, pictures } = region('mouth');
      const [, , upper, lower] = pictures[0].anchors;
      const [width, height] = [17, Math.round(lower[1] - upper[1]) + 40];
      const { data } = pixels({ x: x + Math.round(upper[0]) - 8, y: y + Math.round(upper[1]) - 8, width, height });
      const red = Array.from({ length: height }, (_, row) => {
        let count = 0;
        for (let i = 4 * width * row; i < 4 * width * (row + 1); i += 4) if (data[i] > 60 && (data[i] - data[i + 1]) / data[i] > 0.37) count++; // the shadow below the lip has up to 0.35
        return count > width / 2;
      });
      const lips = red.slice(red.indexOf(true), red.lastIndexOf(true));
      return lips.filter((row) => !row).length;
    };
    /** Counts pixels of iris and white in an eye: darker or brighter than skin. */
    window.eye = (name) => {
      const { data } = pixels(region(name));
      let count = 0;
      for (let i = 0; i < data.length; i += 4) if (data[i] - data[i + 2] < 22) count++;
      return count;
    };
  }, set);
  await page.goto(`${pages.url}/`);
  await page.waitForFunction(() => document.querySelector('talking-head').debug?.().state === 'idle' && document.querySelector('talking-head').debug().frames > 0, null, { timeout: 120000 });
  return page;
}

/** Poses the face and waits until it is drawn. */
async function posed(page, faps, name) {
  await page.evaluate(async (values) => {
    document.querySelector('talking-head').pose(values);
    for (let i = 0; i < 3; i++) await new Promise(requestAnimationFrame);
  }, faps);
  if (name) {
    fs.mkdirSync(artefacts, { recursive: true });
    await page.locator('talking-head').screenshot({ path: path.join(artefacts, `pictures-${name}.png`) });
  }
  return page.evaluate(() => ({ gap: window.gap(), left: window.eye('eye_l'), right: window.eye('eye_r') }));
}

function spoken(text) {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'pictures-'));
  const [fap, json] = ['a.fap', 'a.json'].map((file) => path.join(folder, file));
  execFileSync(path.join(build, 'server/cli/faccia'), ['say', '--lang', 'it', '--fps', '100', '--still', '--fap', fap, '--json', json, text], { stdio: 'ignore' });
  const out = { ...parseFap(fs.readFileSync(fap, 'utf8')), phones: JSON.parse(fs.readFileSync(json)).phones };
  fs.rmSync(folder, { recursive: true });
  return out;
}

test('the set matches its schema and its size limit', async (t) => {
  assert.equal(violations('pictures', set), null);
  assert.ok(set.regions.find(({ name }) => name === 'mouth').pictures.length >= 34);
  const answer = await daemon.get('/v1/pictures/mara', { headers: { 'accept-encoding': 'gzip' } });
  const bytes = Number(answer.headers.get('content-length'));
  t.diagnostic(`${bytes} bytes as it is sent`);
  assert.ok(bytes > 10000 && bytes <= 765000, `${bytes} bytes`);
});

test('every head has a set, whose mouth opens without WebGL; in a wide place its shoulders are whole', async () => {
  const { models } = await (await daemon.get('/v1/models')).json();
  assert.ok(models.length >= 8, `${models.length} heads`);
  const page = await browser.newPage({ viewport: { width: 600, height: 700 } });
  await page.goto(pages.url);
  await page.waitForFunction(() => document.querySelector('talking-head').debug?.().frames);
  for (const [i, { name }] of models.entries()) {
    const { level, opened, mask, cut } = await page.evaluate(async ([model, first]) => {
      const face = document.querySelector('talking-head');
      const shown = first || new Promise((resolve) => face.addEventListener('ready', resolve, { once: true }));
      Object.assign(face.style, { display: 'block', inlineSize: '500px', blockSize: '300px' });
      face.setAttribute('model', model);
      await shown;
      const look = async (faps) => {
        face.pose(faps);
        for (let i = 0; i < 3; i++) await new Promise(requestAnimationFrame);
        const canvas = face.shadowRoot.querySelector('canvas');
        return canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
      };
      const [closed, open] = [await look({}), await look({ 3: 400, 5: -350, 10: -300, 11: -300 })];
      let opened = 0;
      for (let i = 0; i < open.length; i += 4) opened += Math.abs(open[i] - closed[i]) > 30;
      const { width, height, style } = face.shadowRoot.querySelector('canvas');
      let cut = 0; // points of the body on the sides of the picture, down to where its frame ends
      for (let y = 0; y < height - 60; y++) for (const x of [0, width - 1]) cut += Number(open[4 * (y * width + x) + 3] > 40);
      return { level: face.debug().level, opened, mask: style.maskImage, cut };
    }, [name, i === 0]);
    assert.equal(level, 'pictures', name);
    assert.ok(opened > 100, `${name}: ${opened} pixels change as the mouth opens`);
    assert.equal(mask, '', `${name}: nothing fades`);
    assert.equal(cut, 0, `${name}: the picture ends in the shoulders`);
  }
  // A set without a frame ends in the shoulders: there its sides fade.
  const { frame: _, ...unframed } = await (await daemon.get('/v1/pictures/mara')).json();
  const mask = await page.evaluate(async (other) => {
    const face = document.querySelector('talking-head');
    await face.showHead(other);
    for (let n = 0; n < 3; n++) await new Promise(requestAnimationFrame);
    return face.shadowRoot.querySelector('canvas').style.maskImage;
  }, { ...unframed, name: 'unframed' });
  assert.match(mask, /transparent [12]\d/);
  await page.close();
});

test('uses the picture set without WebGL, and shows no error', async () => {
  const page = await openFace();
  const { level, frames } = await page.evaluate(() => document.querySelector('talking-head').debug());
  assert.equal(level, 'pictures');
  assert.ok(frames > 0);
  assert.equal(await page.evaluate(() => window.errors), undefined);
  assert.ok(await page.locator('talking-head .message').isHidden());
  assert.ok(await page.locator('talking-head .poster').isHidden());
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('lips meet in every /p b m/ of a sentence and part in every /a/, in pixels', async (t) => {
  const page = await openFace();
  const { phones, fps, frames } = spoken(TEXT);
  const shown = (frame, name) => posed(page, Object.fromEntries(frame.map((value, n) => [n, value]).filter(([n, value]) => n > 2 && value)), name);
  const seen = { closed: [], open: [] };
  for (const [i, { ipa, start, end }] of phones.entries()) {
    const within = frames.slice(Math.ceil((start - 0.02) * fps), Math.floor((end + 0.02) * fps) + 1);
    if (LABIALS.includes([...ipa][0])) {
      const closed = within.filter((f) => f[4] + f[5] >= 0);
      assert.ok(closed.length, `/${ipa}/ at ${start}: the FAPs do not close`);
      seen.closed.push((await shown(closed[closed.length >> 1], `${i}-${ipa}`)).gap);
    } else if (ipa.startsWith('a') && end - start > 0.05)
      seen.open.push((await shown(within.reduce((a, b) => (a[4] + a[5] < b[4] + b[5] ? a : b)), `${i}-${ipa}`)).gap);
  }
  t.diagnostic(JSON.stringify(seen));
  assert.ok(seen.closed.length >= 6 && seen.open.length >= 4);
  // the gloss of the lower lip may pass for two
  assert.ok(Math.max(...seen.closed) <= 2, `rows between closed lips: ${seen.closed}`);
  assert.ok(Math.min(...seen.open) >= 4, `rows between the lips of /a/: ${seen.open}`);
  await page.close();
});

test('the lids close on command and blink spontaneously', async (t) => {
  const page = await openFace();
  const open = await posed(page, {}, 'rest');
  const shut = await posed(page, { 19: 940, 20: 940, 21: 84, 22: 84 }, 'blink');
  const wink = await posed(page, { 19: 940, 21: 84 }, 'wink');
  t.diagnostic(JSON.stringify({ open, shut, wink }));
  for (const side of ['left', 'right']) assert.ok(shut[side] < 0.25 * open[side], side);
  assert.ok(wink.left < 0.25 * open.left && wink.right > 0.9 * open.right);
  assert.equal(open.gap, 0);
  await page.evaluate(() => document.querySelector('talking-head').pose(null));
  await page.waitForFunction((least) => window.eye('eye_l') < least, 0.5 * open.left, { polling: 'raf', timeout: 120000 });
  await page.waitForFunction((least) => window.eye('eye_l') > least, 0.8 * open.left, { polling: 'raf', timeout: 120000 });
  await page.close();
});

test('the mouth on the canvas opens and closes while a sentence plays', async () => {
  const page = await openFace();
  const gaps = await page.evaluate(async (text) => {
    const head = document.querySelector('talking-head');
    const found = [];
    let going = true;
    const look = () => {
      if (head.debug().running) found.push(window.gap());
      if (going) requestAnimationFrame(look);
    };
    look();
    const { reason } = await head.speak(text, { lang: 'it' });
    going = false;
    return { reason, found };
  }, TEXT);
  assert.equal(gaps.reason, 'done');
  assert.ok(gaps.found.length > 5, `${gaps.found.length} pictures`);
  assert.ok(Math.max(...gaps.found) >= 4 && Math.min(...gaps.found) === 0, `${gaps.found}`);
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('uses the picture set that a page names; reports a broken one and uses the server\'s', async () => {
  const page = await openFace();
  pages.files['/anna.json'] = { body: JSON.stringify({ ...set, name: 'anna', title: 'Anna' }), type: 'application/json' };
  pages.files['/broken.json'] = { body: JSON.stringify({ ...set, regions: [{ ...set.regions[0], mask: {} }] }), type: 'application/json' };
  const shown = (address) => page.evaluate((value) => {
    const head = document.querySelector('talking-head');
    const ready = new Promise((resolve) => head.addEventListener('ready', ({ detail }) => resolve(detail.title), { once: true }));
    head.pictures = value;
    return ready;
  }, address);
  assert.equal(await shown('anna.json'), 'Anna');
  assert.equal(await page.evaluate(() => document.querySelector('talking-head').debug().level), 'pictures');
  assert.equal(await page.evaluate(() => document.querySelector('talking-head').speak('Mamma.', { lang: 'it' }).then(({ reason }) => reason)), 'done');
  assert.equal(await page.evaluate(() => window.errors), undefined);
  assert.notEqual(await shown('broken.json'), 'Anna');
  assert.deepEqual(await page.evaluate(() => window.errors), ['bad-pictures']);
  await page.close();
});
