// SPDX-License-Identifier: GPL-3.0-or-later
// Recovery of individual movements from pictures of poses. A head (luca) gets individual movements unknown to the tools and is drawn at rest and in six poses;
// `make-portrait.mjs` makes a head from these on another one (--like, mara), with and without --poses. Measures how differently their skin moves from the
// original, in shown and in other poses. node tests/bench/run.mjs poses [HEAD] [--like HEAD] [--only POSE[,POSE]...]; build/poses contains the pictures.
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { unpack } from '../../models/tools/lib/deform.mjs';
import { openEye } from '../../models/tools/portrait/eye.mjs';
import { flat } from '../../models/tools/portrait/images.mjs';
import { film, headOf, sway } from '../lib/film.mjs';
import { othersOf, otherwise, posesOf, samePlaces, withHabits } from '../lib/habits.mjs';

const root = fileURLToPath(new URL('../../', import.meta.url));
const { values: { like, only }, positionals: [name = 'luca'] } = parseArgs({ allowPositionals: true, options: { like: { type: 'string', default: 'mara' }, only: { type: 'string' } } });
const folder = path.join(root, 'build/poses', name);
const truth = withHabits(headOf(name));
const poses = Object.fromEntries(Object.entries(posesOf()).filter(([pose]) => !only || only.split(',').includes(pose)));
await film(truth, [{}, ...Object.values(poses).map((faps, i) => ({ ...faps, ...sway(i) }))], path.join(folder, 'drawn'), { height: 600 });
fs.mkdirSync(path.join(folder, 'poses'), { recursive: true });
Object.keys(poses).forEach((pose, i) => fs.copyFileSync(path.join(folder, 'drawn', `000${i + 2}.png`), path.join(folder, 'poses', `${pose}.png`)));
const front = path.join(folder, 'drawn/0001.png');
const make = (out, more) => {
  const before = Date.now();
  const { status, stdout, stderr } = spawnSync('node', [path.join(root, 'models/tools/portrait/make-portrait.mjs'), front, '-o', path.join(folder, out), '--like', like, ...more], { encoding: 'utf8' });
  if (status) throw new Error(stderr);
  console.log(`${stdout.trim().split('\n').join('\n')} (${((Date.now() - before) / 1000).toFixed(0)} s)`);
  return unpack(JSON.parse(fs.readFileSync(path.join(folder, out), 'utf8')));
};
const base = make('base.json', []);
const own = make('own.json', ['--poses', path.join(folder, 'poses')]);

const table = JSON.parse(fs.readFileSync(path.join(root, 'build/web/face-points.json'), 'utf8'));
const places = samePlaces(own, truth, table[like], table[name], await (await openEye())(await flat(front)));
for (const [what, list] of [['shown', poses], ['not shown', othersOf(truth)]]) {
  const all = Object.entries(list).map(([pose, faps]) => [pose, otherwise(base, truth, faps, places), otherwise(own, truth, faps, places)]);
  for (const [pose, was, is] of all) console.log(`${what}: ${pose.padEnd(20)} moves by ${is.moved.toFixed(2)} mm (rms of ${places.length} places); the base's actions are off by ${was.rms.toFixed(2)}, its own by ${is.rms.toFixed(2)}`);
  const mean = (k) => Math.sqrt(all.reduce((sum, one) => sum + one[k].rms ** 2, 0) / all.length).toFixed(2);
  console.log(`${what}, all: ${mean(1)} and ${mean(2)} mm`);
}
