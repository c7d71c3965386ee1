// SPDX-License-Identifier: GPL-3.0-or-later
// Every message, typed command and route, in every state of a daemon: each gets an answer or an end, and the daemon survives. The lists
// come from the schemas and the table of commands, so new ones are tested automatically.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import net from 'node:net';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { setTimeout as sleep } from 'node:timers/promises';
import WebSocket from 'ws';
import { build, Daemon, eventually, root } from '../../lib/daemon.mjs';

const read = (name) => fs.readFileSync(path.join(root, name), 'utf8');
const schema = JSON.parse(read('protocol/schema/client.json'));
const openapi = JSON.parse(read('protocol/openapi.json'));
const types = schema.properties.type.enum;
const commands = ['mood joy', 'help', ...[...read('server/api/text_protocol.c').matchAll(/^ {4}\{"(\w+)", "\w+",/gm)].map(([, name]) => `${name} x`),
  ...read('server/api/text_protocol.c').match(/settings\[\] = \{([^}]*)\}/)[1].match(/\w+(?=")/g).map((name) => `${name} 1`)];

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-states-'));
after(() => fs.rmSync(folder, { recursive: true }));
const gate = path.join(folder, 'gate'), config = path.join(folder, 'voices.json');
fs.writeFileSync(config, JSON.stringify({ early: { file: gate } }));

/** Makes a folder of voice plugins. files: name in the folder to plugin. */
function plugins(name, files) {
  const place = path.join(folder, name);
  fs.mkdirSync(place);
  for (const [as, file] of Object.entries(files)) fs.symlinkSync(path.join(build, file), path.join(place, `${as}.so`));
  return place;
}
const slow = plugins('slow', { early: 'tests/plugins/sleepy.so' });
const none = plugins('none', { refuses: 'tests/plugins/refuses.so' });
const espeak = plugins('espeak', { espeak: 'server/plugins/espeak.so' });
const start = (place, env = {}, more = []) => Daemon.start([...more, '--plugins', place, '--voice-config', config, '--lang', 'it', '--voice-start', '30'], env, { voices: false });

const WAIT = 20000; // ms: anything slower hangs

/** Rejects after WAIT with a message that names what is missing. */
function bounded(promise, what) {
  let timer;
  const late = new Promise((_, reject) => (timer = setTimeout(() => reject(new Error(`waited in vain for ${what}`)), WAIT)));
  return Promise.race([promise, late]).finally(() => clearTimeout(timer));
}

/** Stops the daemon like an operator and checks that it exits cleanly. */
async function stops(daemon, left = daemon.stop()) {
  assert.deepEqual(await bounded(left, `the daemon's end:\n${daemon.log.slice(-2000)}`), { code: 0, signal: null }, daemon.log.slice(-3000));
}

/** Makes a value that the schema allows. */
function sample(name, of) {
  const known = { id: 'u', room: 'hall', text: 'Ciao a tutti.', token: 'x', passage: 'x:1', voice: 'x', mark: 'x', name: 'x' };
  if (of === true) return known[name] ?? 'x'; // anything
  if (of.$ref) return sample(name, of.$ref.split('/').slice(1).reduce((value, key) => value[key], schema));
  if (of.enum) return of.enum[0];
  if ('const' in of) return of.const;
  if (of.type === 'array') return [sample('', of.items ?? { type: 'string' })];
  if (of.type === 'object') return Object.fromEntries((of.required ?? []).map((key) => [key, sample(key, of.properties[key])]));
  if (of.type === 'boolean') return true;
  if (of.type === 'number' || of.type === 'integer') return of.minimum ?? 1;
  return known[name] ?? 'x';
}

/** Messages of a type: with required members, with all members, and with none. */
function messages(type) {
  const { required = [], properties = {} } = schema.$defs[type] ?? {};
  const made = (names) => ({ ...Object.fromEntries(names.map((name) => [name, sample(name, properties[name] ?? {})])), type });
  return [made(required), made(Object.keys(properties)), { type }];
}

async function everyMessage(daemon) {
  for (const type of types) {
    const stream = await daemon.stream();
    for (const message of messages(type)) stream.send(message);
    stream.send({ type: 'ping', id: type });
    await stream.wait({ type: 'pong', id: type }, { milliseconds: WAIT });
    await bounded(stream.close(), `the end of the connection after ${type}`);
  }
}

async function everyCommand(daemon) {
  const socket = new WebSocket(`ws://127.0.0.1:${daemon.port}/v1/stream`, ['faccia.text.v1']);
  const heard = [];
  socket.on('message', (data) => heard.push(String(data)));
  await bounded(new Promise((resolve, reject) => socket.on('open', resolve).on('error', reject)), 'the text protocol');
  socket.send('Ciao.');
  for (const command of commands) socket.send(`/${command}`);
  socket.send('/help');
  await eventually(() => heard.filter((line) => line.startsWith('help')).length >= 2, `the answers to /help: ${heard.slice(-3)}`, WAIT);
  socket.terminate();
}

/** Requests every route; some answers wait for voices. */
function everyRoute(daemon) {
  return Object.entries(openapi.paths).flatMap(([address, item]) =>
    ['get', 'post', 'put', 'delete'].filter((method) => method in item).map(async (method) => {
      const url = `${address.replace(/\{\w+\}/g, 'x')}?text=Ciao&q=x&room=hall`;
      const body = method === 'get' || method === 'delete' ? undefined : address === '/v1/speech' || address === '/v1/say' ? 'Ciao.' : '{}';
      const controller = new AbortController();
      const answer = daemon.get(url, { method: method.toUpperCase(), body, signal: controller.signal, headers: body ? { 'content-type': 'text/plain' } : {} });
      const response = await bounded(answer, `${method} ${address}`).catch((e) => {
        throw new Error(`${method} ${address}: ${e.message} ${e.cause ?? ""} (daemon: ${daemon.process.exitCode} ${daemon.process.signalCode})\n${daemon.log.slice(-3000)}`);
      });
      assert.notEqual(response.status, 500, `${method} ${address}`);
      if (response.status >= 400 && response.headers.get('content-type') === 'application/json' && address !== '/healthz')
        assert.ok((await bounded(response.json(), `the body of ${method} ${address}`)).code, `${method} ${address} ${response.status}`);
      controller.abort();
    }));
}

/** Writes an open text faster than a voice can start. Resolves at its end. */
async function written(daemon, lang) {
  const stream = await daemon.stream();
  stream.send({ type: 'speak', open: true, id: 'u', lang, text: '' });
  for (const text of ['Bon', 'jour ', 'tout ', 'le ', 'monde. ', 'Ça ', 'va bien?']) {
    stream.send({ type: 'text', id: 'u', text });
    await sleep(20);
  }
  stream.send({ type: 'flush', id: 'u' });
  stream.send({ type: 'close', id: 'u' });
  return stream;
}

async function all(daemon, lang) {
  const stream = await written(daemon, lang);
  const asked = everyRoute(daemon);
  await everyMessage(daemon);
  await everyCommand(daemon);
  return async () => {
    await Promise.all(asked);
    return (await stream.wait({ type: 'end', id: 'u' }, { milliseconds: WAIT })).reason;
  };
}

test('accepts every message and command while the voices are starting, and when they are ready', async () => {
  const daemon = await start(slow);
  const ended = await all(daemon, 'fr');
  assert.equal((await (await daemon.get('/healthz')).json()).status, 'starting');
  fs.writeFileSync(gate, '');
  assert.equal(await ended(), 'done');
  assert.equal(await (await all(daemon, 'fr'))(), 'done');
  await stops(daemon);
});

/** A Redis that accepts connections and never answers. */
async function silent() {
  const server = net.createServer(() => {}).listen(0, '127.0.0.1');
  await new Promise((resolve) => server.on('listening', resolve));
  return server;
}

test('accepts them while reading the library, without Redis and voices; and afterwards', async () => {
  const works = path.join(folder, 'works'), redis = await silent();
  for (const name of ['works', 'media', 'scenes']) fs.mkdirSync(path.join(folder, name));
  for (let i = 0; i < 300; i++) fs.writeFileSync(path.join(works, `${i}.txt`), `Opera ${i}\n\n${'Amore e parola. '.repeat(200)}`);
  const more = ['--library', works, '--library-index', path.join(folder, 'index.db'), '--media', path.join(folder, 'media'), '--scenes', path.join(folder, 'scenes'), '--editing', '--cluster', `redis://127.0.0.1:${redis.address().port}`];
  fs.rmSync(gate, { force: true });
  const daemon = await start(slow, {}, more);
  const ended = await all(daemon, 'fr');
  assert.equal((await (await daemon.get('/healthz')).json()).status, 'starting');
  fs.writeFileSync(gate, '');
  assert.equal(await ended(), 'done');
  await eventually(async () => (await daemon.get('/v1/library')).status === 200, 'the library', WAIT);
  assert.equal(await (await all(daemon, 'fr'))(), 'done');
  await stops(daemon);
  redis.close();
});

test('accepts them without any voice', async () => {
  const daemon = await start(none);
  await daemon.logged(/no voice plugin could be started/);
  assert.equal(await (await all(daemon, 'it'))(), 'failed');
  await stops(daemon);
});

test('accepts them when a voice is gone', async () => {
  const daemon = await start(espeak);
  await daemon.logged(/ready: /);
  const workers = fs.readFileSync(`/proc/${daemon.process.pid}/task/${daemon.process.pid}/children`, 'utf8').trim().split(' ');
  assert.ok(workers[0]);
  for (const worker of workers) process.kill(Number(worker), 'SIGKILL');
  assert.equal(await (await all(daemon, 'it'))(), 'done');
  await stops(daemon);
});

test('accepts them while it is shutting down', async () => {
  const daemon = await start(espeak, { FACCIA_STOP_SECONDS: '20' });
  await daemon.logged(/ready: /);
  const streams = [];
  for (const type of types) streams.push([type, await daemon.stream()]);
  const [, speaks] = streams.find(([type]) => type === 'stop');
  speaks.send({ type: 'speak', id: 'long', lang: 'it', text: 'Uno, due, tre, quattro, cinque, sei, sette, otto, nove, dieci.' });
  await speaks.wait({ type: 'begin', id: 'long' });
  const left = daemon.stop();
  await daemon.logged(/stop/i);
  for (const [type, stream] of streams) {
    for (const message of messages(type)) if (stream !== speaks) stream.send(message);
    stream.send({ type: 'ping', id: type });
    await Promise.race([stream.wait({ type: 'pong', id: type }, { milliseconds: WAIT }), stream.closed]);
    if (type === 'speak' && stream.socket.readyState === WebSocket.OPEN) assert.ok(stream.messages.some((m) => m.code === 'stopping'));
  }
  await Promise.allSettled(everyRoute(daemon)); // connections are refused, or get an error
  speaks.send({ type: 'stop' });
  assert.equal((await speaks.wait({ type: 'end', id: 'long' })).reason, 'stopped');
  await stops(daemon, left);
});
