// SPDX-License-Identifier: GPL-3.0-or-later
// Commands to a room's leader that falls silent, forgets them, or reuses another leader's numbers: each sender gets exactly one end per utterance, in order.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Daemon, eventually } from '../lib/daemon.mjs';
import { Redis } from '../lib/redis.mjs';
import { StandInHome } from '../lib/stand-in-home.mjs';

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
  const home = await StandInHome.open(redis, room, 1000);
  const asker = await daemon.stream(`?lang=it&room=${room}`);
  t.after(() => {
    home.close();
    asker.socket.terminate();
  });
  const { from } = await home.told('here');
  home.recap(from);
  return { home, asker, from };
}
/** Waits until everything sent before has arrived. */
async function settled(home, from, asker) {
  home.say(from, null, begin(99, 'last'), ended(99, 'last', 'done'));
  await eventually(() => ends(asker, 'last').length, 'the last');
}

test('what was told to have failed, unanswered, has no second end when the home forgets it or speaks it', async (t) => {
  const { home, asker, from } = await enter(t, 'forgets');
  asker.send({ type: 'speak', id: 'waits', text: 'Uno.' });
  asker.send({ type: 'speak', id: 'speaks', text: 'Due.' });
  const [waits, speaks] = [await home.told('order', ({ order }) => order.request.id === 'waits'), await home.told('order', ({ order }) => order.request.id === 'speaks')];
  home.recap(from); // a second recap: messages were missed
  const { visit } = await home.told('here', (head) => head.visit > waits.visit);
  assert.ok(visit);
  await eventually(() => ends(asker, 'waits').length && ends(asker, 'speaks').length, 'to be told');
  home.recap(from);
  home.say(from, waits, { type: 'error', utterance: 5, id: 'waits', code: 'room-away', message: '' }, ended(5, 'waits', 'failed'));
  home.say(from, speaks, begin(6, 'speaks'), ended(6, 'speaks', 'done'));
  await settled(home, from, asker);
  assert.deepEqual([ends(asker, 'waits'), ends(asker, 'speaks')], [['failed'], ['failed']]);
  assert.ok(!asker.messages.some(({ type, id }) => type === 'begin' && id === 'speaks'));
});

test('an answer that is lost: what is heard counts as answered', async (t) => {
  const { home, asker, from } = await enter(t, 'unanswered');
  asker.send({ type: 'speak', id: 'heard', text: 'Uno.', again: true });
  const order = await home.told('order');
  home.say(from, order, begin(5, 'heard'), ended(5, 'heard', 'done'));
  await eventually(() => ends(asker, 'heard').length, 'its end');
  // the next leader does not get the command again
  const next = await StandInHome.open(redis, 'unanswered', 1001);
  t.after(() => next.close());
  await next.told('here');
  next.recap(from);
  await settled(next, from, asker);
  assert.deepEqual(ends(asker, 'heard'), ['done']);
  assert.ok(!next.heard.some(({ kind }) => kind === 'order'));
});

test('homes that number alike: what is asked again is not taken for what another has said', async (t) => {
  const { home, asker, from } = await enter(t, 'numbers');
  asker.send({ type: 'speak', id: 'again', text: 'Uno.', again: true });
  home.answer(await home.told('order'), 7);
  const next = await StandInHome.open(redis, 'numbers', 1001);
  t.after(() => next.close());
  await next.told('here');
  next.recap(from);
  next.say(from, null, begin(7, 'other'), ended(7, 'other', 'done'));
  const order = await next.told('order');
  next.answer(order, 8);
  next.say(from, order, begin(8, 'again'), ended(8, 'again', 'done'));
  await settled(next, from, asker);
  assert.deepEqual([ends(asker, 'other'), ends(asker, 'again')], [['done'], ['done']]);
});

test('what a home passes over, as it does not know yet that it is the home, is asked again before what comes after it', async (t) => {
  const { home, asker } = await enter(t, 'passes');
  const orders = () => home.heard.filter(({ kind }) => kind === 'order').map(({ order, after }) => [order.request.id, after]);
  asker.send({ type: 'speak', id: 'first', text: 'Uno.' });
  const first = await home.told('order');
  asker.send({ type: 'speak', id: 'second', text: 'Due.' });
  const second = await home.told('order', ({ order }) => order.request.id === 'second');
  home.pass(first);
  home.pass(second);
  await eventually(() => orders().length >= 4, 'both once more');
  assert.deepEqual(orders().slice(0, 4), [['first', 0], ['second', first.number], ['first', 0], ['second', first.number]]);
  home.pass(first);
  asker.send({ type: 'speak', id: 'third', text: 'Tre.' });
  await eventually(() => orders().some(([id]) => id === 'third'), 'the third');
  const since = orders().slice(4).map(([id]) => id);
  assert.ok(since.indexOf('first') >= 0 && since.indexOf('first') < since.indexOf('third'), String(since));
});

test('what a home refuses has an end, also when that is lost with it', async (t) => {
  const { home, asker, from } = await enter(t, 'refuses');
  asker.send({ type: 'speak', id: 'told', text: 'Uno.' });
  const told = await home.told('order', ({ order }) => order.request.id === 'told');
  home.say(from, told, { type: 'error', utterance: 5, id: 'told', code: 'unknown-voice', message: '' }, ended(5, 'told', 'failed'));
  home.answer(told, 5);
  await eventually(() => ends(asker, 'told').length, 'to be told');
  asker.send({ type: 'speak', id: 'lost', text: 'Due.' });
  home.answer(await home.told('order', ({ order }) => order.request.id === 'lost'), 6); // its end was sent without a lease, so it was not delivered
  const next = await StandInHome.open(redis, 'refuses', 1001);
  t.after(() => next.close());
  await next.told('here');
  next.recap(from);
  await settled(next, from, asker);
  assert.deepEqual([ends(asker, 'told'), ends(asker, 'lost')], [['failed'], ['failed']]);
});

test('a home does nothing before what it comes after', async (t) => {
  const room = 'after';
  const listener = await daemon.stream(`?lang=it&room=${room}`);
  const lease = await eventually(() => redis.cli('get', `faccia:lease:room:${room}`), 'the lease');
  const [name, token] = lease.split(' ');
  const branch = await StandInHome.open(redis, room, Number(token), { lease: false });
  t.after(() => {
    branch.close();
    listener.socket.terminate();
  });
  const ask = (number, after, id, more) => branch.tell(name, 'order', { number, after, visit: 1, order: { type: 'speak', request: { text: 'Uno.', id, lang: 'it', ...more } } });
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
