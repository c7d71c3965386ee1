// SPDX-License-Identifier: GPL-3.0-or-later
// Calibrates the element with a person's feature points at run time: the face on the canvas changes, and an invalid point changes nothing.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { launch } from '../../lib/browser.mjs';
import { artefacts, Daemon } from '../../lib/daemon.mjs';
import { fiveLines, servePages } from '../../lib/page-server.mjs';

let daemon, browser, pages, bruno;

before(async () => {
  pages = await servePages({});
  daemon = await Daemon.start(['--origin', pages.url]);
  pages.files['/'] = fiveLines(daemon.url);
  browser = await launch();
  bruno = (await (await daemon.get('/v1/models/bruno')).json()).fdp;
});
after(async () => {
  await browser?.close();
  await pages?.close();
  assert.equal((await daemon.stop()).code, 0);
});

test('calibrate() draws a different face, rejects invalid points, and restores the original', async () => {
  const page = await browser.newPage({ viewport: { width: 420, height: 520 } });
  await page.goto(`${pages.url}/`);
  await page.waitForFunction(() => document.querySelector('talking-head')?.debug?.().triangles > 0);
  const width = () => page.evaluate(() => document.querySelector('talking-head').debugParts().stage.view.head.model.fapu.MW);
  const keep = async (name) => fs.writeFileSync(path.join(artefacts, `calibrate-${name}.png`), await page.screenshot());
  const calibrate = (calibration) => page.evaluate((one) => document.querySelector('talking-head').calibrate(one).then(() => 'done', ({ place, message }) => `${place}|${message}`), calibration);
  const own = await width();
  await keep('own');
  assert.equal(await calibrate({ featurePointsCoord: bruno }), 'done');
  assert.ok(Math.abs((await width()) - (bruno['8.3'][0] - bruno['8.4'][0])) < 0.01);
  await keep('taken');
  assert.match(await calibrate({ featurePointsCoord: { '8.4': [1, 2] } }), /^featurePointsCoord\.8\.4\|.*three numbers/);
  assert.match(await calibrate({ featurePointsCoord: { '8.3': bruno['8.4'], '8.4': bruno['8.3'] } }), /^featurePointsCoord\|.*MW/);
  assert.ok(Math.abs((await width()) - (bruno['8.3'][0] - bruno['8.4'][0])) < 0.01, 'as it was');
  assert.equal(await calibrate(null), 'done');
  assert.equal(await width(), own);
});

test('applies a room’s calibration to all its faces, including later ones; the page’s own overrides it', async () => {
  const enter = async () => {
    const page = await browser.newPage({ viewport: { width: 160, height: 200 } });
    await page.goto(`${pages.url}/`);
    await page.evaluate(() => {
      const head = document.querySelector('talking-head');
      window.told = [];
      for (const type of ['calibrated', 'error']) head.addEventListener(type, ({ detail }) => window.told.push(detail));
      Object.assign(head, { quality: 'low', still: true, room: 'salotto' });
    });
    await page.waitForFunction(() => document.querySelector('talking-head').debug().triangles > 0);
    return page;
  };
  const units = (page) => page.evaluate(() => ({ ...document.querySelector('talking-head').debugParts().stage.view.head.model.fapu }));
  const told = (page, count) => page.waitForFunction((n) => window.told.length >= n && window.told.slice(n - 1), count).then((handle) => handle.jsonValue());
  const like = (is, was, wanted) => assert.ok(Math.abs(is[was] / wanted - 1) < 0.01, `${was} ${is[was]} ${wanted}`);
  const fapu = { MW: bruno['8.3'][0] - bruno['8.4'][0], ES: bruno['3.5'][0] - bruno['3.6'][0] };
  const first = await enter();
  const own = await units(first);
  assert.ok(Math.abs(own.MW / fapu.MW - 1) > 0.03, 'another face');
  const twice = { '8.3': bruno['8.4'], '8.4': bruno['8.3'] }; // swapped: impossible in a face
  assert.ok(await first.evaluate((points) => document.querySelector('talking-head').calibrateAll({ featurePointsCoord: points }), twice));
  const [{ code, place, message }] = await told(first, 1);
  assert.deepEqual([code, place], ['bad-calibration', 'featurePointsCoord'], message);
  assert.deepEqual(await units(first), own);
  const sent = await daemon.get('/v1/rooms/salotto/commands', { method: 'POST', body: JSON.stringify({ type: 'calibrate', featurePointsCoord: bruno }) });
  assert.deepEqual([sent.status, (await sent.json()).listeners], [202, 1]);
  const second = await enter();
  for (const page of [first, second]) {
    await page.waitForFunction((wide) => Math.abs(document.querySelector('talking-head').debugParts().stage.view.head.model.fapu.MW / wide - 1) < 0.01, fapu.MW);
    like(await units(page), 'ES', fapu.ES);
  }
  fs.writeFileSync(path.join(artefacts, 'calibrate-room.png'), await second.screenshot());
  await second.evaluate((points) => document.querySelector('talking-head').calibrate({ featurePointsCoord: points }), { '8.3': [20, -62, 18], '8.4': [-20, -62, 18] });
  assert.ok(Math.abs((await units(second)).MW - 40) < 1);
  await second.evaluate(() => document.querySelector('talking-head').calibrate(null));
  like(await units(second), 'MW', fapu.MW);
  await first.evaluate(() => document.querySelector('talking-head').calibrateAll(null));
  for (const page of [first, second]) {
    await page.waitForFunction((wide) => document.querySelector('talking-head').debugParts().stage.view.head.model.fapu.MW === wide, own.MW);
    await page.close();
  }
});

/** Counts pixels of skin on the canvas, right after a picture was drawn. */
const drawnPoints = (page) => page.evaluate(() => {
  const { stage } = document.querySelector('talking-head').debugParts();
  const { view } = stage;
  if (!view?.head || stage.lost) return 0;
  view.draw();
  const gl = view.renderer.getContext();
  const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
  const pixels = new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  let count = 0;
  for (let i = 0; i < pixels.length; i += 4) if (pixels[i + 3] > 128 && pixels[i] > 60) count++; // skin, not black
  return count / (width * height);
});

test('draws the same face again after a lost context is restored or recreated', async () => {
  const page = await browser.newPage({ viewport: { width: 420, height: 520 } });
  await page.goto(`${pages.url}/`);
  await page.waitForFunction(() => document.querySelector('talking-head')?.debug?.().triangles > 0);
  const before = await drawnPoints(page);
  assert.ok(before > 0.1, `${before} of the canvas`);
  const lose = () => page.evaluate(() => {
    const { stage } = document.querySelector('talking-head').debugParts();
    window.losing = stage.view.renderer.getContext().getExtension('WEBGL_lose_context');
    window.canvasBefore = stage.canvas;
    window.losing.loseContext();
  });
  const back = () => page.waitForFunction(() => {
    const { stage } = document.querySelector('talking-head').debugParts();
    return !stage.lost && stage.view?.head;
  }, null, { timeout: 30000 });
  await lose();
  await page.waitForFunction(() => document.querySelector('talking-head').debugParts().stage.lost);
  await page.evaluate(() => window.losing.restoreContext());
  await back();
  assert.ok(await page.evaluate(() => window.canvasBefore === document.querySelector('talking-head').debugParts().stage.canvas), 'it is the same context');
  const restored = await drawnPoints(page);
  assert.ok(Math.abs(restored / before - 1) < 0.05, `${restored} of the canvas, ${before} before`);
  await lose();
  await page.waitForFunction(() => window.canvasBefore !== document.querySelector('talking-head').debugParts().stage.canvas, null, { timeout: 30000 });
  await back();
  const anew = await drawnPoints(page);
  assert.ok(Math.abs(anew / before - 1) < 0.05, `${anew} of the canvas, ${before} before`);
  await page.close();
});

test('rejects a texture of 16,000 x 16,000 pixels before decoding it', async () => {
  const page = await browser.newPage({ viewport: { width: 420, height: 520 } });
  await page.goto(`${pages.url}/`);
  await page.waitForFunction(() => document.querySelector('talking-head')?.debug?.().triangles > 0);
  const bytes = Buffer.alloc(64);
  bytes.set([0x89, 0x50, 0x4e, 0x47, 13, 10, 26, 10, 0, 0, 0, 13, 0x49, 0x48, 0x44, 0x52]);
  bytes.writeUInt32BE(16000, 16);
  bytes.writeUInt32BE(16000, 20);
  const told = await page.evaluate(async ([featurePointsCoord, data]) => {
    let decoded = 0;
    const own = window.createImageBitmap;
    window.createImageBitmap = (...all) => (decoded++, own(...all));
    const head = document.querySelector('talking-head');
    const said = await head.calibrate({ featurePointsCoord, texture: { type: 'image/png', data } }).then(() => 'done', ({ place, message }) => `${place}|${message}`);
    return [said, decoded];
  }, [bruno, bytes.toString('base64')]);
  assert.match(told[0], /^texture\.data\|.*16000 x 16000/);
  assert.equal(told[1], 0);
  assert.ok(await drawnPoints(page) > 0.1);
  await page.close();
});
