// SPDX-License-Identifier: GPL-3.0-or-later
// The element takes somebody's feature points while the page lives: the face on the canvas is another, and a wrong point changes nothing.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { launch } from '../lib/browser.mjs';
import { artefacts, Daemon } from '../lib/daemon.mjs';
import { fiveLines, servePages } from '../lib/page-server.mjs';

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

test('calibrate() draws another face, refuses what is wrong, and gives the first one back', async () => {
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
