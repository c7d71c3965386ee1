// SPDX-License-Identifier: GPL-3.0-or-later
// Tables of visible teeth and tongue in each sound of each language on every head, with requirements:
// FACCIA_BUILD=build node tests/bench/run.mjs teeth [--all] [HEAD]...; --all: sound by sound
import fs from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { launch } from '../lib/browser.mjs';
import { headPage } from '../lib/head-page.mjs';
import { expressionPose, LANGUAGES, soundPoses } from '../lib/mouth-poses.mjs';
import { heading, misses, MUST, paint, row, seenIn } from '../lib/mouth-seen.mjs';

const root = fileURLToPath(new URL('../../', import.meta.url));
const built = path.join(process.env.FACCIA_BUILD ?? path.join(root, 'build'), 'models/heads');
const heads = fs.readdirSync(built).filter((file) => file.endsWith('.json')).map((file) => JSON.parse(fs.readFileSync(path.join(built, file))));
const all = process.argv.includes('--all');
const names = process.argv.slice(2).filter((name) => name !== '--all');
const wanted = heads.filter(({ name }) => !names.length || names.includes(name)).sort((a, b) => a.rank - b.rank);
const UNITS = { area: 'mm²', white: 'mm²', width: 'mm', height: 'mm', flat: '' };
const limits = ([what, least, most]) =>
  what in UNITS ? `${what} ${least} to ${most} ${UNITS[what]}`.trim() : `${what} ${Math.round(100 * least)} to ${Math.round(100 * most)} %`;

/** Formats minimum and maximum. */
const range = (list, unit = '') => {
  const [low, high] = [Math.min(...list), Math.max(...list)].map((x) => Math.round(unit ? 100 * x : x));
  return `${low === high ? low : `${low} to ${high}`}${unit}`;
};

const sounds = Object.keys(LANGUAGES).map((lang) => [lang, soundPoses(lang)]);
const emotions = Object.fromEntries(['joy', 'fear', 'surprise'].map((name) => [name, expressionPose(`${name}=1`)]));
const browser = await launch();
const page = await headPage(browser);
for (const head of wanted) {
  await page.load(head.name, head, paint);
  const [wrong, rows, found] = [[], [], []];
  for (const [lang, poses] of [...sounds, ['', emotions]]) {
    const them = await seenIn(page, head.name, head, Object.values(poses));
    for (const [i, name] of Object.keys(poses).entries()) {
      const one = them[i];
      found.push([name, one]);
      rows.push(row(`${lang} ${name}`.trim(), one));
      wrong.push(...misses(name, one, head.mouth).map((miss) => `${lang} ${miss}`.trim()));
    }
  }
  console.log(`\n${head.title}\n\n| | mm² | upper teeth | lower teeth | tongue | dark | must be | why |\n|---|---|---|---|---|---|---|---|`);
  for (const { of, why, must } of MUST) {
    const some = found.filter(([name]) => of.includes(name)).map(([, one]) => one);
    const shares = ['upper', 'lower', 'tongue', 'dark'].map((part) => range(some.map((one) => one[part]), ' %'));
    console.log(`| ${of.join(' ')} | ${range(some.map(({ area }) => area))} | ${shares.join(' | ')} | ${must.map(limits).join(', ')} | ${why} |`);
  }
  if (all) console.log(`\n${heading}\n${rows.join('\n')}`);
  console.log(`\n${head.title}: ${wrong.length ? `${wrong.length} misses\n- ${wrong.join('\n- ')}` : 'all as it must be'}`);
}
await browser.close();
