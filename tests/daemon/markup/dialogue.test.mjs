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
