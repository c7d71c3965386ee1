// SPDX-License-Identifier: MIT
import assert from 'node:assert/strict';
import test from 'node:test';
import { decodeChunk, encodeChunk } from '../../../protocol/chunk/chunk.mjs';
import { Speech } from '../../../web/element/speech/speech.mjs';
import { Turns } from '../../../web/element/speech/turns.mjs';

const RATE = 1000;

/** A speech with a simulated player and server. */
function rig({ linked = true, turns, state } = {}) {
  const sent = [];
  const events = [];
  const media = [];
  const timers = [];
  const player = {
    rate: RATE, written: 0, position: 0, flushed: 0, running: true,
    open() {},
    write(block) {
      this.written += block.length;
    },
    finish() {},
    flush() {
      this.flushed++;
      this.position = this.written;
    },
    held: false,
    hold() {
      this.held = true;
    },
    release() {
      this.held = false;
    },
    heard(now, ahead = 0) {
      return { position: this.position + ahead * RATE, running: this.running };
    },
  };
  const link = { up: linked };
  const speech = new Speech({
    player,
    send: (message) => link.up && sent.push(message) > 0,
    emit: (type, detail) => (type === 'media' ? media : events).push([type, detail]),
    turns,
    state,
    setTimeout: (act, after) => timers.push({ act, after }),
  });
  return {
    speech, player, sent, events, media, link, timers,
    names: () => events.map(([type, { text, reason }]) => text ?? reason ?? type),
    hear: (message) => speech.hear(message),
    chunk: (utterance, start, samples, frames = [], firstFrame = 0) =>
      speech.media(
        decodeChunk(encodeChunk({
          audioCodec: 1, fapCodec: 1, utterance, sampleRate: RATE, fps: 25, start, samples, firstFrame,
          frames, audio: new Int16Array(samples),
        })),
      ),
    play: (position) => {
      player.position = position;
      speech.tick(0);
      return speech.heard(0);
    },
  };
}

const begin = (id, utterance) => ({ type: 'begin', id, utterance, rate: RATE, fps: 25 });
const word = (id, utterance, time, text) => ({ type: 'word', id, utterance, time, text, utf16_start: 0, utf16_end: text.length });

test('reports events when they are heard, in order, and the promise resolves with the end', async () => {
  const { speech, sent, names, media, hear, chunk, play } = rig();
  const promise = speech.speak('Uno due', { lang: 'it', id: 'mine' });
  assert.deepEqual(sent, [{ lang: 'it', id: 'u1', type: 'speak', text: 'Uno due' }]);
  hear(begin('u1', 1));
  hear(word('u1', 1, 0, 'Uno'));
  chunk(1, 0, 400, [new Int32Array(69)]);
  hear(word('u1', 1, 0.4, 'due'));
  chunk(1, 400, 300);
  hear({ type: 'end', id: 'u1', utterance: 1, reason: 'done', duration: 0.7 });
  assert.deepEqual(media.map(([, one]) => [one.id, one.utterance, one.fps, one.firstFrame, one.frames.length, one.start, one.rate, one.audio.length]), [['mine', 1, 25, 0, 1, 0, RATE, 400], ['mine', 1, 25, 0, 0, 400, RATE, 300]], 'as it comes');
  play(0);
  assert.deepEqual(names(), ['begin', 'Uno']);
  const heard = play(399);
  assert.equal(heard.seconds, 0.399);
  assert.deepEqual(names(), ['begin', 'Uno']);
  play(400);
  assert.deepEqual(names(), ['begin', 'Uno', 'due']);
  play(699);
  assert.ok(speech.busy);
  assert.equal(play(700), null);
  assert.deepEqual(names(), ['begin', 'Uno', 'due', 'done']);
  assert.deepEqual(await promise, { type: 'end', id: 'mine', utterance: 1, reason: 'done', duration: 0.7 });
  assert.equal(speech.busy, false);
});

test('reports no event before its sound', () => {
  const { speech, player, names, hear, play } = rig();
  speech.speak('Uno');
  hear(begin('u1', 1));
  player.running = false;
  play(0);
  assert.deepEqual(names(), []);
  player.running = true;
  play(0);
  assert.deepEqual(names(), ['begin']);
});

test('plays two utterances one after the other on the sample stream', () => {
  const { speech, hear, chunk, play, names } = rig();
  speech.speak('a');
  speech.speak('b');
  hear(begin('u1', 1));
  chunk(1, 0, 100);
  hear({ type: 'end', id: 'u1', utterance: 1, reason: 'done' });
  hear(begin('u2', 2));
  chunk(2, 0, 100);
  assert.equal(play(99).utterance.text, 'a');
  const second = play(130);
  assert.deepEqual([second.utterance.text, second.seconds], ['b', 0.03]);
  assert.deepEqual(names(), ['begin', 'done', 'begin']);
});

test('looking ahead at the face triggers no events', () => {
  const { speech, hear, chunk, play, names } = rig();
  speech.speak('a');
  hear(begin('u1', 1));
  hear(word('u1', 1, 0.1, 'uno'));
  chunk(1, 0, 500);
  play(90);
  assert.equal(speech.heard(0, 0.05).seconds, 0.14);
  assert.deepEqual(names(), ['begin']);
});

test('stop silences before the server answers, and drops the events that it cut', async () => {
  const { speech, player, sent, names, hear, chunk, play } = rig();
  const first = speech.speak('a');
  const second = speech.speak('b');
  hear(begin('u1', 1));
  chunk(1, 0, 500);
  play(100);
  speech.stop();
  assert.equal(player.flushed, 1);
  assert.equal(play(player.written), null);
  assert.deepEqual(sent.at(-1), { type: 'stop' });
  chunk(1, 500, 500); // was on its way
  hear(word('u1', 1, 0.5, 'late'));
  assert.equal(player.written, 500);
  hear({ type: 'end', id: 'u2', reason: 'stopped', duration: 0 });
  hear({ type: 'end', id: 'u1', utterance: 1, reason: 'stopped', duration: 0.6 });
  assert.equal((await first).reason, 'stopped');
  assert.equal((await second).reason, 'stopped');
  play(600);
  assert.deepEqual(names(), ['begin', 'stopped', 'stopped']);
});

test('stops during the last half second, after the server is done', async () => {
  const { speech, hear, chunk, play } = rig();
  const promise = speech.speak('a');
  hear(begin('u1', 1));
  chunk(1, 0, 500);
  hear({ type: 'end', id: 'u1', utterance: 1, reason: 'done', duration: 0.5 });
  play(100);
  speech.stop();
  assert.equal((await promise).reason, 'stopped');
});

test('plays the next utterance after a stop', () => {
  const { speech, player, hear, chunk, play } = rig();
  speech.speak('a');
  hear(begin('u1', 1));
  chunk(1, 0, 500);
  play(100);
  speech.stop();
  speech.speak('b');
  hear({ type: 'end', id: 'u1', utterance: 1, reason: 'stopped' });
  hear(begin('u2', 2));
  chunk(2, 0, 300);
  assert.equal(player.written, 800);
  const heard = play(510);
  assert.deepEqual([heard.utterance.text, heard.seconds], ['b', 0.01]);
});

test('a refusal ends at once, with its error', async () => {
  const { speech, hear, events } = rig();
  const promise = speech.speak('a', { lang: 'xx' });
  hear({ type: 'error', id: 'u1', code: 'unknown-language', field: 'lang' });
  hear({ type: 'end', id: 'u1', reason: 'failed' });
  assert.equal((await promise).reason, 'failed');
  assert.deepEqual(events[0], ['error', { type: 'error', code: 'unknown-language', field: 'lang' }]);
});

test('plays the received sound after the link is lost, then fails', async () => {
  const { speech, hear, chunk, play, events } = rig();
  const promise = speech.speak('a', { id: 7 });
  hear(begin('u1', 1));
  chunk(1, 0, 500);
  speech.unlinked();
  assert.equal(events[0][1].code, 'connection-lost');
  assert.equal(play(400).seconds, 0.4);
  play(500);
  assert.deepEqual(await promise, { type: 'end', reason: 'failed', code: 'connection-lost', id: 7 });
});

test('fails at the end of the sound when the link is lost before the sound of announced words', async () => {
  const { speech, hear, chunk, play, names, player } = rig();
  const promise = speech.speak('a', { id: 7 });
  hear(begin('u1', 1));
  hear(word('u1', 1, 0.1, 'uno'));
  hear(word('u1', 1, 0.9, 'due'));
  chunk(1, 0, 500);
  speech.unlinked();
  play(400);
  player.running = false;
  play(500);
  assert.equal((await promise).code, 'connection-lost');
  assert.ok(names().includes('uno') && !names().includes('due'), names().join());
});

test('reports words at the very end before the end event, after the sound stops', async () => {
  const { speech, hear, chunk, play, names, player } = rig();
  const promise = speech.speak('a', { id: 7 });
  hear(begin('u1', 1));
  hear(word('u1', 1, 0.5, 'uno'));
  chunk(1, 0, 500);
  hear({ type: 'end', id: 'u1', utterance: 1, reason: 'done' });
  player.running = false;
  play(500);
  assert.equal((await promise).reason, 'done');
  assert.deepEqual(names().slice(-2), ['uno', 'done']);
});

test('an utterance repeated by another daemon starts again, and has one end', async () => {
  const { speech, hear, chunk, play, names, events } = rig();
  const promise = speech.speak('a', { again: true });
  hear(begin('u1', 1));
  hear(word('u1', 1, 0, 'uno'));
  chunk(1, 0, 100);
  play(50);
  hear({ type: 'warning', id: 'u1', utterance: 1, code: 'room-away' });
  hear(begin('u1', 4));
  hear(word('u1', 4, 0, 'uno'));
  chunk(1, 100, 100);
  chunk(4, 0, 200);
  hear({ type: 'end', id: 'u1', utterance: 4, reason: 'done' });
  play(101);
  play(300);
  assert.deepEqual(names(), ['begin', 'uno', 'warning', 'begin', 'uno', 'done']);
  assert.equal((await promise).reason, 'done');
  assert.equal(events.at(-1)[1].utterance, 4);
  assert.equal(speech.busy, false);
});

test('treats another client\'s utterance repeated by another daemon as a new one', () => {
  const { speech, hear, chunk, play, names } = rig();
  speech.adopts = true;
  hear({ ...begin('theirs', 1), id: undefined });
  chunk(1, 0, 100);
  play(0);
  hear({ type: 'warning', utterance: 1, code: 'room-away' });
  hear({ ...begin('theirs', 2), id: undefined });
  chunk(2, 0, 100);
  hear({ type: 'end', utterance: 2, reason: 'done' });
  play(101);
  play(200);
  assert.deepEqual(names(), ['begin', 'warning', 'failed', 'begin', 'done']);
  assert.equal(speech.busy, false);
});

test('sends a request made before the connection when it opens', () => {
  const { speech, sent, link } = rig({ linked: false });
  speech.speak('a');
  assert.deepEqual(sent, []);
  link.up = true;
  speech.linked();
  assert.equal(sent[0].text, 'a');
});

test('fails after ten seconds without a connection', async () => {
  const { speech, events, timers } = rig({ linked: false });
  const promise = speech.speak('a');
  assert.equal(timers[0].after, 10000);
  timers[0].act();
  assert.deepEqual(await promise, { type: 'end', reason: 'failed', code: 'no-connection', duration: 0 });
  assert.equal(events[0][1].code, 'no-connection');
});

test('fills a gap in the samples, so that the face keeps its position', () => {
  const { speech, player, hear, chunk } = rig();
  speech.speak('a');
  hear(begin('u1', 1));
  chunk(1, 0, 100);
  chunk(1, 250, 100);
  assert.equal(player.written, 350);
});

test('plays and shows the requests of others in a room; ignores them elsewhere', () => {
  const { speech, names, hear, chunk, play } = rig();
  const others = { type: 'begin', id: 'theirs', utterance: 4, rate: RATE, fps: 25, markup: 'plain' };
  hear(others);
  assert.equal(speech.busy, false);
  speech.adopts = true;
  hear(others);
  hear({ type: 'sentence', utterance: 4, time: 0, text: 'Ciao a tutti.', start: 100, end: 113, utf16_start: 90, utf16_end: 103 });
  hear({ type: 'word', utterance: 4, time: 0.5, text: 'tutti', utf16_start: 97, utf16_end: 102 });
  chunk(4, 0, 1000);
  assert.deepEqual(play(100).utterance.captions.lineOf(), { said: '', word: '', rest: 'Ciao a tutti.' });
  assert.deepEqual(play(600).utterance.captions.lineOf(), { said: 'Ciao a ', word: 'tutti', rest: '.' });
  hear({ type: 'end', utterance: 4, reason: 'done', duration: 1 });
  play(1000);
  assert.deepEqual(names(), ['begin', 'Ciao a tutti.', 'tutti', 'done']);
  assert.equal(speech.busy, false);
});

test('a pause holds the player at once, and whenever the server says so', () => {
  const { speech, player, sent, hear, names } = rig();
  speech.pause();
  assert.ok(player.held);
  hear({ type: 'paused', stream: 's1' });
  speech.resume();
  assert.ok(!player.held);
  hear({ type: 'resumed', stream: 's1' });
  hear({ type: 'paused', stream: 's1', utterance: 9, time: 1, sample: 1 }); // another client's, in a room
  assert.ok(player.held);
  speech.stop();
  assert.ok(!player.held);
  assert.deepEqual(sent.map((m) => m.type), ['pause', 'resume', 'stop']);
  assert.deepEqual(names(), ['paused', 'resumed', 'paused']);
});

test('drops pending events after a jump, and reports later ones at their time', () => {
  const { speech, player, sent, names, hear, chunk, play } = rig();
  speech.speak('Uno due tre');
  hear(begin('u1', 1));
  hear(word('u1', 1, 0, 'Uno'));
  chunk(1, 0, 400);
  hear(word('u1', 1, 0.3, 'due'));
  play(200);
  speech.jump('fine');
  assert.deepEqual(sent.at(-1), { type: 'jump', mark: 'fine' });
  hear({ type: 'jumped', id: 'u1', utterance: 1, mark: 'fine', time: 0.4, sample: 400 });
  assert.equal(player.flushed, 1);
  hear({ type: 'mark', id: 'u1', utterance: 1, name: 'fine', time: 0.4, sample: 400 });
  chunk(1, 400, 300);
  hear(word('u1', 1, 0.5, 'tre'));
  play(500);
  assert.deepEqual(names(), ['begin', 'Uno', 'jumped', 'mark', 'tre']);
});

test('silences at once what the server cuts, even without a request of its own', async () => {
  const { speech, player, names, hear, chunk, play } = rig();
  const first = speech.speak('Uno due');
  hear(begin('u1', 1));
  hear(word('u1', 1, 0, 'Uno'));
  chunk(1, 0, 400);
  play(100);
  speech.speak('Ehi!', { mode: 'interrupt' });
  hear({ type: 'end', id: 'u1', utterance: 1, reason: 'stopped', duration: 0.4 });
  assert.equal(player.flushed, 1);
  assert.equal((await first).reason, 'stopped');
  hear(begin('u2', 2));
  chunk(2, 0, 100);
  assert.equal(play(450).seconds, 0.05);
  assert.deepEqual(names(), ['begin', 'Uno', 'stopped', 'begin']);
});

/** Lets an utterance begin, and be heard to its end. */
function say({ hear, chunk, play, player }, id, utterance) {
  hear(begin(id, utterance));
  chunk(utterance, 0, 100);
  hear({ type: 'end', id, utterance, reason: 'done', duration: 0.1 });
  play(player.written);
}

const texts = ({ sent }) => sent.filter(({ type }) => type === 'speak').map(({ text }) => text);

test('two heads take turns: the second request is sent when the first was heard, and its promise then resolves', async () => {
  const turns = new Turns();
  const [a, b] = [rig({ turns }), rig({ turns })];
  a.speech.speak('Ciao.');
  const promise = b.speech.speak('Ciao a te.');
  a.speech.speak('Come stai?');
  assert.deepEqual([texts(a), texts(b)], [['Ciao.'], []]);
  assert.deepEqual(b.timers, [], 'it waits as long as it takes');
  say(a, 'u1', 1);
  assert.deepEqual([texts(a), texts(b)], [['Ciao.'], ['Ciao a te.']]);
  say(b, 'u1', 1);
  assert.equal((await promise).reason, 'done');
  assert.deepEqual(texts(a), ['Ciao.', 'Come stai?']);
});

test('a head that does not wait speaks at once; a stop, a pause and a lost link let the next one speak', () => {
  const turns = new Turns();
  const [a, b, c] = [rig({ turns }), rig({ turns }), rig({ turns })];
  b.speech.waits = false;
  a.speech.speak('Uno.');
  b.speech.speak('Due.');
  assert.deepEqual(texts(b), ['Due.']);
  c.speech.speak('Tre.');
  b.speech.stop();
  b.hear({ type: 'end', id: 'u1', reason: 'stopped', duration: 0 });
  assert.deepEqual(texts(c), []);
  a.speech.pause();
  assert.deepEqual(texts(c), ['Tre.']);
  a.speech.resume();
  b.speech.waits = true;
  b.speech.speak('Quattro.');
  say(a, 'u1', 1);
  assert.deepEqual(texts(b), ['Due.']);
  c.link.up = false;
  c.speech.unlinked();
  assert.deepEqual(texts(b), ['Due.', 'Quattro.']);
});

test('a stop, or replacing speech, cancels waiting requests', async () => {
  const turns = new Turns();
  const [a, b] = [rig({ turns }), rig({ turns })];
  a.speech.speak('Uno.');
  const [first, second] = [b.speech.speak('Due.'), b.speech.speak('Tre.', { mode: 'replace' })];
  assert.equal((await first).reason, 'stopped');
  b.speech.stop();
  assert.equal((await second).reason, 'stopped');
  say(a, 'u1', 1);
  assert.deepEqual(texts(b), []);
});

test('sends a request made before the connection when it opens; heads without a connection delay no one', () => {
  const turns = new Turns();
  let state = 'closed';
  const [a, b] = [rig({ turns, linked: false, state: () => state }), rig({ turns })];
  a.speech.speak('Uno.');
  b.speech.speak('Due.');
  assert.deepEqual(texts(b), ['Due.']);
  say(b, 'u1', 1);
  state = 'open';
  a.link.up = true;
  a.speech.linked();
  assert.deepEqual(texts(a), ['Uno.']);
});

test('keeps the order while connections open', () => {
  const turns = new Turns();
  let state = 'connecting';
  const [a, b] = [rig({ turns, linked: false, state: () => state }), rig({ turns })];
  a.speech.speak('Uno.');
  b.speech.speak('Due.');
  assert.deepEqual(texts(b), []);
  state = 'open';
  a.link.up = true;
  a.speech.linked();
  assert.deepEqual(texts(a), ['Uno.']);
  say(a, 'u1', 1);
  assert.deepEqual(texts(b), ['Due.']);
});

test('the end reports unheard speech', async () => {
  const silent = rig();
  silent.player.sound = 'blocked';
  const promise = silent.speech.speak('Uno.');
  say(silent, 'u1', 1);
  assert.deepEqual(await promise, { type: 'end', utterance: 1, reason: 'done', duration: 0.1, sound: 'blocked' });
});
