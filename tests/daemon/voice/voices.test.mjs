// SPDX-License-Identifier: GPL-3.0-or-later
// Voice plugins that crash, hang or never start: the sentence fails with an error, and others are unaffected.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { build, Daemon } from '../../lib/daemon.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
let daemon;
before(async () => {
  fs.symlinkSync(path.join(build, 'server/plugins/espeak.so'), path.join(folder, 'espeak.so'));
  for (const name of ['puppet', 'old', 'empty', 'refuses', 'dies', 'escape'])
    fs.symlinkSync(path.join(build, `tests/plugins/${name}.so`), path.join(folder, `${name}.so`));
  daemon = await Daemon.start(['--plugins', folder]);
});
after(async () => {
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  fs.rmSync(folder, { recursive: true });
});

test('names plugins that do not start in the log, and serves with the others', async () => {
  for (const name of ['old', 'empty', 'refuses', 'dies']) await daemon.logged(new RegExp(name));
  const { voices } = await (await daemon.get('/v1/voices')).json();
  assert.ok(voices.some((v) => v.id === 'puppet:plain'));
  assert.ok(voices.some((v) => v.id === 'espeak:it'));
  assert.ok(!voices.some((v) => ['old', 'empty', 'refuses', 'dies'].includes(v.plugin)));
});

for (const [trick, code] of [['crash', 'voice-crashed'], ['hang', 'voice-timeout']])
  test(`a voice that does ${trick} costs its sentence only`, async () => {
    const [victim, other] = await Promise.all([daemon.stream(), daemon.stream()]);
    other.send({ type: 'speak', lang: 'it', text: 'Io parlo tranquilla. E poi ancora.' });
    victim.send({ type: 'speak', voice: 'puppet:plain', lang: 'it', id: 'v', text: `Una frase.\n\n${trick} adesso.\n\nPoi si continua.` });
    const error = await victim.wait({ type: 'error', id: 'v' }, { milliseconds: 40000 });
    assert.equal(error.code, code);
    const end = await victim.wait({ type: 'end', id: 'v' }, { milliseconds: 40000 });
    assert.equal(end.reason, 'done');
    const said = victim.messages.filter((m) => m.type === 'word').map((m) => m.text);
    assert.ok(said.includes('Una') && said.includes('continua.'), String(said));
    assert.ok(!said.includes('adesso.'));
    assert.equal((await other.wait({ type: 'end' })).reason, 'done');
    assert.equal(other.messages.filter((m) => m.type === 'error').length, 0);
    await Promise.all([victim.close(), other.close()]);
  });

test('fails the utterance when no sentence could be spoken', async () => {
  const stream = await daemon.stream();
  stream.send({ type: 'speak', voice: 'puppet:plain', lang: 'it', text: 'crash' });
  assert.equal((await stream.wait({ type: 'end' })).reason, 'failed');
  await stream.close();
});

test('reports it over HTTP as an error with a status', async () => {
  const response = await daemon.get('/v1/speech?voice=puppet:plain&lang=it', { method: 'POST', body: 'crash', headers: { 'content-type': 'text/plain' } });
  assert.equal(response.status, 500);
  assert.equal((await response.json()).code, 'voice-crashed');
});

test('repairs wrong times', async () => {
  const stream = await daemon.stream();
  for (const trick of ['backwards', 'beyond', 'names']) stream.send({ type: 'speak', voice: 'puppet:plain', lang: 'it', text: trick });
  await stream.until(() => stream.messages.filter((m) => m.type === 'end').length === 3);
  let sample = 0;
  for (const chunk of stream.chunks) {
    if (chunk.start === 0) sample = 0;
    assert.equal(chunk.start, sample);
    sample += chunk.samples;
  }
  await stream.close();
});

test('a stop reaches a working voice', async () => {
  const stream = await daemon.stream();
  await daemon.asks(() => stream.send({ type: 'speak', voice: 'puppet:plain', lang: 'it', id: 's', text: 'slow' }));
  stream.send({ type: 'stop' });
  await stream.wait({ type: 'end', id: 's', reason: 'stopped' });
  stream.send({ type: 'speak', voice: 'puppet:plain', lang: 'it', id: 't', text: 'Ora va bene.' });
  assert.equal((await stream.wait({ type: 'end', id: 't' })).reason, 'done');
  await stream.close();
});

// tests/unit/voice/test_escape.c has all attempts
for (const attempt of ['memory', 'environment', 'poke', 'signal', 'priority', 'out of memory score', 'datagram of a pair', 'fork'])
  test(`denies a plugin "${attempt}", and the daemon survives`, async () => {
    const stream = await daemon.stream();
    stream.send({ type: 'speak', voice: 'escape:plain', lang: 'it', markup: 'plain', id: 'e', text: attempt });
    assert.match((await stream.wait({ type: 'warning', id: 'e' })).message, /^refused, refused$/);
    assert.equal((await stream.wait({ type: 'end', id: 'e' })).reason, 'done');
    assert.equal((await daemon.get('/healthz')).status, 200);
    await stream.close();
  });

test('a worker stopped inside a sentence does not delay others until its deadline', async () => {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-stopped-'));
  fs.symlinkSync(path.join(build, 'tests/plugins/puppet.so'), path.join(folder, 'puppet.so'));
  // a deadline longer than this test may run
  const daemon = await Daemon.start(['--plugins', folder, '--deadline-base', '1000']);
  const [victim, ...others] = await Promise.all(Array.from({ length: 21 }, () => daemon.stream()));
  const worker = Number(spawnSync('pgrep', ['-P', String(daemon.process.pid)], { encoding: 'utf8' }).stdout);
  victim.send({ type: 'speak', lang: 'it', id: 'v', text: 'Una frase.\n\nbrief\n\nE poi ancora.' });
  await victim.wait({ type: 'begin', id: 'v' });
  process.kill(worker, 'SIGSTOP');
  const stopped = performance.now();
  for (const other of others) other.send({ type: 'speak', lang: 'it', id: 'o', text: 'Io parlo.' });
  const begins = await Promise.all(others.map((other) => other.wait({ type: 'begin', id: 'o' })));
  console.log(`# the last of ${others.length} was heard after ${(Math.max(...begins.map((b) => b.arrived)) - stopped).toFixed(0)} ms`);
  for (const stream of [victim, ...others]) {
    assert.equal((await stream.wait({ type: 'end' })).reason, 'done');
    assert.ok(!stream.messages.some((m) => m.type === 'error'));
  }
  assert.match(daemon.log, /spare worker/);
  process.kill(worker, 'SIGCONT');
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  fs.rmSync(folder, { recursive: true });
});
