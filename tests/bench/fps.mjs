// SPDX-License-Identifier: GPL-3.0-or-later
// Frames per second in headless Chromium with software rendering at 640 x 480, and CPU time per frame (of all browser processes): the page during
// speech in `low`, `high` and `auto`, and idle in `low`, beside a typical head of other software (reference-head.mjs) and an empty page that only counts frames; in turns,
// so that other load affects all. --before also measures another folder (a build/web of an older commit). Chromium runs as without a GPU: SwiftShader
// draws faces, but the page is composited without it. --forced composites with SwiftShader too, as older figures did, although no visitor does.
// Usage: node tests/bench/run.mjs fps [--seconds 8] [--turns 3] [--before FOLDER] [--model mara] [--forced] [--only high] (beside the reference)
import fs from 'node:fs';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { launch, openPage } from '../lib/browser.mjs';
import { build, Daemon, root } from '../lib/daemon.mjs';
import { descendantSeconds, median } from './figures.mjs';
import { watchOthers } from './others.mjs';
import { bundle } from './page-script.mjs';
import { prose } from './text.mjs';

const { values: options } = parseArgs({
  options: { seconds: { type: 'string', default: '8' }, turns: { type: 'string', default: '3' }, before: { type: 'string' }, model: { type: 'string', default: 'mara' }, forced: { type: 'boolean', default: false }, only: { type: 'string', default: '' } },
});
const SETTLED_MS = 5000; // until shaders are compiled and adaptive quality has reduced triangles
const seconds = Number(options.seconds);
const models = path.join(process.env.FACCIA_MODELS ?? path.join(build, 'models'), 'heads');
const json = JSON.parse(fs.readFileSync(path.join(models, `${options.model}.json`)));
const daemon = await Daemon.start();
const daemons = [daemon.process.pid];
let before;
if (options.before) {
  before = await Daemon.start([], { FACCIA_WEB: path.resolve(options.before) });
  daemons.push(before.process.pid);
}
const browser = await launch({ forced: options.forced, idling: true });
const spent = () => descendantSeconds(daemons);

/** Measures frames per second by a counter in the page, and CPU time per frame. */
async function rate(page, counter) {
  await new Promise((resolve) => setTimeout(resolve, SETTLED_MS));
  const [first, cpu, started] = [await page.evaluate(counter), spent(), performance.now()];
  await new Promise((resolve) => setTimeout(resolve, seconds * 1000));
  const frames = (await page.evaluate(counter)) - first;
  return { fps: frames / ((performance.now() - started) / 1000), cost: ((spent() - cpu) * 1000) / frames };
}

async function empty() {
  const page = await browser.newPage();
  await page.evaluate(() => {
    window.frames_ = 0;
    const tick = () => (window.frames_++, requestAnimationFrame(tick));
    tick();
  });
  const found = await rate(page, () => window.frames_);
  await page.close();
  return found;
}

const script = await bundle(`
import { reference } from '${path.join(root, 'tests/bench/reference-head.mjs')}';
import { decodeTexture, readModel } from './element/head/model/model.mjs';
window.begin = async (json) => {
  const head = await reference(document.querySelector('canvas'), readModel(json), decodeTexture);
  window.frames_ = 0;
  const tick = (now) => (window.frames_++, head.draw(now / 1000), requestAnimationFrame(tick));
  requestAnimationFrame(tick);
  return head.triangles;
};`);
async function other() {
  const page = await browser.newPage({ viewport: { width: 1000, height: 800 } });
  await page.setContent('<!doctype html><body style="margin:0"><canvas width=640 height=480 style="width:640px;height:480px"></canvas>');
  await page.addScriptTag({ type: 'module', content: script });
  await page.waitForFunction(() => window.begin);
  const triangles = await page.evaluate((model) => window.begin(model), json);
  const found = await rate(page, () => window.frames_);
  await page.close();
  return { ...found, triangles };
}

async function ours(quality, { url }, speaks = true) {
  const page = await openPage(browser, url);
  await page.evaluate((wanted) => document.querySelector('talking-head').setAttribute('quality', wanted), quality);
  await page.evaluate(() => Object.assign(document.querySelector('talking-head').style, { width: '640px', height: '480px', position: 'fixed', inset: 0, maxWidth: 'none' }));
  if (speaks) await page.evaluate((text) => void document.querySelector('talking-head').speak(text, { lang: 'it' }), prose(seconds + 12));
  const found = await rate(page, () => document.querySelector('talking-head').debug().frames);
  const { triangles, level } = await page.evaluate(() => document.querySelector('talking-head').debug());
  await page.close();
  return { ...found, triangles, level };
}

const kinds = [
  ['an empty page', empty],
  ['reference', other],
  ...['low', 'high', 'auto'].map((quality) => [quality, () => ours(quality, daemon)]),
  ['low, idle', () => ours('low', daemon, false)],
  ...(before ? ['low', 'high'].map((quality) => [`${quality}, before`, () => ours(quality, before)]) : []),
  ...(before ? [['low, idle, before', () => ours('low', before, false)]] : []),
].filter(([name]) => name === 'reference' || name.includes(options.only));
const found = new Map(kinds.map(([name]) => [name, []]));
const stop = watchOthers();
const begun = Number(process.hrtime.bigint()) / 1e6;
for (let turn = 0; turn < Number(options.turns); turn++) for (const [name, measure] of kinds) found.get(name).push(await measure());
const others = stop()(begun, Number(process.hrtime.bigint()) / 1e6);
const of = (name, what) => median(found.get(name).map((one) => one[what]));
console.log(`640 x 480${options.forced ? ', forced' : ''}, ${options.turns} turns of ${seconds} s, ${options.model}; other programs took ${others.toFixed(2)} processors`);
console.log('| | pictures a second | beside the reference | processor, ms a picture | beside the reference | triangles |\n|---|---|---|---|---|---|');
for (const [name, list] of found) {
  const [fps, cost] = [of(name, 'fps'), of(name, 'cost')];
  const { triangles = '', level } = list.at(-1);
  console.log(`| ${name}${level && level !== name ? ` (${level})` : ''} | ${fps.toFixed(1)} | ${(fps / of('reference', 'fps')).toFixed(1)} | ${cost.toFixed(1)} | ${(cost / of('reference', 'cost')).toFixed(2)} | ${triangles} |`);
}
await browser.close();
await daemon.stop();
await before?.stop();
