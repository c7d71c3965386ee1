// SPDX-License-Identifier: GPL-3.0-or-later
// The boundary table moves a voice's phone boundaries, in events and in the face, unless it is disabled.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { build, root } from '../../lib/daemon.mjs';

const models = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-boundaries-'));
after(() => fs.rmSync(models, { recursive: true }));
for (const name of ['speech', 'normalization', 'expressions.json']) fs.symlinkSync(path.join(root, 'models', name), path.join(models, name));
const table = (value) => fs.writeFileSync(path.join(models, 'boundaries.json'), value);
const fap = path.join(models, 'said.fap');
const say = (...args) => spawnSync(path.join(build, 'server/cli/faccia'), [...args, 'say', '--voice', 'espeak:it', '--json', '-', '--fap', fap, 'La pasta bolle.'],
  { encoding: 'utf8', maxBuffer: 1 << 28, env: { ...process.env, FACCIA_MODELS: models } });
const said = (...args) => ({ ...JSON.parse(say(...args).stdout), face: fs.readFileSync(fap, 'utf8') });
const rule = (ms) => JSON.stringify({ sounds: { vowel: 'aeo', p: 'p' }, voices: { 'espeak:it': [{ before: 'vowel', after: 'p', ms }], 'espeak:tr': [{ before: 'p', after: 'vowel', ms: -20 }] } });

test('the boundary table of a voice moves its boundaries, their words and the face, and nothing else', () => {
  table(rule(15));
  const own = said('--boundaries', 'own'), heard = said();
  const p = own.phones.findIndex(({ ipa }) => ipa === 'p');
  const near = (a, b) => Math.abs(a - b) < 1e-4;
  assert.ok(p > 0 && heard.phones.length === own.phones.length && near(own.duration, heard.duration));
  own.phones.forEach((phone, i) => {
    assert.ok(near(heard.phones[i].start - phone.start, i === p ? 0.015 : 0), `${phone.ipa}: ${phone.start}, ${heard.phones[i].start}`);
    assert.ok(near(heard.phones[i].end - phone.end, i === p - 1 ? 0.015 : 0));
  });
  assert.ok(near(own.words[1].start, own.phones[p].start) && near(heard.words[1].start, heard.phones[p].start));
  assert.deepEqual([heard.words[0], heard.words[2]].map(({ start }) => start), [own.words[0], own.words[2]].map(({ start }) => start));
  assert.notEqual(heard.face, own.face);
  table(rule(0));
  assert.deepEqual(said().phones, own.phones);
  fs.rmSync(path.join(models, 'boundaries.json'));
  assert.deepEqual(said(), own, 'no table, no correction');
});

test('rejects a broken table with its position', () => {
  table(rule(61));
  const { status, stderr } = say();
  assert.equal(status, 1, stderr);
  assert.match(stderr, /boundaries\.json: voices\.espeak:it\[0\]\.ms: must be a number from -60 to 60 \(bad-boundaries\)/);
  table('{"sounds": {},\n "voices": }');
  assert.match(say().stderr, /boundaries\.json: 2:\d+: .*\(bad-boundaries\)/);
});
