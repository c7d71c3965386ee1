// SPDX-License-Identifier: GPL-3.0-or-later
// Open texts, spoken while they are written. The writer imitates a language model: tokens of a few letters, in bursts, with stalls.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import http from 'node:http';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { setTimeout as sleep } from 'node:timers/promises';
import { build, Daemon, eventually } from '../../lib/daemon.mjs';
import { violations } from '../../lib/schema.mjs';

let daemon;
before(async () => {
  daemon = await Daemon.start(['--max-open', '2', '--max-text', '2000', '--open-seconds', '2', '--max-queue', '4']);
});
after(async () => assert.deepEqual(await daemon.stop(), { code: 0, signal: null }));

const texts = {
  it: 'Certo! Ecco **due** id**ee**:\n- una zuppa di ceci, ecc. 😀\n- la pasta. Il dott. Bianchi pesa 3.5 kg, dice. Va bene?',
  'pt-BR': 'Bom dia! O filme começa às 10.30. Não é verdade? Está ótimo.',
  tr: 'Merhaba. Bugün hava çok güzel. Nasılsınız? İyiyim!',
  en: 'Sure. Node.js is fast. Dr. Who said "No." Then he left… or not? 👍 Fine.',
};

/** A seeded generator, so that failures can be reproduced. */
const random = (seed) => () => (seed = (seed * 1664525 + 1013904223) % 4294967296) / 4294967296;

/** Splits a text like a model's tokens: a few letters, mostly with a leading space. */
function tokens(text, next) {
  const characters = [...text], found = [];
  while (characters.length) found.push(characters.splice(0, 1 + Math.floor(next() * 6)).join(''));
  return found;
}

/** Writes like a model at perSecond tokens per second, with bursts and stalls. */
async function write(stream, id, text, { perSecond = 100, seed = 1 } = {}) {
  const next = random(seed);
  for (const token of tokens(text, next)) {
    stream.send({ type: 'text', id, text: token });
    const luck = next();
    if (luck > 0.3) await sleep((luck > 0.97 ? 10 : 1) * (1000 / perSecond));
  }
}

const of = (stream, id, type) => stream.messages.filter((m) => m.id === id && (!type || m.type === type));
const places = (stream, id, type) => of(stream, id, type).map((m) => [m.start, m.end, m.text]);
const valid = (stream) => {
  for (const { arrived, ...message } of stream.messages) assert.equal(violations('server', message), null, `${arrived} ${JSON.stringify(message)}`);
};

test('speaks text written token by token as one utterance, in four languages', async () => {
  await Promise.all(
    Object.entries(texts).map(async ([lang, text], i) => {
      const stream = await daemon.stream();
      stream.send({ type: 'speak', id: 'at once', lang, open: true, text });
      stream.send({ type: 'close', id: 'at once' });
      stream.send({ type: 'speak', id: 'tokens', lang, open: true });
      await write(stream, 'tokens', text, { perSecond: 20 + 25 * i, seed: i + 1 });
      stream.send({ type: 'close', id: 'tokens' });
      await stream.wait({ type: 'end', id: 'tokens' });
      assert.deepEqual(places(stream, 'tokens', 'sentence'), places(stream, 'at once', 'sentence'), lang);
      assert.deepEqual(places(stream, 'tokens', 'word'), places(stream, 'at once', 'word'), lang);
      assert.equal(of(stream, 'tokens', 'begin').length, 1);
      assert.deepEqual(of(stream, 'tokens', 'end').map((m) => m.reason), ['done']);
      assert.deepEqual(of(stream, 'tokens').filter((m) => m.type === 'error' || m.type === 'warning'), []);
      const bytes = Buffer.from(text);
      let at = 0, sample = -1;
      for (const word of of(stream, 'tokens', 'word')) {
        assert.equal(bytes.subarray(word.start, word.end).toString(), word.text);
        assert.equal(text.slice(word.utf16_start, word.utf16_end), word.text);
        assert.ok(word.start >= at && word.sample > sample, `${lang}: ${word.text}`);
        at = word.end;
        sample = word.sample;
      }
      assert.ok(!of(stream, 'tokens', 'word').some((word) => /^[*😀👍]/u.test(word.text)), lang);
      valid(stream);
      await stream.close();
    }),
  );
});

test('begins before the text ends, and is silent while waiting for more', async () => {
  const stream = await daemon.stream();
  stream.send({ type: 'speak', id: 'a', lang: 'it', open: true, text: 'Prima frase. Se' });
  await stream.wait({ type: 'word', id: 'a', text: 'frase' });
  const last = of(stream, 'a', 'word').at(-1);
  // the second sentence plays when it is written, after the silence
  await stream.until(() => stream.chunks.some((c) => c.start > last.sample + 22050), 60000, 'a second of silence');
  stream.send({ type: 'text', id: 'a', text: 'conda frase' });
  stream.send({ type: 'flush', id: 'a' });
  const second = await stream.wait({ type: 'word', id: 'a', text: 'Seconda' });
  assert.ok(second.sample > last.sample + 22050, `${second.sample}`);
  stream.send({ type: 'text', id: 'a', text: ' e terza.' });
  stream.send({ type: 'close', id: 'a' });
  const end = await stream.wait({ type: 'end', id: 'a' });
  assert.equal(end.reason, 'done');
  assert.deepEqual(of(stream, 'a', 'sentence').map((m) => m.text), ['Prima frase.', 'Seconda frase', 'e terza.']);
  let at = 0, frame = 0;
  for (const chunk of stream.chunks) {
    assert.deepEqual([chunk.start, chunk.firstFrame], [at, frame]);
    at += chunk.samples;
    frame += chunk.frames.length;
  }
  assert.equal(at, Math.round(end.duration * 22050));
  valid(stream);
  await stream.close();
});

test('speaks a probable sentence end speculatively; a wrong guess is never heard', async () => {
  const asked = () => daemon.metric('faccia_sentences_asked_total');
  const speaks = async (id, parts) => {
    const stream = await daemon.stream();
    const before = await asked();
    stream.send({ type: 'speak', id, lang: 'en', open: true });
    for (const text of parts) stream.send({ type: 'text', id, text });
    stream.send({ type: 'close', id });
    assert.equal((await stream.wait({ type: 'end', id })).reason, 'done');
    const words = of(stream, id, 'word').map((m) => m.text), sentences = of(stream, id, 'sentence').map((m) => m.text);
    valid(stream);
    await stream.close();
    return { words, sentences, asked: (await asked()) - before };
  };
  assert.deepEqual(await speaks('right', ['She runs away.', ' He', ' sleeps.']), { words: ['She', 'runs', 'away', 'He', 'sleeps'], sentences: ['She runs away.', 'He sleeps.'], asked: 2 });
  const wrong = await speaks('wrong', ['We use Node.', 'js here.']);
  assert.deepEqual([wrong.sentences, wrong.words.at(-1), wrong.asked], [['We use Node.js here.'], 'here', 2]);
  assert.deepEqual(await speaks('longer', ['She said no.', '"', ' Then she left.']), { words: ['She', 'said', 'no', 'Then', 'she', 'left'], sentences: ['She said no."', 'Then she left.'], asked: 3 });
  // a text full of full stops causes only a few speculative requests
  const dots = await speaks('dots', Array.from({ length: 40 }, (_, i) => `word${'abcdefghij'[i % 10]}.`));
  assert.ok(dots.asked <= 3 + dots.sentences.length, `${dots.asked} of ${dots.sentences.length}`);
  // a speculative sentence plays as soon as the next token confirms it
  const early = await daemon.stream(), before = await daemon.metric('faccia_sentences_total{result="spoken"}');
  early.send({ type: 'speak', id: 'e', lang: 'en', open: true, text: 'She runs' });
  early.send({ type: 'text', id: 'e', text: ' away.' });
  await eventually(async () => (await daemon.metric('faccia_sentences_total{result="spoken"}')) > before, 'the guess');
  early.send({ type: 'text', id: 'e', text: ' He' });
  for (let i = 0; i < 20; i++) {
    early.send({ type: 'ping', id: `${i}` });
    await early.wait({ type: 'pong', id: `${i}` });
  }
  assert.equal(of(early, 'e', 'begin').length, 1);
  await early.close();
  // cancels during speculation, and disconnects during speculation
  const stream = await daemon.stream();
  for (const how of [{ type: 'cancel', id: 'g' }, { type: 'stop' }]) {
    stream.send({ type: 'speak', id: 'g', lang: 'en', open: true, text: 'She runs' });
    stream.send({ type: 'text', id: 'g', text: ' away.' });
    stream.send(how);
    await stream.until(() => of(stream, 'g', 'end').length === (how.type === 'cancel' ? 1 : 2));
  }
  stream.send({ type: 'speak', id: 'h', lang: 'en', open: true });
  stream.send({ type: 'text', id: 'h', text: 'She runs away.' });
  await stream.close();
});

test('accepts markup in pieces, even half a tag; errors have their position', async () => {
  const stream = await daemon.stream();
  stream.send({ type: 'speak', id: 'a', open: true });
  for (const text of ['<spe', 'ak xml:lang="en">One. <pro', 'sody rate="slow">Two. <mark na', 'me="m"/>Three.</prosody></speak>', ' ']) stream.send({ type: 'text', id: 'a', text });
  stream.send({ type: 'close', id: 'a' });
  assert.equal((await stream.wait({ type: 'end', id: 'a' })).reason, 'done');
  assert.deepEqual(of(stream, 'a', 'word').map((m) => m.text), ['One', 'Two', 'Three']);
  assert.deepEqual(of(stream, 'a', 'mark').map((m) => m.name), ['m']);
  assert.deepEqual(of(stream, 'a', 'begin').map((m) => [m.lang, m.markup]), [['en', 'ssml']]);
  stream.send({ type: 'speak', id: 'b', lang: 'it', open: true, text: '<speak>Uno. \nDue. <b>Tre</c>. Quattro.' });
  const error = await stream.wait({ type: 'error', id: 'b' });
  assert.deepEqual([error.code, error.line], ['bad-xml', 2]);
  stream.send({ type: 'text', id: 'b', text: 'Cinque.' });
  assert.equal((await stream.wait({ type: 'end', id: 'b' })).reason, 'done');
  assert.deepEqual(of(stream, 'b', 'word').map((m) => m.text), ['Uno', 'Due']);
  stream.send({ type: 'speak', id: 'c', open: true, text: '<bml><speech><text>Ciao.</text></speech></bml>' });
  assert.equal((await stream.wait({ type: 'error', id: 'c' })).field, 'markup');
  assert.equal((await stream.wait({ type: 'end', id: 'c' })).reason, 'failed');
  valid(stream);
  await stream.close();
});

test('closes an abandoned open text after a timeout, with a warning', async () => {
  const [writer, listener] = await Promise.all([daemon.stream('?room=cucina'), daemon.stream('?room=cucina')]);
  writer.send({ type: 'speak', id: 'a', lang: 'it', open: true, text: 'Il treno per' });
  assert.equal((await writer.wait({ type: 'warning', id: 'a' })).code, 'unfinished');
  assert.equal((await writer.wait({ type: 'end', id: 'a' })).reason, 'done');
  writer.send({ type: 'text', id: 'a', text: 'Nessuno lo sente.' });
  // the writer disconnects within a word: the others hear what was written
  writer.send({ type: 'speak', id: 'b', lang: 'it', open: true, text: 'La cena è pron' });
  await writer.wait((m) => m.type === 'begin' && m.id === 'a');
  writer.socket.terminate();
  assert.equal((await listener.wait({ type: 'warning', id: 'b' })).code, 'unfinished');
  assert.equal((await listener.wait({ type: 'end', id: 'b' })).reason, 'done');
  assert.deepEqual(of(listener, 'b', 'word').map((m) => m.text), ['La', 'cena', 'è', 'pron']);
  valid(listener);
  await listener.close();
});

test('cancels utterances by their id, whether they speak or wait', async () => {
  const stream = await daemon.stream();
  const ends = () => stream.messages.filter((m) => m.type === 'end').map((m) => `${m.id} ${m.reason}`);
  stream.send({ type: 'speak', id: 'a', lang: 'it', open: true, text: 'Questa frase non finisce. ' });
  stream.send({ type: 'speak', id: 'b', lang: 'it', open: true, text: 'Questa non comincia.' });
  stream.send({ type: 'speak', id: 'c', lang: 'it', text: 'Questa si sente.' });
  await stream.wait({ type: 'word', id: 'a' });
  stream.send({ type: 'cancel', id: 'b' });
  stream.send({ type: 'cancel', id: 'a' });
  stream.send({ type: 'text', id: 'a', text: 'Troppo tardi.' });
  stream.send({ type: 'close', id: 'a' });
  await stream.wait({ type: 'end', id: 'c' });
  assert.deepEqual(ends(), ['b stopped', 'a stopped', 'c done']);
  assert.deepEqual(of(stream, 'a', 'error'), []);
  stream.send({ type: 'cancel', id: 'nobody' });
  assert.equal((await stream.wait({ type: 'error', id: 'nobody' })).code, 'unknown-utterance');
  valid(stream);
  await stream.close();
});

test('reports limits and mistakes, which affect no one else', async () => {
  const stream = await daemon.stream();
  const refused = async (message, code, field) => {
    const from = stream.messages.length;
    stream.send(message);
    const error = await stream.wait({ type: 'error' }, { from });
    assert.deepEqual([error.code, error.field, error.id], [code, field, message.id], JSON.stringify(message));
  };
  await refused({ type: 'speak', open: true, text: 'Ciao.' }, 'missing-field', 'id');
  await refused({ type: 'text', id: 'x', text: 'Ciao.' }, 'unknown-utterance', 'id');
  await refused({ type: 'flush', id: 'x' }, 'unknown-utterance', 'id');
  await refused({ type: 'close' }, 'missing-field', 'id');
  await refused({ type: 'speak', id: 'v', open: true, voice: 'nobody' }, 'unknown-voice', 'voice');
  await refused({ type: 'speak', id: 'm', open: true, markup: 'runes' }, 'unknown-markup', 'markup');
  stream.send({ type: 'speak', id: 'a', lang: 'it', open: true, text: 'Eccomi' });
  await refused({ type: 'speak', id: 'a', open: true }, 'bad-field', 'id');
  stream.send({ type: 'speak', id: 'b', open: true });
  await refused({ type: 'speak', id: 'c', open: true }, 'too-many-open');
  await refused({ type: 'text', id: 'a' }, 'missing-field', 'text');
  await refused({ type: 'text', id: 'a', text: 7 }, 'bad-field', 'text');
  await refused({ type: 'text', id: 'a', text: 'x'.repeat(2000) }, 'text-too-long', 'text');
  const from = stream.messages.length;
  stream.send({ type: 'text', id: 'a', text: ' qua\0' });
  assert.deepEqual([(await stream.wait({ type: 'error', id: 'a' }, { from })).code, stream.messages.at(-1).byte], ['nul', 10]);
  stream.send({ type: 'text', id: 'a', text: ' qui.' });
  stream.send({ type: 'close', id: 'a' });
  stream.send({ type: 'close', id: 'b' });
  assert.equal((await stream.wait({ type: 'error', id: 'b' })).code, 'empty-text');
  assert.equal((await stream.wait({ type: 'end', id: 'b' })).reason, 'failed');
  assert.deepEqual(of(stream, 'a', 'word').map((m) => m.text), ['Eccomi', 'qui']);
  valid(stream);
  await stream.close();
});

/** Starts a POST whose chunked body is sent piece by piece. */
function post(address) {
  const request = http.request(daemon.url + address, { method: 'POST', headers: { 'Transfer-Encoding': 'chunked' } });
  request.answer = new Promise((resolve, reject) => {
    request.on('error', reject);
    request.on('response', async (response) => {
      let body = '';
      for await (const part of response) body += part;
      resolve({ status: response.statusCode, body: JSON.parse(body) });
    });
  });
  request.flushHeaders();
  return request;
}

test('over HTTP: sends the sound of a body while it is written', async () => {
  const whole = Buffer.from(await (await daemon.get('/v1/speech?lang=it', { method: 'POST', body: 'Prima frase. E la seconda.' })).arrayBuffer());
  const request = http.request(`${daemon.url}/v1/speech?open=1&lang=it`, { method: 'POST', headers: { 'transfer-encoding': 'chunked' } });
  const answered = new Promise((resolve) => request.on('response', resolve));
  request.write('Prima fra');
  request.write('se. E la ');
  const response = await answered; // of the first sentence
  assert.deepEqual([response.statusCode, response.headers['content-type']], [200, 'audio/wav']);
  const parts = response[Symbol.asyncIterator](), bytes = [(await parts.next()).value];
  request.end('seconda.');
  for (let part; !(part = await parts.next()).done; ) bytes.push(part.value);
  const samples = (wav) => (wav.length - 44) / 2;
  assert.ok(Math.abs(samples(Buffer.concat(bytes)) - samples(whole)) < 0.05 * samples(whole), `${samples(Buffer.concat(bytes))} ${samples(whole)}`);
  for (const [query, body, type, code] of [['format=json', 'Ciao.', 'text/plain', 'bad-field'], ['', '{"text":"Ciao.","open":true}', 'application/json', 'bad-field'], ['', ' ', 'text/plain', 'empty-text'], ['', 'a\u0000', 'text/plain', 'nul']]) {
    const refused = await daemon.get(`/v1/speech?open=1&lang=it&${query}`, { method: 'POST', body, headers: { 'content-type': type } });
    assert.deepEqual([refused.status, (await refused.json()).code], [400, code], body);
  }
  const left = http.request(`${daemon.url}/v1/speech?open=1&lang=it`, { method: 'POST', headers: { 'transfer-encoding': 'chunked' } });
  left.on('error', () => {});
  left.write('Questa frase non la sente nessuno, e ');
  left.destroy(); // the daemon must not be affected
});

test('over HTTP: speaks a body in a room while it is written', async () => {
  const listener = await daemon.stream('?room=sala');
  const request = post('/v1/say?room=sala&open=1&id=h&lang=it');
  request.write('Prima fra');
  request.write('se. È l');
  await listener.wait({ type: 'word', id: 'h', text: 'frase' });
  const [first, rest] = [Buffer.from('à').subarray(0, 1), Buffer.from('à').subarray(1)];
  request.write(first);
  await sleep(20);
  request.write(rest);
  request.end('. Fine.');
  assert.deepEqual(await request.answer, { status: 202, body: { type: 'accepted', room: 'sala', listeners: 1 } });
  await listener.wait({ type: 'end', id: 'h' });
  assert.deepEqual(of(listener, 'h', 'sentence').map((m) => m.text), ['Prima frase.', 'È là.', 'Fine.']);

  const dropped = post('/v1/say?room=sala&open=1&id=d&lang=it');
  dropped.write('Mi senti? An');
  await listener.wait({ type: 'begin', id: 'd' });
  dropped.destroy();
  await assert.rejects(dropped.answer);
  assert.equal((await listener.wait({ type: 'warning', id: 'd' })).code, 'unfinished');
  assert.equal((await listener.wait({ type: 'end', id: 'd' })).reason, 'done');

  const broken = post('/v1/say?room=sala&open=1&id=e&lang=it');
  broken.write(Buffer.from([0x43, 0x69, 0xff, 0x61]));
  const answer = await broken.answer;
  assert.deepEqual([answer.status, answer.body.code, answer.body.byte], [400, 'bad-utf8', 2]);
  for (const [address, code] of [['/v1/say?room=nobody&open=1', 'unknown-room'], ['/v1/say?room=sala&open=no', 'bad-field']]) {
    const refused = post(address);
    refused.on('error', () => {});
    refused.end('Ciao.');
    assert.equal((await refused.answer).body.code, code);
  }
  valid(listener);
  await listener.close();
});

test('faccia say speaks standard input while it is written', async () => {
  const say = spawn(path.join(build, 'server/cli/faccia'), ['say', '--open', '--lang', 'it', '--ndjson', '-', '-']);
  let out = '';
  const heard = (text) => new Promise((resolve) => say.stdout.on('data', () => out.includes(`"text":"${text}"`) && resolve()));
  say.stdout.setEncoding('utf8').on('data', (piece) => (out += piece));
  say.stdin.write('Prima fra');
  say.stdin.write('se. Seconda');
  await heard('frase'); // while the second is being written
  say.stdin.end(' frase');
  assert.equal(await new Promise((resolve) => say.on('close', resolve)), 0, out);
  const words = out.trim().split('\n').map((line) => JSON.parse(line)).filter((line) => line.type === 'word');
  assert.deepEqual(words.map((word) => [word.start, word.text]), [[0, 'Prima'], [6, 'frase'], [13, 'Seconda'], [21, 'frase']]);
  const wrong = spawn(path.join(build, 'server/cli/faccia'), ['say', '--open', 'Ciao.']);
  assert.equal(await new Promise((resolve) => wrong.on('close', resolve)), 2);
});
