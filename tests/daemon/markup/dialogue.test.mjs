// SPDX-License-Identifier: GPL-3.0-or-later
// Dialogue in prose: two voices in turn for what stands in quotation marks or after dashes.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import path from 'node:path';
import { test } from 'node:test';
import { build } from '../../lib/daemon.mjs';

const program = path.join(build, 'server/cli/faccia');
const say = (text, ...options) => JSON.parse(execFileSync(program, ['say', '--lang', 'it', '--json', '-', ...options, text], { encoding: 'utf8', maxBuffer: 1 << 26 }));

/** Who says which words: '' for the narrator, 1 and 2. */
function heard(text, ...options) {
  const found = [];
  for (const { text: word, speaker } of say(text, '--dialogue', 'voices', ...options).words) {
    const who = (speaker ?? '').replace('voice-', '');
    if (found.at(-1)?.[0] !== who) found.push([who, []]);
    found.at(-1)[1].push(word);
  }
  return found.map(([who, words]) => [who, words.join(' ')]);
}

test('a paragraph has one speaker, and the next one another; the narrator says the rest', () => {
  assert.deepEqual(heard('Anna si fermò. «Buongiorno», disse, «vieni?» E rise.\n\n«Vengo subito.»\n\nTacquero.\n\n«Allora vai!»'), [
    ['', 'Anna si fermò'], ['1', 'Buongiorno'], ['', 'disse'], ['1', 'vieni'], ['', 'E rise'], ['2', 'Vengo subito'], ['', 'Tacquero'], ['1', 'Allora vai'],
  ]);
});

test('after two paragraphs without speech the first one begins again', () => {
  assert.deepEqual(heard('«Uno due.»\n\nNiente.\n\nNiente.\n\n«Tre quattro.»').map(([who]) => who), ['1', '', '1']);
});

test('quotation marks of several languages; apostrophes and quoted words are no speech', () => {
  for (const [text, expected] of [
    ['“Vieni qui”, disse.', ['1', '']],
    ['„Komm her“, disse.', ['1', '']],
    ['»Komm her«, disse. »Ja, ich.«', ['1', '', '1']],
    ['"Vieni qui" disse "e siedi."', ['1', '', '1']],
    ['‘Don’t go.’ disse.', ['1', '']],
    ['Disse: ‹Vieni qui›.', ['', '1']],
    ['Il «buono» e il "brutto".', ['']],
    ['L’acqua dell’orto.', ['']],
    ['«Un detto “famoso” dice», rispose.', ['1', '']],
    ['Tornò chiamato da don Anselmo «per affari che premono». Nel paese bolle "la gran fiumana dei vizi" e basta.', ['']],
    ['Lesse «tutto il giornale» e tacque. Disse «vieni qui». Poi «torno subito» rispose.', ['', '1', '', '1', '']],
    ['Il maestro: «due e due». E lei «quattro!»', ['', '1', '', '1']],
  ]) assert.deepEqual(heard(text).map(([who]) => who), expected, text);
});

test('dashes begin a speech, and divide it from the words of the narrator', () => {
  assert.deepEqual(heard('— Vieni qua — disse lei. — Andiamo al porto-canale.\n— Non posso.\nE tacque — a lungo — così.'), [
    ['1', 'Vieni qua'], ['', 'disse lei'], ['1', 'Andiamo al porto-canale'], ['2', 'Non posso E tacque'], ['', 'a lungo'], ['2', 'così'],
  ]);
});

test('a quotation that is not closed goes on in the next paragraph, with the same voice', () => {
  assert.deepEqual(heard('«Prima parte.\n\n«Seconda parte.»\n\n«Risposta breve.»').map(([who]) => who), ['1', '2']);
});

test('nothing is divided without the option, in markup, or where somebody is said to speak', () => {
  const text = '«Vieni qui», disse.';
  assert.ok(say(text).words.every(({ speaker }) => speaker === undefined));
  assert.deepEqual(heard(`<speak>${text}</speak>`, '--markup', 'ssml').map(([who]) => who), ['']);
  const voices = new Set(say(`${text}\n\n«No, resto.»`, '--dialogue', 'voices').speakers.map(({ id }) => id));
  assert.deepEqual([...voices], ['voice-1', 'voice-2']);
});

test('strange texts end in time', () => {
  for (const text of ['«'.repeat(3000), '"'.repeat(3001), '— '.repeat(2000), '“a '.repeat(1000), '\n—'.repeat(1000), '»«'.repeat(2000)]) {
    try {
      say(`Parola. ${text} fine`, '--dialogue', 'voices');
    } catch (error) {
      assert.match(error.stderr, /speak/);
    }
  }
});

test('after a dash, the words of the narrator may stand between commas only', () => {
  const said = (lang, text) => {
    const found = [];
    for (const { text: word, speaker } of JSON.parse(execFileSync(program, ['say', '--lang', lang, '--json', '-', '--dialogue', 'voices', text], { encoding: 'utf8' })).words)
      if (found.at(-1)?.[0] !== (speaker ?? '')) found.push([speaker ?? '', word]);
      else found.at(-1)[1] += ` ${word}`;
    return found;
  };
  for (const [lang, text, expected] of [
    ['it', '— Vieni qui, disse Renzo, è tardi.', [['renzo', 'Vieni qui'], ['', 'disse Renzo'], ['renzo', 'è tardi']]],
    ['it', '— Chi va là? chiese Lucia, aprendo la porta. Entrate!', [['lucia', 'Chi va là'], ['', 'chiese Lucia aprendo la porta'], ['lucia', 'Entrate']]],
    ['pt', '— Não sei, disse-lhe o Bento; vamos ver.', [['bento', 'Não sei'], ['', 'disse-lhe o Bento'], ['bento', 'vamos ver']]],
    ['pt', '— Que é? exclamou Capitu.', [['capitu', 'Que é'], ['', 'exclamou Capitu']]],
    ['tr', '— Nereye gidiyorsun? dedi Ahmet.\n\n— Eve, diye bağırdı Ayşe.', [['ahmet', 'Nereye gidiyorsun'], ['', 'dedi Ahmet'], ['ayşe', 'Eve'], ['', 'diye bağırdı Ayşe']]],
    ['en', '— No, said Mr. Brown, not today.', [['mr-brown', 'No'], ['', 'said Mr. Brown'], ['mr-brown', 'not today']]],
    // a verb that the speech itself has, and one without anybody
    ['it', '— Ieri disse tutto, e gli altri tacquero.', [['voice-1', 'Ieri disse tutto e gli altri tacquero']]],
    ['it', '— Così è, dice sempre cose vere.', [['voice-1', 'Così è dice sempre cose vere']]],
  ]) assert.deepEqual(said(lang, text), expected, text);
});

/** Who says which words, by id, in a language. */
const ids = (lang, text) => {
  const found = [];
  for (const { text: word, speaker } of JSON.parse(execFileSync(program, ['say', '--lang', lang, '--json', '-', '--dialogue', 'voices', text], { encoding: 'utf8' })).words)
    if (speaker && found.at(-1)?.[0] !== speaker) found.push([speaker, word]);
    else if (speaker) found.at(-1)[1] += ` ${word}`;
  return found.map(([id]) => id);
};

test('the narrator names who speaks, before and after the quotation, in four languages', () => {
  for (const [lang, text, expected] of [
    ['it', '«Chi va là?» disse Renzo.\n\nLucia rispose: «Sono io».\n\n«Entrate», soggiunse allora don Abbondio, «e presto.»', ['renzo', 'lucia', 'don-abbondio']],
    ['it', '— Buongiorno — disse il Griso. — Vieni con me.\n— Non posso — rispose Agnese.', ['griso', 'agnese']],
    ['en', '“Good day,” said Mr. Brown.\n\n“Good day,” Alice said at once, “and welcome.”\n\nThe Hatter replied, “Tea?”', ['mr-brown', 'alice', 'hatter']],
    ['pt', '— Bom dia — perguntou Capitu.\n— Não sei — disse-lhe Bento Santiago. — Vamos ver.', ['capitu', 'bento-santiago']],
    ['tr', '“Nereye gidiyorsun?” dedi Ahmet.\n\nAyşe Hanım: “Eve gidiyorum,” dedi.\n\n“Ben de geleyim mi?” diye sordu Ömer Bey.', ['ahmet', 'ayşe-hanım', 'ömer-bey']],
  ]) assert.deepEqual(ids(lang, text), expected, text);
});

test('a short and a full name are one person; Mr. and Mrs. Brown are two', () => {
  assert.deepEqual(ids('en', '“Come,” said Jane Fairfax.\n\n“No,” said Emma.\n\n“Please,” said Jane.'), ['jane-fairfax', 'emma', 'jane-fairfax']);
  assert.deepEqual(ids('en', '“Come,” said Mr. Brown.\n\n“No,” said Mrs. Brown.'), ['mr-brown', 'mrs-brown']);
});

test('two who are named go on in turn; a third voice has who is not sure', () => {
  assert.deepEqual(ids('it', '«Vieni», disse Anna.\n\n«No», disse Bruno.\n\n«Perché no?»\n\n«Ho sonno, lo sai.»\n\n«Allora dormi», disse Anna.'), ['anna', 'bruno', 'anna', 'bruno', 'anna']);
  assert.deepEqual(ids('it', '«Vieni», disse Anna.\n\n«Non posso venire.»'), ['anna', 'voice-2']);
  // turns that do not fit who is named next are nobody's
  assert.deepEqual(ids('it', '«Vieni», disse Anna.\n\n«No», disse Bruno.\n\n«Perché no?»\n\n«Allora dormi», disse Anna.'), ['anna', 'bruno', 'voice-2', 'anna']);
});

test('who is spoken to, or begins a sentence, is not who speaks', () => {
  assert.deepEqual(ids('it', '«Vieni», disse a Lucia.\n\nPoi Renzo disse ad Agnese: «Andiamo via».'), ['voice-2', 'renzo']);
  assert.deepEqual(ids('en', '“Come,” she said to Alice.\n\nAlice’s cat said nothing.\n\n“Go on,” said Alice.'), ['voice-2', 'alice']);
  assert.deepEqual(ids('en', 'Smiling, he said: “Good day to you.”'), ['voice-1']);
});
