// SPDX-License-Identifier: GPL-3.0-or-later
// The npm package @faccia/client, installed as in an application, against the real daemon.
import assert from 'node:assert/strict';
import { execFile, execFileSync, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { promisify } from 'node:util';
import { publint } from 'publint';
import ts from 'typescript';
import WebSocket from 'ws';
import { Daemon, root } from '../../lib/daemon.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-client-'));
const installed = path.join(folder, 'node_modules/@faccia/client');
let [daemon, connect] = [];
before(async () => {
  execFileSync('node', [path.join(root, 'web/client/pack.mjs'), installed]);
  ({ connect } = await import(path.join(installed, 'client.js')));
  daemon = await Daemon.start();
});
after(async () => {
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  fs.rmSync(folder, { recursive: true });
});

const open = (options) => connect(daemon.url, { WebSocket, ...options });
async function all(utterance) {
  const events = [];
  for await (const event of utterance) events.push(event);
  return events;
}

test('delivers speech in order: words, sound, frames, end', async () => {
  const client = await open();
  assert.equal(client.hello.protocol, 1);
  const events = await all(client.speak('La mamma parla piano.', { lang: 'it' }));
  assert.equal(events[0].type, 'begin');
  assert.deepEqual([events.at(-1).type, events.at(-1).reason], ['end', 'done']);
  assert.deepEqual(events.filter(({ type }) => type === 'word').map(({ text }) => text), ['La', 'mamma', 'parla', 'piano']);
  const media = events.filter(({ type }) => type === 'media');
  const samples = media.reduce((sum, { audio }) => sum + audio.length, 0);
  assert.equal(samples, Math.round(events.at(-1).duration * media[0].sampleRate));
  assert.ok(media.flatMap(({ frames }) => frames).some((frame) => frame[3] > 100), 'she opens her mouth');
  client.close();
});

test('Opus and compact frames carry the same face in a fraction of the bytes', async () => {
  const client = await open({ audio: 'opus', fap: 'fapc', events: 'packed' });
  const events = await all(client.speak('La mamma parla piano.', { lang: 'it' }));
  assert.deepEqual(events.filter(({ type }) => type === 'word').map(({ text }) => text), ['La', 'mamma', 'parla', 'piano']);
  const media = events.filter(({ type }) => type === 'media');
  assert.ok(media.flatMap(({ audio }) => audio ?? []).every((packet) => packet instanceof Uint8Array && packet.length < 400));
  assert.ok(media.flatMap(({ frames }) => frames).some((frame) => frame[3] > 100));
  client.close();
});

test('speaks open text; reports cancelled and refused utterances; distinguishes two at once', async () => {
  const client = await open();
  const written = client.open({ lang: 'it' });
  const words = all(written);
  for (const token of ['Buon', 'giorno. ', 'Come ', 'stai?']) written.write(token);
  written.close();
  const refused = client.speak('Ciao.', { lang: 'xx' });
  assert.equal((await refused.done).reason, 'failed');
  assert.deepEqual(refused.errors.map(({ code }) => code), ['unknown-language']);
  assert.deepEqual((await words).filter(({ type }) => type === 'word').map(({ text }) => text), ['Buongiorno', 'Come', 'stai']);
  const cut = client.speak('Una frase lunga che non finisce mai, perché qualcuno la interrompe.', { lang: 'it' });
  for await (const event of cut) if (event.type === 'media') break;
  client.send({ type: 'stop' });
  assert.equal((await cut.done).reason, 'stopped');
  client.close();
});

test('returns a live voice with a face', async () => {
  const client = await open(), said = client.voice({ rate: 16000, lang: 'it' }), events = all(said);
  for (let i = 0; i < 25; i++) assert.ok(said.sound(new Int16Array(320).fill(i)));
  said.close();
  const media = (await events).filter(({ type }) => type === 'media');
  assert.equal((await said.done).reason, 'done');
  assert.equal(media.reduce((sum, { samples }) => sum + samples, 0), 8000);
  assert.ok(media.flatMap(({ frames }) => frames).length >= 12);
  client.close();
});

test('a listener in a room hears what others say there', async () => {
  const [listener, speaker] = await Promise.all([open({ room: 'sala' }), open({ room: 'sala' })]);
  const heard = new Promise((resolve) => listener.addEventListener('message', ({ detail }) => detail.type === 'word' && resolve(detail.text)));
  const media = new Promise((resolve) => listener.addEventListener('media', ({ detail }) => resolve(detail)));
  const spoken = speaker.speak('Eccoci.', { lang: 'it' });
  assert.equal(await heard, 'Eccoci');
  assert.ok((await media).samples > 0);
  assert.equal((await spoken.done).reason, 'done');
  for (const client of [listener, speaker]) client.close();
});

test('reports a missing server; a lost one ends current speech and is reconnected to', async () => {
  await assert.rejects(connect('http://127.0.0.1:9', { WebSocket }), /no faccia server answers/);
  await assert.rejects(connect(daemon.url, { WebSocket, signal: AbortSignal.abort(new Error('enough')) }), /enough/);
  const own = await Daemon.start();
  const client = await connect(own.url, { WebSocket });
  const utterance = client.speak('Una frase lunga che non finisce mai, perché il server se ne va.', { lang: 'it' });
  for await (const { type } of utterance) if (type === 'media') break;
  own.process.kill('SIGKILL');
  assert.equal((await utterance.done).reason, 'lost');
  assert.equal((await client.speak('Nessuno.').done).reason, 'lost');
  const back = new Promise((resolve) => client.addEventListener('state', ({ detail }) => detail === 'open' && resolve()));
  const again = await Daemon.start(['--port', String(own.port)]);
  await back;
  assert.equal((await client.speak('Di nuovo.', { lang: 'it' }).done).reason, 'done');
  client.close();
  await again.stop();
});

test('the Python client does the same, in one typed file', async () => {
  const home = path.join(root, 'web/client/python');
  const env = { ...process.env, PYTHONPATH: home, PYTHONDONTWRITEBYTECODE: '1' };
  const { stdout } = await promisify(execFile)('/usr/bin/python3', [path.join(import.meta.dirname, 'client.py'), daemon.url, path.join(root, 'protocol/vectors/chunks.json')], { env });
  const { spoken, client, server, ...found } = JSON.parse(stdout);
  assert.deepEqual(found, { wrong: [], protocol: 1, heard: 'La', written: 'done', said: 'done', refused: ['unknown-language', 'failed'], lost: ['lost', 'lost'] });
  assert.deepEqual([spoken.words, spoken.reason], [['La', 'mamma', 'parla', 'piano'], 'done']);
  assert.equal(spoken.samples, Math.round(spoken.duration * 22050));
  assert.ok(spoken.opened > 100);
  const types = (side) => JSON.parse(fs.readFileSync(path.join(root, `protocol/schema/${side}.json`))).properties.type.enum.toSorted();
  assert.deepEqual([client, server], [types('client'), types('server')]);
  const { status, stdout: said } = spawnSync('mypy', ['--strict', '--cache-dir', path.join(folder, 'mypy'), path.join(home, 'faccia.py')], { encoding: 'utf8' });
  assert.equal(status, 0, said);
});

test('the package is complete, and its types cover all messages', async () => {
  assert.deepEqual((await publint({ pkgDir: installed, strict: true })).messages, []);
  const attw = path.join(root, 'tests/node_modules/.bin/attw');
  const { status, stdout, stderr } = spawnSync(attw, ['--pack', installed, '--profile', 'esm-only'], { encoding: 'utf8' });
  assert.equal(status, 0, stdout + stderr);
  const wrong = (body) => {
    const file = path.join(folder, 'app.mts');
    fs.writeFileSync(file, `import { connect } from '@faccia/client';\nconst client = await connect('http://localhost:8080');\n${body}\n`);
    const program = ts.createProgram([file], { module: ts.ModuleKind.NodeNext, moduleResolution: ts.ModuleResolutionKind.NodeNext, target: ts.ScriptTarget.ES2022, strict: true, noEmit: true, types: [] });
    return ts.getPreEmitDiagnostics(program).map(({ messageText }) => ts.flattenDiagnosticMessageText(messageText, ' '));
  };
  const good = `for await (const event of client.speak('Ciao.', { lang: 'it', mode: 'interrupt' }))
    if (event.type === 'word') event.time.toFixed(); else if (event.type === 'media') event.frames[0]?.[3]?.toFixed(); else if (event.type === 'end') event.reason satisfies string;
    client.send({ type: 'pause' });`;
  assert.deepEqual(wrong(good), []);
  assert.notDeepEqual(wrong("client.speak('Ciao.', { mode: 'sometime' });"), []);
  assert.notDeepEqual(wrong("client.send({ type: 'dance' });"), []);
  assert.notDeepEqual(wrong("client.send({ type: 'join' });"), [], 'a room is needed');
});
