// SPDX-License-Identifier: GPL-3.0-or-later
// How fast `faccia film` draws and codes at 640x480: wall time and processor time of a film, beside its length, and the part of it that the start takes. Two builds
// take turns, so that other load affects both.
// Usage: node tests/bench/run.mjs film [--seconds N] [--turns N] [--quality fine] [--against FOLDER] (FOLDER: another build)
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { parseArgs } from 'node:util';
import { faccia } from '../lib/command.mjs';
import { build } from '../lib/daemon.mjs';
import { parseFap } from '../lib/fapfile.mjs';
import { descendantSeconds, median } from './figures.mjs';
import { needPackages } from './need.mjs';
import { prose } from './text.mjs';

const LOOK_MS = 100; // between two readings of the processor time; what the programs use after the last is not counted
const { values: given } = parseArgs({ options: { seconds: { type: 'string', default: '20' }, turns: { type: 'string', default: '3' }, quality: { type: 'string', default: 'fine' }, against: { type: 'string' } } });
needPackages('chromium-headless-shell', 'ffmpeg');

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'film-bench-'));
const at = (name) => path.join(folder, name);
const said = faccia(['say', '--lang', 'it', '--voice', 'espeak:it', '--seed', '1', '--fap', at('long.fap'), '--wav', at('long.wav'), prose(Number(given.seconds))]);
if (said.status) throw new Error(said.stderr);
const { fps, frames } = parseFap(fs.readFileSync(at('long.fap'), 'utf8'));

/** Films the recorded face, or only its first moment. @returns {Promise<{wall: number, cpu: number}>} seconds */
async function film(from, whole) {
  const output = whole ? ['-o', at('film.mp4')] : ['-o', at('film.png'), '--at', '0.2'];
  const begun = performance.now();
  const child = spawn(path.join(from, 'server/cli/faccia'), ['--models', path.join(from, 'models'), '--web', path.join(from, 'web'), 'film', '--from', at('long.fap'), '--audio', at('long.wav'), '--quality', given.quality, ...output], { stdio: 'ignore' });
  let cpu = 0;
  const watch = setInterval(() => (cpu = Math.max(cpu, descendantSeconds())), LOOK_MS);
  const [status] = await once(child, 'exit');
  clearInterval(watch);
  if (status) throw new Error(`faccia film: ${status}`);
  return { wall: (performance.now() - begun) / 1000, cpu };
}

const builds = { 'this build': build, ...(given.against ? { 'the other': path.resolve(given.against) } : {}) };
const runs = Object.fromEntries(Object.keys(builds).map((name) => [name, []]));
for (let turn = 0; turn < Number(given.turns); turn++)
  for (const [name, from] of Object.entries(builds)) runs[name].push({ start: await film(from, false), film: await film(from, true) });
fs.rmSync(folder, { recursive: true });

const seconds = frames.length / fps;
console.log(`${frames.length} pictures, ${seconds.toFixed(1)} s, quality ${given.quality}; medians of ${given.turns}`);
const processor = {};
for (const [name, turns] of Object.entries(runs)) {
  const of = (what, kind) => median(turns.map((turn) => turn[what][kind]));
  processor[name] = of('film', 'cpu');
  const picture = (1000 * (of('film', 'cpu') - of('start', 'cpu'))) / frames.length;
  console.log(`${name}: ${of('film', 'wall').toFixed(1)} s (${(seconds / of('film', 'wall')).toFixed(2)} times real time), ${of('film', 'cpu').toFixed(1)} s of processor; ` +
    `start ${of('start', 'cpu').toFixed(1)} s of processor, each picture ${picture.toFixed(1)} ms`);
}
if (given.against) console.log(`processor time of this build / the other: ${median(runs['this build'].map((turn, i) => turn.film.cpu / runs['the other'][i].film.cpu)).toFixed(2)}`);
