// SPDX-License-Identifier: GPL-3.0-or-later
// Do the lips of a film come back? A head of ours speaks sentences with another's habits (vowels half as wide open again, rounder); pictures of it
// are watched by `faccia head lips`, the curves compared with the FAPs that were played, and a pack is fitted to them: does it foretell other sentences, as
// the film shows them, and as they were played?
// With --markers eight markers on the face take the place of the film.
// node tests/bench/seen-lips.mjs [HEAD] [--fps N] [--markers]; pictures are kept in build/seen-lips.
import { execFileSync, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { PARAMETERS } from '../../models/tools/lips/articulation.mjs';
import { pose } from '../../models/tools/lib/deform.mjs';
import { film, headOf, sway } from '../lib/film.mjs';
import { parseFap } from '../lib/fapfile.mjs';

const root = fileURLToPath(new URL('../../', import.meta.url));
const args = process.argv.slice(2);
const fps = args.includes('--fps') ? Number(args.splice(args.indexOf('--fps'), 2)[1]) : 25;
const marked = args.includes('--markers') && args.splice(args.indexOf('--markers'), 1).length > 0;
const [name = 'samuel'] = args;
const folder = path.join(root, 'build/seen-lips', `${name}-${fps}${marked ? '-markers' : ''}`);
const models = path.join(folder, 'models');
const faccia = path.join(root, 'build/server/app/faccia');
const env = { ...process.env, FACCIA_MODELS: models };
const SENTENCES = ['La barca scivola sul mare.', 'Una nuvola bianca passa piano.', 'Due gatti dormono sopra la sedia.', 'Sul prato fiorisce una rosa.'];
const FITTED = 2; // the first of them; the others are to be foretold
const REST = 0.3; // s before and behind, in which the mouth is still

fs.mkdirSync(models, { recursive: true });
fs.cpSync(path.join(root, 'models/speech'), path.join(models, 'speech'), { recursive: true });
fs.copyFileSync(path.join(root, 'models/expressions.json'), path.join(models, 'expressions.json'));

function writeSpeaker() {
  const { groups, phones } = JSON.parse(fs.readFileSync(path.join(root, 'models/speech/it.json'), 'utf8'));
  const pack = { tag: 'it-x-true', name: 'vero', inherits: 'it', sources: ['a bench'], voices: ['espeak:it'], abbreviations: [], phones: {} };
  for (const [ipa, { sampa, group }] of Object.entries(phones))
    if (group) pack.phones[ipa] = { sampa, like: ipa, ...(groups[group].kind === 'vowel' ? { gain: { LI: 1.5 } } : { shift: { AR: -2 } }) };
  fs.writeFileSync(path.join(models, 'speech/it-x-true.json'), JSON.stringify(pack));
}

/** The frames of a sentence, and its phones beside the curves that will be. */
function speak(text, n) {
  const base = path.join(folder, `s${n}`);
  execFileSync(faccia, ['say', '--still', '--lang', 'it-x-true', '--fps', String(fps), '--fap', `${base}.fap`, '--json', `${base}.say.json`, text], { env });
  const { phones } = JSON.parse(fs.readFileSync(`${base}.say.json`, 'utf8'));
  const { frames } = parseFap(fs.readFileSync(`${base}.fap`, 'utf8'));
  const still = Array.from({ length: Math.round(REST * fps) }, () => Array(69).fill(0));
  const lead = still.length / fps;
  const all = [...still, ...frames, ...still].map((frame, i) => ({ ...frame, ...sway(i / fps) }));
  const end = lead + phones.at(-1).end;
  const lines = phones.map((p) => `${(lead + p.start).toFixed(4)},${(lead + p.end).toFixed(4)},${p.ipa ? (p.stress === 2 ? 'ˈ' : '') + p.ipa : '_'}`);
  fs.writeFileSync(`${base}.phones.csv`, `start,end,ipa\n0,${lead.toFixed(4)},_\n${lines.join('\n')}\n${end.toFixed(4)},${(all.length / fps).toFixed(4)},_\n`);
  return { base, frames: all };
}

const told = (head, f) => {
  const [mns, mw] = [head.fapu.MNS / 1024, head.fapu.MW / 1024];
  return [-f[5] * mns, -f[4] * mns, (f[6] + f[7]) * mw, f[16] * mns, f[17] * mns, f[3] * mns];
};

function compare(head, takes, plain) {
  const sums = new Map();
  for (const { base, frames } of takes) {
    const [names, ...rows] = fs.readFileSync(`${base}${plain ? '.plain' : ''}.csv`, 'utf8').trim().split('\n').map((line) => line.split(','));
    for (const [p, parameter] of PARAMETERS.entries()) {
      const column = names.indexOf(parameter);
      if (column < 0) continue;
      const pairs = rows.map((row) => [Number(row[column]), told(head, frames[Math.round(row[0] * fps)])[p]]);
      const off = pairs.reduce((sum, [a, b]) => sum + a - b, 0) / pairs.length; // where rest is, is one number
      const list = sums.get(parameter) ?? sums.set(parameter, []).get(parameter);
      list.push(...pairs.map(([a, b]) => [a - off, b]));
    }
  }
  for (const [parameter, pairs] of sums) {
    const rms = Math.sqrt(pairs.reduce((sum, [a, b]) => sum + (a - b) ** 2, 0) / pairs.length);
    const mean = pairs.reduce((sum, [, b]) => sum + b, 0) / pairs.length;
    const [sa, sb] = [0, 1].map((k) => Math.sqrt(pairs.reduce((sum, pair) => sum + (pair[k] - mean) ** 2, 0) / pairs.length));
    const correlation = pairs.reduce((sum, [a, b]) => sum + (a - mean) * (b - mean), 0) / pairs.length / sa / sb;
    const within = pairs.filter(([a, b]) => Math.abs(a - b) <= 0.3).length / pairs.length;
    console.log(`${plain ? 'landmarks as they are, ' : ''}${parameter}: ${rms.toFixed(2)} mm rms of ${sb.toFixed(2)}, correlation ${correlation.toFixed(2)}, ${Math.round(100 * within)} % within 0.3 mm`);
  }
}

const POINTS = ['9.3', '8.1', '8.3', '8.4', '8.2', '2.1', '10.5', '10.6']; // in the order of the thesis

/** Tracks of eight markers on the face, mm. */
function track(head, frames, file) {
  const skin = head.parts.find(({ name: part }) => part === 'skin');
  const distance = (v, p) => Math.hypot(...p.map((x, k) => x - skin.position[3 * v + k]));
  const vertices = POINTS.map((point) => {
    let best = 0;
    for (let v = 1; v < skin.position.length / 3; v++) if (distance(v, head.fdp[point]) < distance(best, head.fdp[point])) best = v;
    return best;
  });
  const rows = frames.map((faps, i) => {
    const now = pose(head, skin, faps);
    return [i / fps, ...vertices.flatMap((v) => [...now.slice(3 * v, 3 * v + 3)])].map((x) => x.toFixed(4)).join(',');
  });
  fs.writeFileSync(file, `${rows.join('\n')}\n`);
}

/** Degrees by which the plane of nose and ears falls. */
function tiltOf({ fdp }) {
  const [nose, left, right] = ['9.3', '10.5', '10.6'].map((point) => fdp[point]);
  return (Math.atan2((left[1] + right[1]) / 2 - nose[1], nose[2] - (left[2] + right[2]) / 2) * 180) / Math.PI;
}

const head = headOf(name);
writeSpeaker();
const takes = [];
for (const [n, text] of SENTENCES.entries()) {
  const take = speak(text, n);
  takes.push(take);
  if (marked) track(head, take.frames, path.join(folder, `film${n}.csv`));
  else await film(head, take.frames, path.join(folder, `film${n}`), { tell: (i) => i % 25 || console.error(`${text} ${i} of ${take.frames.length}`) });
}
for (const [n, { base }] of takes.entries())
  for (const plain of marked ? [false] : [false, true]) {
    const source = marked ? [path.join(folder, `film${n}.csv`), `--tilt=${tiltOf(head)}`] : [path.join(folder, `film${n}`), '--fps', String(fps)];
    const { status, stderr } = spawnSync('node', [path.join(root, 'models/tools/lips/faccia-lips.mjs'), ...source, '-o', `${base}${plain ? '.plain' : ''}.csv`, ...(plain ? ['--plain'] : [])], { encoding: 'utf8' });
    if (status) throw new Error(stderr);
  }
console.log(`${name}, ${fps} pictures a second, ${takes.reduce((sum, { frames }) => sum + frames.length, 0)} of them`);
compare(head, takes, false);
if (!marked) compare(head, takes, true);
for (const { base, frames } of takes) {
  const rows = frames.map((frame, i) => [(i / fps).toFixed(4), ...told(head, frame).map((x) => x.toFixed(4))].join(','));
  fs.writeFileSync(`${base}.true.csv`, `time,${PARAMETERS.join(',')}\n${rows.join('\n')}\n`);
  fs.copyFileSync(`${base}.phones.csv`, `${base}.true.phones.csv`);
}
for (const [what, ending] of [['as the film shows them', '.csv'], ['as they were played', '.true.csv']]) {
  const tests = takes.slice(FITTED).flatMap(({ base }) => ['--test', `${base}${ending}`]);
  const { stderr, status } = spawnSync(faccia, ['fit', '--output', path.join(models, 'speech/it-x-fitted.json'), ...tests, ...takes.slice(0, FITTED).map(({ base }) => `${base}.csv`)], { env, encoding: 'utf8' });
  if (status) throw new Error(stderr);
  console.log(`${what}:\n${stderr.split('\n').filter((line) => /test recordings/.test(line)).join('\n')}`);
}
