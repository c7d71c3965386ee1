// SPDX-License-Identifier: GPL-3.0-or-later
// A room shared by three daemons over a real Redis: one speaks, the followers of all hear it, and any daemon may die.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import WebSocket from 'ws';
import { Daemon, eventually } from '../../lib/daemon.mjs';
import { cases } from '../../lib/long.mjs';
import { SlowRoad } from '../../chaos/slow-road.mjs';
import { Redis } from '../../lib/redis.mjs';

const TEXT = 'La mamma parla piano con Beppe, e il vento porta via le foglie del viale.';
const LONG = Array.from({ length: 12 }, (_, i) => `Questa è la frase numero ${i + 1}, che nessuno ha fretta di finire.`).join(' ');
let redis;
let daemons = [];
const start = async (url = redis.url) => {
  const daemon = await Daemon.start(['--cluster', url, '--hold', '60']);
  daemons.push(daemon);
  await up(daemon);
  return daemon;
};
const up = (daemon, state = 'up') => eventually(async () => (await (await daemon.get('/healthz')).json()).cluster === state, `the cluster to be ${state}`);
const post = async (daemon, path, body, type = 'text/plain') => {
  const response = await daemon.get(path, { method: 'POST', body, headers: { 'content-type': type } });
  return { status: response.status, ...(await response.json()) };
};
const end = (daemon, signal = 'SIGKILL') => {
  daemon.process.kill('SIGCONT');
  daemon.process.kill(signal);
  daemons = daemons.filter((other) => other !== daemon);
  return daemon.exited;
};

/** Records all messages of a listener of a room, media as raw bytes. */
class Listener {
  static async open(daemon, room, query = '&audio=pcm&fap=plain') {
    const listener = Object.assign(new Listener(), { frames: [], daemon });
    listener.socket = new WebSocket(`ws://127.0.0.1:${daemon.port}/v1/stream?lang=it&room=${room}${query}`, { perMessageDeflate: false });
    listener.socket.on('error', () => {});
    listener.socket.on('message', (data, binary) => listener.frames.push(binary ? { hex: data.toString('hex'), size: data.length } : JSON.parse(data)));
    await new Promise((resolve, reject) => listener.socket.on('open', resolve).on('error', reject));
    await listener.heard({ type: 'joined' });
    return listener;
  }

  send(message) {
    this.socket.send(JSON.stringify(message));
  }

  find(pattern, from = 0) {
    return this.frames.slice(from).find((frame) => Object.entries(pattern).every(([name, value]) => frame[name] === value));
  }

  heard(pattern, from = 0) {
    return eventually(() => this.find(pattern, from), `${JSON.stringify(pattern)}; heard ${JSON.stringify(this.frames.slice(-4))}`);
  }

  media() {
    return this.frames.filter((frame) => frame.hex);
  }

  /** Returns the room's messages, without those for this client alone. */
  said() {
    return this.frames.filter((frame) => frame.hex || !['hello', 'joined', 'left'].includes(frame.type));
  }

  close() {
    this.socket.terminate();
  }
}

/** Returns the room's leader and the other daemons. */
async function homeOf(room) {
  const lease = await eventually(() => redis.cli('get', `faccia:lease:room:${room}`), `somebody to have ${room}`);
  const token = lease.split(' ')[1];
  const home = await eventually(() => daemons.find((daemon) => daemon.log.includes(`room ${room}: spoken by this daemon from now on (${token})`)), `the home of ${room}`);
  return { home, token: Number(token), others: daemons.filter((daemon) => daemon !== home) };
}
/** Joins an empty room and waits until the client's daemon leads it, because the lease may come after the join. */
async function first(daemon, room, query) {
  const listener = await Listener.open(daemon, room, query);
  assert.equal((await homeOf(room)).home, daemon);
  return listener;
}
/** Waits until the leader knows of all followers and the encodings they want. */
const followed = async (room, count) => {
  const { home } = await homeOf(room);
  await eventually(async () => (await (await home.get('/v1/rooms')).json()).rooms.find(({ name }) => name === room)?.listeners === count, `${count} listeners in ${room}`);
};

before(async () => {
  redis = await Redis.start();
  await Promise.all([start(), start(), start()]);
});
after(async () => {
  for (const daemon of daemons) {
    daemon.process.kill('SIGCONT');
    assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  }
  redis.stop();
});

for (const [what, query] of cases([['Opus with packed events', '&audio=opus&fap=fapc&events=packed']], [['PCM', '&audio=pcm&fap=plain']]))
  test(`listeners at three daemons get the same bytes, each once, in order: ${what}`, async () => {
    const room = `same-${query.length}`;
    const listeners = [await first(daemons[0], room, query)];
    for (const daemon of daemons) while (listeners.filter((listener) => listener.daemon === daemon).length < 2) listeners.push(await Listener.open(daemon, room, query));
    await followed(room, 6);
    const { others } = await homeOf(room);
    const answer = await post(others[1], `/v1/say?room=${room}&lang=it`, TEXT);
    assert.deepEqual(answer, { status: 202, type: 'accepted', room, listeners: 6 });
    const isEnd = (listener) => listener.find({ type: 'end', reason: 'done' }) || (query.includes('packed') && listener.media().length > 15 && Date.now() - listener.last > 1500);
    for (const listener of listeners) listener.socket.on('message', () => (listener.last = Date.now()));
    for (const listener of listeners) await eventually(() => isEnd(listener), 'the end');
    const expected = listeners[0].said();
    assert.ok(expected.filter(({ hex }) => hex).length >= 15, `${expected.length} messages`);
    for (const listener of listeners) assert.deepEqual(listener.said(), expected);
    for (const listener of listeners) listener.close();
  });

test('a late listener gets the current state, at any daemon', async () => {
  const room = 'late';
  const [one, two] = [await Listener.open(daemons[0], room), await Listener.open(daemons[1], room)];
  await followed(room, 2);
  two.send({ type: 'express', mix: [{ name: 'joy', intensity: 0.5 }] });
  two.send({ type: 'head', head: 'mara' });
  two.send({ type: 'state', state: 'thinking', text: 'un momento' });
  two.send({ type: 'choices', id: 'q', question: 'Vieni?', choices: ['Sì', 'No'] });
  two.send({ type: 'consent', consent: 'asked', text: 'Si registra?' });
  two.send({ type: 'speak', id: 'long', text: LONG });
  await one.heard({ type: 'word', text: 'frase' });
  // a request that fails meanwhile does not end the current utterance
  two.send({ type: 'speak', id: 'bad', voice: 'no:such', text: 'Ciao' });
  for (const listener of [one, two]) await listener.heard({ type: 'end', id: 'bad', reason: 'failed' });
  const late = [];
  for (const daemon of daemons) late.push(await Listener.open(daemon, room));
  for (const listener of late) {
    await listener.heard({ type: 'head', head: 'mara' });
    await eventually(() => listener.media().length > 3, 'media');
    const told = listener.said().filter(({ hex }) => !hex).map(({ type }) => type);
    for (const type of ['begin', 'sentence', 'word', 'expressed', 'consent', 'state', 'choices']) assert.ok(told.includes(type), `${type} of ${told}`);
    assert.equal(listener.find({ type: 'begin' }).id, 'long');
    assert.equal(listener.find({ type: 'state' }).text, 'un momento');
  }
  late[2].send({ type: 'choose', id: 'q', choice: 1 });
  for (const listener of [one, two, ...late]) assert.equal((await listener.heard({ type: 'chosen' })).text, 'No');
  two.send({ type: 'stop' });
  for (const listener of [one, two, ...late]) await listener.heard({ type: 'end', id: 'long', reason: 'stopped' });
  const all = one.media().map(({ hex }) => hex);
  for (const listener of [two, ...late]) {
    const heard = listener.media().map(({ hex }) => hex);
    assert.deepEqual(heard, all.slice(all.length - heard.length));
  }
  for (const listener of [one, two, ...late]) listener.close();
});

test('room commands work at any daemon, and errors are answered there', async () => {
  const room = 'asked';
  const [one, two, three] = [await Listener.open(daemons[0], room), await Listener.open(daemons[1], room), await Listener.open(daemons[2], room)];
  await followed(room, 3);
  await post(daemons[2], `/v1/say?room=${room}&lang=it`, LONG);
  await one.heard({ type: 'begin' });
  assert.deepEqual(await post(daemons[1], `/v1/rooms/${room}/commands`, '{"type":"pause"}', 'application/json'), { status: 200, type: 'paused', room });
  await three.heard({ type: 'paused' });
  three.send({ type: 'resume' });
  for (const listener of [one, two, three]) await listener.heard({ type: 'resumed' });
  assert.equal((await post(daemons[2], `/v1/say?room=${room}&mode=quiet`, 'Zitta.')).code, 'busy');
  assert.equal((await post(daemons[1], `/v1/rooms/${room}/commands`, '{"type":"state","state":"nonsense"}', 'application/json')).field, 'state');
  assert.equal((await post(daemons[1], `/v1/rooms/${room}/commands`, '{"type":"state","state":"muted"}', 'application/json')).listeners, 3);
  await three.heard({ type: 'state', state: 'muted' });
  two.send({ type: 'jump', mark: 'nowhere' });
  await two.heard({ type: 'error', code: 'unknown-mark' });
  two.send({ type: 'express', mix: [{ name: 'hapiness' }] });
  await two.heard({ type: 'error', code: 'unknown-expression' });
  two.send({ type: 'speak', id: 'open', text: 'Scritto', open: true });
  await two.heard({ type: 'error', code: 'room-away', id: 'open' });
  two.send({ type: 'cancel', id: 'nobody' });
  await two.heard({ type: 'error', code: 'unknown-utterance' });
  assert.ok(!one.find({ type: 'error' }) && !three.find({ type: 'error' }));
  two.send({ type: 'speak', id: 'bad', voice: 'no:such', text: 'Ciao' });
  for (const listener of [one, two, three]) await listener.heard({ type: 'end', id: 'bad', reason: 'failed' });
  assert.equal((await post(daemons[2], `/v1/stop?room=${room}`)).type, 'stopped');
  for (const listener of [one, two, three]) await listener.heard({ type: 'end', reason: 'stopped' });
  assert.equal((await post(daemons[2], '/v1/stop?room=empty')).code, 'unknown-room');
  for (const listener of [one, two, three]) listener.close();
  await eventually(() => !redis.cli('keys', `faccia:lease:*`), 'all leases to be given up');
});

test('of simultaneous speakers one speaks first, and all are heard once', async () => {
  const rooms = Array.from({ length: 8 }, (_, i) => `at-once-${i}`);
  const all = await Promise.all(rooms.map((room) => Promise.all(daemons.map((daemon) => Listener.open(daemon, room)))));
  await Promise.all(
    rooms.map(async (room, i) => {
      await followed(room, 3);
      daemons.forEach((daemon, k) => all[i][k].send({ type: 'speak', id: `from-${k}`, text: 'Uno.' }));
      for (const listener of all[i]) await eventually(() => listener.frames.filter(({ type }) => type === 'end').length >= 3, 'three ends');
      const expected = all[i][0].said();
      assert.deepEqual(expected.filter(({ type }) => type === 'end').map(({ id }) => id).sort(), ['from-0', 'from-1', 'from-2']);
      for (const listener of all[i]) assert.deepEqual(listener.said(), expected);
    }),
  );
  for (const listener of all.flat()) listener.close();
});

test('speech for an empty room waits for the first listener at any daemon', async () => {
  const room = 'held';
  assert.equal((await post(daemons[1], `/v1/say?room=${room}&lang=it&id=one`, 'Uno.')).held, 60);
  assert.equal((await post(daemons[2], `/v1/say?room=${room}&lang=it&id=two`, 'Due.')).held, 60);
  const listener = await Listener.open(daemons[0], room);
  for (const id of ['one', 'two']) await listener.heard({ type: 'end', id, reason: 'done' });
  listener.close();
});

test('the lexicon of a room applies at every daemon, and moves with the leader', async () => {
  const room = 'lexicon';
  const leaving = await start();
  const one = await first(leaving, room);
  const two = await Listener.open(daemons[1], room);
  await followed(room, 2);
  const { token } = await homeOf(room);
  const phones = async (id, text) => {
    two.send({ type: 'speak', id, text, phones: true });
    await two.heard({ type: 'end', id, reason: 'done' });
    const { utterance } = two.find({ type: 'begin', id });
    return two.frames.filter((frame) => frame.type === 'phone' && frame.utterance === utterance).map(({ ipa }) => ipa).join('');
  };
  const plain = await phones('plain', 'Ecco la stanza.');
  const lexicon = '<lexicon version="1.0" xml:lang="it"><lexeme><grapheme>aula</grapheme><alias>stanza</alias></lexeme></lexicon>';
  two.send({ type: 'lexicon', lexicon });
  for (const listener of [one, two]) await listener.heard({ type: 'lexicon', lexicon });
  assert.equal(await phones('there', 'Ecco la aula.'), plain);
  two.send({ type: 'lexicon', lexicon: '<lexicon>' });
  await two.heard({ type: 'error', code: 'bad-lexicon' });
  one.close();
  assert.deepEqual(await end(leaving, 'SIGTERM'), { code: 0, signal: null });
  assert.ok((await homeOf(room)).token > token);
  assert.equal(await phones('here', 'Ecco la aula.'), plain);
  const late = await Listener.open(daemons[2], room);
  await late.heard({ type: 'lexicon', lexicon });
  two.send({ type: 'lexicon', lexicon: '' });
  await late.heard({ type: 'lexicon', lexicon: '' });
  assert.notEqual(await phones('cleared', 'Ecco la aula.'), plain);
  for (const listener of [two, late]) listener.close();
});

test('a stopping daemon hands its rooms to the others at once', async () => {
  const fourth = await start();
  const room = 'left';
  const there = await first(fourth, room);
  const here = await Listener.open(daemons[0], room);
  await followed(room, 2);
  const { token } = await homeOf(room);
  assert.deepEqual(await end(fourth, 'SIGTERM'), { code: 0, signal: null });
  assert.ok((await homeOf(room)).token > token);
  here.send({ type: 'speak', id: 'next', text: 'Uno.' });
  await here.heard({ type: 'end', id: 'next', reason: 'done' });
  here.close();
  there.close();
});

test('when a leader dies while speaking, listeners get an error and another daemon continues', async () => {
  const fourth = await start();
  const room = 'killed';
  const there = await first(fourth, room);
  const others = [await Listener.open(daemons[0], room), await Listener.open(daemons[1], room)];
  await followed(room, 3);
  others[0].send({ type: 'speak', id: 'cut', text: LONG });
  for (const listener of others) await listener.heard({ type: 'word', text: 'frase' });
  const { token } = await homeOf(room);
  others[1].send({ type: 'speak', id: 'waited', text: TEXT });
  assert.equal((await post(daemons[0], `/v1/say?room=${room}&lang=it&id=posted`, TEXT)).listeners, 3);
  const died = Date.now();
  await end(fourth);
  for (const listener of others) {
    assert.equal((await listener.heard({ type: 'error', id: 'cut' })).code, 'room-away');
    const { utterance, duration } = await listener.heard({ type: 'end', id: 'cut', reason: 'failed' });
    assert.ok(utterance === listener.find({ type: 'begin' }).utterance && duration > 0);
  }
  // waiting utterances end on the daemon that received their requests
  await others[1].heard({ type: 'end', id: 'waited', reason: 'failed' });
  await others[0].heard({ type: 'end', id: 'posted', reason: 'failed' });
  const next = await homeOf(room);
  assert.ok(next.token > token);
  console.log(`# taken over within ${Date.now() - died} ms`);
  others[1].send({ type: 'speak', id: 'next', text: 'Uno.' });
  for (const listener of others) {
    await listener.heard({ type: 'end', id: 'next', reason: 'done' });
    assert.ok(listener.find({ type: 'begin', id: 'next' }).utterance > listener.find({ type: 'begin', id: 'cut' }).utterance);
    assert.equal(listener.frames.filter(({ type }) => type === 'end').length, 3);
    listener.close();
  }
  there.close();
});

for (const [how, signal] of [
  ['dies', 'SIGKILL'],
  ['stands still', 'SIGSTOP'],
])
  test(`repeats a pending command when the leader ${how}: in order, with one end`, async () => {
    const fourth = await start();
    const room = `again-${signal}`;
    const there = await first(fourth, room);
    const others = [await Listener.open(daemons[0], room), await Listener.open(daemons[1], room)];
    await followed(room, 3);
    const wishes = { zero: true, one: true, two: false, three: true };
    for (const [id, again] of Object.entries(wishes)) others[0].send({ type: 'speak', id, text: id === 'zero' ? TEXT : `${id}.`, again });
    // the next message takes another path and might overtake this one
    await there.heard({ type: 'begin', id: 'zero' });
    there.send({ type: 'speak', id: 'own', text: 'Mia.', again: true });
    assert.equal((await post(daemons[1], `/v1/say?room=${room}&lang=it&id=posted&again=1`, 'Postata.')).listeners, 3);
    for (const listener of others) {
      await listener.heard({ type: 'word', text: 'piano' });
      assert.equal(listener.find({ type: 'begin', id: 'zero' }).again, true);
    }
    if (signal === 'SIGKILL') await end(fourth);
    else fourth.process.kill('SIGSTOP');
    // later requests are spoken after these
    others[0].send({ type: 'speak', id: 'later', text: 'Poi.', again: true });
    for (const listener of others) {
      for (const id of ['zero', 'one', 'three', 'posted', 'later']) await listener.heard({ type: 'end', id, reason: 'done' });
      const cut = listener.find({ type: 'warning', id: 'zero' });
      assert.equal(cut.code, 'room-away');
      assert.equal(cut.utterance, listener.find({ type: 'begin', id: 'zero' }).utterance);
      for (const id of [...Object.keys(wishes), 'posted', 'later'].filter((each) => wishes[each] !== false)) {
        assert.equal(listener.frames.filter((frame) => frame.type === 'end' && frame.id === id).length, 1, id);
        assert.equal(listener.frames.filter((frame) => frame.type === 'begin' && frame.id === id).length, id === 'zero' ? 2 : 1, id);
      }
      const order = listener.frames.filter(({ type }) => type === 'end').map(({ id }) => id);
      assert.deepEqual(order.filter((id) => ['zero', 'one', 'three', 'later'].includes(id)), ['zero', 'one', 'three', 'later']);
    }
    // requests without `again` fail, only on the daemon that received them
    await others[0].heard({ type: 'end', id: 'two', reason: 'failed' });
    for (const id of ['two', 'own']) assert.equal(others[1].find({ id }), undefined, JSON.stringify(others[1].frames.filter(({ type }) => ['begin', 'error', 'warning', 'end'].includes(type))));
    if (signal === 'SIGSTOP') {
      fourth.process.kill('SIGCONT');
      await there.heard({ type: 'end', id: 'own', reason: 'failed' });
      others[1].send({ type: 'speak', id: 'last', text: 'Fine.' });
      await there.heard({ type: 'end', id: 'last', reason: 'done' });
      const ends = there.frames.filter(({ type }) => type === 'end').map(({ id }) => id);
      assert.equal(new Set(ends).size, ends.length, String(ends));
      await end(fourth, 'SIGTERM');
    }
    for (const listener of [there, ...others]) listener.close();
  });

test('a daemon that loses Redis for a moment does not replay speech reported as failed', async () => {
  const room = 'blink';
  const listeners = [];
  for (const daemon of daemons) listeners.push(await Listener.open(daemon, room));
  await followed(room, 3);
  const { home } = await homeOf(room);
  const mine = listeners.find(({ daemon }) => daemon === home), others = listeners.filter((listener) => listener !== mine);
  mine.send({ type: 'speak', id: 'own', text: TEXT });
  others[0].send({ type: 'speak', id: 'asked', text: 'Uno.' });
  others[0].send({ type: 'speak', id: 'again', text: 'Due.', again: true });
  for (const listener of listeners) await listener.heard({ type: 'word', text: 'piano' });
  // kills every connection; the daemons reconnect at once
  redis.cli('client', 'kill', 'type', 'normal');
  redis.cli('client', 'kill', 'type', 'pubsub');
  for (const listener of others) await listener.heard({ type: 'end', id: 'own', reason: 'failed' });
  for (const listener of listeners) if (listener !== others[1]) await listener.heard({ type: 'end', id: 'asked', reason: 'failed' });
  await mine.heard({ type: 'end', id: 'own', reason: 'done' });
  await others[0].heard({ type: 'end', id: 'again', reason: 'done' });
  for (const daemon of daemons) await up(daemon);
  await followed(room, 3);
  for (const listener of listeners) listener.send({ type: 'speak', id: `after-${listeners.indexOf(listener)}`, text: 'Tre.' });
  for (const listener of listeners)
    for (const i of listeners.keys()) await listener.heard({ type: 'end', id: `after-${i}`, reason: 'done' });
  for (const listener of listeners) {
    const ends = listener.frames.filter(({ type }) => type === 'end').map(({ id }) => id);
    assert.equal(new Set(ends).size, ends.length, String(ends));
    listener.close();
  }
});

for (const next of cases(['the daemon that asked for it'], ['that daemon']))
  test(`an isolated daemon that reported an utterance as failed does not get it from the next leader, ${next}`, async () => {
    const room = `known ${next.length}`.replace(' ', '-');
    const road = await SlowRoad.open(redis.port);
    const [home, alone] = [await start(), await start(road.url)];
    const [asks] = daemons;
    const there = await first(home, room);
    const asker = await Listener.open(asks, room), listener = await Listener.open(alone, room);
    await followed(room, 3);
    asker.send({ type: 'speak', id: 'told', text: LONG, again: true });
    for (const each of [there, asker, listener]) await each.heard({ type: 'word', text: 'frase' });
    road.delay = Infinity;
    await listener.heard({ type: 'end', id: 'told', reason: 'failed' });
    if (next === 'that daemon') {
      road.delay = 0;
      await up(alone);
      await followed(room, 3);
      asks.process.kill('SIGSTOP');
    }
    await end(home);
    if (next === 'that daemon') {
      await eventually(() => alone.log.includes(`room ${room}: spoken by this daemon from now on`), 'it to be the home');
      asks.process.kill('SIGCONT');
      await asker.heard({ type: 'end', id: 'told', reason: 'failed' });
    } else {
      const cut = asker.frames.indexOf(await asker.heard({ type: 'warning', id: 'told' }));
      await asker.heard({ type: 'begin', id: 'told' }, cut);
      road.delay = 0;
      await up(alone);
      await followed(room, 2);
      await asker.heard({ type: 'word', text: 'frase' }, asker.frames.indexOf(asker.find({ type: 'begin', id: 'told' }, cut)));
      asker.send({ type: 'stop' });
      await asker.heard({ type: 'end', id: 'told', reason: 'stopped' });
    }
    asker.send({ type: 'speak', id: 'after', text: 'Uno.' });
    for (const each of [asker, listener]) await each.heard({ type: 'end', id: 'after', reason: 'done' });
    const of = (type) => listener.frames.filter((frame) => frame.type === type && frame.id === 'told').length;
    assert.deepEqual({ begins: of('begin'), ends: of('end') }, { begins: 1, ends: 1 });
    const past = listener.frames.indexOf(listener.find({ type: 'end', id: 'told' })), after = listener.frames.indexOf(listener.find({ type: 'begin', id: 'after' }));
    assert.equal(listener.frames.slice(past, after).filter(({ hex }) => hex).length, 0);
    for (const each of [there, asker, listener]) each.close();
    await end(alone, 'SIGTERM');
  });

test('a leader that was frozen cannot speak into the room when it resumes', async () => {
  const room = 'frozen';
  const [there, one, two] = [await first(daemons[0], room), await Listener.open(daemons[1], room), await Listener.open(daemons[2], room)];
  await followed(room, 3);
  const home = daemons[0];
  one.send({ type: 'speak', id: 'cut', text: LONG });
  await two.heard({ type: 'word', text: 'frase' });
  home.process.kill('SIGSTOP');
  // a request meanwhile fails because the leader does not answer
  const lost = post(daemons[1], `/v1/say?room=${room}`, 'Chi mi sente?');
  assert.equal((await lost).code, 'room-away');
  for (const listener of [one, two]) await listener.heard({ type: 'end', id: 'cut', reason: 'failed' });
  two.send({ type: 'speak', id: 'next', text: TEXT });
  for (const listener of [one, two]) await listener.heard({ type: 'begin', id: 'next' });
  const before = one.said().length;
  home.process.kill('SIGCONT');
  await there.heard({ type: 'end', id: 'cut', reason: 'failed' });
  for (const listener of [one, two, there]) await listener.heard({ type: 'end', id: 'next', reason: 'done' });
  assert.deepEqual(one.said(), two.said());
  assert.ok(one.said().length > before);
  const last = there.said().findIndex(({ id, type }) => id === 'cut' && type === 'end');
  const after = there.said().slice(last + 1).filter(({ hex }) => hex).map(({ hex }) => hex);
  const expected = one.media().map(({ hex }) => hex);
  assert.deepEqual(after, expected.slice(expected.length - after.length));
  // the daemon is a replica now
  one.send({ type: 'speak', id: 'third', text: 'Uno.' });
  for (const listener of [one, two, there]) await listener.heard({ type: 'end', id: 'third', reason: 'done' });
  for (const listener of [one, two, there]) listener.close();
});

test('without Redis each daemon speaks to its own listeners; afterwards they reunite', async () => {
  const room = 'split';
  const listeners = [];
  for (const daemon of daemons) listeners.push(await Listener.open(daemon, room));
  await followed(room, 3);
  const { home } = await homeOf(room);
  const mine = listeners.find(({ daemon }) => daemon === home), others = listeners.filter((listener) => listener !== mine);
  mine.send({ type: 'speak', id: 'through', text: TEXT });
  for (const listener of listeners) await listener.heard({ type: 'word' });
  redis.stop();
  for (const listener of others) await listener.heard({ type: 'end', id: 'through', reason: 'failed' });
  await mine.heard({ type: 'end', id: 'through', reason: 'done' });
  for (const daemon of daemons) await up(daemon, 'away');
  assert.equal(await home.metric('faccia_cluster_rooms{role="unshared"}'), 1);
  others[0].send({ type: 'speak', id: 'own', text: 'Uno.' });
  await others[0].heard({ type: 'end', id: 'own', reason: 'done' });
  assert.ok(!others[1].find({ id: 'own' }) && !mine.find({ id: 'own' }));
  // utterances numbered by a daemon alone use numbers of no other daemon
  others[1].send({ type: 'speak', id: 'too', text: 'Uno.' });
  await others[1].heard({ type: 'end', id: 'too', reason: 'done' });
  mine.send({ type: 'speak', id: 'mine', text: 'Uno.' });
  await mine.heard({ type: 'end', id: 'mine', reason: 'done' });
  const numbers = [...listeners.map((one) => one.find({ type: 'begin', id: 'through' })), others[0].find({ type: 'begin', id: 'own' }), others[1].find({ type: 'begin', id: 'too' }), mine.find({ type: 'begin', id: 'mine' })].map(({ utterance }) => utterance);
  assert.equal(new Set(numbers).size, 4, `${numbers}: one that all heard, three of which each daemon has one`);
  // an utterance in progress when the bus is back is spoken to its end
  others[1].send({ type: 'speak', id: 'last', text: TEXT });
  await others[1].heard({ type: 'begin', id: 'last' });
  redis.again();
  for (const daemon of daemons) await up(daemon);
  await others[1].heard({ type: 'end', id: 'last', reason: 'done' });
  await followed(room, 3);
  others[0].send({ type: 'speak', id: 'healed', text: 'Due.' });
  for (const listener of listeners) await listener.heard({ type: 'end', id: 'healed', reason: 'done' });
  const healed = (listener) => listener.said().slice(listener.said().findIndex(({ id }) => id === 'healed'));
  for (const listener of listeners) assert.deepEqual(healed(listener), healed(listeners[0]));
  for (const listener of listeners) listener.close();
});

test('a Redis that loses its data, or hangs, costs at most one utterance', async () => {
  const room = 'forgot';
  const listeners = [];
  for (const daemon of daemons) listeners.push(await Listener.open(daemon, room));
  for (const [id, harm] of [
    ['flushed', () => redis.cli('flushall')],
    ['stands', () => redis.process.kill('SIGSTOP')],
  ]) {
    await followed(room, 3);
    const { token } = await homeOf(room);
    listeners[1].send({ type: 'speak', id, text: TEXT });
    for (const listener of listeners) await listener.heard({ type: 'begin', id });
    harm();
    for (const listener of listeners) await listener.heard({ type: 'end', id });
    redis.process.kill('SIGCONT');
    for (const daemon of daemons) await up(daemon);
    await eventually(async () => (await homeOf(room)).token > token, 'a new token');
    await followed(room, 3);
    for (const listener of listeners) listener.send({ type: 'speak', id: `${id}-after`, text: 'Uno.' });
    for (const listener of listeners) {
      await eventually(() => listener.frames.filter((frame) => frame.type === 'end' && frame.id === `${id}-after`).length === 3, 'three ends');
      assert.equal(listener.frames.filter((frame) => frame.type === 'end' && frame.id === id).length, 1);
    }
  }
  for (const listener of listeners) listener.close();
});

test('ignores invalid messages between daemons', async () => {
  const listener = await Listener.open(daemons[0], 'nonsense');
  const { token } = await homeOf('nonsense');
  const channels = redis.cli('pubsub', 'channels', 'faccia:to:*').split('\n');
  assert.equal(channels.length, daemons.length);
  const heads = ['', '{', '{}\n', '{"v":9,"kind":"here","room":"nonsense"}\n', '{"v":5,"kind":"here","room":"nonsense"}\n'];
  for (const kind of ['here', 'recap', 'text', 'media', 'gone', 'command', 'answer', 'what'])
    for (const rest of ['{}', '{"from":"x","wants":[[9,9,9,1],[0],7],"idle":{"life":-1},"visit":7,"begin":true}', `{"token":${token},"event":"begin","line":99,"as":3}`, '{"command":{"type":"speak","request":{"text":7}},"number":1,"status":200,"from":"x"}', `{"token":${token},"command":7,"was":-1,"visit":4294967296,"speaks":-7,"past":true,"number":1,"answer":{"utterance":99},"from":"x"}`])
      heads.push(`${JSON.stringify({ v: 5, kind, room: 'nonsense', ...JSON.parse(rest) })}\nbody`);
  for (const channel of channels) for (const head of heads) redis.cli('publish', channel, head);
  listener.send({ type: 'speak', id: 'still', text: 'Uno.' });
  await listener.heard({ type: 'end', id: 'still', reason: 'done' });
  assert.ok(!listener.find({ type: 'begin', id: undefined }));
  listener.close();
});
