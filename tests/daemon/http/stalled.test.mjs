// SPDX-License-Identifier: GPL-3.0-or-later
// Clients that read nothing or too little: the daemon buffers little, disconnects them, and others are unaffected.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import { test } from 'node:test';
import { decodeChunk } from '../../../protocol/chunk/chunk.mjs';
import { Daemon, eventually } from '../../lib/daemon.mjs';
import { stalled } from '../../lib/stalled.mjs';

const text = 'Una frase dopo l’altra, senza fine e senza fretta. '.repeat(100);
const pcm = 'lang=it&audio=pcm&fap=plain';
const speak = JSON.stringify({ type: 'speak', text });
const megabytes = (daemon) => (Number(fs.readFileSync(`/proc/${daemon.process.pid}/statm`, 'utf8').split(' ')[1]) * 4096) / 1e6;

/** Starts a daemon that always ends with the test. */
async function start(t, ...options) {
  const daemon = await Daemon.start(options);
  t.after(async () => assert.deepEqual(await daemon.stop(), { code: 0, signal: null }));
  return daemon;
}
const stuck = async (t, daemon, ...args) => {
  const client = await stalled(daemon.port, ...args);
  t.after(() => client.close());
  return client;
};

/** Opens a room with a speaker and a listener; done() checks that neither missed anything. */
async function room(daemon, name) {
  const [speaker, listener] = [await daemon.stream(`?room=${name}&lang=it`), await daemon.stream(`?room=${name}`)];
  for (const stream of [speaker, listener]) await stream.wait({ type: 'joined' });
  return {
    speaker,
    async done() {
      speaker.send({ type: 'stop' });
      for (const stream of [speaker, listener]) {
        await stream.wait({ type: 'end', reason: 'stopped' });
        stream.chunks.forEach((c, i) => assert.equal(c.start, i ? stream.chunks[i - 1].start + stream.chunks[i - 1].samples : 0));
        assert.ok(!stream.messages.some((m) => m.code === 'skipped'));
        await stream.close();
      }
    },
  };
}

/** Waits until only those two are in the hall. */
async function left(daemon) {
  const ask = async () => (await (await daemon.get('/v1/rooms')).json()).rooms;
  await eventually(async () => (await ask())[0].followers === 2, 'the others to have left');
  assert.deepEqual(await ask(), [{ name: 'hall', followers: 2, listeners: 2, speaks: true }]);
}

test('disconnects a room member that stops reading, with the reason in the log', async (t) => {
  const daemon = await start(t, '--stall-seconds', '2');
  const { speaker, done } = await room(daemon, 'hall');
  for (const query of [`&${pcm}`, '']) await stuck(t, daemon, `/v1/stream?room=hall${query}`);
  await stuck(t, daemon, '/v1/events?room=hall');
  speaker.send({ type: 'speak', text, phones: true });
  await daemon.logged(/s3 takes nothing: closed \(too-slow\)/);
  await daemon.logged(/s4 takes nothing: closed \(too-slow\)/);
  await daemon.logged(/an HTTP client takes nothing: closed \(too-slow\)/, 60000);
  await left(daemon);
  assert.match(await (await daemon.get('/metrics')).text(), /^faccia_too_slow_total 3$/m);
  await done();
});

test('a room member that resumes reading is at the live edge, and learns that media were dropped', async (t) => {
  const daemon = await start(t, '--lag-seconds', '1', '--stall-seconds', '600');
  const { speaker, done } = await room(daemon, 'hall');
  const slow = await stuck(t, daemon, `/v1/stream?room=hall&${pcm}`);
  speaker.send({ type: 'speak', text });
  await speaker.until(() => speaker.chunks.length > 50);
  const missed = speaker.chunks.length;
  slow.read();
  await speaker.until(() => speaker.chunks.length > missed + 10);
  await done();
  const heard = slow.messages();
  const told = heard.findIndex((m) => m.code === 'skipped');
  assert.ok(told >= 0 && heard[told].type === 'warning');
  const starts = heard.filter((m) => m instanceof Uint8Array).map((m) => decodeChunk(m).start);
  const all = speaker.chunks.map((c) => c.start);
  const gap = starts.findIndex((start, i) => i && all.indexOf(start) !== all.indexOf(starts[i - 1]) + 1);
  assert.ok(gap > 0, 'something was left out');
  // media may be up to one second old; chunks are 0.2 s
  assert.ok(all.indexOf(starts[gap]) >= missed - 8, 'and it goes on with what is said now');
  assert.deepEqual(starts.slice(gap), all.slice(all.indexOf(starts[gap]), all.indexOf(starts.at(-1)) + 1), 'without a gap from there on');
  // no word is missing
  const words = (messages) => messages.filter((m) => m.type === 'word').map((m) => m.start);
  assert.deepEqual(words(heard), words(speaker.messages).slice(0, words(heard).length));
});

test('a private stream waits, then is closed; so is a request', async (t) => {
  const daemon = await start(t, '--stall-seconds', '3');
  await stuck(t, daemon, `/v1/stream?${pcm}`, speak);
  const before = megabytes(daemon);
  // more than an hour of speech, which would be 200 MB
  await stuck(t, daemon, '/v1/speech?lang=it', text.repeat(18));
  await daemon.logged(/an HTTP client takes nothing/);
  const grown = megabytes(daemon) - before;
  assert.ok(grown < 60, `${grown} MB more`);
  await daemon.logged(/s1 takes nothing/);
  const stream = await daemon.stream('?lang=it');
  stream.send({ type: 'speak', id: 'a', text: 'Sì.' });
  await stream.wait({ type: 'end', id: 'a', reason: 'done' });
  await stream.close();
});

test('disconnects a client that answers no ping; keeps a silent one that answers', async (t) => {
  const daemon = await start(t, '--ping-seconds', '1');
  const mute = await daemon.stream('', { autoPong: false }), quiet = await daemon.stream();
  const pings = { mute: 0, quiet: 0 };
  mute.socket.on('ping', () => pings.mute++);
  quiet.socket.on('ping', () => pings.quiet++);
  assert.equal((await mute.closed).code, 1006, 'cut, not closed');
  await daemon.logged(/s1 does not answer: closed/);
  assert.equal(pings.mute, 1);
  // pinged repeatedly
  await eventually(() => pings.quiet >= 3, 'three pings');
  quiet.send({ type: 'ping', id: 'p' });
  await quiet.wait({ type: 'pong', id: 'p' });
  await quiet.close();
});

test('disconnected listeners do not affect the others', async (t) => {
  const daemon = await start(t);
  const { speaker, done } = await room(daemon, 'hall');
  speaker.send({ type: 'speak', text });
  for (let round = 0; round < 10; round++) {
    const crowd = await Promise.all(Array.from({ length: 10 }, () => daemon.stream('?room=hall')));
    const chunks = speaker.chunks.length;
    await speaker.until(() => speaker.chunks.length > chunks); // so that the daemon writes to them
    daemon.process.kill('SIGSTOP'); // when resumed, it writes before it notices that they are gone
    for (const stream of crowd) stream.socket._socket.resetAndDestroy();
    await Promise.all(crowd.map(({ closed }) => closed));
    daemon.process.kill('SIGCONT');
  }
  await left(daemon);
  await done();
});
