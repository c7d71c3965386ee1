// SPDX-License-Identifier: GPL-3.0-or-later
// Effects of markup on sound: several voices and languages in a sentence, sound files, say-as, given phones.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { faccia } from '../../lib/command.mjs';
import { build, Daemon } from '../../lib/daemon.mjs';
import { wavOf } from '../../lib/wav.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
const plugins = path.join(folder, 'plugins');
const sounds = path.join(folder, 'sounds');

/** Writes a mono WAV file with a tone. */
const tone = (file, rate, seconds) =>
  fs.writeFileSync(file, wavOf(Int16Array.from({ length: Math.round(rate * seconds) }, (_, i) => Math.round(8000 * Math.sin((2 * Math.PI * 700 * i) / rate))), rate));

before(() => {
  fs.mkdirSync(plugins);
  fs.mkdirSync(sounds);
  for (const [name, at] of [['espeak', 'server/plugins'], ['puppet', 'tests/plugins']])
    fs.symlinkSync(path.join(build, at, `${name}.so`), path.join(plugins, `${name}.so`));
  tone(path.join(sounds, 'bell.wav'), 44100, 0.5);
  fs.writeFileSync(path.join(sounds, 'broken.wav'), 'RIFF....WAVE, or so');
  fs.writeFileSync(path.join(folder, 'secret.wav'), 'secret');
});
after(() => fs.rmSync(folder, { recursive: true }));

/** Runs `faccia say` on the content of an SSML document. */
function say(content, { lang = 'it', voice = 'espeak:it', options = [] } = {}) {
  const wav = path.join(folder, 'out.wav');
  const result = faccia(['say', '-l', lang, '-v', voice, '--audio', sounds, '--wav', wav, '--json', '-', ...options,
    `<speak xml:lang="${lang}">${content}</speak>`], { env: { FACCIA_PLUGINS: plugins } });
  assert.equal(result.status, 0, result.stderr);
  const said = JSON.parse(result.stdout);
  const bytes = fs.readFileSync(wav);
  said.pcm = new Int16Array(bytes.buffer, bytes.byteOffset + 44, (bytes.length - 44) >> 1);
  said.stderr = result.stderr;
  let at = 0;
  for (const phone of said.phones) {
    assert.ok(Math.abs(phone.start - at) < 1e-4, 'phones touch');
    at = phone.end;
  }
  assert.ok(Math.abs(said.pcm.length / said.rate - said.duration) < 1e-4 && Math.abs(at - said.duration) < 1e-4);
  return said;
}
const words = (said) => said.words.map((w) => w.text);
const between = (said, a, b) => said.words[words(said).indexOf(b)].start - said.words[words(said).indexOf(a)].end;

test('a voice of the language speaks a word in another language', () => {
  const said = say('Mi piace il <lang xml:lang="en">rock and roll</lang>, davvero.');
  assert.deepEqual(words(said), ['Mi', 'piace', 'il', 'rock', 'and', 'roll', 'davvero']);
  const rock = said.words[3];
  const phones = said.phones.filter((p) => p.start >= rock.start - 1e-3 && p.end <= rock.end + 1e-3).map((p) => p.ipa);
  assert.ok(phones.includes('ɹ'), String(phones));
  assert.ok(between(said, 'il', 'rock') < 0.05);
  assert.ok(between(said, 'roll', 'davvero') > 0.1);
  assert.equal(said.stderr, ''); // the pack knows the phones of both languages
});

test('voices of plugins with different sample rates speak one sentence, at the rate of the first', () => {
  const said = say('Uno, <voice name="puppet:plain">due tre</voice> e <voice name="nobody puppet:gb">quattro</voice><mark name="m"/><break time="600ms"/> cinque.');
  assert.equal(said.rate, 22050);
  assert.deepEqual(words(said), ['Uno', 'due', 'tre', 'e', 'quattro', 'cinque']);
  assert.deepEqual(said.marks.map((m) => m.name), ['m']);
  assert.ok(Math.abs(between(said, 'quattro', 'cinque') - 0.6) < 0.06);
  assert.equal(said.stderr.match(/no voice "nobody/), null);
  for (let i = 1; i < said.words.length; i++) assert.ok(said.words[i].start >= said.words[i - 1].end - 1e-6);
});

test('a gender selects a voice of the language', () => {
  /** Pitch of the stressed vowel in Hz, by autocorrelation. */
  const pitch = (s) => {
    const vowel = s.phones.find((p) => p.ipa.startsWith('a'));
    const pcm = s.pcm.subarray(vowel.start * s.rate, vowel.end * s.rate);
    const alike = (lag) => {
      let sum = 0, energy = 0;
      for (let i = lag; i < pcm.length; i++) (sum += pcm[i] * pcm[i - lag]), (energy += pcm[i] ** 2 + pcm[i - lag] ** 2);
      return (2 * sum) / energy;
    };
    const lags = Array.from({ length: Math.floor(s.rate / 60) - Math.ceil(s.rate / 350) }, (_, i) => Math.ceil(s.rate / 350) + i);
    const best = Math.max(...lags.map(alike));
    return s.rate / lags.find((lag) => alike(lag) > 0.95 * best);
  };
  const he = say('<voice gender="male">Mamma</voice>'), she = say('<voice gender="female">Mamma</voice>'), usual = say('Mamma');
  assert.deepEqual(he.pcm.length, usual.pcm.length); // the default voice is male
  assert.ok(pitch(she) > 1.4 * pitch(he), `${pitch(she)}, ${pitch(he)} Hz`);
});

test('warns of unknown voices and languages at their position, and uses the default voice', () => {
  const said = say('Uno <voice name="nobody">due</voice>\n<lang xml:lang="xx">tre</lang>.');
  assert.deepEqual(words(said), ['Uno', 'due', 'tre']);
  assert.match(said.stderr, /warning: 1:\d+: there is no voice "nobody"/);
  assert.match(said.stderr, /warning: 2:\d+: no voice speaks "xx"/);
});

test('sentences by voices of different rates follow each other at one rate', () => {
  const said = say('<s>Uno due.</s><s><voice name="puppet:plain">Tre quattro.</voice></s><s>Cinque.</s>');
  assert.equal(said.rate, 22050);
  assert.deepEqual(words(said).map((w) => w.replace('.', '')), ['Uno', 'due', 'Tre', 'quattro', 'Cinque']);
});

test('plays sounds at their position with the mouth at rest', () => {
  const said = say('Senti <audio src="bell.wav">una campana</audio> adesso.');
  assert.deepEqual(words(said), ['Senti', 'adesso']);
  const gap = between(said, 'Senti', 'adesso');
  assert.ok(Math.abs(gap - 0.5) < 0.06, String(gap));
  const middle = said.words[0].end + gap / 2;
  const slice = said.pcm.subarray((middle - 0.1) * said.rate, (middle + 0.1) * said.rate);
  assert.ok(Math.sqrt(slice.reduce((sum, v) => sum + v * v, 0) / slice.length) > 5000);
  assert.equal(said.phones.find((p) => p.start <= middle && p.end > middle).ipa, '');
});

for (const [source, why] of [['../secret.wav', 'not a path'], ['/etc/passwd', 'not a path'], ['http://127.0.0.1/x.wav', 'not a path'], ['none.wav', 'no sound'], ['broken.wav', 'cannot be read']])
  test(`warns of an unavailable sound (${source}), and speaks its text`, () => {
    const said = say(`Senti <audio src="${source}">una campana</audio> adesso.`);
    assert.deepEqual(words(said), ['Senti', 'una', 'campana', 'adesso']);
    assert.match(said.stderr, new RegExp(`warning: .*${why}`));
  });

test('reads dates, times and sums as words, each as one word of the text', () => {
  const said = say('Il <say-as interpret-as="date" format="dmy">12/03/2024</say-as> per <say-as interpret-as="currency">12,50 €</say-as>.');
  assert.deepEqual(words(said), ['Il', '12/03/2024', 'per', '12,50 €']);
  const ipa = said.phones.map((p) => p.ipa).join('');
  assert.match(ipa, /martso/);
  assert.match(ipa, /tʃentɛzimɪ/);
  assert.equal(said.stderr, '');
});

test('reads text that does not match its interpret-as as written, with a warning', () => {
  const said = say('Il <say-as interpret-as="date" format="dmy">31/31/2024</say-as>.');
  assert.match(said.stderr, /warning: 1:\d+: "31\/31\/2024" cannot be read as "date:dmy"/);
  assert.ok(said.words.length >= 2);
});

test('speaks given phones and keeps the text', () => {
  const said = say('Un <phoneme alphabet="ipa" ph="ˈkaza">gatto</phoneme> solo.');
  assert.deepEqual(words(said), ['Un', 'gatto', 'solo']);
  assert.match(said.phones.map((p) => p.ipa).join(''), /kaza/);
});

test('over the network: sends warnings with positions, then speech; plays nothing outside the sound folder', async () => {
  const daemon = await Daemon.start(['--plugins', plugins, '--audio', sounds]);
  const stream = await daemon.stream();
  const speak = async (id, text) => {
    stream.send({ type: 'speak', lang: 'it', id, text });
    assert.equal((await stream.wait({ type: 'end', id }, { milliseconds: 40000 })).reason, 'done');
    return stream.messages.filter((m) => m.id === id);
  };
  const first = await speak('a', '<speak>Senti <audio src="../secret.wav">il segreto</audio> e\n<voice name="nobody">poi</voice> <audio src="bell.wav"/>.</speak>');
  const warnings = first.filter((m) => m.type === 'warning');
  assert.deepEqual(warnings.map((w) => [w.code, w.line]), [['no-sound', 1], ['unknown-voice', 2]]);
  assert.deepEqual(first.filter((m) => m.type === 'word').map((m) => m.text), ['Senti', 'il', 'segreto', 'e', 'poi']);
  // stops in the middle of a sentence of many voices and sounds
  const turns = '<voice name="puppet:plain">uno</voice> <audio src="bell.wav"/> <voice name="espeak:en-gb">two</voice> '.repeat(30);
  const many = await speak('b', `<speak>${turns}</speak>`);
  assert.ok(many.some((m) => m.type === 'warning' && /more than 16 sounds/.test(m.message)));
  stream.send({ type: 'speak', lang: 'it', id: 'c', text: `<speak>${turns}</speak>` });
  stream.send({ type: 'stop' });
  await stream.wait({ type: 'end', id: 'c' });
  const silent = await speak('e', '<speak><audio src="broken.wav"/></speak>');
  assert.ok(silent.some((m) => m.type === 'warning' && /cannot be read/.test(m.message)));
  await speak('d', 'Fine.');
  await stream.close();
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});
