// SPDX-License-Identifier: GPL-3.0-or-later
// Output files of the commands: written completely or not at all, and never over anything but a regular file.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { once } from 'node:events';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { build } from '../../lib/daemon.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-files-'));
after(() => fs.rmSync(folder, { recursive: true }));
let count = 0;
const fresh = () => {
  const own = path.join(folder, String(count++));
  fs.mkdirSync(own);
  return (name) => path.join(own, name);
};
const program = path.join(build, 'server/cli/faccia');
const faccia = (args, env = {}) => spawnSync(program, args, { encoding: 'utf8', env: { ...process.env, ...env } });

// a voice whose program fails on sentences with "guasto"
const script = path.join(folder, 'voice');
fs.writeFileSync(script, '#!/bin/sh\ncase "$1" in *guasto*) exit 1 ;; esac\nexec espeak-ng -v it --stdout -- "$1"\n', { mode: 0o755 });
const config = path.join(folder, 'voices.json');
fs.writeFileSync(config, JSON.stringify({ command: { voices: [{ id: 'v', lang: 'it', argv: [script, '{text}'] }] } }));
const say = (...args) => faccia(['say', '-l', 'it', '-v', 'command:v', ...args], { FACCIA_VOICE_CONFIG: config });
const kinds = ['wav', 'fap', 'fapc', 'ogg', 'ndjson', 'json', 'arkit', 'arkit-ndjson', 'visemes', 'marks', 'vtt', 'textgrid', 'bundle'];

test('a failing speech leaves no file, and keeps an earlier one', () => {
  const at = fresh();
  fs.writeFileSync(at('a.wav'), 'what was there');
  const { status, stderr } = say(...kinds.flatMap((kind) => [`--${kind}`, at(`a.${kind}`)]), 'Tutto guasto.');
  assert.equal(status, 1, stderr);
  assert.deepEqual(fs.readdirSync(at('')), ['a.wav']);
  assert.equal(fs.readFileSync(at('a.wav'), 'utf8'), 'what was there');
});

test('wrong usage leaves no files behind', () => {
  const at = fresh();
  assert.equal(say('--wav', at('a.wav'), '--fap', '-', '--json', '-', 'Sì.').status, 2);
  assert.equal(say('--wav', at('a.wav'), '--fap', '/nowhere/a.fap', 'Sì.').status, 1);
  assert.deepEqual(fs.readdirSync(at('')), []);
});

test('a failing sentence costs that sentence, not the file', () => {
  const at = fresh();
  assert.equal(say('--wav', at('a.wav'), 'Tutto bene. Tutto guasto.').status, 1);
  assert.deepEqual(fs.readdirSync(at('')), ['a.wav']);
  const wav = fs.readFileSync(at('a.wav'));
  assert.equal(wav.readUInt32LE(40), wav.length - 44, 'its length is true');
});

test('a file that cannot be written does not affect the others', () => {
  const at = fresh();
  const { status, stderr } = say('--wav', at('a.wav'), '--ndjson', '/dev/full', 'Sì.');
  assert.equal(status, 1);
  assert.match(stderr, /\/dev\/full: No space left/);
  assert.ok(fs.statSync(at('a.wav')).size > 1000);
  assert.ok(fs.statSync('/dev/full').isCharacterDevice());
});

test('a killed export leaves nothing behind', async () => {
  const at = fresh();
  const child = spawn(program, ['say', '--wav', at('a.wav'), '--fap', at('a.fap'), '--file', '-'], { stdio: ['pipe', 'ignore', 'ignore'] });
  child.stdin.end('Una frase lunga, che non finisce mai. '.repeat(2000));
  const began = (where) => { try { return fs.readlinkSync(where).includes(at('').replace(/\/$/, '')); } catch { return false; } };
  for (let open = false; !open && child.exitCode === null; ) {
    await new Promise((resolve) => setTimeout(resolve, 5));
    const fds = `/proc/${child.pid}/fd`;
    open = fs.readdirSync(fds).some((fd) => began(path.join(fds, fd)));
  }
  child.kill('SIGKILL');
  await once(child, 'exit');
  assert.deepEqual(fs.readdirSync(at('')), []);
});

test('handles modes, links, folders and pipes', async () => {
  const at = fresh();
  const well = (to) => assert.equal(faccia(['say', '--wav', to, 'Sì.']).status, 0);
  well(at('new.wav'));
  assert.equal(fs.statSync(at('new.wav')).mode & 0o777, 0o666 & ~process.umask());
  fs.writeFileSync(at('own.wav'), '', { mode: 0o600 });
  well(at('own.wav'));
  assert.equal(fs.statSync(at('own.wav')).mode & 0o777, 0o600);
  fs.symlinkSync('own.wav', at('link.wav'));
  fs.truncateSync(at('own.wav'));
  well(at('link.wav'));
  assert.ok(fs.lstatSync(at('link.wav')).isSymbolicLink());
  assert.ok(fs.statSync(at('own.wav')).size > 1000);
  fs.mkdirSync(at('folder'));
  const { status, stderr } = faccia(['say', '--wav', at('folder'), 'Sì.']);
  assert.equal(status, 1);
  assert.match(stderr, /folder: Is a directory/);
  assert.equal(spawnSync('mkfifo', [at('pipe')]).status, 0);
  const reader = spawn('cat', [at('pipe')], { stdio: ['ignore', 'pipe', 'inherit'] });
  let bytes = 0;
  reader.stdout.on('data', (data) => (bytes += data.length));
  const writer = spawn(program, ['say', '--wav', at('pipe'), 'Sì.']);
  await Promise.all([once(reader, 'close'), once(writer, 'exit')]);
  assert.ok(bytes > 1000);
  assert.ok(fs.statSync(at('pipe')).isFIFO());
  assert.deepEqual(fs.readdirSync(at('')).sort(), ['folder', 'link.wav', 'new.wav', 'own.wav', 'pipe']);
});

test('the other commands write files the same way', () => {
  const at = fresh();
  const before = 'what was there';
  for (const name of ['x.svg', 'x.json', 'x.fap', 'x.wav']) fs.writeFileSync(at(name), before);
  // an invalid recording; alignment to a text without words
  fs.writeFileSync(at('bad.fap'), '2.1 x 25 1\nnonsense\n');
  assert.equal(faccia(['play', '--wav', at('x.wav'), at('bad.fap')]).status, 1);
  fs.writeFileSync(at('no-words.txt'), '...');
  assert.equal(faccia(['say', '--wav', at('sound.wav'), 'Sì.']).status, 0);
  assert.equal(faccia(['align', at('sound.wav'), '--text', at('no-words.txt'), '--json', at('x.json')]).status, 1);
  for (const name of ['x.svg', 'x.json', 'x.fap', 'x.wav']) assert.equal(fs.readFileSync(at(name), 'utf8'), before, name);
  assert.equal(faccia(['eval', '--rates', '200', '--svg', at('x.svg'), 'Papà.']).status, 0);
  assert.match(fs.readFileSync(at('x.svg'), 'utf8'), /<\/svg>\s*$/);
  assert.ok(!fs.readdirSync(at('')).some((name) => name.includes('.part')));
});
