// SPDX-License-Identifier: GPL-3.0-or-later
// From a film to a pack in one command: which programs run, in what order and with what. Tracks of markers stand in for the film; ffmpeg and faccia only
// write down how they were called.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { faccia } from '../lib/command.mjs';
import { root } from '../lib/daemon.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
after(() => fs.rmSync(folder, { recursive: true }));
const at = (name) => path.join(folder, name);
const program = (name, body) => fs.writeFileSync(at(name), `#!/bin/sh\nprintf '%s ' ${name} "$@" >> ${at('calls')}; echo >> ${at('calls')}\n${body}\n`, { mode: 0o755 });
program('ffmpeg', 'exit 0');
program('faccia', 'case " $* " in *" broken "*) echo "it broke" >&2; exit 1;; esac');
const MARKERS = { nose: [0, 40, 20], upperLip: [0, 8, 15], leftCorner: [25, 0, 5], rightCorner: [-25, 0, 5], lowerLip: [0, -8, 13], chin: [0, -35, 8], leftEar: [70, 40, -80], rightEar: [-70, 40, -80] };
const film = (name, seconds = 0.5) => {
  const names = Object.keys(MARKERS);
  const rows = Array.from({ length: seconds * 100 }, (_, k) => [k / 100, ...names.flatMap((n) => MARKERS[n].map((v, axis) => (n === 'lowerLip' && axis === 1 ? v - (k > 30 ? 4 : 0) : v)))].join(','));
  fs.writeFileSync(at(name), [['time', ...names.flatMap((n) => ['x', 'y', 'z'].map((a) => `${n}_${a}`))].join(','), ...rows].join('\n') + '\n');
  return at(name);
};
const run = (...args) => {
  fs.rmSync(at('calls'), { force: true });
  const { status, stdout, stderr } = spawnSync(process.execPath, [path.join(root, 'models/tools/lips/faccia-speaker.mjs'), '--faccia', at('faccia'), ...args], { env: { ...process.env, PATH: `${folder}:${process.env.PATH}` } });
  const calls = fs.existsSync(at('calls')) ? fs.readFileSync(at('calls'), 'utf8').trim().split('\n') : [];
  return { status, stdout: `${stdout}`, stderr: `${stderr}`, calls };
};

test('aligns, tracks, compares and fits one film', () => {
  const kept = at('kept');
  const { status, stderr, calls } = run(film('her.csv'), '--text', 'Papà beve.', '--lang', 'it', '--tag', 'it-x-her', '--keep', kept, '-o', at('her.json'));
  assert.equal(status, 0, stderr);
  assert.deepEqual(calls.map((c) => c.split(' ').slice(0, 2).join(' ').replace(/ -v/, '')), ['ffmpeg', 'faccia align', 'faccia eval', 'faccia fit']);
  const file = (ending) => path.join(kept, `1-her.${ending}`);
  assert.match(calls[1], new RegExp(`--lang it .*--text ${file('txt')} --json ${file('json')} ${file('wav')}`));
  assert.match(calls[2], new RegExp(`--recording ${file('csv')} --phones ${file('json')}`));
  assert.match(calls[3], new RegExp(`--rest --own --base it --tag it-x-her --output ${at('her.json')} ${file('csv')}`));
  assert.equal(fs.readFileSync(file('txt'), 'utf8'), 'Papà beve.');
  const rows = fs.readFileSync(file('csv'), 'utf8').trim().split('\n').map((line) => line.split(','));
  assert.ok(Math.abs(Number(rows.at(-1)[rows[0].indexOf('LI')]) - 4) < 0.3, 'the lower lip went down by 4 mm');
});

test('takes the words of several films from adjacent files, and requires an output file for fitting', () => {
  fs.writeFileSync(at('a.txt'), 'Uno.');
  fs.writeFileSync(at('b.txt'), 'Due.');
  const { status, stderr, calls } = run(film('a.csv'), film('b.csv'));
  assert.equal(status, 0, stderr);
  assert.equal(calls.filter((c) => c.startsWith('faccia align')).length, 2);
  assert.equal(calls.at(-1).match(/--recording/g).length, 2);
  assert.ok(!calls.some((c) => c.startsWith('faccia fit')));
});

test('reports missing files and failing steps', () => {
  for (const [args, code, message] of [
    [[], 2, /a film is wanted/],
    [[film('mute.csv')], 2, /mute\.csv: its words are wanted/],
    [[film('a.csv'), film('b.csv'), '--text', 'x'], 2, /--text is of one film/],
    [[at('none.mp4'), '--text', 'x'], 1, /none\.mp4: no such file/],
    [[film('a.csv'), '--lang', 'broken'], 1, /it broke\nfaccia speaker: faccia failed/],
    [['--wrong'], 2, /wrong/],
  ]) {
    const { status, stderr } = run(...args);
    assert.match(stderr, message);
    assert.equal(status, code, args.join(' '));
  }
  assert.match(run('--help').stdout, /Usage/);
});

/** Runs the command, with the tools of the sources. */
const command = (...args) => {
  fs.rmSync(at('calls'), { force: true });
  const result = faccia(['--models', path.join(root, 'models'), ...args], { env: { PATH: `${folder}:${process.env.PATH}` } });
  return { ...result, calls: fs.existsSync(at('calls')) ? fs.readFileSync(at('calls'), 'utf8').trim().split('\n') : [] };
};

test('eval --film compares with the options of eval, and fits nothing', () => {
  const { status, stderr, calls } = command('eval', '--film', film('her.csv'), '--text', 'Papà beve.', '--engine', 'table', '--engine', 'dominance', '--contacts', 'both', '--shift', '20', '--json', at('her.figures'), '--faccia', at('faccia'));
  assert.equal(status, 0, stderr);
  const models = `faccia --models ${path.join(root, 'models')}`;
  assert.deepEqual(calls.map((c) => c.replace(/ (-v|--certain|--lang) .*/, '')), ['ffmpeg', `${models} align`, `${models} eval`]);
  assert.match(calls[2], new RegExp(`eval --lang it --contacts both --shift 20 --json ${at('her.figures')} --engine table --engine dominance --recording .*1-her.csv --phones .*1-her.json`));
});

test('faccia speaker is the same program, and starts the calling faccia, with its models', () => {
  const { status, stderr, calls } = command('speaker', film('her.csv'), '-t', 'Papà beve.', '-o', at('new.json'));
  assert.equal(status, 1);
  assert.deepEqual(calls.map((c) => c.split(' ')[0]), ['ffmpeg'], 'the stand-in for faccia was not called');
  assert.match(stderr, /1-her\.wav: .*\nfaccia speaker: faccia failed/, 'no sound came out of the stand-in for ffmpeg');
  assert.ok(!fs.existsSync(at('new.json')));
});

test('the command reports wrong arguments', () => {
  for (const [args, message] of [
    [['speaker'], /a film is wanted\nTry 'faccia speaker --help'/],
    [['eval', '--film'], /--film/],
    [['eval', '--film', film('a.csv'), 'Ciao.'], /unexpected 'Ciao\.'/],
    [['eval', '--film', film('a.csv'), '-o', at('pack.json')], /--film: nothing is fitted to it/],
  ]) {
    const { status, stderr } = command(...args);
    assert.match(stderr, message);
    assert.equal(status, 2);
  }
  assert.match(command('speaker', '--help').stdout, /^Usage: faccia speaker /);
  assert.match(command('eval', '--help').stdout, /--film FILM --text WORDS/);
  const none = faccia(['--models', folder, 'speaker', 'a.mp4']);
  assert.match(none.stderr, /tools\/lips\/faccia-speaker\.mjs: No such file/);
  assert.equal(none.status, 1);
});
