// SPDX-License-Identifier: GPL-3.0-or-later
// Default limits stop one address from using up the daemon: a greedy and a modest client, on different local addresses.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import net from 'node:net';
import { after, before, test } from 'node:test';
import { Daemon, Stream, eventually } from '../../lib/daemon.mjs';

const GREEDY = '127.0.0.2', MODEST = '127.0.0.3';
const defaults = { FACCIA_MAX_PER_ADDRESS: '', FACCIA_MAX_REQUESTS: '', FACCIA_MAX_ROOMS_PER_ADDRESS: '', FACCIA_MAX_VOICES_PER_ADDRESS: '' };

let daemon;
before(async () => (daemon = await Daemon.start(['--max-connections', '300', '--open-seconds', '2'], defaults)));
after(async () => assert.deepEqual(await daemon.stop(), { code: 0, signal: null }));

const stream = (from, query = '') => Stream.open(`ws://127.0.0.1:${daemon.port}/v1/stream${query}`, { localAddress: from });
/** Checks that the modest client can join a new room and hear speech. */
async function served(room) {
  const modest = await stream(MODEST);
  modest.send({ type: 'join', room, id: 'j' });
  modest.send({ type: 'speak', id: 'u', lang: 'it', text: 'Sì.' });
  await modest.wait({ type: 'end', id: 'u', reason: 'done' }, { milliseconds: 30000 });
  await modest.close();
}

test('limits connections of one address', async () => {
  const sockets = Array.from({ length: 400 }, () => net.connect({ port: daemon.port, host: '127.0.0.1', localAddress: GREEDY }).on('error', () => {}));
  await eventually(() => sockets.every((socket) => !socket.connecting), 'the connections to be tried', 120000);
  await eventually(async () => (await (await daemon.get('/healthz')).json()).connections <= 260, 'those above 250 to be closed', 120000);
  await served('modest-1');
  sockets.forEach((socket) => socket.destroy());
  await daemon.left(3);
});

test('limits rooms', async () => {
  const greedy = await Promise.all(Array.from({ length: 30 }, () => stream(GREEDY)));
  greedy.forEach((each, i) => each.send({ type: 'join', room: `greedy-${i}`, id: 'j' }));
  const refused = () => greedy.filter((each) => each.messages.some(({ code }) => code === 'too-many-rooms'));
  const joined = () => greedy.filter((each) => each.messages.some(({ type }) => type === 'joined'));
  await eventually(() => refused().length === 5 && joined().length === 25, 'five to be refused', 120000);
  await served('modest-2');
  // existing rooms can still be joined; which connections came too late is chance
  const [late] = refused(), room = `greedy-${greedy.indexOf(joined()[0])}`;
  late.send({ type: 'join', room });
  await late.wait({ type: 'joined', room });
  await Promise.all(greedy.map((each) => each.close()));
});

test('limits live voices, including one with hardly any sound', async () => {
  const greedy = await Promise.all(Array.from({ length: 10 }, () => stream(GREEDY)));
  for (const each of greedy) each.send({ type: 'voice', id: 'v', rate: 16000, lang: 'it' });
  await eventually(() => greedy.filter((each) => each.messages.some(({ code }) => code === 'too-many-voices')).length === 2, 'two to be refused', 120000);
  const modest = await stream(MODEST);
  modest.send({ type: 'voice', id: 'm', rate: 16000, lang: 'it' });
  // the modest client sends sound, the others only two bytes now and then: their live voices are closed
  const timer = setInterval(() => {
    for (const each of greedy) each.socket.send(Buffer.alloc(2));
    modest.socket.send(Buffer.alloc(3200, 5));
  }, 100);
  await modest.wait({ type: 'begin', id: 'm' }, { milliseconds: 20000 });
  const heard = greedy.filter((each) => !each.messages.some(({ code }) => code === 'too-many-voices'));
  await Promise.all(heard.map((each) => each.wait({ code: 'unfinished' }, { milliseconds: 20000 })));
  clearInterval(timer);
  assert.equal(modest.messages.some(({ code }) => code === 'unfinished'), false);
  await Promise.all([...greedy, modest].map((each) => each.close()));
});

// All clients behind a proxy share an address: there, connections take turns.
test('limits texts with hundreds of pauses, on many connections of one address', async () => {
  const text = `<speak>${'a<break time="10s"/>'.repeat(150)}</speak>`;
  const greedy = await Promise.all(Array.from({ length: 30 }, () => stream(GREEDY, '?audio=none&fap=none')));
  const modest = await stream(GREEDY);
  const begun = () => greedy.filter((each) => each.messages.some(({ type }) => type === 'begin')).length;
  for (const each of greedy) each.send({ type: 'speak', id: 'g', lang: 'en', text });
  // The part is cached after its first synthesis. Replays from the cache must not starve other clients.
  const others = [];
  for (let i = 0; i < 3; i++) {
    modest.send({ type: 'speak', id: `m${i}`, lang: 'it', text: `Sì, ${i}.`, mode: 'replace' });
    await modest.wait({ type: 'begin', id: `m${i}` });
    others.push(begun());
  }
  assert.ok(others[0] < 10 && others[1] < 20, `of 30 texts of 150 parts, ${others} had been made before a word of somebody else`);
  for (const each of [...greedy, modest]) each.socket.terminate();
  await daemon.left(3);
});

test('limits utterances', async () => {
  const own = await Daemon.start(['--max-requests', '20'], defaults);
  const ask = (from) => new Promise((resolve, reject) => {
    const socket = net.connect({ port: own.port, host: '127.0.0.1', localAddress: from }, () => socket.write('POST /v1/stop?room=x HTTP/1.1\r\nhost: localhost\r\ncontent-length: 0\r\nconnection: close\r\n\r\n'));
    socket.once('data', (data) => resolve(Number(String(data).split(' ')[1]))).on('error', reject);
  });
  const statuses = [];
  for (let i = 0; i < 25; i++) statuses.push(await ask(GREEDY));
  assert.ok(statuses.filter((status) => status === 429).length >= 4, String(statuses));
  assert.notEqual(await ask(MODEST), 429);
  assert.equal((await own.stop()).code, 0);
});

test('applies the limits by default', () => {
  const { limits } = JSON.parse(execFileSync(daemon.process.spawnfile, ['--print-config']));
  assert.deepEqual([limits.address_connections, limits.address_rooms, limits.address_voices, limits.address_requests], [250, 25, 8, 1200]);
});
