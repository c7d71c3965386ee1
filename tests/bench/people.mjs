// SPDX-License-Identifier: GPL-3.0-or-later
// Accuracy of the engines against people: node tests/bench/run.mjs people LANG CURVES TIMES [CURVES TIMES]...
// Prints a Markdown table of correlation and error per parameter, averaged over the recordings. The last line compares recordings of the same sentence
// with each other. With two or more recordings, also fits a pack to each and measures it on the others.
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { build, root } from '../lib/daemon.mjs';

const [lang, ...files] = process.argv.slice(2);
const people = Array.from({ length: files.length / 2 }, (_, i) => ({ curves: files[2 * i], times: files[2 * i + 1] }));
if (!people.length || files.length % 2) throw new Error('usage: people.mjs LANG CURVES TIMES [CURVES TIMES]...');
const faccia = (args, env = {}) => {
  const { status, stdout, stderr } = spawnSync(path.join(build, 'server/cli/faccia'), args, { env: { ...process.env, ...env }, maxBuffer: 1 << 28 });
  if (status !== 0) throw new Error(`faccia ${args.join(' ')}: ${stderr}`);
  return { stdout: String(stdout), stderr: String(stderr) };
};
const HEADS = { aperture: 'lip aperture', LI: 'lower lip', LS: 'upper lip', AR: 'width', PI: 'lower protrusion', PS: 'upper protrusion', EM: 'jaw', TH: 'tip height', TA: 'tip advance', TB: 'body height' };
const recording = ({ curves, times }) => ['--recording', curves, '--phones', times];
const other = (one) => people.filter((p) => p !== one).slice(0, 1).flatMap(({ curves, times }) => ['--other', curves, '--other-phones', times]);

function table(rows, title) {
  const names = Object.keys(HEADS).filter((name) => rows.some((row) => row[name]));
  console.log(`\n| ${title} | ${names.map((name) => HEADS[name]).join(' | ')} | reader |\n|---|${names.map(() => '---|').join('')}---|`);
  for (const row of rows)
    console.log(`| ${row.engine}${row.contacts ? (row.contacts === 'on' ? ', contacts' : ', no contacts') : ''} | ` +
      `${names.map((name) => (row[name] ? `${row[name].r.toFixed(2)} / ${row[name].rms.toFixed(2)}` : '')).join(' | ')} | ${row.reader.right} of ${row.reader.read} |`);
}

const sameText = people.length > 1;
for (const shift of [0, -30]) {
  const all = people.flatMap((one) => [...recording(one), ...(sameText ? other(one) : [])]);
  const report = JSON.parse(faccia(['eval', '--lang', lang, '--ablation', '--shift', String(shift), '--json', '-', ...all]).stdout);
  table(report.rows, `correlation / RMS mm${shift ? `, predictions ${-shift} ms earlier` : ''}`);
}
if (people.length > 1) {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-people-'));
  const models = path.join(folder, 'models');
  fs.cpSync(path.join(root, 'models/speech'), path.join(models, 'speech'), { recursive: true });
  for (const [i, one] of people.entries()) {
    const copy = (p, name) => {
      fs.copyFileSync(p.curves, path.join(folder, `${name}.csv`));
      const ending = path.extname(p.times) === '.csv' ? '.phones.csv' : path.extname(p.times);
      fs.copyFileSync(p.times, path.join(folder, `${name}${ending}`));
      return path.join(folder, `${name}.csv`);
    };
    const tests = people.filter((p) => p !== one).flatMap((p, k) => ['--test', copy(p, `test${i}-${k}`)]);
    const said = faccia(['fit', '--base', lang, '--compare', '--tag', `${lang}-x-${i}`, ...tests, '--output', path.join(models, `speech/${lang}-x-${i}.json`), copy(one, `fit${i}`)]).stderr;
    console.log(`\nFitted to recording ${i + 1}:\n\n${said.replace(/^.*iteration.*\n/gm, '')}`);
    const rest = people.filter((p) => p !== one).flatMap(recording);
    const before = JSON.parse(faccia(['eval', '--lang', lang, '-e', 'dominance', '--json', '-', ...rest], { FACCIA_MODELS: models }).stdout);
    const after = JSON.parse(faccia(['eval', '--lang', `${lang}-x-${i}`, '-e', 'dominance', '--json', '-', ...rest], { FACCIA_MODELS: models }).stdout);
    table([{ ...before.rows[0], engine: 'unfitted' }, { ...after.rows[0], engine: 'fitted' }], 'on the other recordings');
  }
  fs.rmSync(folder, { recursive: true });
}
