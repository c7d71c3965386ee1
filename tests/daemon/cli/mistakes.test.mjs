// SPDX-License-Identifier: GPL-3.0-or-later
// Mistakes of a first hour on the command line: each is refused with its place, near names, and no file of a wrong name.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { spawnSync } from 'node:child_process';
import { after, describe, test } from 'node:test';
import { saidBy } from '../../lib/command.mjs';
import { build } from '../../lib/daemon.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-mistakes-'));
after(() => fs.rmSync(folder, { recursive: true }));
const write = (name, bytes) => fs.writeFileSync(path.join(folder, name), bytes);
write('latin1.txt', Buffer.from('caff\xe8 caldo', 'latin1'));
write('open.ssml', '<speak>ciao\n');
write('words.fap', 'these are words\n');
write('empty.txt', '');
const there = fs.readdirSync(folder);

function run(program, args, input = '') {
  const { status, stdout, stderr } = spawnSync(path.join(build, 'server', program), args, { cwd: folder, encoding: 'utf8', input });
  return { status, stdout, stderr: saidBy(stderr) };
}

const mistakes = [
  // options
  [['say', '--lnag', 'it', 'ciao'], 2, "faccia: unknown option '--lnag'; near: --lang\n"],
  [['say', '-Z', 'ciao'], 2, "faccia: unknown option '-Z'\n"],
  [['say', '--lang'], 2, 'faccia: --lang needs a value\n'],
  [['say', '-l'], 2, 'faccia: -l needs a value\n'],
  [['say', '--json', '-l', 'it', 'ciao'], 2, "faccia: --json needs a value, but the option '-l' follows\n"],
  [['say', '--wav', '--fap', 'a.fap', 'ciao'], 2, "faccia: --wav needs a value, but the option '--fap' follows\n"],
  [['say', '--wav', '--fap=a.fap', 'ciao'], 2, "faccia: --wav needs a value, but the option '--fap=a.fap' follows\n"],
  [['say', '--still=2', 'ciao'], 2, 'faccia: --still takes no value\n'],
  [['say', '--vo', 'x', 'ciao'], 2, "faccia: '--vo' begins several options\n"],
  [['timed', '--egine', 'table', 'x'], 2, "faccia: unknown option '--egine'; near: --engine\n"],
  [['fap', 'plot', '--fpa', '4', 'words.fap', 'a.svg'], 2, "faccia: unknown option '--fpa'; near: --fap\n"],
  [['anova', '--cvs', 'x'], 2, "faccia: unknown option '--cvs'; near: --csv\n"],
  [['film', '--wrds', 'x', 'ciao'], 2, "faccia: unknown option '--wrds'; near: --words\n"],
  [['film', '-o', '--size', '3', 'ciao'], 2, "faccia: -o needs a value, but the option '--size' follows\n"],
  [['--lnag', 'it', 'say', 'ciao'], 2, "faccia: unknown option '--lnag'; near: --lang, --log\n"],
  // commands
  [['sya', 'ciao'], 2, "faccia: unknown command 'sya'; near: say; "],
  [['fap', 'inof', 'words.fap'], 2, "faccia: fap: unknown command 'inof'; near: info\n"],
  // files
  [['say', '-f', 'latin1.txt'], 1, 'faccia: latin1.txt: byte 4: the text is not UTF-8\n'],
  [['read', '-f', 'latin1.txt'], 1, 'faccia: latin1.txt: byte 4: the text is not UTF-8\n'],
  [['corpus', '-f', 'latin1.txt'], 1, 'faccia: latin1.txt: byte 4: the text is not UTF-8\n'],
  [['say', '-f', 'empty.txt'], 1, 'faccia: there is nothing to speak\n'],
  [['play', 'words.fap'], 1, 'faccia: words.fap:1:1: neither a header '],
  [['play', 'none.fap'], 1, 'faccia: none.fap: No such file or directory\n'],
  [['hear', 'none.wav'], 1, 'faccia: none.wav: No such file or directory\n'],
  [['hear', 'words.fap'], 1, 'faccia: words.fap: not a sound file of a known format\n'],
  [['play', 'words.fap', 'none.wav'], 1, 'faccia: none.wav: No such file or directory\n'],
];

describe('each mistake', () => {
  for (const [args, code, message] of mistakes)
    test(`faccia ${args.join(' ')}`, () => {
      const { status, stdout, stderr } = run('cli/faccia', args);
      assert.ok(stderr.startsWith(message), stderr);
      assert.equal(status, code);
      assert.equal(stdout, '');
      assert.deepEqual(fs.readdirSync(folder), there, 'no file was written');
    });
});

test('warnings of a file name it', () => {
  const { status, stderr } = run('cli/faccia', ['say', '--lang', 'it', '-f', 'open.ssml']);
  assert.equal(status, 0, stderr);
  assert.match(stderr, /^faccia: open\.ssml:2:1: warning: the element 'speak' of line 1 is not closed\n/);
});

test('the daemon refuses mistaken options, too', () => {
  for (const [args, message] of [
    [['--prot', '80'], "facciad: unknown option '--prot'; near: --port\n"],
    [['--host', '--remote'], "facciad: --host needs a value, but the option '--remote' follows\n"],
    [['--port'], 'facciad: --port needs a value\n'],
  ]) {
    const { status, stderr } = run('daemon/facciad', args);
    assert.ok(stderr.startsWith(message), stderr);
    assert.equal(status, 2);
  }
});

test('a value may look like an option behind =, and a text behind --', () => {
  const { status, stderr } = run('cli/faccia', ['say', '--lang', 'it', '--json=-l', '--', '--lang']);
  assert.equal(status, 0, stderr);
  assert.deepEqual(JSON.parse(fs.readFileSync(path.join(folder, '-l'))).words.map(({ text }) => text), ['lang']);
  fs.rmSync(path.join(folder, '-l'));
});
