// SPDX-License-Identifier: GPL-3.0-or-later
// faccia fit on recordings made from the face itself: the lips of VCV words, in mm, with noise; the pack that comes out speaks.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { build, root } from '../lib/daemon.mjs';
import { parseFap } from '../lib/fapfile.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
after(() => fs.rmSync(folder, { recursive: true }));
const faccia = (args, env = {}) => {
  const { status, stdout, stderr } = spawnSync(path.join(build, 'server/app/faccia'), args, { env: { ...process.env, ...env }, maxBuffer: 1 << 28 });
  return { status, stdout: String(stdout), stderr: String(stderr) };
};
const MNS = 21; // mm, of the Italian pack's speaker

/** Records a word: its phones, and lower lip and jaw at 100 Hz with up to 0.2 mm of noise; silence stands before and behind it. */
function recordWord(word, seed) {
  const name = path.join(folder, word);
  const { status, stderr } = faccia(['say', '--still', '--fps', '100', '--fap', `${name}.fap`, '--json', `${name}.say.json`, `${word}.`]);
  assert.equal(status, 0, stderr);
  const { phones, duration } = JSON.parse(fs.readFileSync(`${name}.say.json`));
  const { frames } = parseFap(fs.readFileSync(`${name}.fap`, 'utf8'));
  let random = seed;
  const noise = () => ((random = (random * 16807) % 2147483647), (random / 2147483647 - 0.5) * 0.4);
  const lead = 0.2;
  const rows = Array.from({ length: 20 }, (_, k) => [k / 100, noise(), noise()]).concat(
    frames.map((f, k) => [lead + k / 100, (-f[5] * MNS) / 1024 + noise(), (f[3] * MNS) / 1024 + noise()]));
  fs.writeFileSync(`${name}.csv`, 'time,LI,EM\n' + rows.map((r) => r.map((v) => v.toFixed(4)).join(',')).join('\n') + '\n');
  fs.writeFileSync(`${name}.phones.csv`, `start,end,ipa\n0,${lead},_\n` + phones.map((p) => `${(lead + p.start).toFixed(4)},${(lead + p.end).toFixed(4)},${p.ipa || '_'}`).join('\n') + '\n');
  assert.ok(duration > 0.2);
  return `${name}.csv`;
}

test('recordings become a pack that loads and speaks', () => {
  const files = ['asa', 'ala', 'ata', 'ana'].map((word, i) => recordWord(word, i + 7));
  const models = path.join(folder, 'models');
  fs.cpSync(path.join(root, 'models/speech'), path.join(models, 'speech'), { recursive: true });
  fs.copyFileSync(path.join(root, 'models/expressions.json'), path.join(models, 'expressions.json'));
  const pack = path.join(models, 'speech/it-x-fitted.json');
  const { status, stdout, stderr } = faccia(['fit', '--compare', '--first', '5', '--then', '10', '--output', pack, ...files]);
  assert.equal(status, 0, stderr);
  const fitted = JSON.parse(fs.readFileSync(pack));
  assert.equal(fitted.inherits, 'it');
  assert.ok(Object.keys(fitted.phones).length >= 4, stdout);
  const said = faccia(['say', '--lang', fitted.tag, 'Ana sala la sala.'], { FACCIA_MODELS: models });
  assert.equal(said.status, 0, said.stderr);
  assert.ok(JSON.parse(said.stdout).phones.length > 8);
});

test('a TextGrid with X-SAMPA, markers for columns, and a recording to test on, in one command', () => {
  const [one, two] = ['apa', 'ala'].map((word, i) => recordWord(word, i + 20));
  for (const file of [one, two]) {
    const name = file.slice(0, -4);
    const lines = fs.readFileSync(file, 'utf8').trim().split('\n').slice(1).map((line) => line.split(',').map(Number));
    fs.writeFileSync(file, 't,ll_z,jaw_z\n' + lines.map(([t, low, jaw]) => [t, 30 - low, 10 - jaw].join(',')).join('\n'));
    const rows = fs.readFileSync(`${name}.phones.csv`, 'utf8').trim().split('\n').slice(1).map((line) => line.split(','));
    fs.rmSync(`${name}.phones.csv`);
    fs.rmSync(`${name}.json`, { force: true });
    const end = rows.at(-1)[1];
    fs.writeFileSync(`${name}.TextGrid`, `File type = "ooTextFile"\nObject class = "TextGrid"\n\n0\n${end}\n<exists>\n1\n"IntervalTier"\n"phones"\n0\n${end}\n${rows.length}\n` +
      rows.map(([from, to, ipa]) => `${from}\n${to}\n"${{ _: '', tʃ: 'tS' }[ipa] ?? ipa}"`).join('\n') + '\n');
  }
  const { status, stdout, stderr } = faccia(['fit', '--first', '2', '--then', '3', '--test', two, one]);
  assert.equal(status, 0, stderr);
  assert.match(stderr, /^LI: unfitted [\d.]+ mm, fitted [\d.]+; held out: unfitted [\d.]+, fitted [\d.]+; strength /m);
  assert.match(stderr, /^EM, test recordings: unfitted [\d.]+ mm, fitted [\d.]+ mm$/m);
  const targets = Object.values(JSON.parse(stdout).phones).flatMap((phone) => Object.values(phone.targets ?? {})).flatMap((contexts) => Object.values(contexts));
  for (const { T } of targets) assert.ok(T >= -3 && T <= 30, `${T} mm is no mouth's`);
});

test('what is wrong with a recording is named', () => {
  const bad = path.join(folder, 'bad.csv');
  fs.writeFileSync(bad, 'time,LI\n0,0\n0.01,x\n');
  fs.writeFileSync(path.join(folder, 'bad.phones.csv'), 'start,end,ipa\n0,0.01,_\n');
  const { status, stderr } = faccia(['fit', bad]);
  assert.equal(status, 1);
  assert.match(stderr, /bad/);
  assert.equal(faccia(['fit', '--strength', '0', bad]).status, 2);
  assert.equal(faccia(['fit']).status, 2);
  assert.equal(faccia(['fit', '--help']).status, 0);
  assert.equal(faccia(['fit', path.join(folder, 'nowhere.csv')]).status, 1);
});
