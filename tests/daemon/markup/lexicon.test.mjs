// SPDX-License-Identifier: GPL-3.0-or-later
// Lexicons: their effect on speech, and offsets, which still refer to the original text.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { faccia } from '../../lib/command.mjs';
import { Daemon } from '../../lib/daemon.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-lexicon-'));
const pls = (name, lang, lexemes, attributes = '') => {
  const file = path.join(folder, name);
  fs.mkdirSync(path.dirname(file), { recursive: true });
  fs.writeFileSync(file, `<?xml version="1.0" encoding="UTF-8"?>
<lexicon version="1.0" xmlns="http://www.w3.org/2005/01/pronunciation-lexicon" xmlns:faccia="urn:faccia" alphabet="ipa" xml:lang="${lang}" ${attributes}>
${lexemes.join('\n')}
</lexicon>
`);
  return file;
};
const alias = (grapheme, said) => `<lexeme><grapheme>${grapheme}</grapheme><alias>${said}</alias></lexeme>`;
const phones = (grapheme, ipa, attributes = '') => `<lexeme><grapheme>${grapheme}</grapheme><phoneme ${attributes}>${ipa}</phoneme></lexeme>`;

const italian = pls('it.pls', 'it', [
  alias('ONU', 'Nazioni Unite'), alias('ONU di Ginevra', 'sede 12'), alias('R&amp;D', 'ricerca'), alias('gatto', 'micio'), alias('perché', 'come mai'),
  phones('Bowie', 'ˈbobo'), phones('Kuki', 'tSitSi', 'alphabet="x-sampa"'),
  '<lexeme faccia:case="any"><grapheme>wifi</grapheme><alias>rete</alias></lexeme>',
]);
const english = pls('en.pls', 'en', [alias('Worcester', 'Wooster'), phones('Bowie', 'ˈmɪmɪ'), alias('NASA', 'the agency')]);
const named = pls('named/names.pls', 'it', [alias('Anna', 'Berta'), alias('ONU', 'organizzazione')]);

let daemon;
before(async () => {
  daemon = await Daemon.start(['--lexicon', italian, '--lexicon', english, '--lexicons', path.dirname(named)]);
});
after(async () => {
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  fs.rmSync(folder, { recursive: true });
});

const words = (lang, text, ...options) => faccia(['read', '--lang', lang, '--lexicon', italian, '--lexicon', english, '--words', ...options, text]).stdout.trim();

for (const [lang, text, said] of [
  ['it', "L'ONU parla.", 'L Nazioni Unite parla'],
  ['it', 'L’ONU di  Ginevra parla.', 'L sede dodici parla'],
  ['it', 'ONUs, SONU e onu.', 'ONUs SONU e onu'],
  ['it', 'Il gatto. Gatto nero. Il Gatto.', 'Il micio micio nero Il Gatto'],
  ['it', 'WiFi e WIFI.', 'rete e rete'],
  ['it', 'R&D oggi.', 'ricerca oggi'],
  ['it', 'E perche\u0301 no?', 'E come mai no'],
  ['it', 'NASA.', 'NASA'],
  ['en', "Worcester's NASA, not ONU.", "Wooster's the agency not O N U"],
  ['en', "It wasn't NASA'll.", "It wasn't NASA'll"],
  ['it', '<speak>R&amp;D e <sub alias="gatto">x</sub> <say-as interpret-as="characters">ONU</say-as>.</speak>', 'ricerca e gatto ONU'],
])
  test(`${lang}: ${text}`, () => assert.equal(words(lang, text), said));

test('reports spoken words next to the written ones', () => {
  const { stdout } = faccia(['read', '--lang', 'it', '--lexicon', italian, "L'ONU di Ginevra tace."]);
  assert.match(stdout, /^sede\tONU di Ginevra$/m);
  assert.match(stdout, /^tace\ttace$/m);
});

const spoken = async (text, query) => (await daemon.get(`/v1/speech?format=json&${query}`, { method: 'POST', body: text, headers: { 'content-type': 'text/plain' } })).json();
const ipa = (answer) => answer.phones.map((phone) => phone.ipa).join('');

for (const [lang, other, own] of [['it', 'bobo', 'mimi'], ['en', 'mimi', 'bobo']])
  test(`${lang}: daemon and command speak the phones of the lexicon, and the word keeps its position`, async () => {
    const text = lang == 'it' ? 'Canta Bowie adesso.' : 'Now Bowie sings.';
    const byCommand = JSON.parse(faccia(['say', '--lang', lang, '--lexicon', lang == 'it' ? italian : english, '--json', '-', text]).stdout);
    for (const answer of [await spoken(text, `lang=${lang}`), byCommand]) {
      assert.ok(ipa(answer).includes(other), ipa(answer));
      assert.ok(!ipa(answer).includes(own));
      assert.deepEqual(answer.words.map((word) => word.text), text.replace('.', '').split(' '));
    }
  });

test('speaks X-SAMPA as IPA, and an alias as text', async () => {
  assert.match(ipa(await spoken('Ecco Kuki qui.', 'lang=it')), /tʃ[iɪ]tʃ[iɪ]/);
  const [short, long] = [await spoken('Vedo ONU ora.', 'lang=it'), await spoken('Vedo Nazioni Unite ora.', 'lang=it')];
  assert.equal(ipa(short), ipa(long));
  assert.deepEqual([...new Set(short.words.map((word) => word.text))], ['Vedo', 'ONU', 'ora']);
});

test('loads lexicons named by SSML from the folder, and reports unavailable ones with their position', async () => {
  const ssml = (body) => spoken(`<speak version="1.1" xml:lang="it">${body}</speak>`, 'lang=it&markup=ssml');
  const plain = await spoken('Berta, Anna e organizzazione, Nazioni Unite.', 'lang=it');
  const looked = await ssml('<lexicon uri="names.pls" xml:id="n"/><lookup ref="n">Anna</lookup>, Anna e <lookup ref="n">ONU</lookup>, ONU.');
  assert.deepEqual(looked.warnings, []);
  assert.equal(ipa(looked), ipa(plain));
  for (const uri of ['../it.pls', 'http://127.0.0.1/names.pls', path.join(folder, 'it.pls'), 'none.pls']) {
    const { warnings } = await ssml(`<lexicon uri="${uri}" xml:id="n"/><lookup ref="n">Gatto e Anna</lookup>.`);
    assert.deepEqual(warnings.map(({ code }) => code), ['bad-value', 'bad-value'], uri);
    assert.deepEqual(warnings.map(({ message }) => message.match(/^1:\d+: \w+/)?.[0]), ['1:45: uri', `1:${72 + uri.length}: ref`]);
  }
});

test('keeps cues and marks around a word that a lexicon replaces', async () => {
  const { words: said, marks } = await spoken('<speak xml:lang="it"><mark name="a"/><emphasis>ONU</emphasis> e <mark name="b"/>Bowie tace.</speak>', 'lang=it&markup=ssml');
  assert.deepEqual(marks.map((mark) => mark.name), ['a', 'b']);
  assert.equal(marks[1].time >= said.find((word) => word.text == 'e').end - 0.05, true);
});

test('faccia lexicon check counts spellings, and reports each fault with its position', () => {
  const faulty = pls('faulty.pls', 'it', [
    alias('uno', 'due'), '<lexeme><alias>tre</alias></lexeme>', '<lexeme><grapheme>quattro</grapheme></lexeme>', phones('cinque', '5%'),
    alias('uno', 'sei'), '<lexeme><grapheme> </grapheme><alias>x</alias></lexeme>', '<lexeme><grapheme>sette</grapheme><phoneme alphabet="x-fon">s</phoneme></lexeme>', '<word/>',
  ]);
  const { status, stdout } = faccia(['lexicon', 'check', faulty]);
  const lines = stdout.trim().split('\n').map((line) => line.replace(`${faulty}:`, ''));
  assert.equal(status, 1);
  assert.deepEqual(lines.map((line) => Number(line.split(':')[0])), [4, 5, 6, 7, 8, 9, 10, NaN], stdout);
  assert.match(lines.at(-1), /1 spellings \(it\), 5 ignored/);
  assert.equal(faccia(['lexicon', 'check', italian]).status, 0);
  for (const [name, content, why] of [
    ['open.pls', '<lexicon xml:lang="it">\n<lexeme>', /:2:\d+: error: the element 'lexeme' of line 2 is not closed/],
    ['other.pls', '\n<speak/>', /:2:1: error: the root element is not 'lexicon'/],
    ['mute.pls', '<lexicon/>', /:1:1: error: the lexicon has no language/],
  ]) {
    fs.writeFileSync(path.join(folder, name), content);
    const checked = faccia(['lexicon', 'check', path.join(folder, name)]);
    assert.equal(checked.status, 1);
    assert.match(checked.stdout, why);
    const used = faccia(['read', '--lang', 'it', '--lexicon', path.join(folder, name), 'uno']);
    assert.equal(used.status, 1);
    assert.match(used.stderr, /\(bad-(lexicon|xml)\)/);
  }
  assert.equal(faccia(['lexicon', 'check']).status, 2);
  assert.equal(faccia(['lexicon', 'weigh', italian]).status, 2);
});

test('limits the length of aliases in a sentence, reads the rest as written, and warns', async () => {
  const file = pls('long.pls', 'it', [alias('eco', 'bello '.repeat(150))]);
  const { stdout } = faccia(['read', '--lang', 'it', '--lexicon', file, '--words', `${'eco e '.repeat(40)}basta.`]);
  assert.equal(stdout.match(/bello/g).length, 4 * 150, 'within 4096 bytes');
  assert.equal(stdout.match(/eco/g).length, 36);
});

test('a lexicon of 20000 spellings with a common beginning hardly slows down a long text', () => {
  const many = pls('many.pls', 'it', Array.from({ length: 20000 }, (_, i) => alias(`via ${i.toString(36).replace(/\d/g, (d) => 'qwertyuiop'[d])}`, 'strada')));
  const text = path.join(folder, 'many.txt');
  fs.writeFileSync(text, 'via via via. '.repeat(5000));
  const { status, stdout } = faccia(['read', '--lang', 'it', '--lexicon', many, '--words', '--file', text]);
  assert.equal(status, 0);
  assert.equal(stdout.trim().split(' ').length, 15000);
});
