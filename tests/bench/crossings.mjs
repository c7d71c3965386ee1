// SPDX-License-Identifier: GPL-3.0-or-later
// Intersections of meshes for every sound of every language (contexts and syllables too) in every affect, in both blends, on every head.
// The full search takes hours. --minutes limits the time for each head, and reports how many poses, sampled evenly, were checked.
// FACCIA_BUILD=build node tests/bench/run.mjs crossings [--apart 0.25] [--minutes N] [--affects joy,anger] [HEAD]...
import fs from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { unpack } from '../../models/tools/lib/deform.mjs';
import { EYE_FAPS, MOUTH_FAPS, Sweep } from '../lib/sweep.mjs';
import { apart, BASIC, sweepPoses } from '../lib/sweep-poses.mjs';

const root = fileURLToPath(new URL('../../', import.meta.url));
const built = path.join(process.env.FACCIA_BUILD ?? path.join(root, 'build'), 'models/heads');
const { values: options, positionals } = parseArgs({ options: { apart: { type: 'string', default: '0.25' }, minutes: { type: 'string', default: 'Infinity' }, affects: { type: 'string' } }, allowPositionals: true });
const mm = Number(options.apart);
const STRIDE = 7919; // a prime, because consecutive poses are similar
const names = positionals.length ? positionals : fs.readdirSync(built).filter((file) => file.endsWith('.json')).map((file) => file.slice(0, -5));

const known = Object.keys(JSON.parse(fs.readFileSync(path.join(root, 'models/expressions.json'))).affect);
const affects = options.affects?.split(',') ?? [...BASIC, ...known.filter((name) => !BASIC.includes(name))];
const { mouths, eyes } = sweepPoses([null, ...affects], { blends: ['auto', 'weighted'], prose: true });
console.log(`${mouths.length} mouths, ${eyes.length} pairs of eyes; poses that are at least ${mm} mm apart count.\n`);
console.log('| head | mouths | eyes | looked at | goes through | poses | deepest mm | in |\n|---|---|---|---|---|---|---|---|');
for (const name of names) {
  const head = unpack(JSON.parse(fs.readFileSync(path.join(built, `${name}.json`))));
  const sweep = await Sweep.of(head);
  const [some, others] = [apart(mouths, MOUTH_FAPS, mm, head), apart(eyes, EYE_FAPS, mm, head)];
  const found = new Map();
  const all = [...some.map((one) => [one, (faps) => sweep.mouth(faps)]), ...others.map((one) => [one, (faps) => sweep.eyes(faps)])];
  const stride = all.length % STRIDE ? STRIDE : 1;
  const end = performance.now() + Number(options.minutes) * 60000;
  let looked = 0;
  for (; looked < all.length && performance.now() < end; looked++) {
    const [{ what, faps }, look] = all[(looked * stride) % all.length];
    for (const { pair, mm: deep, at: place } of look(faps)) {
      const row = found.get(pair) ?? found.set(pair, { poses: 0, deep: 0 }).get(pair);
      row.poses++;
      if (deep > row.deep) Object.assign(row, { deep, what, place });
    }
    if (looked % 500 === 0) process.stderr.write(`${name}: ${looked} of ${all.length} poses\n`);
  }
  const counts = `| ${name} | ${some.length} | ${others.length} | ${looked} |`;
  if (!found.size) console.log(`${counts} nothing | 0 | | |`);
  for (const [pair, row] of found)
    console.log(`${counts} ${pair} | ${row.poses} | ${row.deep.toFixed(1)} | ${row.what}, at ${row.place.map((x) => x.toFixed(0)).join(' ')} |`);
}
