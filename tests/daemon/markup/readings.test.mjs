// SPDX-License-Identifier: GPL-3.0-or-later
// A sentence with numbers, signs and abbreviations, in every interface and markup: it sounds as if written in words.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import fs from 'node:fs';
import net from 'node:net';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { faccia } from '../../lib/command.mjs';
import { build, Daemon, eventually } from '../../lib/daemon.mjs';
import { writeZip, epub } from '../../lib/works.mjs';

const written = 'Il 26 novembre pago € 3,50 al Sig. Rossi.';
const words = 'Il ventisei novembre pago tre euro e cinquanta al signor Rossi.';
const voice = 'espeak:it';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-readings-'));
const at = (name) => path.join(folder, name);
const running = new Set();
let daemon, said, bypassed;

const door = (name, ...options) => {
  const child = spawn(name.includes('/') ? name : path.join(build, 'server/bridges', name), options);
  running.add(child);
  child.text = '';
  for (const out of [child.stderr, child.stdout]) out.on('data', (text) => (child.text += text));
  child.exited = once(child, 'exit').then(([code]) => (running.delete(child), code));
  return child;
};
const freePort = () => new Promise((resolve) => {
  const server = net.createServer().listen(0, '127.0.0.1', () => {
    const { port } = server.address();
    server.close(() => resolve(port));
  });
});
const bytesOf = (wav) => Buffer.from(wav).subarray(44);
const post = (address, text, type) => daemon.get(address, { method: 'POST', body: text, headers: { 'content-type': type } });
async function wavOf(text, query = '', type = 'text/plain') {
  const response = await post(`/v1/speech?voice=${voice}${query}`, text, type);
  assert.equal(response.status, 200);
  return bytesOf(await response.arrayBuffer());
}
/** Returns the sound of the utterance with that id, or of the first one, from a stream. */
async function soundOn(stream, id = undefined) {
  const { utterance } = await stream.wait({ type: 'begin', ...(id && { id }) });
  await stream.wait((message) => message.type === 'end' && message.utterance === utterance);
  const sound = stream.chunks.filter((chunk) => chunk.utterance === utterance && chunk.audio).map(({ audio }) => Buffer.from(audio.buffer, audio.byteOffset, audio.byteLength));
  return Buffer.concat(sound);
}
async function inRoom(act) {
  const kiosk = await daemon.stream(`?lang=it&voice=${voice}&room=kitchen`);
  await kiosk.wait({ type: 'joined' });
  await act();
  const sound = await soundOn(kiosk);
  await kiosk.close();
  return sound;
}
const same = (sound) => {
  assert.ok(!sound.equals(bypassed), 'it went to the voice as it was written');
  assert.ok(sound.equals(said), `${sound.length} bytes, not the ${said.length} of the words`);
};

before(async () => {
  fs.mkdirSync(at('works'));
  fs.writeFileSync(at('works/testo.it.txt'), `${written}\n`);
  fs.writeFileSync(at('works/tei.xml'), `<TEI xml:lang="it"><text><body><p>${written.replace('Rossi', '<hi>Rossi</hi>')}</p></body></text></TEI>`);
  writeZip(at('works/libro.epub'), epub({ 'uno.xhtml': `<p>${written}</p>` }));
  daemon = await Daemon.start(['--library', at('works')]);
  said = await wavOf(words, '&normalize=off');
  bypassed = await wavOf(written, '&normalize=off');
  assert.ok(said.length > 44100 && !said.equals(bypassed));
});
after(async () => {
  for (const child of running) child.kill('SIGTERM');
  await Promise.all([...running].map((child) => child.exited));
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  fs.rmSync(folder, { recursive: true });
});

const markups = {
  plain: ['text/plain', written],
  ssml: ['application/ssml+xml', `<speak>${written}</speak>`],
  apml: ['application/xml', `<apml><performative type="inform"><theme>${written}</theme></performative></apml>`],
  jsml: ['application/xml', `<jsml>${written}</jsml>`],
};
for (const [markup, [type, text]] of Object.entries(markups))
  test(`speaks normalised text over HTTP, ${markup}`, async () => same(await wavOf(text, `&markup=${markup}`, type)));

for (const markup of ['plain', 'ssml']) // only these two, because starting takes seconds
  test(`speaks normalised text on the command line, ${markup}`, () => {
    const [, text] = markups[markup];
    const { status, stderr } = faccia(['say', '--still', '--voice', voice, '--markup', markup, '--wav', at('wav'), '-'], { input: text });
    assert.equal(status, 0, stderr);
    same(bytesOf(fs.readFileSync(at('wav'))));
  });

test('speaks normalised text with a voice of Festival', async () => {
  const of = async (text, query = '') => {
    const response = await post(`/v1/speech?voice=festival:pc${query}`, text, 'text/plain');
    assert.equal(response.status, 200);
    return bytesOf(await response.arrayBuffer());
  };
  const own = await of(written);
  assert.ok(own.equals(await of(words, '&normalize=off')));
  assert.ok(!own.equals(await of(written, '&normalize=off')));
});

test('loses nothing of long runs of digits, letters and marks', () => {
  const read = (lang, input) => {
    const { status, stdout, stderr } = faccia(['read', '--words', '-l', lang, '-'], { input });
    assert.equal(status, 0, stderr);
    return stdout.trim();
  };
  for (const lang of ['it', 'en', 'pt-BR', 'tr']) {
    const [seven] = read(lang, '7').split(' ');
    assert.deepEqual(new Set(read(lang, '7'.repeat(20000)).split(/[ ,]+/)), new Set([seven]));
    assert.equal(read(lang, '7'.repeat(20000)).split(/[ ,]+/).length, 20000, lang);
    assert.equal(read(lang, `Uno ${'\u202e\u2066'.repeat(3000)}due.`).replace(/[\u202e\u2066 ]/g, '').toLowerCase(), 'unodue');
    assert.match(read(lang, `Uno ${'a\u0301\u0302\u0303'.repeat(2000)} due.`), /^Uno .*due$/s);
    assert.match(read(lang, `Uno ${'\u{e000}\u0378'.repeat(3000)} due.`), /^Uno .*due$/s);
  }
});

test('faccia read prints those words', () => {
  assert.equal(`${faccia(['read', '--words', '-l', 'it', written]).stdout.trim()}.`, words);
});

test('a stream speaks normalised text: at once, open in pieces, as JSON over HTTP', async () => {
  const stream = await daemon.stream(`?voice=${voice}`);
  stream.send({ type: 'speak', id: 'whole', voice, text: written });
  same(await soundOn(stream, 'whole'));
  stream.send({ type: 'speak', id: 'pieces', voice, open: true });
  for (const text of ['Il 2', '6 novembre pa', 'go € 3,', '50 al Sig', '. Rossi', '.']) stream.send({ type: 'text', id: 'pieces', text });
  stream.send({ type: 'close', id: 'pieces' });
  same(await soundOn(stream, 'pieces'));
  await stream.close();
  same(bytesOf(await (await post('/v1/speech', JSON.stringify({ text: written, voice, format: 'wav' }), 'application/json')).arrayBuffer()));
});

for (const passage of ['testo-it:1:p1', 'tei:1:p1', 'libro:1:p1'])
  test(`the library speaks normalised text, ${passage}`, async () => {
    await eventually(async () => (await (await daemon.get('/v1/library')).json()).state === 'ready', 'the library');
    const response = await daemon.get(`/v1/speech?passage=${passage}&voice=${voice}`);
    assert.equal(response.status, 200, await response.clone().text());
    same(bytesOf(await response.arrayBuffer()));
  });

test('a room speaks normalised text: by HTTP, by a command, by faccia-say', async () => {
  same(await inRoom(async () => assert.equal((await post(`/v1/say?room=kitchen&voice=${voice}`, written, 'text/plain')).status, 202)));
  same(await inRoom(() => post('/v1/rooms/kitchen/commands', JSON.stringify({ type: 'speak', text: written, voice }), 'application/json')));
  same(await inRoom(() => door('faccia-say', '--url', daemon.url, '--room', 'kitchen', '--voice', voice, written).exited));
});

test('Wyoming speaks normalised text', async () => {
  const wyoming = door('faccia-wyoming', '--listen', '0', '--url', daemon.url);
  const [, port] = await eventually(() => wyoming.text.match(/port (\d+)/), 'the port');
  const socket = net.connect(Number(port), '127.0.0.1');
  const data = JSON.stringify({ text: written, voice: { name: voice } });
  socket.write(`${JSON.stringify({ type: 'synthesize', data_length: Buffer.byteLength(data) })}\n${data}`);
  let [bytes, sound] = [Buffer.alloc(0), Buffer.alloc(0)];
  for await (const more of socket) {
    bytes = Buffer.concat([bytes, more]);
    let type;
    for (let end; (end = bytes.indexOf(10)) >= 0; ) {
      const head = JSON.parse(bytes.subarray(0, end));
      const [from, to] = [end + 1 + (head.data_length ?? 0), end + 1 + (head.data_length ?? 0) + (head.payload_length ?? 0)];
      if (bytes.length < to) break;
      ({ type } = head);
      if (type === 'audio-chunk') sound = Buffer.concat([sound, bytes.subarray(from, to)]);
      bytes = bytes.subarray(to);
      if (type === 'audio-stop') break;
    }
    if (type === 'audio-stop') break;
  }
  same(sound);
});

test('MQTT speaks normalised text', async () => {
  const port = await freePort();
  fs.writeFileSync(at('mosquitto.conf'), `listener ${port} 127.0.0.1\nallow_anonymous true\npersistence false\nlog_dest stderr\nuser root\n`);
  const broker = door('/usr/sbin/mosquitto', '-c', at('mosquitto.conf'));
  await eventually(() => broker.text.includes('Opening ipv4'), 'the broker');
  const bridge = door('faccia-mqtt', '--room', 'kitchen', '--broker', `127.0.0.1:${port}`, '--url', daemon.url);
  const watch = door('/usr/bin/mosquitto_sub', '-p', String(port), '-t', 'faccia/kitchen/now/available');
  await eventually(() => watch.text.includes('online'), () => `the bridge: ${bridge.text}`);
  same(await inRoom(() => door('/usr/bin/mosquitto_pub', '-p', String(port), '-q', '1', '-t', 'faccia/kitchen/say', '-m', JSON.stringify({ text: written, voice })).exited));
});

test('speech-dispatcher speaks normalised text', async () => {
  fs.writeFileSync(at('faccia.conf'), `FacciaUrl "${daemon.url}"\nFacciaRoom "kitchen"\n`);
  const module = door('sd_faccia', at('faccia.conf'));
  const answered = (line) => eventually(() => module.text.includes(line), line);
  module.stdin.write(`SET\nsynthesis_voice=${voice}\n.\n`);
  await answered('203 OK');
  same(await inRoom(async () => {
    module.stdin.write('SPEAK\n');
    await answered('202 OK');
    module.stdin.write(`<speak>${written}</speak>\n.\n`);
  }));
});

/** Returns phones, words and warnings of the JSON export. */
async function export_(text, query = '&lang=it', type = 'text/plain') {
  const response = await post(`/v1/speech?format=json${query}`, text, type);
  assert.equal(response.status, 200, await response.clone().text());
  return response.json();
}
const phonesOf = ({ phones }) => phones.map(({ ipa }) => ipa).filter(Boolean).join(' ');

for (const [script, foreign, lang] of [['Cyrillic', 'Привет, мир', 'ru'], ['Chinese', '你好', 'zh'], ['Japanese', '日本の', 'ja'], ['Greek', 'λόγος', 'el']])
  test(`reads ${script} in an Italian text by a voice of that script, at its position`, async () => {
    const own = phonesOf(await export_(foreign, `&lang=${lang}`));
    assert.ok(own.length);
    for (const [text, type] of [[`Dico ${foreign} a voi.`, 'text/plain'], [`<speak>Dico <emphasis>${foreign}</emphasis> a voi.</speak>`, 'application/ssml+xml']]) {
      const mixed = await export_(text, '&lang=it', type);
      assert.ok(phonesOf(mixed).includes(own), `${phonesOf(mixed)}: no ${own}`);
      assert.deepEqual(mixed.warnings, []);
      assert.equal(mixed.words[0].text, 'Dico');
      assert.deepEqual(mixed.words.slice(-2).map((word) => word.text), ['a', 'voi']);
      for (const word of mixed.words) assert.equal(Buffer.from(text).subarray(word.byte_start, word.byte_end).toString(), word.text);
    }
  });

test('omits a script that no voice reads, and reports it once, with its position', async () => {
  const text = 'Prima riga.\nPoi བོད་ཡིག e ancora བོད, basta.';
  const { warnings, words: heard } = await export_(text);
  assert.deepEqual(heard.map((word) => word.text), ['Prima', 'riga', 'Poi', 'e', 'ancora', 'basta']);
  assert.equal(warnings.length, 1);
  assert.equal(warnings[0].code, 'unspoken');
  assert.match(warnings[0].message, /^2:5: .*Tibetan: 10 /);
  const alone = await post('/v1/speech?format=json&lang=it', 'བོད་ཡིག', 'text/plain');
  assert.match(await alone.text(), /unspoken/);
});

test('reports characters without a reading with the position of the first', async () => {
  const said_ = await export_(JSON.stringify({ text: 'Ciao \ue000a \ud83d tutti\u0001.', lang: 'it', format: 'json' }), '', 'application/json');
  assert.deepEqual(said_.warnings.map(({ code }) => code), ['unspoken']);
  assert.match(said_.warnings[0].message, /^1:6: 3 characters/);
  assert.deepEqual((await export_('Ciao \ue000a.', '&lang=it&normalize=off')).warnings, []);
});

test('prints spoken and written words side by side: in the JSON export, and as lines', async () => {
  const text = 'Perché il 26 pago € 3,50? Ora.';
  const { normalized } = await export_(text);
  assert.deepEqual(normalized.map(({ text: from, said: to, guess }) => [from, to, guess]), [['26', 'ventisei', false], ['€ 3,50', 'tre euro e cinquanta', false]]);
  for (const one of normalized) {
    assert.equal(Buffer.from(text).subarray(one.byte_start, one.byte_end).toString(), one.text);
    assert.equal(text.slice(one.utf16_start, one.utf16_end), one.text);
  }
  const lines = await (await post('/v1/speech?format=words&lang=it', text, 'text/plain')).text();
  assert.equal(lines, 'Perché\tPerché\nil\til\nventisei\t26\npago\tpago\ntre euro e cinquanta\t€ 3,50\nOra\tOra\n');
  assert.equal(lines, faccia(['read', '-l', 'it', text]).stdout);
  assert.deepEqual((await export_('Ciao.')).normalized, []);
});

test('faccia check lists guesses with their position', () => {
  const { status, stdout } = faccia(['check', '--lang', 'it', '-'], { input: 'Ciao.\nAlle 3 o il 5/6 vengo.\n' });
  assert.equal(status, 0);
  assert.match(stdout, /^-:2:13: warning: "5\/6" is read as "cinque giugno": a guess$/m);
  assert.equal(faccia(['check', '--lang', 'it', '-'], { input: 'Pago € 3,50.\n' }).stdout, '');
});

test('verses run on, or end with a pause without punctuation', async () => {
  const poem = 'la gente della valle usciva di casa presto\nal primo lume e andava ai campi, senza parlare';
  const length = async (text, query = '') => (await wavOf(text, query)).length;
  const [runs, paused] = [await length(poem), await length(poem, '&verse=pause')];
  assert.ok(Math.abs((await length(poem.replace('\n', ' '))) - runs) < 2205, 'the line end is white space'); // 50 ms
  assert.ok(paused > runs + 2 * 2205, `${paused} bytes, not more than ${runs}`);
  assert.equal(await length(poem.replace('presto', 'presto,'), '&verse=pause'), await length(poem.replace('presto', 'presto,')));
  const torn = 'sul mare nero guardava salire la\nluna di agosto';
  assert.equal(await length(torn, '&verse=pause'), await length(torn), 'no pause between an article and its noun');
  const [scanned, slower] = [await length(torn, '&verse=scan'), (await length(torn)) / 0.8];
  assert.ok(scanned > slower + 2205 && scanned < slower + 8 * 2205, `${scanned} bytes scanned, ${slower} slower`);
  const wrong = await post('/v1/speech?verse=sometimes', poem, 'text/plain');
  assert.equal(wrong.status, 400);
});

test('warns of unspoken characters of an open text once', async () => {
  const stream = await daemon.stream(`?voice=${voice}`);
  stream.send({ type: 'speak', id: 'open', voice, open: true });
  for (const text of ['Uno \u{e000} due. ', 'Tre \u{e001} quattro. ', 'Cinque \u{202e}sei. ']) stream.send({ type: 'text', id: 'open', text });
  stream.send({ type: 'close', id: 'open' });
  await stream.wait((message) => message.type === 'end');
  const told = stream.messages.filter(({ type, code }) => type === 'warning' && code === 'unspoken');
  assert.deepEqual(told.map(({ message }) => message.match(/U\+\w+/)[0]), ['U+E000', 'U+202E']);
  await stream.close();
});
