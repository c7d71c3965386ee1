// SPDX-License-Identifier: GPL-3.0-or-later
// Long messages are parsed on another thread: other clients are served meanwhile, and the client's next messages wait.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Daemon } from '../../lib/daemon.mjs';

let daemon;
before(async () => (daemon = await Daemon.start(['--max-text', '20000000', '--max-message', '20000000'])));
after(async () => assert.deepEqual(await daemon.stop(), { code: 0, signal: null }));

// parsing takes a fraction of a second
const long = (more) => JSON.stringify({ type: 'ping', ...more, much: Array.from({ length: 300000 }, (_, i) => i % 1000) });

test('serves others while it reads a long message', async () => {
  const [talker, other] = await Promise.all([daemon.stream(), daemon.stream()]);
  const text = long({ id: 'long' });
  talker.socket.send(text.slice(0, -1), { fin: false });
  other.send({ type: 'ping', id: 'first' });
  await other.wait({ type: 'pong', id: 'first' });
  // the pong to a control frame shows that all but the last byte have arrived
  await new Promise((resolve) => {
    talker.socket.once('pong', resolve);
    talker.socket.ping();
  });
  talker.socket.send(text.slice(-1), { fin: true });
  let served = 0;
  const answered = talker.wait({ type: 'pong', id: 'long' }).then(() => (served = -served));
  for (let i = 0; served >= 0 && i < 100000; i++) {
    other.send({ type: 'ping', id: i });
    await other.wait({ type: 'pong', id: i }, { from: other.messages.length });
    if (served >= 0) served++;
  }
  await answered;
  // requests that the loop served meanwhile; it would be one or two if it parsed the message itself
  assert.ok(-served > 4, `${-served} were served`);
});

test('executes commands after a long message in order', async () => {
  const stream = await daemon.stream();
  const bad = '{"type":"ping","much":[' + '1,'.repeat(50000) + '}';
  stream.socket._socket.cork();
  stream.send(long({ id: 1 }));
  stream.send({ type: 'ping', id: 2 });
  stream.socket.send(Buffer.from('x'));
  stream.send(long({ id: 3 }));
  stream.send(bad);
  stream.send({ type: 'ping', id: 4 });
  stream.socket._socket.uncork();
  await stream.wait({ type: 'pong', id: 4 });
  const answers = stream.messages.filter((m) => m.type === 'pong' || m.type === 'error').map((m) => m.id ?? m.code);
  assert.deepEqual(answers, [1, 2, 'binary-message', 3, 'bad-json', 4]);
  assert.equal(stream.messages.find((m) => m.code === 'bad-json').byte, bad.length - 1);
});

test('answers a close behind a long message afterwards; a client may disconnect meanwhile', async () => {
  const [closes, goes] = await Promise.all([daemon.stream(), daemon.stream()]);
  goes.send(long({ id: 1 }));
  closes.send(long({ id: 1 }));
  closes.socket.close(1000);
  setTimeout(() => goes.socket.terminate(), 30); // somewhere in the middle of parsing
  assert.equal((await closes.closed).code, 1000);
  assert.ok(closes.messages.some((m) => m.type === 'pong'));
  await goes.closed;
  assert.equal((await daemon.get('/healthz')).status, 200);
});

test('stops while it reads a long message', async () => {
  const own = await Daemon.start(['--max-message', '20000000']);
  const stream = await own.stream();
  stream.send(long({ id: 1 }));
  await new Promise((resolve) => setTimeout(resolve, 50)); // somewhere in the middle of parsing
  assert.deepEqual(await own.stop(), { code: 0, signal: null });
});

test('speaks a long text like a short one', async () => {
  const stream = await daemon.stream('?lang=it');
  stream.send({ type: 'speak', id: 'long', text: 'La mamma parla. '.repeat(5000) });
  stream.send({ type: 'stop' });
  stream.send({ type: 'speak', id: 'short', text: 'Ciao.' });
  assert.equal((await stream.wait({ type: 'end', id: 'long' })).reason, 'stopped');
  assert.equal((await stream.wait({ type: 'end', id: 'short' })).reason, 'done');
});
