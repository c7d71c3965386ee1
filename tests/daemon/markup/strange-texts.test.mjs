// SPDX-License-Identifier: GPL-3.0-or-later
// Unusual texts from people and programs: none crashes a voice, delays others, or is dropped without a warning.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Daemon } from '../../lib/daemon.mjs';

let daemon;
before(async () => void (daemon = await Daemon.start(['--lang', 'en', '--max-message', '100000', '--workers', '1'])));
after(async () => {
  assert.doesNotMatch(daemon.log, /restarting it/); // no worker was lost
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});

const post = (text, query = '', type = 'application/xml') =>
  daemon.get(`/v1/speech?format=json&lang=en${query}`, { method: 'POST', body: text, headers: { 'content-type': type } });

/** Speaks a text. Returns its words, and the codes of warnings with their places. */
async function spoken(text, more = {}) {
  const stream = await daemon.stream('?audio=none&fap=none');
  stream.send({ type: 'speak', id: 'a', lang: 'en', text, ...more });
  const end = await stream.wait({ type: 'end', id: 'a' }, { milliseconds: 30000 });
  const bytes = Buffer.from(text);
  const words = stream.messages.filter((m) => m.type === 'word').map((m) => m.text);
  const places = stream.messages.filter((m) => m.type === 'word').map((m) => bytes.subarray(m.start, m.end).toString());
  const warnings = stream.messages.filter((m) => m.type === 'warning');
  const sentences = stream.messages.filter((m) => m.type === 'sentence').length;
  await stream.close();
  return { end, words, places, warnings, sentences, bytes, errors: stream.messages.filter((m) => m.type === 'error') };
}


test('limits the sum of pauses without counting them as work of the voice', async () => {
  const text = `<speak>One.${'<break time="10s"/>'.repeat(181)}</speak>`;
  const response = await daemon.get('/v1/speech?format=wav&lang=en', { method: 'POST', body: text, headers: { 'content-type': 'application/ssml+xml' } });
  assert.equal(response.status, 200);
  const bytes = (await response.arrayBuffer()).byteLength;
  const seconds = bytes / 2 / 22050;
  assert.ok(seconds > 119 && seconds < 125, `${seconds} s`);
});

test('keeps a pause between sentences, and speaks the text after it', async () => {
  const said = await spoken('<speak><p>One.</p><break time="300ms"/><p>Two.</p><break/></speak>');
  assert.equal(said.end.reason, 'done');
  assert.deepEqual(said.words, ['One', 'Two']);
});

for (const [name, text] of Object.entries({
  'a long sub': `<speak><sub alias="${'word '.repeat(3000)}">x</sub></speak>`,
  'letters by the thousand': `<speak><prosody rate="x-slow"><say-as interpret-as="characters">${'abc'.repeat(1500)}</say-as></prosody></speak>`,
  'a number of a thousand digits': `<speak><say-as interpret-as="cardinal">${'7'.repeat(1000)}</say-as></speak>`,
  'long phones': `<speak><phoneme ph="${'a'.repeat(5000)}">Hello</phoneme></speak>`,
  'many marks': `<speak>One ${'<mark name="m"/>'.repeat(5000)} two</speak>`,
  'very slow': `<speak><prosody rate="0.2">${'word '.repeat(79)}</prosody></speak>`,
}))
  test(`${name}: speaks it, or rejects it as an error in the text`, async () => {
    const response = await post(text, '&rate=40', 'application/ssml+xml');
    const answer = await response.json();
    if (response.status !== 200) assert.match(answer.code, /^(text-too-long|bad-value)$/, JSON.stringify(answer).slice(0, 200));
  });

for (const [text, words, warned, raw] of [
  ['<p>One.</p><p>Two</p>', ['One', 'Two'], 'bad-xml'],
  ['<b>Hi</b> there', ['Hi', 'there'], 'ignored'],
  ['<Anna> hi', ['Anna', 'hi'], null],
  ['a<br/>b', ['a', 'b'], 'ignored'],
  ['<p>one<br/>two</p>', ['one', 'two'], 'unknown-element'],
  ['<speak>One <emphasis>two</speak>', ['One', 'two'], 'bad-xml'],
  ['<i>Who is it?</i>\n<i>Me.</i>', ['Who', 'is', 'it', 'Me'], 'bad-xml'],
  ['<ul><li>One</li><li>Two</li></ul> and more', ['One', 'Two', 'and', 'more'], 'ignored'],
  ['<script>var words = 1;</script>Hello', ['Hello'], 'ignored'],
  ['un caf&eacute; e caf&#233;', ['un', 'caf&eacute;', 'e', 'caf&#233;'], null, 'raw'],
  ['a < b', ['a', 'b'], null],
  ['5 <3 you', ['you'], null],
  ['- Who is it?', ['Who', 'is', 'it'], null],
  ['<i>- Who is it?</i>\n<i>- Me.</i>', ['Who', 'is', 'it', 'Me'], 'bad-xml'],
  ['<div class="answer"><h2>Two things</h2>\n<p>You <strong>should</strong> try <code>this</code>:</p>\n<ol>\n<li>First, <em>look</em>;</li>\n<li>then <a href="https://example.org/?a=1&b=2">read</a>.</li>\n</ol>\n<hr>\n<p>Good&nbsp;luck!</p></div>',
    ['Two', 'things', 'You', 'should', 'try', 'this', 'First', 'look', 'then', 'read', 'Good', 'luck'], 'bad-xml'],
])
  test(`speaks the words of ${JSON.stringify(text)}`, async () => {
    const said = await spoken(text);
    assert.deepEqual(said.errors, []);
    assert.equal(said.end.reason, 'done');
    if (words) assert.deepEqual(raw ? said.places : said.words.map((word) => word.replace(/[^\p{L}]/gu, '')).filter(Boolean), words);
    if (warned) assert.ok(said.warnings.some((w) => w.code === warned && w.line && w.column), JSON.stringify(said.warnings));
  });

test('reports a document that does not parse as its declared type with its position', async () => {
  const response = await post('<speak>One', '', 'application/ssml+xml');
  const { code, line } = await response.json();
  assert.deepEqual([response.status, code, line], [400, 'bad-xml', 1]);
});

test('rejects a language that is not a BCP 47 tag with its position', async () => {
  for (const lang of ['it\r\nX: y', 'en"><script>', 'e', 'en--us', '-en', 'en-', 'toolongsubtag', '12', 'en_', 'en_US_x', 'en_USA', 'C', 'en_US.', 'en_US.UTF-8\r\n', 'a-b']) {
    const stream = await daemon.stream();
    stream.send({ type: 'speak', id: 'a', lang, text: 'Hello.' });
    const error = await stream.wait({ type: 'error', id: 'a' });
    assert.deepEqual([error.code, error.field], ['bad-field', 'lang'], lang);
    assert.match(error.message, /BCP 47|bytes/);
    await stream.close();
    const response = await daemon.get(`/v1/speech?text=Hi&lang=${encodeURIComponent(lang)}`, {});
    assert.equal(response.status, 400);
  }
  for (const lang of ['en', 'en-US', 'x-klingon', 'EN-us', 'en_US', 'it_IT.UTF-8', 'ca_ES.UTF-8@valencia']) {
    const stream = await daemon.stream();
    stream.send({ type: 'speak', id: 'a', lang, text: 'Hello.' });
    const answer = await stream.wait((m) => ['begin', 'error'].includes(m.type));
    assert.ok(answer.type === 'begin' || answer.code === 'unknown-language', JSON.stringify(answer));
    await stream.close();
  }
});

test('reports the word after a dash, in each language', async () => {
  for (const [lang, text, words] of [
    ['en', '- Who is it?\n- Me.', ['Who', 'is', 'it', 'Me']],
    ['it', '- Chi parla?\n- Sono io.', ['Chi', 'parla', 'Sono', 'io']],
    ['tr', '- Kim geldi?\n- Ben geldim.', ['Kim', 'geldi', 'Ben', 'geldim']],
    ['pt-BR', '- Quem fala?\n- Sou eu.', ['Quem', 'fala', 'Sou', 'eu']],
    ['en', '<speak>Well - <emphasis>who</emphasis> knows?</speak>', ['Well', 'who', 'knows']],
  ]) {
    const said = await spoken(text, { lang });
    assert.deepEqual(said.words, words, text);
  }
});

test('keeps private-use characters and warns that they are unspoken', async () => {
  const stream = await daemon.stream();
  for (const character of ['\u{10d83d}', '\u{10de00}', '\ufdef', '\ufdef\ufdd0\ufdd1\ufdd2'])
    for (const written of [character, [...character].flatMap((c) => c.split('')).map((unit) => `\\u${unit.charCodeAt(0).toString(16).padStart(4, '0')}`).join('')]) {
      const id = `p${Math.random()}`;
      stream.send(`{"type":"speak","id":"${id}","lang":"en","text":"One ${written} two."}`);
      await stream.wait({ type: 'end', id });
      const sentence = stream.messages.find((m) => m.type === 'sentence' && m.id === id);
      assert.equal(sentence.end - sentence.start, Buffer.byteLength(`One ${character} two.`));
      const told = stream.messages.filter((m) => m.id === id && ['error', 'warning'].includes(m.type));
      assert.deepEqual(told.map(({ type, code, line, column }) => [type, code, line, column]), [['warning', 'unspoken', 1, 5]], JSON.stringify(told));
    }
  await stream.close();
});

test('joins two halves of a character from two pieces of an open text', async () => {
  const stream = await daemon.stream();
  stream.send({ type: 'speak', open: true, id: 'a', lang: 'en', text: 'I love \ud83c' });
  stream.send({ type: 'text', id: 'a', text: '\udf55 and \ud83d' });
  stream.send({ type: 'text', id: 'a', text: '\ude00 a lot.' });
  stream.send({ type: 'close', id: 'a' });
  assert.equal((await stream.wait({ type: 'end', id: 'a' })).reason, 'done');
  const sentence = stream.messages.find((m) => m.type === 'sentence');
  assert.equal(sentence.end - sentence.start, Buffer.byteLength('I love 🍕 and 😀 a lot.'));
  assert.ok(!stream.messages.some((m) => m.type === 'error' || m.type === 'warning'), JSON.stringify(stream.messages.filter((m) => m.type === 'error')));
  // a lone surrogate loses no word, and is reported
  stream.send({ type: 'speak', id: 'b', lang: 'en', text: 'Half \ud83d a face.' });
  assert.equal((await stream.wait({ type: 'end', id: 'b' })).reason, 'done');
  stream.send({ type: 'speak', open: true, id: 'c', lang: 'en', text: 'The end \ud83d' });
  stream.send({ type: 'close', id: 'c' });
  assert.equal((await stream.wait({ type: 'warning', id: 'c' })).code, 'bad-utf8');
  assert.equal((await stream.wait({ type: 'end', id: 'c' })).reason, 'done');
  await stream.close();
});

test('answers every refused message with its id', async () => {
  const stream = await daemon.stream();
  for (const [i, [message, code]] of [
    ['{"type":"speak","text":5,"id":"#"}', 'bad-field'],
    ['{"type":"speak","text":"a","rate":"x","id":"#"}', 'bad-field'],
    ['{"type":"speak","text":"a\\u0000b","lang":"en","id":"#"}', 'nul'],
    ['{"type":"speak","text":"a,"id":"#"}', 'bad-json'],
    ['{"type":"speak","id":"#","text":"a', 'bad-json'],
    ['{"type":"play","name":5,"id":"#"}', null],
    ['{"type":"voice","rate":"x","id":"#"}', 'bad-field'],
    [`{"type":"speak","id":"#","text":"${'a '.repeat(60000)}"}`, 'message-too-long'],
  ].entries()) {
    const id = `id${i}`;
    stream.send(message.replace('#', id));
    const error = await stream.wait({ type: 'error', id });
    if (code) assert.equal(error.code, code, message.slice(0, 80));
    assert.equal((await stream.wait({ type: 'end', id })).reason, 'failed');
  }
  for (const [i, message] of ['{"type":"nonsense","id":"#"}', '{"type":"jump","mark":5,"id":"#"}', '{"type":"choose","choice":"x","id":"#"}', '{"type":"express","id":"#"}'].entries()) {
    stream.send(message.replace('#', `other${i}`));
    await stream.wait({ type: 'error', id: `other${i}` });
  }
  await stream.close();
});
