// SPDX-License-Identifier: GPL-3.0-or-later
// `faccia fap capture --room`: a face that another program sends by UDP drives a room.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import dgram from 'node:dgram';
import { once } from 'node:events';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { setTimeout as sleep } from 'node:timers/promises';
import { build, Daemon } from '../../lib/daemon.mjs';
import { parseFap } from '../../lib/fapfile.mjs';
import { sign } from '../../lib/tokens.mjs';

const [JAW, YAW] = [3, 49];
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-puppet-'));
const running = [];
let daemon;
before(async () => {
  daemon = await Daemon.start(['--lang', 'it'], {}, { voices: false });
});
after(async () => {
  for (const child of running) child.kill('SIGKILL');
  fs.rmSync(folder, { recursive: true });
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});

/** Starts the program. @returns says(pattern) waits for a message; ended is the exit code */
function drive(...options) {
  const child = spawn(path.join(build, 'server/cli/faccia'), ['fap', 'capture', ...options], { env: { ...process.env, FACCIA_URL: daemon.url, FACCIA_TOKEN: '' } });
  running.push(child);
  const self = { child, stderr: '', stdout: '', ended: once(child, 'close').then(([code]) => code) };
  child.stdout.setEncoding('utf8').on('data', (text) => (self.stdout += text));
  child.stderr.setEncoding('utf8').on('data', (text) => (self.stderr += text));
  self.says = async (pattern) => {
    while (!pattern.test(self.stderr)) {
      assert.equal(child.exitCode, null, `${pattern} was not said: ${self.stderr}`);
      await sleep(10);
    }
    return pattern.exec(self.stderr);
  };
  return self;
}
const big = (value, put) => {
  const bytes = Buffer.alloc(4);
  bytes[put](value);
  return bytes;
};
const [int, float] = [(value) => big(value, 'writeInt32BE'), (value) => big(value, 'writeFloatBE')];
/** A packet of Live Link Face; values by their place. */
const link = (frame, values) => Buffer.concat([Buffer.from([6]), int(4), Buffer.from('uuid'), int(5), Buffer.from('phone'), int(frame), float(0), int(60), int(1), Buffer.from([61]), ...Array.from({ length: 61 }, (_, i) => float(values[i] ?? 0))]);
const padded = (text) => Buffer.from(text + '\0'.repeat(4 - (text.length % 4)));
const message = (address, types, ...values) => Buffer.concat([padded(address), padded(types), ...values]);
const sized = (bytes) => Buffer.concat([int(bytes.length), bytes]);
/** A bundle of the VMC protocol. */
const puppet = (name, weight) =>
  Buffer.concat([padded('#bundle'), Buffer.alloc(8), sized(message('/VMC/Ext/Blend/Val', ',sf', padded(name), float(weight))), sized(message('/VMC/Ext/Blend/Apply', ','))]);

/** Sends packets 60 times a second. @returns end() */
function perform(port, packet) {
  const socket = dgram.createSocket('udp4');
  let k = 0;
  const timer = setInterval(() => socket.send(packet(k++), port, '127.0.0.1'), 1000 / 60);
  return () => {
    clearInterval(timer);
    socket.close();
  };
}
async function screenOf(room, life = 0) {
  const screen = await daemon.stream(`?room=${room}`);
  await screen.wait({ type: 'joined' });
  screen.send({ type: 'idle', life });
  await screen.until(() => screen.chunks.length > 2);
  return screen;
}
const last = (stream, fap) => stream.chunks.at(-1)?.frames.at(-1)?.[fap];
const near = (a, b, most = 20) => Math.abs(a - b) <= most;

test('Live Link Face drives a room, and is recorded', async () => {
  const screen = await screenOf('stage');
  const out = path.join(folder, 'out.fap');
  const puppeteer = drive('--room', 'stage', '--udp', '127.0.0.1:0', out);
  const [, port] = await puppeteer.says(/port (\d+)/);
  const end = perform(Number(port), (k) => link(k, { 17: 0.6, 52: 0.2 }));
  await screen.wait({ type: 'driven', on: true });
  await screen.until(() => near(last(screen, JAW), 600) && near(last(screen, YAW), 20000, 100));
  await puppeteer.says(/the face of the room stage is driven/);
  end();
  puppeteer.child.kill('SIGINT');
  assert.equal(await puppeteer.ended, 0, puppeteer.stderr);
  await screen.wait({ type: 'driven', on: false });
  await screen.until(() => last(screen, JAW) === 0);
  const { fps, frames } = parseFap(fs.readFileSync(out, 'utf8'));
  assert.equal(fps, 60);
  assert.ok(frames.length > 2 && frames.every((frame) => frame[JAW] === 600 && frame[YAW] === 20000), JSON.stringify([frames.length, frames[0][JAW], frames[0][YAW]]));
  await screen.close();
});

test('a program with the VMC protocol drives the face, and not the head if it sends no bone', async () => {
  const screen = await screenOf('puppet', 1);
  const puppeteer = drive('--room', 'puppet', '--udp', '0');
  const [, port] = await puppeteer.says(/port (\d+)/);
  const end = perform(Number(port), () => puppet('JawOpen', 0.5));
  await screen.until(() => near(last(screen, JAW), 500));
  await screen.until(() => last(screen, YAW) !== 0, 60000); // it is alive
  assert.ok(near(last(screen, JAW), 500));
  end();
  await sleep(100);
  puppeteer.child.kill('SIGTERM');
  assert.equal(await puppeteer.ended, 0);
  assert.equal(puppeteer.stdout, '', 'nothing is recorded unless a file is given');
  await screen.close();
});

test('says why a face cannot be driven', async () => {
  const secret = 'a secret of at least thirty-two bytes';
  fs.writeFileSync(path.join(folder, 'secret'), secret, { mode: 0o600 });
  fs.writeFileSync(path.join(folder, 'listens'), sign({ secret, claims: { rights: 'listen' } }));
  fs.writeFileSync(path.join(folder, 'speaks'), sign({ secret }));
  const guarded = await Daemon.start(['--secret-file', path.join(folder, 'secret')], {}, { voices: false });
  const fails = async (pattern, options, packets = false) => {
    const puppeteer = drive('--udp', '0', ...options);
    let end = () => {};
    if (packets) end = perform(Number((await puppeteer.says(/port (\d+)/))[1]), (k) => link(k, { 17: 1 }));
    assert.equal(await puppeteer.ended, 1, puppeteer.stderr);
    assert.match(puppeteer.stderr, pattern);
    end();
  };
  await fails(/http:\/\/127\.0\.0\.1:1: /, ['--room', 'r', '--url', 'http://127.0.0.1:1']);
  await fails(/ftp:\/\/x: not a daemon's address/, ['--room', 'r', '--url', 'ftp://x']);
  await fails(/no-such-file: contains no token/, ['--room', 'r', '--token-file', path.join(folder, 'no-such-file')]);
  await fails(/token/, ['--room', 'r', '--url', guarded.url]);
  await fails(/cannot receive at 'x'/, ['--room', 'r', '--udp', 'x']);
  await fails(/r: /, ['--room', 'r', '--url', guarded.url, '--token-file', path.join(folder, 'listens')], true);
  const other = await daemon.stream('?room=taken&watch=1');
  await other.wait({ type: 'joined' });
  const timer = setInterval(() => other.send({ type: 'drive', frames: [{ time: performance.now() / 1000, faps: { [JAW]: 1 } }] }), 50);
  await other.wait({ type: 'driven', on: true });
  await fails(/taken: .*driv/, ['--room', 'taken'], true);
  clearInterval(timer);
  await other.close();
  const left = drive('--room', 'r', '--udp', '0', '--url', guarded.url, '--token-file', path.join(folder, 'speaks'));
  const end = perform(Number((await left.says(/port (\d+)/))[1]), (k) => link(k, { 17: 1 }));
  await left.says(/is driven/);
  assert.deepEqual(await guarded.stop(), { code: 0, signal: null });
  assert.equal(await left.ended, 1);
  end();
  assert.match(left.stderr, /r: the daemon closed the connection|r: .*shutting down/);
});
