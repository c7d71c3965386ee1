// SPDX-License-Identifier: MIT
import assert from 'node:assert/strict';
import test from 'node:test';
import { Backoff, Connection } from '../../../web/element/stream/connection.mjs';

/** A connection with a simulated clock. */
function rig() {
  const sockets = [];
  const states = [];
  const heard = [];
  let timers = [];
  let now = 0;
  class Socket {
    constructor(url, protocol) {
      Object.assign(this, { url, protocol, sent: [], closed: false });
      sockets.push(this);
    }
    send(text) {
      this.sent.push(JSON.parse(text));
    }
    close() {
      this.closed = true;
    }
    hear(message) {
      this.onmessage({ data: typeof message === 'string' ? message : JSON.stringify(message) });
    }
  }
  const connection = new Connection(
    'ws://there/v1/stream',
    { onstate: (state) => states.push(state), onmessage: (message) => heard.push(message), onmedia: (data) => heard.push(data) },
    {
      WebSocket: Socket,
      random: () => 1,
      setTimeout: (act, after) => timers.push({ act, at: now + after, id: timers.length }) && timers.at(-1),
      clearTimeout: (timer) => (timers = timers.filter((other) => other !== timer)),
    },
  );
  const pass = (milliseconds) => {
    const end = now + milliseconds;
    for (;;) {
      const due = timers.filter(({ at }) => at <= end).sort((a, b) => a.at - b.at)[0];
      if (!due) break;
      timers = timers.filter((timer) => timer !== due);
      now = due.at;
      due.act();
    }
    now = end;
  };
  return { connection, sockets, states, heard, pass };
}

const hello = { type: 'hello', protocol: 1 };

test('retry delays double up to a limit, with jitter, and reset', () => {
  const steady = new Backoff({ first: 500, limit: 4000, random: () => 1 });
  assert.deepEqual([1, 2, 3, 4, 5].map(() => steady.next()), [500, 1000, 2000, 4000, 4000]);
  steady.reset();
  assert.equal(steady.next(), 500);
  assert.equal(new Backoff({ first: 500, random: () => 0 }).next(), 250);
});

test('is open when the server has said hello, not before', () => {
  const { connection, sockets, states } = rig();
  connection.open();
  assert.equal(sockets[0].protocol, 'faccia.v1');
  assert.equal(connection.send({ type: 'stop' }), false);
  sockets[0].hear(hello);
  assert.deepEqual(states.map(({ state }) => state), ['connecting', 'open']);
  assert.equal(connection.send({ type: 'stop' }), true);
  assert.deepEqual(sockets[0].sent, [{ type: 'stop' }]);
});

test('retries a lost link with growing delays until it holds', () => {
  const { connection, sockets, states, pass } = rig();
  connection.open();
  sockets[0].onclose();
  assert.deepEqual(states.at(-1), { state: 'waiting', retryIn: 500 });
  pass(499);
  assert.equal(sockets.length, 1);
  pass(1);
  sockets[1].onclose();
  assert.equal(states.at(-1).retryIn, 1000);
  pass(1000);
  sockets[2].hear(hello);
  sockets[2].onclose();
  assert.equal(states.at(-1).retryIn, 2000, 'hello alone proves nothing');
  pass(2000);
  sockets[3].hear(hello);
  pass(5000);
  sockets[3].onclose();
  assert.equal(states.at(-1).retryIn, 500);
});

test('notices a link that died silently', () => {
  const { connection, sockets, states, pass } = rig();
  connection.open();
  sockets[0].hear(hello);
  pass(20000);
  assert.deepEqual(sockets[0].sent, [{ type: 'ping', id: 'alive' }]);
  sockets[0].hear({ type: 'pong', id: 'alive' });
  pass(20000);
  assert.equal(sockets[0].sent.length, 2);
  assert.equal(states.at(-1).state, 'open');
  pass(10000);
  assert.equal(states.at(-1).state, 'waiting');
  assert.ok(sockets[0].closed);
});

test('ignores messages of an old link', () => {
  const { connection, sockets, heard, pass } = rig();
  connection.open();
  const [old] = sockets;
  old.hear(hello);
  old.onclose();
  pass(500);
  sockets[1].hear(hello);
  old.hear({ type: 'word' });
  old.onclose();
  assert.deepEqual(heard, [hello, hello]);
  assert.equal(connection.state, 'open');
});

test('stays closed when closed on purpose', () => {
  const { connection, sockets, states, pass } = rig();
  connection.open();
  sockets[0].hear(hello);
  connection.close();
  pass(100000);
  assert.equal(sockets.length, 1);
  assert.ok(sockets[0].closed);
  assert.equal(states.at(-1).state, 'closed');
});

test('reconnects at once when the network is back', () => {
  const { connection, sockets, pass } = rig();
  connection.open();
  sockets[0].onclose();
  connection.hurry();
  assert.equal(sockets.length, 2);
  connection.hurry();
  pass(1000);
  assert.equal(sockets.length, 2, 'nor tries twice');
});
