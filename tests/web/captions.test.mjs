// SPDX-License-Identifier: MIT
import assert from 'node:assert/strict';
import test from 'node:test';
import { CaptionTrack, cutCaption } from '../../web/src/captions.mjs';

const place = (text, part, from = 0) => {
  const start = text.indexOf(part, from);
  return { utf16_start: start, utf16_end: start + part.length };
};

test('a sentence that fits is one caption', () => {
  const text = '  La mamma parla.  Poi tace.';
  assert.deepEqual(cutCaption(text, 0, 17), [{ start: 2, end: 17 }]);
});

test('a long sentence is cut at spaces, best after punctuation, and nothing is lost', () => {
  const text =
    'Nel mezzo del cammin di nostra vita, mi ritrovai per una selva oscura, ché la diritta via era smarrita; ahi quanto a ' +
    'dir qual era è cosa dura';
  const pieces = cutCaption(text, 0, text.length);
  assert.ok(pieces.length >= 2);
  assert.equal(text.slice(pieces[0].start, pieces[0].end), 'Nel mezzo del cammin di nostra vita, mi ritrovai per una selva oscura,');
  for (const { start, end } of pieces) assert.ok(end - start <= 84);
  assert.equal(pieces.map(({ start, end }) => text.slice(start, end)).join(' '), text);
});

test('a word longer than a caption is cut, but not through a character', () => {
  const text = '😀'.repeat(100);
  const pieces = cutCaption(text, 0, text.length, 25);
  assert.equal(pieces.map(({ start, end }) => text.slice(start, end)).join(''), text);
  for (const { start, end } of pieces) assert.ok((end - start) % 2 === 0 && end - start <= 26);
});

test('words move from what is to come to what was said as they are heard', () => {
  const text = 'Uno. Due tre quattro.';
  const track = new CaptionTrack(text);
  assert.equal(track.line, null);
  track.sentence(place(text, 'Due tre quattro.'));
  assert.deepEqual(track.line, { said: '', word: '', rest: 'Due tre quattro.' });
  track.heard(place(text, 'tre'));
  assert.deepEqual(track.line, { said: 'Due ', word: 'tre', rest: ' quattro.' });
});

test('the caption turns over with the word that is heard', () => {
  const text = 'alfa beta gamma delta epsilon zeta eta theta iota kappa lambda mi ni xi omicron pi rho sigma tau ypsilon';
  const track = new CaptionTrack(text);
  track.sentence({ utf16_start: 0, utf16_end: text.length });
  track.heard(place(text, 'alfa'));
  const first = track.line;
  assert.ok(!first.rest.includes('ypsilon'));
  track.heard(place(text, 'ypsilon'));
  const last = track.line;
  assert.equal(last.word, 'ypsilon');
  assert.equal(last.rest, '');
  assert.ok(!last.said.includes('alfa'));
});

test('places are UTF-16: characters beyond the basic plane count two', () => {
  const text = '😀 ciao';
  const track = new CaptionTrack(text);
  track.sentence({ utf16_start: 0, utf16_end: 7 });
  track.heard({ utf16_start: 3, utf16_end: 7 });
  assert.deepEqual(track.line, { said: '😀 ', word: 'ciao', rest: '' });
});
