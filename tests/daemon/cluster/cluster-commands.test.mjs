// SPDX-License-Identifier: GPL-3.0-or-later
// Commands to a room's leader that falls silent, forgets them, or reuses another leader's numbers: each sender gets exactly one end per utterance, in order.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Daemon, eventually } from '../../lib/daemon.mjs';
import { Redis } from '../../lib/redis.mjs';
import { StandInLeader } from '../../lib/stand-in-leader.mjs';

let redis, daemon;
before(async () => {
  redis = await Redis.start();
  daemon = await Daemon.start(['--cluster', redis.url]);
  await eventually(async () => (await (await daemon.get('/healthz')).json()).cluster === 'up', 'the cluster to be up');
});
after(async () => {
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  redis.stop();
});

const begin = (utterance, id) => ({ type: 'begin', utterance, id, rate: 22050 });
const ended = (utterance, id, reason) => ({ type: 'end', utterance, id, reason, duration: 0 });
const ends = (asker, id) => asker.messages.filter((message) => message.type === 'end' && message.id === id).map(({ reason }) => reason);

/** Opens a room led by a stand-in and joins a client, which has received the recap. */
async function enter(t, room) {
  const leader = await StandInLeader.open(redis, room, 1000);
  const asker = await daemon.stream(`?lang=it&room=${room}`);
  t.after(() => {
    leader.close();
    asker.socket.terminate();
  });
  const { from } = await leader.told('here');
  leader.recap(from);
  return { leader, asker, from };
}
/** Waits until everything sent before has arrived. */
async function settled(leader, from, asker) {
  leader.say(from, null, begin(99, 'last'), ended(99, 'last', 'done'));
  await eventually(() => ends(asker, 'last').length, 'the last');
}

test('a command reported as failed does not end twice when the leader forgets or speaks it', async (t) => {
  const { leader, asker, from } = await enter(t, 'forgets');
  asker.send({ type: 'speak', id: 'waits', text: 'Uno.' });
  asker.send({ type: 'speak', id: 'speaks', text: 'Due.' });
  const [waits, speaks] = [await leader.told('command', ({ command }) => command.request.id === 'waits'), await leader.told('command', ({ command }) => command.request.id === 'speaks')];
  leader.recap(from); // a second recap: messages were missed
  const { visit } = await leader.told('here', (head) => head.visit > waits.visit);
  assert.ok(visit);
  await eventually(() => ends(asker, 'waits').length && ends(asker, 'speaks').length, 'to be told');
  leader.recap(from);
  leader.say(from, waits, { type: 'error', utterance: 5, id: 'waits', code: 'room-away', message: '' }, ended(5, 'waits', 'failed'));
  leader.say(from, speaks, begin(6, 'speaks'), ended(6, 'speaks', 'done'));
  await settled(leader, from, asker);
  assert.deepEqual([ends(asker, 'waits'), ends(asker, 'speaks')], [['failed'], ['failed']]);
  assert.ok(!asker.messages.some(({ type, id }) => type === 'begin' && id === 'speaks'));
});

test('a lost answer: speech that was heard counts as answered', async (t) => {
  const { leader, asker, from } = await enter(t, 'unanswered');
  asker.send({ type: 'speak', id: 'heard', text: 'Uno.', again: true });
  const command = await leader.told('command');
  leader.say(from, command, begin(5, 'heard'), ended(5, 'heard', 'done'));
  await eventually(() => ends(asker, 'heard').length, 'its end');
  // the next leader does not get the command again
  const next = await StandInLeader.open(redis, 'unanswered', 1001);
  t.after(() => next.close());
  await next.told('here');
  next.recap(from);
  await settled(next, from, asker);
  assert.deepEqual(ends(asker, 'heard'), ['done']);
  assert.ok(!next.heard.some(({ kind }) => kind === 'command'));
});

test('leaders that reuse numbers: a repeated command is not mistaken for another', async (t) => {
  const { leader, asker, from } = await enter(t, 'numbers');
  asker.send({ type: 'speak', id: 'again', text: 'Uno.', again: true });
  leader.answer(await leader.told('command'), 7);
  const next = await StandInLeader.open(redis, 'numbers', 1001);
  t.after(() => next.close());
  await next.told('here');
  next.recap(from);
  next.say(from, null, begin(7, 'other'), ended(7, 'other', 'done'));
  const command = await next.told('command');
  next.answer(command, 8);
  next.say(from, command, begin(8, 'again'), ended(8, 'again', 'done'));
  await settled(next, from, asker);
  assert.deepEqual([ends(asker, 'other'), ends(asker, 'again')], [['done'], ['done']]);
});

test('repeats commands skipped by a new leader before later ones', async (t) => {
  const { leader, asker } = await enter(t, 'passes');
  const commands = () => leader.heard.filter(({ kind }) => kind === 'command').map(({ command, after }) => [command.request.id, after]);
  asker.send({ type: 'speak', id: 'first', text: 'Uno.' });
  const first = await leader.told('command');
  asker.send({ type: 'speak', id: 'second', text: 'Due.' });
  const second = await leader.told('command', ({ command }) => command.request.id === 'second');
  leader.pass(first);
  leader.pass(second);
  await eventually(() => commands().length >= 4, 'both once more');
  assert.deepEqual(commands().slice(0, 4), [['first', 0], ['second', first.number], ['first', 0], ['second', first.number]]);
  leader.pass(first);
  asker.send({ type: 'speak', id: 'third', text: 'Tre.' });
  await eventually(() => commands().some(([id]) => id === 'third'), 'the third');
  const since = commands().slice(4).map(([id]) => id);
  assert.ok(since.indexOf('first') >= 0 && since.indexOf('first') < since.indexOf('third'), String(since));
});

test('ends a refused command even if the refusal is lost', async (t) => {
  const { leader, asker, from } = await enter(t, 'refuses');
  asker.send({ type: 'speak', id: 'told', text: 'Uno.' });
  const told = await leader.told('command', ({ command }) => command.request.id === 'told');
  leader.say(from, told, { type: 'error', utterance: 5, id: 'told', code: 'unknown-voice', message: '' }, ended(5, 'told', 'failed'));
  leader.answer(told, 5);
  await eventually(() => ends(asker, 'told').length, 'to be told');
  asker.send({ type: 'speak', id: 'lost', text: 'Due.' });
  leader.answer(await leader.told('command', ({ command }) => command.request.id === 'lost'), 6); // its end was sent without a lease, so it was not delivered
  const next = await StandInLeader.open(redis, 'refuses', 1001);
  t.after(() => next.close());
  await next.told('here');
  next.recap(from);
  await settled(next, from, asker);
  assert.deepEqual([ends(asker, 'told'), ends(asker, 'lost')], [['failed'], ['failed']]);
});

test('a leader executes commands in order', async (t) => {
  const room = 'after';
  const listener = await daemon.stream(`?lang=it&room=${room}`);
  const lease = await eventually(() => redis.cli('get', `faccia:lease:room:${room}`), 'the lease');
  const [name, token] = lease.split(' ');
  const branch = await StandInLeader.open(redis, room, Number(token), { lease: false });
  t.after(() => {
    branch.close();
    listener.socket.terminate();
  });
  const ask = (number, after, id, more) => branch.tell(name, 'command', { number, after, visit: 1, command: { type: 'speak', request: { text: 'Uno.', id, lang: 'it', ...more } } });
  const answer = (number, count) => eventually(() => branch.heard.filter((head) => head.kind === 'answer' && head.number === number)[count - 1], `answer ${count} to ${number}`);
  const answers = async (number, count) => (await answer(number, count)).status;
  await eventually(async () => (await (await daemon.get('/v1/rooms')).json()).rooms.some((one) => one.name === room), 'the room');
  ask(2, 1, 'later');
  assert.equal(await answers(2, 1), 0);
  ask(1, 0, 'sooner');
  ask(2, 1, 'later');
  assert.deepEqual([await answers(1, 1), await answers(2, 2)], [202, 202]);
  await eventually(() => ends(listener, 'later').length, 'the end');
  assert.deepEqual(listener.messages.filter(({ type }) => type === 'begin').map(({ id }) => id), ['sooner', 'later']);
  ask(3, 0, 'refused', { voice: 'nobody' });
  assert.ok((await answer(3, 1)).answer.utterance > 2, 'what is refused has a number');
});
