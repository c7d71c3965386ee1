// SPDX-License-Identifier: GPL-3.0-or-later
// Misbehaving voice plugins: killed, hanging, using up memory or processor time, false times, network access, starting programs.
// Each loses at most a sentence; the daemon and other clients are unaffected.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { build, Daemon } from '../../lib/daemon.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
const worker = fs.readFileSync(path.join(build, 'server/voice/faccia-voice'));
const sanitized = worker.includes('__asan_init');
const confined = worker.includes('seccomp_load');
let daemon;
before(async () => {
  fs.symlinkSync(path.join(build, 'tests/plugins/puppet.so'), path.join(folder, 'puppet.so'));
  daemon = await start();
});
after(async () => {
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  fs.rmSync(folder, { recursive: true });
});

function start(...options) {
  return Daemon.start(['--plugins', folder, '--workers', '2', '--worker-memory', '1024', ...options]);
}

/** One client triggers the misbehaviour between two sentences while another one speaks. */
async function suffer(trick, code, message, { at = daemon, meanwhile } = {}) {
  const [victim, other] = await Promise.all([at.stream(), at.stream()]);
  victim.send({ type: 'speak', voice: 'puppet:plain', lang: 'it', id: 'v', text: `Una frase.\n\n${trick} adesso.\n\nPoi si continua.` });
  other.send({ type: 'speak', voice: 'puppet:gb', lang: 'en', id: 'o', text: 'And I. Go on.' });
  await meanwhile?.();
  const error = await victim.wait({ type: 'error', id: 'v' }, { milliseconds: 60000 });
  assert.equal(error.code, code);
  assert.match(error.message, message);
  assert.equal((await victim.wait({ type: 'end', id: 'v' }, { milliseconds: 60000 })).reason, 'done');
  assert.deepEqual(victim.messages.filter((m) => m.type === 'word').map((m) => m.text), ['Una', 'frase.', 'Poi', 'si', 'continua.']);
  assert.equal((await other.wait({ type: 'end', id: 'o' }, { milliseconds: 60000 })).reason, 'done');
  assert.equal(other.messages.filter((m) => m.type === 'error').length, 0);
  await Promise.all([victim.close(), other.close()]);
}

async function speak(body, at = daemon) {
  const response = await at.get('/v1/speech?voice=puppet:plain&lang=it&format=json', { method: 'POST', body, headers: { 'content-type': 'text/plain' } });
  assert.equal(response.status, 200);
  return response.json();
}

/** Returns the results of the puppet's attempts, which it reports as warnings. */
async function attempts(trick, at = daemon) {
  const { warnings } = await speak(trick, at);
  return Object.fromEntries(warnings.map((w) => w.message.split(': ')));
}

test('a worker killed while speaking costs its sentence', () =>
  suffer('hang', 'voice-crashed', /^the voice puppet was killed by signal 9$/, {
    meanwhile: async () => {
      const [, pid] = await daemon.logged(/puppet (\d+) hangs/);
      process.kill(Number(pid), 'SIGKILL');
    },
  }));

test('a hung voice is given up after the sentence\'s time limit', () =>
  suffer('hang', 'voice-timeout', /^the voice puppet took too long$/));

test('a worker out of memory costs its sentence', { skip: sanitized && 'the sanitizer takes more than any limit' }, () =>
  suffer('hog', 'voice-crashed', /^the voice puppet was killed by signal 6$/));

test('a worker out of processor time costs its sentence', async () => {
  const at = await start('--deadline-base', '100', '--worker-processor', '0.01'); // 1 s
  await suffer('spin', 'voice-crashed', /^the voice puppet took too much processor time$/, { at });
  assert.deepEqual(await at.stop(), { code: 0, signal: null });
});

// A long text may need that much sound, so the error does not blame the voice.
test('limits the sound of a sentence', () => suffer('flood', 'text-too-long', /exceeds the maximum duration/));

test('limits the events of a sentence', () => suffer('chatter', 'voice-failed', /^the voice puppet reported more/));

test('ends a worker that sends garbage on its socket', () => suffer('garbage', 'voice-crashed', /sent garbage/));

for (const trick of ['backwards', 'beyond'])
  test(`repairs times that are ${trick}, with a warning`, async () => {
    const said = await speak(trick);
    let at = 0;
    for (const { start, end } of said.phones) {
      assert.equal(start, at);
      assert.ok(end >= start);
      at = end;
    }
    assert.equal(at, said.duration);
    at = 0;
    for (const { start, end } of said.words) {
      assert.ok(start >= at && end >= start && end <= said.duration, JSON.stringify(said.words));
      at = start;
    }
    assert.match(said.warnings.map((w) => w.message).join('\n'), trick === 'beyond' ? /after the end of the audio/ : /before the previous one/);
  });

test('denies network access to a plugin that did not request it', { skip: !confined && 'built without libseccomp' }, async () => {
  const refused = 'Operation not permitted';
  assert.deepEqual(await attempts('dial'), { inet: refused, inet6: refused, packets: refused, netlink: refused, connect: refused });
});

test('denies it programs and signals to the daemon, but allows threads', { skip: !confined && 'built without libseccomp' }, async () => {
  const refused = 'Operation not permitted';
  assert.deepEqual(await attempts('launch'), { spawn: refused, exec: refused, signal: refused, unshare: refused, thread: 'done' });
});

test('logs a missing sandbox', () => assert.equal(/puppet runs without a sandbox/.test(daemon.log), !confined));

test('--sandbox off allows plugins network access', async () => {
  const open = await start('--sandbox', 'off');
  assert.equal((await attempts('dial', open)).inet, 'done');
  assert.deepEqual(await open.stop(), { code: 0, signal: null });
});
