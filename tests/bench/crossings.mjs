// SPDX-License-Identifier: GPL-3.0-or-later
// Every sound of every language (contexts and syllables, too) in every affect, spoken in both blends, on every head: what goes through what.
// FACCIA_BUILD=build node tests/bench/crossings.mjs [--apart MM] [HEAD]...
import fs from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { unpack } from '../../models/tools/lib/deform.mjs';
import { EYE_FAPS, MOUTH_FAPS, Sweep } from '../lib/sweep.mjs';
import { apart, BASIC, sweepPoses } from '../lib/sweep-poses.mjs';

const root = fileURLToPath(new URL('../../', import.meta.url));
const built = path.join(process.env.FACCIA_BUILD ?? path.join(root, 'build'), 'models/heads');
const args = process.argv.slice(2);
const at = args.indexOf('--apart');
const mm = at < 0 ? 0.25 : Number(args.splice(at, 2)[1]);
const names = args.length ? args : fs.readdirSync(built).filter((file) => file.endsWith('.json')).map((file) => file.slice(0, -5));

const affects = Object.keys(JSON.parse(fs.readFileSync(path.join(root, 'models/expressions.json'))).affect);
const { mouths, eyes } = sweepPoses([null, ...BASIC, ...affects.filter((name) => !BASIC.includes(name))], { blends: ['auto', 'weighted'], prose: true });
console.log(`${mouths.length} mouths, ${eyes.length} pairs of eyes; poses that are at least ${mm} mm apart count.\n`);
console.log('| head | mouths | eyes | goes through | poses | deepest mm | in |\n|---|---|---|---|---|---|---|');
for (const name of names) {
  const head = unpack(JSON.parse(fs.readFileSync(path.join(built, `${name}.json`))));
  const sweep = await Sweep.of(head);
  const [some, others] = [apart(mouths, MOUTH_FAPS, mm, head), apart(eyes, EYE_FAPS, mm, head)];
  const found = new Map();
  for (const [poses, look] of [[some, (faps) => sweep.mouth(faps)], [others, (faps) => sweep.eyes(faps)]])
    for (const { what, faps } of poses)
      for (const { pair, mm: deep, at: place } of look(faps)) {
        const row = found.get(pair) ?? found.set(pair, { poses: 0, deep: 0 }).get(pair);
        row.poses++;
        if (deep > row.deep) Object.assign(row, { deep, what, place });
      }
  const counts = `| ${name} | ${some.length} | ${others.length} |`;
  if (!found.size) console.log(`${counts} nothing | 0 | | |`);
  for (const [pair, row] of found)
    console.log(`${counts} ${pair} | ${row.poses} | ${row.deep.toFixed(1)} | ${row.what}, at ${row.place.map((x) => x.toFixed(0)).join(' ')} |`);
}
