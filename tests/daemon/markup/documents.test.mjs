// SPDX-License-Identifier: GPL-3.0-or-later
// Runs `faccia check` on tests/documents and compares scores, warnings and places of errors. After an intended change run
// faccia check --score - <DOCUMENT >DOCUMENT.expected and review the difference.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { faccia } from '../../lib/command.mjs';
import { root } from '../../lib/daemon.mjs';

const folder = path.join(root, 'tests/documents');
const check = (args, input) => {
  const { status, stdout, stderr } = faccia(['check', ...args], { input });
  return { status, stdout, stderr };
};
const documents = fs.readdirSync(folder).filter((name) => /\.(xml|txt)$/.test(name));

for (const name of documents)
  test(`reads ${name} as expected`, () => {
    const { status, stdout, stderr } = check(['--score', '-'], fs.readFileSync(path.join(folder, name)));
    assert.equal(stderr, '');
    assert.equal(stdout, fs.readFileSync(path.join(folder, `${name}.expected`), 'utf8'));
    assert.equal(status, /^-:\d+:\d+: error: /m.test(stdout) ? 1 : 0);
    for (const line of stdout.split('\n').filter((l) => l.startsWith('-:')))
      assert.match(line, /^-:\d+:\d+: (warning|error): ./);
  });

test('every element and every value has its document', () => {
  const all = documents.map((name) => fs.readFileSync(path.join(folder, name), 'latin1').toLowerCase()).join('\n');
  const source = ['apml', 'jsml', 'ssml', 'emotionml', 'bml'].map((name) => fs.readFileSync(path.join(root, `server/markup/languages/${name}.c`), 'utf8')).join('\n');
  const elements = [...source.matchAll(/(?:\.name = |(?:EMOTIONML_\w+|FUNCTION|UNSHOWN)\()"([^"]+)"/g)].map((m) => m[1]);
  assert.ok(elements.length > 60);
  for (const element of elements.filter((e) => !['apml', 'jsml', 'ssml', 'emotionml'].includes(e)))
    assert.match(all, new RegExp(`<([a-z]+:)?${element.toLowerCase()}[\\s/>]`), element);
  for (const [, value] of source.matchAll(/\{"([^"]+)", [\w.]+\}/g)) assert.ok(all.includes(value.toLowerCase()), value);
});

test('names the file, and fails when one of several has an error', () => {
  const [good, bad] = ['jsml-thesis-d1.xml', 'bad-truncated.xml'].map((name) => path.join(folder, name));
  assert.deepEqual(check([good]), { status: 0, stdout: '', stderr: '' });
  const both = check([bad, good]);
  assert.equal(both.status, 1);
  assert.equal(both.stdout, `${bad}:1:37: error: the element 'emphasis' of line 1 is not closed\n`);
  const none = check([path.join(folder, 'nowhere.xml')]);
  assert.equal(none.status, 1);
  assert.match(none.stderr, /^faccia: .*nowhere\.xml: No such file/);
});

test('reads as the requested markup', () => {
  assert.match(check(['--score', '--markup', 'plain', '-'], '<speak>a</speak>').stdout, /"<speak>a<\/speak>"/);
  assert.match(check(['--score', '-m', 'jsml', '-'], 'iki <HAPPY>üç</HAPPY>').stdout, /"iki "[^]*cue affect joy 1-2/);
  assert.equal(check(['--markup', 'rtf', '-'], '').status, 2);
  assert.equal(check([], '').status, 2);
  assert.equal(check(['--help'], '').status, 0);
});
