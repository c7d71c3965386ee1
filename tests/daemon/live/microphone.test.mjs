// SPDX-License-Identifier: GPL-3.0-or-later
// faccia-live: sends a person's live speech from a pipe or a file to a room, whose listeners hear and see it.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { once } from 'node:events';
import fs from 'node:fs';
import net from 'node:net';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { setTimeout as sleep } from 'node:timers/promises';
import { saidBy } from '../../lib/command.mjs';
import { build, Daemon, eventually, framesOf } from '../../lib/daemon.mjs';
import { sign } from '../../lib/tokens.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
const file = (name) => path.join(folder, name);
const program = path.join(build, 'server/bridges/faccia-live');

let daemon, kiosk, spoken;
before(async () => {
  const { status, stderr } = spawnSync(path.join(build, 'server/cli/faccia'), ['say', '-l', 'es', '-v', 'espeak:es', '--wav', file('es.wav'), '--json', file('es.json'), 'Mi primo Pablo compra pan y tomates en la plaza.']);
  assert.equal(status, 0, String(stderr));
  const data = fs.readFileSync(file('es.wav'));
  spoken = { rate: data.readUInt32LE(24), raw: data.subarray(44), samples: new Int16Array(data.buffer.slice(data.byteOffset + 44)), phones: JSON.parse(fs.readFileSync(file('es.json'))).phones };
  spoken.seconds = spoken.samples.length / spoken.rate;
  fs.writeFileSync(file('es.raw'), spoken.raw);
  fs.writeFileSync(file('text.wav'), 'This is no sound.');
  daemon = await Daemon.start();
  kiosk = await daemon.stream('?room=kitchen');
  await kiosk.wait({ type: 'joined' });
});
after(async () => {
  await kiosk.close();
  fs.rmSync(folder, { recursive: true });
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});

/** Starts faccia-live; `exited` resolves to {status, stderr, seconds}. stdin: as for spawn. */
function start(options, { url = daemon.url, stdin = 'pipe', env = {} } = {}) {
  const child = spawn(program, options, { stdio: [stdin, 'ignore', 'pipe'], env: { ...process.env, FACCIA_URL: url, FACCIA_ROOM: 'kitchen', ...env } });
  const began = performance.now();
  child.text = '';
  child.stderr.setEncoding('utf8').on('data', (text) => (child.text += text));
  child.stdin?.on('error', () => {}); // the process may have exited
  child.exited = once(child, 'close').then(([status]) => ({ status, stderr: saidBy(child.text), seconds: (performance.now() - began) / 1000 }));
  return child;
}
const run = (...args) => {
  const child = start(...args);
  child.stdin?.end();
  return child.exited;
};
const well = { status: 0, stderr: '' };
const told = ({ status, stderr }) => ({ status, stderr });
const soundOf = (utterance) => kiosk.chunks.filter((c) => c.utterance === utterance).flatMap((c) => [...c.audio]);
/**
 * Checks that a file is heard completely. Its first second must be identical; the rest may be resampled if the daemon, on a busy machine, measured that sound
 * arrives faster or slower than real time. Returns where it begins, after silence, s.
 */
function heardWhole(utterance) {
  const sound = soundOf(utterance), lead = sound.findIndex((x) => x) - spoken.samples.findIndex((x) => x), count = sound.length - lead;
  assert.ok(lead >= 0 && lead < 2 * spoken.rate, `${lead} samples before it`);
  assert.ok(Math.abs(count / spoken.samples.length - 1) < 0.05, `${count} samples of ${spoken.samples.length}`);
  assert.equal(spoken.samples.findIndex((x, i) => i < spoken.rate && x !== sound[lead + i]), -1);
  return lead / spoken.rate;
}
/** Returns the next `begin` in the room after `act`. */
async function begins(act) {
  const from = kiosk.messages.length, child = act();
  const begin = await kiosk.wait({ type: 'begin', captions: false }, { from, milliseconds: 15000 });
  return { child, begin, ended: kiosk.wait({ type: 'end', id: begin.id }, { from, milliseconds: 20000 }) };
}

test('plays a file in the room in real time, and closes its /p b m/', async () => {
  const { child, begin, ended } = await begins(() => start(['--lang', 'es', file('es.wav')]));
  const end = await ended, exit = await child.exited;
  assert.deepEqual(told(exit), well);
  assert.ok(exit.seconds > spoken.seconds - 0.2, `${exit.seconds} s for ${spoken.seconds}`);
  assert.deepEqual([begin.rate, begin.lang, begin.lookahead, end.reason], [spoken.rate, 'es', 80, 'done']);
  const lead = heardWhole(begin.utterance);
  const frames = framesOf(kiosk.chunks, begin.utterance), gap = ({ values }) => -((values[4] ?? 0) + (values[5] ?? 0));
  const closures = spoken.phones.filter(({ ipa }) => /^[pbm]/.test(ipa));
  const closed = closures.filter(({ start: a, end: b }) => frames.some((f) => f.time - lead > a - 0.06 && f.time - lead < b + 0.06 && gap(f) <= 0));
  assert.ok(closures.length >= 8 && closed.length >= 0.7 * closures.length, `${closed.length} of ${closures.length}`);
  assert.ok(frames.filter((f) => gap(f) > 50).length > 5, 'and it opens');
});

test('reads a pipe in pieces of any size with two channels, and a file as standard input', async () => {
  const both = Buffer.alloc(2 * spoken.raw.length);
  for (let i = 0; i < spoken.samples.length; i++) (both.writeInt16LE(spoken.samples[i], 4 * i), both.writeInt16LE(spoken.samples[i], 4 * i + 2));
  const pour = async (stdin) => {
    for (let at = 0; at < both.length; at += 4999) {
      stdin.write(both.subarray(at, at + 4999));
      await sleep((1000 * 4999) / (4 * spoken.rate));
    }
    stdin.end();
  };
  const piped = await begins(() => {
    const child = start(['--raw', `${spoken.rate},2`, '--lookahead', '0', '-']);
    pour(child.stdin);
    return child;
  });
  assert.deepEqual(told(await piped.child.exited), well);
  const { duration } = await piped.ended;
  assert.equal(piped.begin.lookahead, 0);
  // on a busy machine, gaps are filled with silence
  assert.ok(duration > spoken.seconds - 0.05 && duration < spoken.seconds + 1.5, `${duration} s of ${spoken.seconds}`);

  for (const options of [['--raw', String(spoken.rate), '-'], ['-'], ['--raw', String(spoken.rate), file('es.raw')]]) {
    const source = fs.openSync(file(options.length > 1 ? 'es.raw' : 'es.wav'));
    const { child, begin, ended } = await begins(() => start(options, { stdin: source }));
    fs.closeSync(source);
    assert.deepEqual(told(await child.exited), well);
    assert.equal((await ended).reason, 'done');
    heardWhole(begin.utterance);
  }
});

test('sends endless sound in real time with little buffering; Ctrl-C ends it cleanly', async () => {
  const zero = fs.openSync('/dev/zero');
  const { child, ended } = await begins(() => start(['--raw', '96000,8', '-'], { stdin: zero }));
  fs.closeSync(zero);
  const before = performance.now();
  await sleep(3000);
  const resident = Number(fs.readFileSync(`/proc/${child.pid}/status`, 'utf8').match(/VmRSS:\s+(\d+)/)[1]);
  child.kill('SIGINT');
  const passed = (performance.now() - before) / 1000, { reason, duration } = await ended;
  assert.deepEqual(told(await child.exited), well);
  assert.equal(reason, 'done');
  assert.ok(duration > 1 && duration < passed + 3, `${duration} s in ${passed}`);
  assert.ok(resident < 200000, `${resident} kB`);
});

test('Ctrl-C ends a silent microphone too', async () => {
  const { child, ended } = await begins(() => {
    const silent = start(['--raw', String(spoken.rate), '-']);
    silent.stdin.write(spoken.raw.subarray(0, spoken.rate));
    return silent;
  });
  await sleep(300);
  child.kill('SIGTERM');
  assert.equal((await ended).reason, 'done');
  assert.deepEqual(told(await child.exited), well);
});

test('waits for a daemon that does not read, and continues afterwards', async () => {
  const zero = fs.openSync('/dev/zero');
  const { child, ended } = await begins(() => start(['--raw', '96000,8', '-'], { stdin: zero }));
  fs.closeSync(zero);
  daemon.process.kill('SIGSTOP');
  await sleep(6000);
  const resident = Number(fs.readFileSync(`/proc/${child.pid}/status`, 'utf8').match(/VmRSS:\s+(\d+)/)[1]);
  daemon.process.kill('SIGCONT');
  assert.ok(resident < 200000, `${resident} kB`); // while 9 MB arrived
  await sleep(500);
  child.kill('SIGINT');
  assert.equal((await ended).reason, 'done');
  assert.equal((await child.exited).status, 0);
});

test('waits for its turn, interrupts, or does not speak; a higher priority interrupts it', async () => {
  const from = kiosk.messages.length;
  kiosk.send({ type: 'speak', id: 'first', lang: 'it', text: 'Una frase che dura un poco, perché qualcuno aspetta.' });
  await kiosk.wait({ type: 'begin', id: 'first' });
  const busy = await run(['--if-quiet', file('es.wav')]);
  assert.equal(busy.status, 4, busy.stderr);
  const waits = await begins(() => start([file('es.wav')]));
  assert.ok(kiosk.messages.slice(from).some((m) => m.type === 'end' && m.id === 'first'));
  assert.equal((await waits.ended).reason, 'done');
  heardWhole(waits.begin.utterance); // a file waits for its turn
  assert.deepEqual(told(await waits.child.exited), well);

  const cut = await begins(() => start([file('es.wav')]));
  const cuts = await begins(() => start(['--interrupt', '--priority', 'alarm', file('es.wav')]));
  assert.equal((await cut.ended).reason, 'stopped');
  assert.deepEqual(told(await cut.child.exited), { status: 5, stderr: '' });
  assert.equal((await cuts.ended).reason, 'done');
  assert.deepEqual(told(await cuts.child.exited), well);
});

test('reports a lost daemon, a missing one, and a server that is not faccia', async () => {
  const own = await Daemon.start();
  const child = start(['--raw', '16000', '-'], { url: own.url });
  child.stdin.write(Buffer.alloc(16000));
  await eventually(async () => (await (await own.get('/healthz')).json()).connections > 1, 'its connection');
  await sleep(300);
  own.process.kill('SIGKILL');
  await own.exited;
  assert.deepEqual(told(await child.exited), { status: 1, stderr: 'faccia-live: the daemon closed the connection\n' });
  const gone = await run([file('es.wav')], { url: own.url });
  assert.equal(gone.status, 1);
  assert.match(gone.stderr, /connect/i);
  const odd = net.createServer((socket) => socket.on('data', () => socket.end('SSH-2.0-nothing\r\n\r\n')).on('error', () => {})).listen(0, '127.0.0.1');
  await once(odd, 'listening');
  const other = await run([file('es.wav')], { url: `http://127.0.0.1:${odd.address().port}` });
  assert.equal(other.status, 1);
  assert.match(other.stderr, /not a faccia daemon's stream/);
  odd.close();
  const late = net.createServer((socket) => {
    socket.on('error', () => {}).write('HTTP/1.1 503 Service Unavailable\r\n\r\n');
    setTimeout(() => socket.end('{"message":"come back later"}'), 200);
  }).listen(0, '127.0.0.1');
  await once(late, 'listening');
  const refused = await run([file('es.wav')], { url: `http://127.0.0.1:${late.address().port}` });
  assert.deepEqual([refused.status, refused.stderr.split(': ').at(-1)], [1, 'come back later\n']);
  late.close();
});

test('reports a rejected token', async () => {
  const secret = 's'.repeat(40);
  fs.writeFileSync(file('secret'), `${secret}\n`, { mode: 0o600 });
  const own = await Daemon.start(['--secret-file', file('secret')]);
  for (const [name, token] of [['false', sign({ secret: 'x'.repeat(40) })], ['listens', sign({ secret, claims: { rights: 'listen' } })], ['speaks', sign({ secret })]]) fs.writeFileSync(file(name), `${token}\n`);
  for (const options of [[], ['--token-file', file('false')], ['--token-file', file('listens')]]) {
    const { status, stderr } = await run([...options, file('es.wav')], { url: own.url });
    assert.equal(status, 1, stderr);
    assert.match(stderr, /token/);
  }
  assert.deepEqual(told(await run(['--token-file', file('speaks'), file('es.wav')], { url: own.url })), well);
  assert.equal((await own.stop()).code, 0);
});

for (const [what, options, status, message] of [
  ['nothing', [], 2, /^Usage/],
  ['two sounds', ['a', 'b'], 2, /^Usage/],
  ['an unknown option', ['--nothing', 'x'], 2, /--help/],
  ['a rate out of range', ['--raw', '7999', '-'], 2, /'7999' is not a rate/],
  ['no number', ['--raw', '16k', '-'], 2, /'16k' is not a rate/],
  ['nine channels', ['--raw', '16000,9', '-'], 2, /'16000,9' is not a rate/],
  ['a lookahead that it has not', ['--lookahead', '50', 'x'], 2, /'50' is not a lookahead/],
  ['a pipe without a rate', ['-'], 1, /--raw 16000/],
  ['a pipe with nothing in it', ['--raw', '16000', '-'], 1, /sound/],
  ['no such file', ['nowhere.wav'], 1, /nowhere\.wav/],
  ['a text', [file('text.wav')], 1, /text\.wav/],
  ['no such token', ['--token-file', '/nowhere', 'x'], 1, /\/nowhere/],
  ['no such room', ['--room', 'no spaces', file('es.wav')], 1, /letters, digits/],
  ['no such engine', ['--engine', 'x', file('es.wav')], 1, /'?x'?/],
  ['no such priority', ['--priority', 'high', file('es.wav')], 1, /background, chat, alarm/],
  ['no address', ['--url', 'kitchen', file('es.wav')], 1, /kitchen: not a daemon's address/],
])
  test(`${what}: reports it`, async () => {
    const exit = await run(options);
    assert.equal(exit.status, status, exit.stderr);
    assert.match(exit.stderr, message);
  });

test('prints its help and version', async () => {
  for (const [option, text] of [['--help', /arecord .* \| faccia-live/], ['--version', /^faccia-live \d/]]) {
    const { status, stdout } = spawnSync(program, [option], { encoding: 'utf8' });
    assert.equal(status, 0);
    assert.match(stdout, text);
  }
});
