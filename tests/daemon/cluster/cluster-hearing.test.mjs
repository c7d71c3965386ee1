// SPDX-License-Identifier: GPL-3.0-or-later
// A screen at a daemon that does not lead its room is heard, too: that daemon recognises, and the leader acts on the words.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Daemon, eventually } from '../../lib/daemon.mjs';
import { Redis } from '../../lib/redis.mjs';

let redis;
const daemons = [];
before(async () => {
  redis = await Redis.start();
  for (let i = 0; i < 2; i++) daemons.push(await Daemon.start(['--cluster', redis.url, '--recogniser', "cat >/dev/null; echo 'la seconda'"]));
  for (const daemon of daemons) await eventually(async () => (await (await daemon.get('/healthz')).json()).cluster === 'up', 'the cluster');
});
after(async () => {
  for (const daemon of daemons) assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  redis?.stop();
});

test('the words of a screen choose an answer and reach the operator, whichever daemon the screen is at', async () => {
  for (const [own, other] of [daemons, [...daemons].reverse()]) {
    const room = `room-${daemons.indexOf(own)}`, desk = await own.stream(`?room=${room}&watch=1`); // own leads
    await desk.wait({ type: 'joined' });
    const screen = await other.stream(`?room=${room}&lang=it`);
    const { stream: me } = await screen.wait({ type: 'hello' });
    await screen.wait({ type: 'joined' });
    await desk.wait(({ type }) => type === 'observers');
    desk.send({ type: 'ask', id: 'q', lang: 'it', text: 'Tè o caffè?', choices: ['Tè', 'Caffè'] });
    await screen.wait({ type: 'asked', id: 'q' });
    screen.send({ type: 'hear', id: 'h', codec: 'pcm_s16le', rate: 16000, lang: 'it' });
    screen.socket.send(Buffer.alloc(3200));
    screen.send({ type: 'close', id: 'h' });
    assert.equal((await screen.wait({ type: 'heard', id: 'h', final: true })).text, 'la seconda');
    assert.equal((await desk.wait({ type: 'heard', id: 'h', final: true })).by, me);
    for (const stream of [desk, screen]) assert.equal((await stream.wait({ type: 'chosen', id: 'q' })).text, 'Caffè');
    assert.equal((await desk.wait({ type: 'answered', id: 'q' })).reason, 'chosen');
    assert.equal(screen.messages.filter(({ type, final }) => type === 'heard' && final).length, 1);
    assert.deepEqual([...screen.messages, ...desk.messages].filter(({ type }) => type === 'error'), []);
    screen.socket.close();
    desk.socket.close();
  }
});
