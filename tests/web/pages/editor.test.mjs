// SPDX-License-Identifier: GPL-3.0-or-later
// The markup editor without a page: marks that go along with their words, and what is written, read again.
import assert from 'node:assert/strict';
import test from 'node:test';
import { moved, sentenceAt, wholeWords, withMark, within } from '../../../web/pages/editor/marks.js';
import { MARKUPS, read, write } from '../../../web/pages/editor/markup.js';

const text = 'Buongiorno! Che bella <sorpresa> & gioia.';
const over = (words, kind, value) => ({ kind, value, from: text.indexOf(words), to: text.indexOf(words) + words.length });
const marks = [over('Che bella', 'affect', 'joy'), over('bella <sorpresa>', 'emphasis', 'strong'), over('gioia', 'gaze', 'left')].reduce((all, mark) => withMark(all, mark), []);

test('a mark covers whole words, and replaces marks of its kind there', () => {
  assert.deepEqual(wholeWords(text, 13, 18), [12, 21]);
  assert.deepEqual(wholeWords('  ', 1, 1), [1, 1]);
  const all = withMark(withMark([], { kind: 'affect', value: 'joy', from: 0, to: 20 }), { kind: 'affect', value: 'fear', from: 5, to: 10 });
  assert.deepEqual(all.map(({ value, from, to }) => [value, from, to]), [['joy', 0, 5], ['fear', 5, 10], ['joy', 10, 20]]);
  assert.deepEqual(withMark([], { kind: 'pause', value: 300, from: 3, to: 9 }), [{ kind: 'pause', value: 300, from: 9, to: 9 }]);
  assert.deepEqual(withMark([], { kind: 'gesture', value: 'wink', from: 3, to: 9 }), [{ kind: 'gesture', value: 'wink', from: 3, to: 3 }]);
});

test('marks follow edits of the text', () => {
  const mark = [{ kind: 'affect', value: 'joy', from: 12, to: 21 }];
  const at = (after) => moved(mark, text, after).map(({ from, to }) => after.slice(from, to));
  assert.deepEqual(at(`Oh! ${text}`), ['Che bella']);
  assert.deepEqual(at(text.replace('bella', 'bellissima')), ['Che bellissima']);
  assert.deepEqual(at(text.replace('Che bella ', '')), []);
  assert.deepEqual(at(''), []);
});

test('reads written markup back unchanged, in every markup that can express it, with crossing marks', () => {
  const pieces = (each) => each.flatMap(({ kind, value, from, to }) => [...text.slice(from, to)].map((_, k) => `${kind} ${value} ${from + k}`)).sort();
  for (const markup of MARKUPS) {
    const { code, unsaid } = write(markup, text, marks, 'it');
    assert.deepEqual(unsaid, []);
    const again = read(code);
    assert.equal(again.text, text, code);
    assert.equal(again.lang, 'it');
    assert.deepEqual(again.lost, []);
    assert.deepEqual(pieces(again.marks), pieces(marks), code);
  }
  const points = [{ kind: 'pause', value: 300, from: 11, to: 11 }, { kind: 'gesture', value: 'wink', from: 12, to: 12 }, { kind: 'pause', value: 500, from: text.length, to: text.length }];
  for (const markup of MARKUPS) assert.deepEqual(read(write(markup, text, [...marks, ...points], 'it').code).marks.filter(({ from, to }) => from === to), points, markup);
});

test('reports what a markup cannot express', () => {
  const voice = { kind: 'voice', value: 'espeak:it', from: 0, to: 10 }, shame = { kind: 'affect', value: 'shame', from: 0, to: 10 };
  assert.deepEqual(MARKUPS.map((markup) => write(markup, text, [voice, shame], 'it').unsaid.map(({ kind }) => kind)), [['voice'], ['affect'], []]);
});

test('other documents: keeps their text, lists unknown parts, resists hostile input', () => {
  const found = read('<?xml version="1.0"?><!-- x --><speak xml:lang="tr">Merhaba <sub alias="x">y</sub> &#x41;&lt; <break time="0.5s"/>son</speak>');
  assert.deepEqual([found.text, found.lang, found.lost], ['Merhaba y A< son', 'tr', ['sub']]);
  assert.deepEqual(found.marks, [{ kind: 'pause', value: 500, from: 13, to: 13 }]);
  assert.equal(read('solo testo').text, 'solo testo');
  assert.ok(read('<'.repeat(50000)).text.length <= 50000);
  assert.ok(read(`<speak ${'a="b" '.repeat(5000)}`).text.length > 0);
});

test('finds the sentence at a position, and the marks inside a range', () => {
  assert.deepEqual(sentenceAt(text, 15, 20), [12, text.length]);
  assert.deepEqual(sentenceAt(text, 0, 4), [0, 12]);
  assert.deepEqual(within(marks, 12, 21).map(({ kind, from, to }) => [kind, from, to]), [['affect', 0, 9], ['emphasis', 4, 9]]);
});
