// SPDX-License-Identifier: GPL-3.0-or-later
// Cost of drawing the picture face: node tests/bench/run.mjs pictures. Draws a sentence's FAPs in Chromium without WebGL as fast as possible.
// Reports CPU time of the page's thread per frame, and frames per second at full speed and throttled four and six times
// (Emulation.setCPUThrottlingRate).
import { createRequire } from 'node:module';
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { launch } from '../lib/browser.mjs';
import { build } from '../lib/daemon.mjs';
import { parseFap } from '../lib/fapfile.mjs';

const web = fileURLToPath(new URL('../../web/', import.meta.url));
const TEXT = 'La mamma abbraccia il papà, e la bimba mangia una pera sotto un pioppo.';
const script = `
import { Pictures, PicturesView } from './element/pictures/pictures-view.mjs';
import { readPictures } from './element/pictures/set.mjs';
window.begin = async (json) => {
  const before = performance.now();
  window.view = new PicturesView(document.querySelector('canvas'));
  const pictures = await Pictures.create(readPictures(json));
  view.show(pictures);
  return performance.now() - before;
};
window.draw = (frames) => {
  const before = performance.now();
  for (const frame of frames) {
    view.head.setFaps(frame);
    view.draw();
    view.context.getImageData(0, 0, 1, 1); // forces the drawing
  }
  return performance.now() - before;
};`;

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'pictures-'));
const fap = path.join(folder, 'a.fap');
execFileSync(path.join(build, 'server/cli/faccia'), ['say', '--lang', 'it', '--fps', '30', '--fap', fap, '--wav', path.join(folder, 'a.wav'), TEXT], { stdio: 'ignore' });
const { frames } = parseFap(fs.readFileSync(fap, 'utf8'));
fs.rmSync(folder, { recursive: true });
const set = JSON.parse(fs.readFileSync(process.argv[2] ?? path.join(process.env.FACCIA_MODELS ?? path.join(build, 'models'), 'pictures/mara.json')));

const { build: bundle } = createRequire(path.join(web, 'package.json'))('esbuild');
const { outputFiles } = await bundle({ stdin: { contents: script, resolveDir: web }, bundle: true, format: 'esm', write: false });
const browser = await launch({ webgl: false, idling: true, forced: true, whole: true });
const page = await browser.newPage();
await page.setContent('<canvas></canvas>');
await page.addScriptTag({ type: 'module', content: outputFiles[0].text });
await page.waitForFunction(() => window.draw);
const session = await page.context().newCDPSession(page);
await session.send('Performance.enable', { timeDomain: 'threadTicks' });
const spent = async () => (await session.send('Performance.getMetrics')).metrics.find(({ name }) => name === 'TaskDuration').value * 1000;
const made = await page.evaluate((json) => window.begin(json), set);
console.log(`${set.width} x ${set.height}, ${frames.length} frames of a sentence with life; ready in ${made.toFixed(0)} ms`);
await page.evaluate((list) => window.draw(list), frames); // warms up
for (const rate of [1, 4, 6]) {
  await session.send('Emulation.setCPUThrottlingRate', { rate });
  const runs = [];
  for (let i = 0; i < 5; i++) {
    const before = await spent();
    const clock = await page.evaluate((list) => window.draw(list), frames);
    runs.push({ cpu: ((await spent()) - before) / frames.length, clock: clock / frames.length });
  }
  const median = (key) => runs.map((run) => run[key]).sort((a, b) => a - b)[2];
  console.log(`slowed ${rate} times: ${median('clock').toFixed(2)} ms a picture on the clock = ${(1000 / median('clock')).toFixed(0)} a second; ${median('cpu').toFixed(2)} ms of processor time (medians of 5)`);
}
await browser.close();
