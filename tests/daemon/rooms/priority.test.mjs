// SPDX-License-Identifier: GPL-3.0-or-later
// Order of utterances in a room: priorities and topics; observers, and speech that no listener came to hear.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Daemon } from '../../lib/daemon.mjs';

let daemon, stream;
before(async () => {
  daemon = await Daemon.start(['--max-queue', '5']);
  stream = await daemon.stream('?lang=it');
});
after(async () => {
  await stream.close();
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});

const long = 'Una frase che dura abbastanza a lungo perché qualcosa le passi davanti, e poi ancora un poco.';
const speak = (id, more = {}) => stream.send({ type: 'speak', id, text: 'Sì.', ...more });
const told = () => stream.messages.filter((m) => m.type === 'begin' || m.type === 'end').map((m) => `${m.id} ${m.reason ?? 'begins'}`);

/** Returns the events during `act`, until the queue is empty. */
async function during(act) {
  stream.messages.length = 0;
  await act();
  speak('last', { priority: 'background' });
  await stream.wait({ type: 'end', id: 'last' });
  return told().filter((line) => !line.startsWith('last'));
}
const begun = (id, more) => {
  speak(id, { text: long, ...more });
  return stream.wait({ type: 'begin', id });
};

test('an alarm interrupts current speech, and precedes queued speech', async () => {
  const lines = await during(async () => {
    await begun('talk');
    speak('later');
    speak('news', { priority: 'background' });
    speak('fire', { priority: 'alarm', text: long });
    speak('smoke', { priority: 'alarm' });
    speak('soon');
  });
  assert.deepEqual(lines, ['talk begins', 'talk stopped', 'fire begins', 'fire done', 'smoke begins', 'smoke done', 'later begins', 'later done', 'soon begins', 'soon done', 'news begins', 'news done']);
});

for (const mode of ['replace', 'interrupt'])
  test(`${mode} neither cuts nor drops an alarm`, async () => {
    const lines = await during(async () => {
      await begun('fire', { priority: 'alarm' });
      speak('smoke', { priority: 'alarm' });
      speak('talk');
      speak('now', { mode });
    });
    const rest = mode === 'replace' ? [] : ['talk begins', 'talk done']; // with `interrupt`, waiting utterances follow
    assert.deepEqual(lines.filter((line) => line !== 'talk stopped'), ['fire begins', 'fire done', 'smoke begins', 'smoke done', 'now begins', 'now done', ...rest]);
    assert.equal(lines.includes('talk stopped'), mode === 'replace');
  });

test('plays an alarm during a pause', async () => {
  const lines = await during(async () => {
    await begun('talk');
    stream.send({ type: 'pause' });
    await stream.wait({ type: 'paused' });
    speak('fire', { priority: 'alarm' });
    await stream.wait({ type: 'resumed' });
  });
  assert.deepEqual(lines, ['talk begins', 'talk stopped', 'fire begins', 'fire done']);
});

test('a full queue drops the last utterance of a lower priority, or refuses the new one', async () => {
  const lines = await during(async () => {
    await begun('fire', { priority: 'alarm' });
    for (const id of ['a', 'g', 'h']) speak(id);
    speak('b', { priority: 'background' });
    speak('c', { priority: 'background' });
    speak('d');
    speak('e');
    speak('f');
    await stream.wait({ type: 'error', id: 'f', code: 'queue-full' });
    stream.send({ type: 'cancel', id: 'd' });
  });
  assert.deepEqual(lines, ['fire begins', 'c stopped', 'b stopped', 'f failed', 'd stopped', 'fire done', 'a begins', 'a done', 'g begins', 'g done', 'h begins', 'h done', 'e begins', 'e done']);
});

test('a topic replaces queued speech of that topic, not current speech', async () => {
  const lines = await during(async () => {
    await begun('one', { topic: 'timer' });
    speak('two', { topic: 'timer' });
    speak('else', { topic: 'door' });
    speak('three', { topic: 'timer' });
  });
  assert.deepEqual(lines, ['one begins', 'two stopped', 'one done', 'else begins', 'else done', 'three begins', 'three done']);
});

test('quiet speaks only in silence, and is otherwise refused, over HTTP with 409', async () => {
  const lines = await during(async () => {
    speak('first', { mode: 'quiet', text: long });
    await stream.wait({ type: 'begin', id: 'first' });
    speak('second', { mode: 'quiet' });
    await stream.wait({ type: 'error', id: 'second', code: 'busy' });
  });
  assert.deepEqual(lines, ['first begins', 'second failed', 'first done']);
  const room = await daemon.stream('?lang=it&room=hall');
  const say = (id) => daemon.get(`/v1/say?room=hall&lang=it&mode=quiet&id=${id}`, { method: 'POST', body: long });
  assert.equal((await say('a')).status, 202);
  const refused = await say('b');
  assert.deepEqual([refused.status, (await refused.json()).code], [409, 'busy']);
  await room.wait({ type: 'end', id: 'a', reason: 'done' });
  await room.close();
});

test('reports invalid values', async () => {
  stream.messages.length = 0;
  speak('x', { priority: 'highest' });
  assert.match((await stream.wait({ type: 'error', id: 'x', field: 'priority' })).message, /background, chat, alarm/);
  speak('y', { topic: 'x'.repeat(65) });
  await stream.wait({ type: 'error', id: 'y', field: 'topic' });
  stream.send({ type: 'join', room: 'hall', watch: 'yes' });
  await stream.wait({ type: 'error', code: 'bad-field', field: 'watch' });
  assert.equal((await daemon.get('/v1/events?room=hall&watch=perhaps')).status, 400);
});

test('an observer is not a listener: held speech waits for one, alarms first, and expires with a message', async () => {
  const own = await Daemon.start(['--hold', '2']);
  const say = async (id, query = '') => (await own.get(`/v1/say?room=hall&lang=it&id=${id}${query}`, { method: 'POST', body: 'Sì.' })).json();
  const desk = await own.stream('?lang=it&room=hall&watch=1');
  await desk.wait({ type: 'joined' });
  assert.deepEqual(await say('lost'), { type: 'accepted', room: 'hall', listeners: 0, held: 2 });
  assert.deepEqual((await (await own.get('/v1/rooms')).json()).rooms, [{ name: 'hall', followers: 1, listeners: 0, speaks: false }]);
  await desk.wait({ type: 'error', id: 'lost', code: 'unheard' });
  await desk.wait({ type: 'end', id: 'lost', reason: 'failed' });
  await say('a');
  await say('old', '&topic=timer');
  await say('b', '&priority=alarm');
  await say('new', '&topic=timer');
  await desk.wait({ type: 'error', id: 'old', code: 'unheard' });
  const kiosk = await own.stream('?lang=it&room=hall');
  await kiosk.wait({ type: 'end', id: 'new', reason: 'done' });
  assert.deepEqual(desk.messages.filter((m) => m.type === 'begin').map((m) => m.id), ['b', 'a', 'new']);
  assert.equal((await say('c')).listeners, 1);
  // an observer may become a listener
  await kiosk.close();
  await own.left(2);
  await say('d');
  desk.send({ type: 'join', room: 'hall' });
  await desk.wait({ type: 'end', id: 'd', reason: 'done' });
  await desk.close();
  assert.equal((await own.stop()).code, 0);
});
