// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the daemon's messages with their declaration (protocol/messages.json): no message has an undeclared member, and every declared
// message and member is provoked here. So neither can change alone.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { Daemon, root } from '../../lib/daemon.mjs';
import { Redis } from '../../lib/redis.mjs';
import { violations } from '../../lib/schema.mjs';

const declared = JSON.parse(fs.readFileSync(path.join(root, 'protocol/messages.json'), 'utf8')).server;
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-said-'));
let redis, daemon, other;
before(async () => {
  fs.writeFileSync(path.join(folder, 'nod.fap'), `2.1 x 25 1\n0 ${'0 '.repeat(67)}\n0\n`);
  redis = await Redis.start();
  [daemon, other] = await Promise.all(['home', 'abroad'].map(() => Daemon.start(['--lang', 'it', '--cluster', redis.url, '--media', folder, '--recogniser', `cat >/dev/null; echo '{"text":"Sì","confidence":0.9}'`])));
});
after(async () => {
  for (const each of [daemon, other]) assert.deepEqual(await each?.stop(), { code: 0, signal: null });
  redis?.stop();
  fs.rmSync(folder, { recursive: true });
});

/** The beginning of a picture of one point (PNG), which is all that the daemon reads. */
function picture() {
  const bytes = Buffer.alloc(64);
  bytes.write('\x89PNG\r\n\x1a\n', 0, 'latin1');
  bytes.writeUInt32BE(13, 8);
  bytes.write('IHDR', 12);
  bytes.writeUInt32BE(1, 16);
  bytes.writeUInt32BE(1, 20);
  return bytes.toString('base64');
}

const streams = [];
const enter = async (query = '', from = daemon) => {
  const stream = await from.stream(query);
  streams.push(stream);
  await stream.wait({ type: 'hello' });
  return stream;
};

async function alone() {
  const stream = await enter('?lang=it&nonsense=1');
  const ask = async (message, answer) => {
    const from = stream.messages.length;
    stream.send(message);
    return stream.wait(answer, { from });
  };
  await ask({ type: 'ping', id: 7 }, { type: 'pong', id: 7 });
  await ask({ type: 'authorize', token: 'x' }, { type: 'authorized' });
  await ask('{"type":', { type: 'error', code: 'bad-json', byte: '...' });
  await ask({ type: 'rate', id: 'r', rate: 'fast' }, { type: 'error', field: 'rate', id: 'r' });
  await ask({ type: 'model' }, ({ type, index, count }) => type === 'model' && index === count - 1);
  await ask({ type: 'speak', id: 'w', markup: 'ssml', phones: true, bell: true, speaker: 'Anna', text: '<speak>Sì, <mark name="m"/>\n<bark/> no.</speak>' }, { type: 'end', id: 'w', reason: 'done' });
  await ask({ type: 'speak', id: 'x', markup: 'ssml', text: '<speak>Sì.' }, { type: 'end', id: 'x', reason: 'failed' });
  stream.send({ type: 'idle' });
  await stream.until(() => stream.chunks.some(({ utterance }) => utterance === 0));
  stream.send({ type: 'speak', id: 'p', markup: 'ssml', text: '<speak>Uno, <mark name="m"/> due, tre, quattro, cinque, sei, sette, otto, nove, dieci, undici.</speak>' });
  await stream.wait({ type: 'word', id: 'p' });
  await ask({ type: 'pause' }, { type: 'paused', id: 'p' });
  await ask({ type: 'jump', mark: 'm' }, { type: 'jumped', id: 'p', mark: 'm' });
  await ask({ type: 'resume' }, { type: 'resumed', id: 'p' });
  await ask({ type: 'stop' }, { type: 'end', id: 'p', reason: 'stopped' });
  await ask({ type: 'play', id: 'n', name: 'nod' }, { type: 'end', id: 'n', reason: 'done' });
  stream.send({ type: 'voice', id: 'v', rate: 16000, engine: 'network' });
  stream.socket.send(Buffer.alloc(16001)); // half a sample is left: a warning with its byte
  await ask({ type: 'close', id: 'v' }, { type: 'end', id: 'v' });
  stream.send({ type: 'hear', id: 'h', rate: 16000 });
  await ask({ type: 'close', id: 'h' }, { type: 'heard', id: 'h', final: true, confidence: 0.9 });
}

async function together() {
  const texture = { type: 'image/png', data: picture() };
  const stream = await enter('?room=hall');
  await stream.wait({ type: 'joined' });
  const desk = await enter('', other);
  desk.send({ type: 'join', room: 'hall', watch: true, as: 'Anna' });
  for (const [message, told] of [
    [{ type: 'choices', id: 'q', question: 'Sì?', choices: ['Sì'] }, { type: 'choices', id: 'q' }],
    [{ type: 'choose', id: 'q', choice: 0 }, { type: 'chosen', id: 'q' }],
    [{ type: 'ask', id: 'k', text: 'Sì?', choices: ['Sì'] }, { type: 'asked', id: 'k' }],
    [{ type: 'choose', id: 'k', choice: 0 }, { type: 'answered', id: 'k', choice: 0 }],
    [{ type: 'state', state: 'listening', text: 'Ciao' }, { type: 'state', text: 'Ciao' }],
    [{ type: 'calibrate', featurePointsCoord: { '8.3': [26, -62, 18] }, textureCoord: { '8.3': [0, 1] }, texture }, { type: 'calibrated', texture }],
    [{ type: 'calibrate', reset: true }, { type: 'calibrated', reset: true }],
    [{ type: 'head', head: 'mara' }, { type: 'head', head: 'mara' }],
    [{ type: 'lexicon', lexicon: '' }, { type: 'lexicon', lexicon: '' }],
    [{ type: 'express', mix: [{ name: 'joy', intensity: 0.5 }] }, { type: 'expressed' }],
    [{ type: 'backdrop', source: 'x.png' }, { type: 'backdrop', source: 'x.png' }],
    [{ type: 'consent', consent: 'asked', text: 'Va bene?' }, { type: 'consent', consent: 'asked' }],
    [{ type: 'consent', consent: 'given' }, { type: 'consent', consent: 'given' }],
  ]) {
    stream.send(message);
    await stream.wait(told);
  }
  await desk.wait({ type: 'observers', observers: [{ name: 'Anna', speaks: true }] });
  desk.send({ type: 'overhear' });
  desk.send({ type: 'ping', id: 'p' });
  await desk.wait({ type: 'pong' });
  stream.send({ type: 'hear', id: 'o', rate: 16000 });
  stream.socket.send(Buffer.alloc(640));
  stream.send({ type: 'close', id: 'o' });
  await desk.wait({ type: 'overheard', id: 'o', data: Buffer.alloc(640).toString('base64') });
  await desk.wait({ type: 'heard', id: 'o', final: true });
  stream.send({ type: 'drive', frames: [{ time: 0, faps: { 3: 1 } }] });
  await desk.wait({ type: 'driven', on: true });
  stream.send({ type: 'drive', on: false });
  await desk.wait({ type: 'driven', on: false });
  stream.send({ type: 'media', blocked: true });
  desk.send({ type: 'speak', id: 'a', text: 'Sì.', again: true }); // of a daemon that does not lead the room
  await stream.wait({ type: 'begin', id: 'a', again: true });
  await stream.wait({ type: 'end', id: 'a', blocked: true });
  stream.send({ type: 'leave' });
  await stream.wait({ type: 'left', room: 'hall' });
}

test('declares all messages, and sends every declared message', async () => {
  await alone();
  await together();
  const said = new Set();
  for (const { arrived: _, ...message } of streams.flatMap(({ messages }) => messages)) {
    assert.equal(violations('server', message), null, JSON.stringify(message).slice(0, 500));
    for (const member of Object.keys(message)) if (member !== 'type') said.add(`${message.type}.${member}`);
  }
  const members = Object.entries(declared.messages).flatMap(([type, { shares = [], members: own }]) =>
    [...shares.flatMap((name) => Object.keys(declared.shared[name].members)), ...Object.keys(own)].map((member) => `${type}.${member}`));
  assert.deepEqual([...said].sort(), [...new Set(members)].sort());
  for (const stream of streams) await stream.close();
});
