// SPDX-License-Identifier: GPL-3.0-or-later
// Rooms: all listeners hear the same at the same time; late joiners, slow clients, permissions.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import net from 'node:net';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { build, Daemon, eventually } from '../../lib/daemon.mjs';

let daemon;
before(async () => (daemon = await Daemon.start()));
after(async () => assert.deepEqual(await daemon.stop(), { code: 0, signal: null }));

const text = 'La prima frase è breve. La seconda frase dura un poco di più, e poi finisce. La terza chiude.';
const bytes = (stream) => stream.raw.map((data) => Buffer.from(data).toString('base64'));
const enter = async (room, daemonOf = daemon, options = {}) => {
  const stream = await daemonOf.stream(`?room=${room}`, options);
  stream.raw = [];
  stream.socket.on('message', (data, binary) => binary && stream.raw.push(data));
  await stream.wait({ type: 'joined', room });
  return stream;
};

test('a room’s speech reaches all its listeners, identical to the byte, and no one else', async () => {
  const [speaker, ...listeners] = await Promise.all([1, 2, 3, 4].map(() => enter('hall')));
  const elsewhere = await enter('cellar');
  const alone = await daemon.stream();
  speaker.send({ type: 'speak', id: 's', lang: 'it', text });
  for (const stream of [speaker, ...listeners]) await stream.wait({ type: 'end', id: 's', reason: 'done' });
  for (const listener of listeners) {
    assert.deepEqual(bytes(listener), bytes(speaker));
    const told = (stream) => stream.messages.filter((m) => m.utterance).map(({ arrived, ...message }) => message);
    assert.deepEqual(told(listener), told(speaker));
    assert.equal(listener.messages.find((m) => m.type === 'begin').stream, 'hall');
  }
  assert.equal(elsewhere.chunks.length + alone.chunks.length, 0);
  // without tokens, any member may stop the speech
  speaker.send({ type: 'speak', id: 't', lang: 'it', text: text.repeat(5) });
  await listeners[1].wait({ type: 'word', id: 't' });
  listeners[2].send({ type: 'stop' });
  for (const stream of [speaker, ...listeners]) await stream.wait({ type: 'end', id: 't', reason: 'stopped' });
  for (const stream of [speaker, ...listeners, elsewhere, alone]) await stream.close();
});

test('a late joiner hears current speech from its current position', async () => {
  const speaker = await enter('late');
  speaker.send({ type: 'speak', id: 's', lang: 'it', text });
  const second = await speaker.wait((m) => m.type === 'sentence' && m.start > 0);
  await speaker.wait((m) => m.type === 'word' && m.start > second.start);
  const late = await enter('late');
  const begin = await late.wait({ type: 'begin', id: 's' });
  assert.deepEqual({ ...begin, arrived: 0 }, { ...(await speaker.wait({ type: 'begin' })), arrived: 0 });
  const sentence = await late.wait({ type: 'sentence' });
  assert.equal(sentence.start, second.start);
  await late.wait({ type: 'end', id: 's' });
  await speaker.wait({ type: 'end', id: 's' });
  const words = (stream) => stream.messages.filter((m) => m.type === 'word' && m.start >= second.start).map((m) => m.text);
  assert.deepEqual(words(late), words(speaker));
  const heard = bytes(late);
  assert.ok(heard.length > 5 && heard.length < bytes(speaker).length);
  assert.deepEqual(heard, bytes(speaker).slice(-heard.length));
  await late.close();
  await speaker.close();
});

test('creates rooms on entering, lists them, and removes them with the last member', async () => {
  const rooms = async () => (await (await daemon.get('/v1/rooms')).json()).rooms.filter((room) => room.name.startsWith('made'));
  const stream = await daemon.stream();
  stream.send({ type: 'join', room: 'made' });
  await stream.wait({ type: 'joined', room: 'made', followers: 1, may_speak: true });
  const other = await enter('made');
  assert.deepEqual(await rooms(), [{ name: 'made', followers: 2, listeners: 2, speaks: false }]);
  stream.send({ type: 'join', room: 'made.too' });
  await stream.wait({ type: 'joined', room: 'made.too' });
  assert.equal((await rooms()).length, 2);
  stream.send({ type: 'leave' });
  await stream.wait({ type: 'left', room: 'made.too' });
  stream.send({ type: 'speak', id: 'own', lang: 'it', text: 'Sì.' });
  assert.notEqual((await stream.wait({ type: 'begin', id: 'own' })).stream, 'made.too');
  await other.close();
  await stream.wait({ type: 'end', id: 'own' });
  await eventually(async () => !(await rooms()).length, 'no room, when nobody is in it');
  for (const room of ['', 'a b', 'x'.repeat(65), '../etc', 'né']) {
    stream.send({ type: 'join', room });
    await stream.wait((m) => m.type === 'error' && m.field === 'room', { from: stream.messages.length });
  }
  await stream.close();
});

test('limits the number of rooms', async () => {
  const small = await Daemon.start(['--max-rooms', '2']);
  const kept = [await enter('a', small), await enter('b', small)];
  const third = await small.stream('?room=c');
  await third.wait({ type: 'error', code: 'too-many-rooms' });
  await kept[0].close();
  third.send({ type: 'join', room: 'a' });
  await third.wait({ type: 'joined', room: 'a' });
  assert.equal((await small.stop()).code, 0);
});

test('idling in a room reaches members that want it, and lasts while one does', async () => {
  const [a, b] = [await enter('quiet'), await enter('quiet')];
  a.send({ type: 'idle', on: true, seed: 3 });
  await a.until(() => a.chunks.filter((c) => c.utterance === 0).length > 3);
  assert.equal(b.chunks.length, 0);
  b.send({ type: 'idle', on: true });
  await b.until(() => b.chunks.length > 2);
  await a.close();
  const count = b.chunks.length;
  await b.until(() => b.chunks.length > count + 3);
  await b.close();
});

test('each listener selects its media; unknown codecs are refused', async () => {
  const all = await enter('codecs');
  const faces = await daemon.stream('?room=codecs&audio=none&fap=plain');
  const sounds = await daemon.stream('?room=codecs&audio=pcm&fap=none');
  const texts = await daemon.stream('?room=codecs&audio=none&fap=none');
  all.send({ type: 'speak', id: 's', lang: 'it', text });
  for (const stream of [all, faces, sounds, texts]) await stream.wait({ type: 'end', id: 's' });
  assert.ok(all.chunks.every((c) => c.audio?.length > 0));
  assert.ok(faces.chunks.length > 10 && faces.chunks.every((c) => !c.audio));
  assert.deepEqual(faces.chunks.flatMap((c) => c.frames), all.chunks.flatMap((c) => c.frames));
  assert.ok(sounds.chunks.length > 10 && sounds.chunks.every((c) => c.frames.length === 0));
  assert.equal(texts.chunks.length, 0);
  faces.send({ type: 'media', audio: 'mp3' });
  await faces.wait({ type: 'error', code: 'unknown-codec', field: 'audio' });
  for (const stream of [all, faces, sounds, texts]) await stream.close();
});

test('prints room events for shell scripts, as they happen', async () => {
  const room = await enter('shell');
  const response = await daemon.get('/v1/events?room=shell');
  assert.equal(response.headers.get('content-type'), 'text/event-stream');
  const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
  room.send({ type: 'speak', id: 's', lang: 'it', text: 'Ciao a tutti.' });
  let heard = '';
  while (!heard.includes('event: end')) heard += (await reader.read()).value;
  await reader.cancel();
  const events = heard.split('\n\n').filter((block) => block.startsWith('event:')).map((block) => {
    const [event, data] = block.split('\n');
    return { event: event.slice(7), ...JSON.parse(data.slice(6)) };
  });
  assert.ok(events.every((e) => e.event === e.type));
  assert.deepEqual(events.filter((e) => e.type === 'word').map((e) => e.text), ['Ciao', 'a', 'tutti']);
  await room.close();
  assert.equal((await daemon.get('/v1/events')).status, 400);
});

test('speaks a word from the shell in a room', async () => {
  const room = await enter('kitchen');
  const say = (query, body) => daemon.get(`/v1/say?${query}`, { method: 'POST', body });
  assert.deepEqual((await say('room=kitchen&lang=it', 'A tavola!')).status, 202);
  await room.wait({ type: 'word', text: 'tavola' });
  await room.wait({ type: 'end', reason: 'done' });
  assert.equal((await say('room=nowhere', 'Ehi!')).status, 202);
  assert.equal((await say('', 'Ehi!')).status, 400);
  assert.equal((await say('room=kitchen&rate=1', 'Ehi!')).status, 400);
  await say('room=kitchen&lang=it', text.repeat(3));
  await room.wait({ type: 'word', utterance: 2 });
  assert.equal((await daemon.get('/v1/stop?room=kitchen', { method: 'POST' })).status, 200);
  await room.wait({ type: 'end', utterance: 2, reason: 'stopped' });
  await room.close();
});

test('a member that stops reading skips media, and delays no one', async () => {
  const small = await Daemon.start(['--send-bytes', '20000', '--send-bytes-max', '1000000', '--stall-seconds', '60']);
  const speaker = await enter('slow', small);
  const slow = await enter('slow', small);
  slow.socket._socket.pause();
  const long = 'Una frase dopo l’altra, senza fine e senza fretta. '.repeat(40);
  speaker.send({ type: 'speak', id: 's', lang: 'it', text: long, rate: 400 });
  // the kernel's buffers take the first media
  await speaker.until(() => speaker.chunks.length > 60, 40000);
  slow.socket._socket.resume();
  await slow.until(() => slow.chunks.at(-1)?.firstFrame >= speaker.chunks.at(-1)?.firstFrame - 10, 20000);
  speaker.send({ type: 'stop' });
  await slow.wait({ type: 'end', id: 's', reason: 'stopped' });
  assert.equal((await small.stop()).code, 0);
});

test('with tokens: listeners listen, speakers speak, each in its room', async () => {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-rooms-'));
  const secrets = path.join(folder, 'secrets');
  fs.writeFileSync(secrets, 'x'.repeat(40));
  const token = (...options) =>
    spawnSync(path.join(build, 'server/cli/faccia'), ['token', '--secret-file', secrets, '--subject', 'a', ...options], { encoding: 'utf8' }).stdout.trim();
  const guarded = await Daemon.start(['--secret-file', secrets]);
  const with_ = (text) => ({ headers: { authorization: `Bearer ${text}` } });
  const speaker = await enter('hall', guarded, with_(token('--room', 'hall', '--rights', 'listen,speak')));
  const listener = await enter('hall', guarded, with_(token('--room', 'hall', '--rights', 'listen')));
  assert.equal((await listener.wait({ type: 'joined' })).may_speak, false);
  listener.send({ type: 'speak', id: 'no', lang: 'it', text: 'No.' });
  await listener.wait({ type: 'error', id: 'no', code: 'forbidden' });
  await listener.wait({ type: 'end', id: 'no', reason: 'failed' });
  for (const type of ['stop', 'express']) {
    listener.send({ type, mix: [] });
    await listener.wait({ type: 'error', code: 'forbidden' }, { from: listener.messages.length });
  }
  speaker.send({ type: 'speak', id: 'yes', lang: 'it', text: 'Sì.' });
  await listener.wait({ type: 'end', id: 'yes', reason: 'done' });
  assert.ok(!speaker.messages.some((m) => m.id === 'no'), 'others need not hear of it');
  const stranger = await guarded.stream('?room=hall', with_(token('--room', 'cellar')));
  await stranger.wait({ type: 'error', code: 'forbidden' });
  const nobody = await guarded.stream('?room=hall');
  await nobody.wait({ type: 'error', code: 'token-needed' });
  assert.equal((await guarded.get('/v1/rooms')).status, 401);
  assert.equal((await guarded.get('/v1/say?room=hall', { method: 'POST', body: 'x', ...with_(token('--room', 'hall', '--rights', 'listen')) })).status, 403);
  assert.equal((await guarded.get('/v1/say?room=hall&lang=it', { method: 'POST', body: 'Sì.', ...with_(token('--room', 'hall')) })).status, 202);
  assert.equal((await guarded.stop()).code, 0);
  fs.rmSync(folder, { recursive: true });
});

test('1000 short connections leak nothing', async () => {
  const busy = await Daemon.start(['--max-connections', '2000']);
  for (let round = 0; round < 10; round++) {
    const sockets = await Promise.all(
      Array.from({ length: 100 }, async (_, i) => {
        if (i % 3 === 0) {
          // a client that never finishes its request
          const socket = net.connect(busy.port, '127.0.0.1');
          await new Promise((resolve) => socket.on('connect', resolve));
          socket.on('error', () => {});
          socket.write('GET /v1/stream HTTP/1.1\r\nHost: localhost\r\n');
          return { close: () => socket.destroy() };
        }
        const stream = await busy.stream(i % 2 ? `?room=r${i % 7}` : '');
        if (i % 5 === 0) stream.send({ type: 'speak', lang: 'it', text });
        return stream;
      }),
    );
    await Promise.all(sockets.map((socket) => socket.close()));
  }
  await busy.left(2);
  assert.deepEqual((await (await busy.get('/v1/rooms')).json()).rooms, []);
  const last = await busy.stream();
  last.send({ type: 'speak', id: 'l', lang: 'it', text: 'Sì.' });
  await last.wait({ type: 'end', id: 'l', reason: 'done' });
  assert.equal((await busy.stop()).code, 0);
});
