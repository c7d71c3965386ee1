// SPDX-License-Identifier: GPL-3.0-or-later
// Compares what a graphics card draws with what software draws: see run.sh.
import fs from 'node:fs';
import path from 'node:path';
import { PNG } from 'pngjs';
import { framed } from '../../web/element/head/framing.mjs';
import { LEVELS } from '../../web/element/head/quality.mjs';
import { launch } from '../lib/browser.mjs';
import { heads as models } from '../lib/built-heads.mjs';
import { artefacts } from '../lib/daemon.mjs';
import { headPage } from '../lib/head-page.mjs';

const SIZE = { width: 640, height: 480 };
const MEAN = 2.5; // of 255: edges are smoothed by samples on a card, after drawing in software
const CLEAR = 60; // of 255: a clear difference of a pixel
const SHARE = 0.02; // of the head's pixels that may differ clearly
const DRAWN = 0.1; // of the picture that a head covers at least
const POSE = { 3: 200, 5: -200, 10: -200, 11: -200, 12: 150, 13: 150, 19: 200, 20: 200, 31: 80, 32: 80, 48: 4000, 49: 9000 };
const SOFTWARE = /swiftshader|llvmpipe|softpipe|software|basic render/i;

const args = process.argv.slice(2);
const pretend = args[0] === '--software';
const wanted = args.slice(pretend ? 1 : 0);
const names = wanted.length ? wanted : fs.readdirSync(models).filter((file) => /^\w+\.json$/.test(file)).map((file) => file.slice(0, -5));
const out = path.join(artefacts, 'gpu');

/** The name of what draws a page's WebGL; null: nothing does. */
const renderer = ({ page }) =>
  page.evaluate(() => {
    const gl = document.createElement('canvas').getContext('webgl2');
    return gl && gl.getParameter(gl.getExtension('WEBGL_debug_renderer_info')?.UNMASKED_RENDERER_WEBGL ?? gl.RENDERER);
  });

/** Starts a browser on the card. Where Chromium does not start so, there is none. */
async function cardPage() {
  if (pretend) return [await launch({ forced: true })];
  try {
    return [await launch({ card: true })];
  } catch (error) {
    return [null, error.message.split('\n')[0]];
  }
}

function compare(one, other) {
  let [sum, clear, drawn] = [0, 0, 0];
  for (let i = 0; i < one.data.length; i += 4) {
    if (!one.data[i + 3] && !other.data[i + 3]) continue;
    const apart = [0, 1, 2, 3].map((c) => Math.abs(one.data[i + c] - other.data[i + c]));
    drawn++;
    sum += (apart[0] + apart[1] + apart[2] + apart[3]) / 4;
    clear += Math.max(...apart) > CLEAR;
  }
  return { drawn, mean: sum / Math.max(1, drawn), share: clear / Math.max(1, drawn) };
}

const [card, why] = await cardPage();
const found = card && (await headPage(card));
const named = found && (await renderer(found));
if (!found || !named || (!pretend && SOFTWARE.test(named))) {
  await card?.close();
  console.log(`skipped: no graphics card draws here (${named ?? why ?? 'no WebGL 2'})`);
  process.exit(0);
}
console.log(`compares ${named} with software`);
const software = await launch({ forced: false });
const plain = await headPage(software);
let wrong = 0;
for (const name of names) {
  const head = JSON.parse(fs.readFileSync(path.join(models, `${name}.json`)));
  for (const page of [found, plain]) await page.load(name, head);
  for (const { name: level } of LEVELS) {
    const camera = { ...framed(head, null, SIZE.width / SIZE.height), ...SIZE, level };
    const shots = [];
    for (const page of [found, plain]) shots.push(await page.shot(name, POSE, camera));
    const pictures = shots.map((bytes) => PNG.sync.read(bytes));
    const least = DRAWN * pictures[0].width * pictures[0].height;
    const { drawn, mean, share } = compare(...pictures);
    const fits = drawn > least && mean < MEAN && share < SHARE;
    console.log(`${fits ? 'ok' : 'not ok'} - ${name}, ${level}: ${mean.toFixed(2)} of 255 apart, ${(100 * share).toFixed(2)} % of ${drawn} pixels clearly`);
    if (fits) continue;
    wrong++;
    fs.mkdirSync(out, { recursive: true });
    shots.forEach((bytes, i) => fs.writeFileSync(path.join(out, `${name}-${level}-${i ? 'software' : 'card'}.png`), bytes));
  }
}
for (const problem of [found, plain].flatMap(({ page }) => page.problems)) {
  console.log(`not ok - ${problem}`);
  wrong++;
}
await card.close();
await software.close();
console.log(wrong ? `${wrong} differ: ${out}` : 'all alike');
process.exit(wrong ? 1 : 0);
