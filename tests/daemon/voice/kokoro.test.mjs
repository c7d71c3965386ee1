// SPDX-License-Identifier: GPL-3.0-or-later
// The Kokoro voices with their real weights: sound, phones known to the language packs, places of words, lips that close with
// the sound. Skipped unless the weights are installed (sh server/run.sh --with kokoro).
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { faccia } from '../../lib/command.mjs';
import { build, Daemon, root } from '../../lib/daemon.mjs';
import { checkOrder, largestStep, loudest, phones, say, words } from '../../lib/speech.mjs';

const plugin = path.join(build, 'server/plugins/kokoro.so');
const there = fs.existsSync(plugin) && fs.existsSync(path.join(root, 'server/plugins/kokoro/node_modules/.faccia-lock'));
const options = { skip: there ? false : 'Kokoro is not installed: sh server/run.sh --with kokoro' };

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
after(() => fs.rmSync(folder, { recursive: true }));

const texts = {
  it: `La mamma beve il tè, e il bambino dorme. «Perché piangi?» — domandò Filippo; ma nessuno rispose: c'era un gran silenzio!
Il babbo comprò 25 pomodori, 3 meloni e mezzo chilo di fave. Una volpe affamata vide dei grappoli d'uva. Che cosa fai? Sbagliò.`,
  'pt-BR': `A raposa faminta viu uns cachos de uva pendurados numa parreira. «Por que você chora?» — perguntou o rapaz; mas ninguém
respondeu! A mamãe comprou 25 pães, batatas e um bolo de maçã. O papai abriu a porta, pediu desculpa e partiu para a praia.`,
  en: `My mother made some plum jam for the baby. "Why do you cry?" asked Philip, but nobody answered: it was very quiet! Bob bought
25 peaches, 3 melons and half a pound of beans. Five brown foxes jumped over the puppy. What do you mean?`,
};
const voices = { if_sara: 'it', im_nicola: 'it', pf_dora: 'pt-BR', pm_alex: 'pt-BR', af_heart: 'en', bm_george: 'en' };

/** Mean level of a stretch of sound, dB. */
function level({ pcm, rate }, from, to) {
  let sum = 0, count = 0;
  for (let i = Math.round(from * rate); i < Math.min(pcm.length, to * rate); i++, count++) sum += pcm[i] ** 2;
  return 10 * Math.log10(sum / Math.max(count, 1) + 1);
}

/** Loudness of speech in dB full scale: mean level of 0.4 s windows outside pauses. */
function loudness(said) {
  const powers = [];
  for (let from = 0; from + 0.4 < said.pcm.length / said.rate; from += 0.1) powers.push(10 ** (level(said, from, from + 0.4) / 10));
  const mean = (list) => list.reduce((sum, x) => sum + x, 0) / list.length;
  return 10 * Math.log10(mean(powers.filter((x) => x > mean(powers) / 10))) - 20 * Math.log10(32768);
}

/** For every p and b between phones: dB from the loudest of its neighbours to its quietest 20 ms. */
function closures(said) {
  const list = said.json.phones;
  const windows = ({ start, end }) => Array.from({ length: Math.max(1, Math.floor((end - start) / 0.01) - 1) }, (_, i) => level(said, start + i * 0.01, start + i * 0.01 + 0.02));
  return list.flatMap((phone, i) => {
    const [before, next] = [list[i - 1], list[i + 1]];
    if (!/^[pb]/.test(phone.ipa) || !before?.ipa || !next?.ipa) return [];
    return [Math.max(...windows(before), ...windows(next)) - Math.min(...windows(phone))];
  });
}

for (const [id, lang] of Object.entries(voices))
  test(`kokoro:${id} speaks a paragraph`, options, () => {
    const said = say(['-l', lang, '-v', `kokoro:${id}`], texts[lang]);
    assert.equal(said.status, 0, said.stderr);
    assert.equal(said.stderr, '');
    assert.deepEqual(said.json.warnings, []);
    assert.equal(said.rate, 24000);
    checkOrder(said);
    assert.ok(largestStep(said) < 40000, `a step of ${largestStep(said)}`);
    assert.ok(loudest(said) > 4000, `loudest ${loudest(said)}`);
    assert.ok(loudest(said) < 32767, 'the sound is cut');
    const loud = loudness(said);
    assert.ok(loud > -23 && loud < -18, `${loud} dB: not as loud as the other voices`);
    assert.deepEqual(words(said).join(' ').split(' '), texts[lang].match(/[\p{L}\d']+/gu));
    for (const phone of said.json.phones) assert.ok(phone.end - phone.start < 1, `${JSON.stringify(phone)} is too long`);
    // no word is silent
    for (const word of said.json.words) assert.ok(loudest(said, word.start, word.end) > 500, `${word.text} is not heard`);
    const dips = closures(said).sort((a, b) => a - b);
    assert.ok(dips.length >= 8, `${dips.length} closures`);
    if (process.env.FACCIA_SHOW) console.log(id, dips.map(Math.round).join(' '));
    assert.ok(dips[dips.length >> 1] > 10, `the sound sinks by ${dips.map(Math.round)} dB in p and b`);
    assert.ok(dips.filter((dip) => dip > 3).length >= 0.9 * dips.length, `the sound sinks by ${dips.map(Math.round)} dB in p and b`);
  });

test('the lips close on every bilabial', options, () => {
  const { stdout, stderr } = faccia(['eval', '-l', 'it', '-v', 'kokoro:if_sara', '-e', 'dominance', '-r', '150', '--json', '-', '-'], { input: texts.it });
  assert.equal(stderr, '');
  const { rows } = JSON.parse(stdout);
  for (const row of rows) {
    assert.ok(row.bilabials > 10);
    assert.equal(row.lips_seen, 1, JSON.stringify(row));
  }
});

const spoken = (said) => phones(said).split(' ').filter((phone) => phone !== '_');

const italian = (text, ...more) => {
  const said = say(['-l', 'it', '-v', 'kokoro:if_sara', ...more], text);
  assert.equal(said.status, 0, said.stderr);
  return said;
};

test('applies rate and volume', options, () => {
  const plain = italian('La mamma parla piano.');
  const slow = italian('La mamma parla piano.', '--rate', '100');
  assert.ok(slow.json.duration > 1.3 * plain.json.duration, `${slow.json.duration} ${plain.json.duration}`);
  assert.deepEqual(spoken(slow), spoken(plain));
  const soft = italian('La mamma parla piano.', '--volume', '0.5');
  assert.ok(Math.abs(loudest(soft) / loudest(plain) - 0.5) < 0.08, `${loudest(soft)} ${loudest(plain)}`);
});

test('reads breaks, marks and other languages, and accepts text without words', options, () => {
  const ssml = '<speak xml:lang="it">Prima <break time="700ms"/> poi <mark name="qui"/> dopo, <lang xml:lang="en">the weather</lang> fine.</speak>';
  const said = italian(ssml);
  assert.deepEqual(words(said), ['Prima', 'poi', 'dopo', 'the', 'weather', 'fine']);
  checkOrder(said);
  const [prima, poi, dopo] = said.json.words;
  assert.ok(poi.start - prima.end >= 0.7, `${poi.start - prima.end} s`);
  assert.equal(loudest(said, poi.start - 0.65, poi.start - 0.1), 0);
  assert.ok(Math.abs(said.json.marks[0].time - dopo.start) < 0.02, JSON.stringify([said.json.marks, dopo]));
  for (const text of ['...', '!?', '« — »', '     ']) assert.ok([0, 1, 2].includes(say(['-l', 'it', '-v', 'kokoro:if_sara'], text).status), text);
});

test('reads numbers and other words that espeak-ng splits as one word', options, () => {
  const said = italian('Nel 1998 costava 1.250,50 €, cioè il 3% in più: scrivi a info@example.org.');
  checkOrder(said);
  assert.equal(words(said)[1], '1998');
  assert.ok(said.json.words[1].end - said.json.words[1].start > 0.8, 'all of the number belongs to it');
});

test('splits a long sentence into pieces', options, () => {
  const text = 'una parola dopo l’altra e ancora un’altra '.repeat(8);
  const said = italian(text);
  assert.equal(said.stderr, '');
  checkOrder(said);
  assert.equal(said.json.words.length, text.match(/[\p{L}’]+/gu).length);
});

test('a stop reaches the model, and the next sentence is spoken', options, async (t) => {
  const daemon = await Daemon.start();
  t.after(() => daemon.process.kill('SIGKILL')); // when an assertion fails
  const stream = await daemon.stream();
  const speak = (id, text) => stream.send({ type: 'speak', lang: 'it', voice: 'kokoro:if_sara', id, text });
  speak('a', 'Una frase.');
  assert.equal((await stream.wait({ type: 'end', id: 'a' }, { milliseconds: 60000 })).reason, 'done');
  await daemon.asks(() => speak('b', 'Una volpe affamata vide dei grappoli d’uva che pendevano da un alto pergolato e pensò di prenderli senza fatica.'));
  stream.send({ type: 'stop' });
  await stream.wait({ type: 'end', id: 'b', reason: 'stopped' });
  speak('c', 'Un’altra frase.');
  assert.equal((await stream.wait({ type: 'end', id: 'c' }, { milliseconds: 60000 })).reason, 'done');
  await stream.close();
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});

const built = { skip: fs.existsSync(plugin) ? false : options.skip };

test('serves without the weights, and says how to install them', built, async (t) => {
  const config = path.join(folder, 'none.json');
  fs.writeFileSync(config, JSON.stringify({ kokoro: { data: '/nowhere' } }));
  const daemon = await Daemon.start(['--voice-config', config]);
  t.after(() => daemon.process.kill('SIGKILL')); // when an assertion fails
  await daemon.logged(/unavailable voices: .*kokoro: .* are not in \/nowhere; to install them: sh server\/run\.sh --with kokoro/);
  const { voices: list } = await (await daemon.get('/v1/voices')).json();
  assert.ok(list.length && list.every((v) => v.plugin !== 'kokoro'));
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});

test('names a mistake in the configuration', built, async (t) => {
  const config = path.join(folder, 'wrong.json');
  fs.writeFileSync(config, JSON.stringify({ kokoro: { threads: 0 } }));
  const daemon = await Daemon.start(['--voice-config', config]);
  t.after(() => daemon.process.kill('SIGKILL')); // when an assertion fails
  await daemon.logged(/kokoro.*threads: must be an integer from 1 to 64/);
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});
