// SPDX-License-Identifier: GPL-3.0-or-later
// Breakdown of the time per frame in headless Chromium with software rendering, 640 x 480: draws the head repeatedly, complete and with parts left
// out, in turns, so that other load affects all. For each frame: CPU time of all browser processes, and elapsed time. Waits for each frame (reads one
// pixel back) and displays none; fps.mjs does. --before also measures the client of another folder (the web/ of an older commit, with its protocol/).
// Usage: node tests/bench/run.mjs frame [--level low] [--web FOLDER] [--before FOLDER] [--model mara] [--rounds 5] [--frames 12] [--only WORD]
import fs from 'node:fs';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { launch } from '../lib/browser.mjs';
import { build as built, root } from '../lib/daemon.mjs';
import { descendantSeconds, median } from './figures.mjs';
import { bundle } from './page-script.mjs';

const { values: options } = parseArgs({
  options: {
    level: { type: 'string', default: 'low' }, web: { type: 'string', default: path.join(root, 'web') }, model: { type: 'string', default: 'mara' },
    rounds: { type: 'string', default: '5' }, frames: { type: 'string', default: '12' }, before: { type: 'string' }, only: { type: 'string', default: '' },
  },
});
const models = path.join(process.env.FACCIA_MODELS ?? path.join(built, 'models'), 'heads');
const json = JSON.parse(fs.readFileSync(path.join(models, `${options.model}.json`)));
const frames = Number(options.frames);

const script = `
import { View } from './element/head/view.mjs';
import { Head } from './element/head/head.mjs';
import { decodeTexture, readModel } from './element/head/model/model.mjs';
import { LEVELS } from './element/head/quality.mjs';
import { setTextureQuality } from './element/head/textures.mjs';
import { reference } from '${path.join(root, 'tests/bench/reference-head.mjs')}';

const [own, other] = document.querySelectorAll('canvas');
window.begin = async (json, level) => {
  const before = performance.now();
  const model = readModel(json);
  const head = await Head.create(model, { software: true });
  window.built = performance.now() - before;
  const view = new View(own);
  view.resize(640, 480);
  view.setLevel(LEVELS.find(({ name }) => name === level));
  view.show(head);
  const shown = performance.now();
  await head.slim?.();
  await head.looking;
  window.slimmed = performance.now() - shown;
  Object.assign(window, { view, head, model });
  window.reference = await reference(other, readModel(json), decodeTexture);
};
/** FAPs of a face that speaks, turns its head slightly and blinks. */
const pose = (t) => {
  const values = new Float32Array(69);
  [3, 4, 5, 6, 7, 8, 9, 10, 11, 14, 15, 16, 17, 44, 51, 52, 55, 56, 57, 58].forEach((n, i) => (values[n] = 150 * Math.sin(t * (4 + 0.3 * i) + n)));
  values[3] = 300 + 200 * Math.sin(5 * t);
  values[19] = values[20] = 200 + 200 * Math.sin(t);
  values[31] = values[32] = 100 * Math.sin(t);
  values[48] = 3000 * Math.sin(t); values[49] = 4000 * Math.sin(0.7 * t); values[50] = 1500 * Math.sin(0.9 * t);
  return values;
};
const point = new Uint8Array(4);
const wait = (gl) => gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, point);
const partOf = (mesh) => (mesh.userData.of ?? head.parts.find((one) => (one.shape ?? one).geometry === mesh.geometry)).part.name;
window.parts = () => [...new Set(head.group.children.filter((mesh) => mesh.visible).map(partOf))];

let flat = false;
function paintFlat() {
  for (const { material } of head.group.children) {
    material.userData.before = material.fragmentShader;
    material.fragmentShader = 'void main() { gl_FragColor = vec4(0.5, 0.4, 0.3, 1.0); }';
    material.needsUpdate = true;
  }
  return () => { for (const { material } of head.group.children) { material.fragmentShader = material.userData.before; material.needsUpdate = true; } };
}
function hide(test) {
  const hidden = head.group.children.filter((mesh) => mesh.visible && test(mesh));
  for (const mesh of hidden) mesh.visible = false;
  return () => { for (const mesh of hidden) mesh.visible = true; };
}
function sized(width, height) {
  view.resize(width, height);
  return () => view.resize(640, 480);
}
/** Disables multisampling. */
function unsampled() {
  const { level } = view;
  view.setLevel({ ...level, samples: 0 });
  return () => view.setLevel(level);
}
/** Sets the cheapest texture filtering. */
function plainTextures() {
  for (const texture of head.textures.values()) if (!texture.isDataTexture) setTextureQuality(texture, false, false, 1);
  return () => view.setLevel(view.level);
}
const undo = () => {};
const setUps = {
  'whole': () => undo,
  'reference': () => undo,
  'JavaScript alone': () => undo,
  'the same pose': () => undo,
  'nothing drawn': () => hide(() => true),
  'flat colour': paintFlat,
  'a quarter of the pixels': () => sized(320, 240),
  'hardly a pixel': () => sized(32, 24),
  'one sample': unsampled,
  'all of it': () => {
    head.seenFrom = () => { for (const { shape } of head.parts) shape.show(false, true); };
    return () => delete head.seenFrom;
  },
  'plain textures': plainTextures,
};
let time = 0;
window.run = (name, frames) => {
  const restore = name.startsWith('without ') ? hide((mesh) => partOf(mesh) === name.slice(8))
    : name.startsWith('only ') ? hide((mesh) => partOf(mesh) !== name.slice(5)) : setUps[name]();
  const gl = name === 'reference' ? window.reference.gl : view.renderer.getContext();
  const step = () => {
    time += 1 / 30;
    if (name === 'reference') return window.reference.draw(time);
    if (name !== 'the same pose') head.setFaps(pose(time));
    if (name !== 'JavaScript alone') view.draw();
  };
  for (let i = 0; i < 3; i++) { step(); wait(gl); }
  window.go = () => {
    const begun = performance.now();
    for (let i = 0; i < frames; i++) { step(); wait(gl); }
    const taken = performance.now() - begun;
    restore();
    return taken / frames;
  };
};
`;
const browser = await launch({ idling: true });
async function open(web) {
  const page = await browser.newPage({ viewport: { width: 800, height: 600 } });
  page.on('pageerror', (error) => console.error(error));
  page.on('console', (message) => message.type() === 'error' && console.error(message.text()));
  await page.setContent('<!doctype html><body style="margin:0"><canvas width=640 height=480></canvas><canvas width=640 height=480></canvas>');
  await page.addScriptTag({ type: 'module', content: await bundle(script, web) });
  await page.waitForFunction(() => window.begin);
  await page.evaluate(([model, level]) => window.begin(model, level), [json, options.level]);
  return page;
}
const page = await open(options.web);
const older = options.before && (await open(path.resolve(options.before)));
const parts = await page.evaluate(() => window.parts());
const names = ['whole', ...(older ? ['before'] : []), 'all of it', 'reference', 'JavaScript alone', 'the same pose', 'nothing drawn', 'flat colour', 'a quarter of the pixels', 'hardly a pixel', 'plain textures', ...(options.level.startsWith('high') ? ['one sample'] : []),
  ...parts.map((part) => `without ${part}`), ...parts.map((part) => `only ${part}`)].filter((name) => ['whole', 'before'].includes(name) || name.includes(options.only));
const found = new Map(names.map((name) => [name, { cpu: [], clock: [] }]));
for (let round = 0; round < Number(options.rounds); round++)
  for (const name of names) {
    const where = name === 'before' ? older : page;
    await where.evaluate(([what, count]) => window.run(what, count), [name === 'before' ? 'whole' : name, frames]);
    const before = descendantSeconds();
    const clock = await where.evaluate(() => window.go());
    const one = found.get(name);
    one.clock.push(clock);
    one.cpu.push(((descendantSeconds() - before) * 1000) / frames);
  }
const whole = median(found.get('whole').cpu);
console.log(`${options.model}, ${options.level}: made in ${(await page.evaluate(() => window.built)).toFixed(0)} ms, fewer triangles in ${(await page.evaluate(() => window.slimmed)).toFixed(0)} ms; ${await page.evaluate(() => window.head.triangles)} triangles, ` +
  `${await page.evaluate(() => window.view.renderer.info.render.triangles)} drawn; the reference: ${await page.evaluate(() => window.reference.triangles)}`);
console.log('| | processor, ms | of the whole | clock, ms (least) |\n|---|---|---|---|');
for (const [name, { cpu, clock }] of found)
  console.log(`| ${name} | ${median(cpu).toFixed(1)} | ${((100 * median(cpu)) / whole).toFixed(0)} % | ${median(clock).toFixed(1)} (${Math.min(...clock).toFixed(1)}) |`);
await browser.close();
