// SPDX-License-Identifier: GPL-3.0-or-later
// Marked-up text through the daemon: detected, spoken without its tags, with warnings and their places; malformed documents
// harm nobody.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { Daemon, root } from '../../lib/daemon.mjs';
import { parseFap } from '../../lib/fapfile.mjs';

let daemon;
before(async () => (daemon = await Daemon.start()));
after(async () => assert.deepEqual(await daemon.stop(), { code: 0, signal: null }));

const folder = path.join(root, 'tests/documents');
const post = (query, type, body) => daemon.get(`/v1/speech?format=json&${query}`, { method: 'POST', body, headers: { 'content-type': type } });

async function speak(request) {
  const stream = await daemon.stream();
  stream.send(typeof request === 'string' ? request : { type: 'speak', ...request });
  stream.end = await stream.wait({ type: 'end' });
  await stream.close();
  return stream;
}

test('selects the markup of a posted document by its media type', async () => {
  const text = '<speak xml:lang="it">Ecco: <mark name="qui"/>la <emphasis>mamma</emphasis> &amp; basta.</speak>';
  for (const type of ['application/ssml+xml', 'application/xml', 'application/x-www-form-urlencoded']) {
    const json = await (await post('lang=it', type, text)).json();
    assert.deepEqual(json.words.slice(0, 3).map((w) => w.text), ['Ecco', 'la', 'mamma']);
    assert.equal(json.marks[0].name, 'qui');
    assert.deepEqual(json.warnings, []);
  }
  const plain = await (await post('lang=it', 'text/plain', text)).json();
  assert.ok(plain.words.length > 6, 'plain text is what it is');
});

test('reports positions in the UTF-8 form of a document in another encoding', async () => {
  const text = '<?xml version="1.0" encoding="ISO-8859-9"?><SENT>Işık, günaydın.</SENT>';
  const bytes = Buffer.from(text.replace(/ş/g, 'þ').replace(/ı/g, 'ý'), 'latin1');
  const json = await (await post('lang=tr', 'application/jsml+xml', bytes)).json();
  assert.deepEqual(json.words.map((w) => w.text), ['Işık', 'günaydın']);
});

test('the root element sets the language unless the request does', async () => {
  const text = '<speak xml:lang="tr">Merhaba.</speak>';
  assert.equal((await (await post('', 'application/ssml+xml', text)).json()).lang, 'tr');
  assert.equal((await (await post('lang=it', 'application/ssml+xml', text)).json()).lang, 'it');
  assert.notEqual((await (await post('', 'application/ssml+xml', text.replace('tr', 'tlh'))).json()).lang, 'tlh');
});

test('a stream sends warnings with line and column before the first sentence', async () => {
  const { messages } = await speak({ lang: 'it', text: '<speak>\n  Uno <blink>due</blink>\n<break time="-1s"/></speak>' });
  const warnings = messages.filter((m) => m.type === 'warning').map(({ code, line, column }) => [code, line, column]);
  assert.deepEqual(warnings, [['unknown-element', 2, 7], ['bad-value', 3, 8]]);
  assert.ok(messages.findIndex((m) => m.type === 'warning') < messages.findIndex((m) => m.type === 'sentence'));
  assert.deepEqual(messages.filter((m) => m.type === 'word').map((m) => m.text), ['Uno', 'due']);
});

test('blends by weights in a document that contains one', async () => {
  const faps = async (weight, query = '') => {
    const text = `<SENT>Bugün <HAPPY${weight}>çok güzel</HAPPY> bir gün.</SENT>`;
    const response = await daemon.get(`/v1/speech?format=fap&lang=tr&life=0&${query}`, { method: 'POST', body: text, headers: { 'content-type': 'application/jsml+xml' } });
    return parseFap(await response.text()).frames;
  };
  const weights = [' WEIGHT="0.02"', ' WEIGHT="0.2"', ' WEIGHT="0.9"'];
  /* brows and cheeks over all frames: only the emotion moves them */
  const raised = (frames) => frames.reduce((sum, f) => sum + Math.abs(f[31]) + Math.abs(f[41]), 0);
  const [little, some, much] = await Promise.all(weights.map(async (w) => raised(await faps(w))));
  assert.ok(little < 0.3 * some && some < 0.7 * much, `${little} ${some} ${much}`);
  assert.deepEqual(await faps(weights[1]), await faps(weights[1], 'blend=weighted'));
  assert.deepEqual(await faps(weights[0], 'blend=regions'), await faps(weights[2], 'blend=regions'));
  assert.deepEqual(await faps(''), await faps('', 'blend=regions'), 'without a weight by regions');
});

test('warns of an unused weight, with its position', async () => {
  const text = '<SENT>Bugün\n <HAPPY WEIGHT="0.9">çok güzel</HAPPY> bir <SAD>gün</SAD>.</SENT>';
  const places = async (blend) => (await speak({ lang: 'tr', markup: 'jsml', text, blend })).messages.filter((m) => m.type === 'warning').map(({ code, line, column }) => [code, line, column]);
  assert.deepEqual(await places('regions'), [['ignored', 2, 2]]);
  assert.deepEqual(await places('weighted'), []);
  assert.deepEqual(await places('auto'), []);
});

test('detects the markup of a document sent without a type', async () => {
  const { messages, end } = await speak('<SENT><SURPRISED>merhaba</SURPRISED>, benim adım erdem</SENT>');
  assert.equal(end.reason, 'done');
  assert.deepEqual(messages.filter((m) => m.type === 'word').map((m) => m.text), ['merhaba', 'benim', 'adım', 'erdem']);
});

test('rejects bad documents with their position, and speaks the next one', async () => {
  const stream = await daemon.stream();
  for (const name of fs.readdirSync(folder).filter((n) => /^bad-.*\.xml$/.test(n))) {
    const from = stream.messages.length;
    const bytes = fs.readFileSync(path.join(folder, name));
    const expected = fs.readFileSync(path.join(folder, `${name}.expected`), 'utf8');
    if (!expected.includes(': error: ') || bytes.includes(0) || Buffer.compare(Buffer.from(bytes.toString()), bytes) !== 0) continue;
    stream.send({ type: 'speak', lang: 'it', text: bytes.toString() });
    const end = await stream.wait({ type: 'end' }, { from });
    // a stream speaks the words of an invalid document, and reports where it is invalid
    const error = stream.messages.slice(from).find((m) => m.type === 'error' || (m.type === 'warning' && m.code === 'bad-xml'));
    assert.equal(end.reason, error.type === 'error' ? 'failed' : 'done', name);
    if (error.type === 'warning') assert.ok(expected.startsWith(`-:${error.line}:${error.column}: error: `), `${name}: ${JSON.stringify(error)}`);
    else if (error.code !== 'empty-text') assert.ok(expected.startsWith(`-:${error.line}:${error.column}: error: ${error.message}`), name);
  }
  const from = stream.messages.length;
  stream.send({ type: 'speak', lang: 'it', text: '<speak>Ciao.</speak>' });
  assert.equal((await stream.wait({ type: 'end' }, { from })).reason, 'done');
  await stream.close();
});

test('reads only the speech of BML and FML, never their numbers', async () => {
  const words = async (name) => (await (await post('lang=it', 'application/xml', fs.readFileSync(path.join(folder, name)))).json()).words.map((w) => w.text);
  assert.deepEqual(await words('bml-semaine.xml'), ['One', 'two', 'three']);
  assert.deepEqual(await words('fml-alone.xml'), ['Only', 'a', 'text']);
  assert.deepEqual(await words('fml-apml.xml'), ['Buongiorno', 'io', 'sono', 'Mara', 'Vieni', 'qui', 'per', 'favore']);
  const json = await (await post('lang=it', 'application/bml+xml', '<bml><speech><text>Uno.</text></speech>2.5</bml>')).json();
  assert.deepEqual(json.words.map((w) => w.text), ['Uno']);
});

test('shows a BML head movement at its time: at a second, and at a sync point', async () => {
  const speech = '<speech id="s"><text>Uno due tre. Quattro cinque sei <sync id="x"/>sette otto nove dieci undici.</text></speech>';
  const pitch = async (behaviours) => {
    const text = `<bml>${speech}${behaviours}</bml>`;
    const [fap, json] = await Promise.all(['fap', 'json'].map((format) =>
      daemon.get(`/v1/speech?format=${format}&lang=it&life=0&seed=1`, { method: 'POST', body: text, headers: { 'content-type': 'application/bml+xml' } })));
    const { frames } = parseFap(await fap.text());
    return { at: (from, to) => Math.max(...frames.slice(Math.round(from * 25), Math.round(to * 25)).map((f) => Math.abs(f[48]))), words: (await json.json()).words, end: frames.length / 25 };
  };
  const still = await pitch('');
  assert.ok(still.at(0, still.end) < 1000);
  const second = await pitch('<head lexeme="NOD" start="1.6"/>'); // in the second sentence
  assert.ok(second.at(1.6, 2.8) > 6000);
  assert.ok(second.at(0, 1.5) < 1000 && second.at(2.9, second.end) < 1000);
  const synced = await pitch('<head lexeme="NOD" start="s:x"/>');
  const from = synced.words.find((w) => w.text === 'sette').start;
  assert.ok(synced.at(from, from + 1.2) > 6000);
  assert.ok(synced.at(0, from - 0.1) < 1000);
});

test('speaks every document of our own', async () => {
  for (const name of ['apml-dialogue', 'apml-breaks-its-dtd', 'jsml-05', 'ssml-emotionml', 'ssml-audio', 'ssml-inside-words', 'emotionml-alone', 'entities', 'bad-billion-laughs', 'unknown-everything', 'bml-speech', 'bml-description', 'bml-times', 'fml-apml', 'apml-semaine']) {
    const response = await post('', 'application/xml', fs.readFileSync(path.join(folder, `${name}.xml`)));
    assert.equal(response.status, 200, name);
    const json = await response.json();
    assert.ok(json.words.length > 0, name);
    assert.ok(!json.phones.some((p) => !(p.end > p.start)), name);
  }
});
