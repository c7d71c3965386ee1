// SPDX-License-Identifier: GPL-3.0-or-later
// Symbolic links in the folders of recordings and gestures: targets outside are not used.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { Daemon, build } from '../../lib/daemon.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-links-'));
after(() => fs.rmSync(folder, { recursive: true }));
const media = path.join(folder, 'media');
const gestures = path.join(folder, 'gestures');
fs.mkdirSync(media);
fs.mkdirSync(gestures);

test('recordings: serves files and their sound below the folder only', async () => {
  const program = path.join(build, 'server/cli/faccia');
  const made = spawnSync(program, ['say', '--lang', 'it', '--fap', path.join(media, 'own.fap'), '--wav', path.join(folder, 'other.wav'), 'Ciao.'], { encoding: 'utf8' });
  assert.equal(made.status, 0, made.stderr);
  fs.copyFileSync(path.join(media, 'own.fap'), path.join(folder, 'other.fap'));
  fs.symlinkSync('own.fap', path.join(media, 'alias.fap'));
  fs.symlinkSync('../other.fap', path.join(media, 'out.fap'));
  fs.symlinkSync(path.join(folder, 'other.wav'), path.join(media, 'own.wav'));
  const daemon = await Daemon.start(['--media', media]);
  const { media: recordings } = await (await fetch(`${daemon.url}/v1/media`)).json();
  assert.deepEqual(recordings.map(({ name, sound }) => [name, sound]), [['alias', false], ['own', false]]);
  const client = await daemon.stream();
  client.send({ type: 'play', id: 'own', name: 'own' });
  await client.wait({ type: 'end', id: 'own' });
  client.send({ type: 'play', id: 'out', name: 'out' });
  await client.wait({ type: 'error', id: 'out', code: 'unknown-media' });
  client.close();
  assert.equal((await daemon.stop()).code, 0, daemon.log);
});

test('gestures: reports a link out of the folder, and refuses to start', () => {
  fs.writeFileSync(path.join(folder, 'nod.json'), '{}');
  fs.symlinkSync('../nod.json', path.join(gestures, 'nod.json'));
  const started = spawnSync(path.join(build, 'server/daemon/facciad'), ['--port', '0', '--gestures', gestures], { encoding: 'utf8', timeout: 60000 });
  assert.notEqual(started.status, 0);
  assert.match(started.stderr, /nod\.json: leads outside the folder of gestures/);
});
