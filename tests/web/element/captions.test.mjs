// SPDX-License-Identifier: MIT
import assert from 'node:assert/strict';
import test from 'node:test';
import { PlainText } from '../../../web/element/captions/plain-text.mjs';
import { CaptionTrack, cutCaption, GivenCaptions, HeardCaptions } from '../../../web/element/captions/captions.mjs';

const place = (text, part, from = 0) => {
  const start = text.indexOf(part, from);
  return { utf16_start: start, utf16_end: start + part.length };
};

test('a sentence that fits is one caption', () => {
  const text = '  La mamma parla.  Poi tace.';
  assert.deepEqual(cutCaption(text, 0, 17), [{ start: 2, end: 17 }]);
});

test('splits a long sentence at spaces, preferably after punctuation, without losing text', () => {
  const text =
    'Nel mezzo del cammin di nostra vita, mi ritrovai per una selva oscura, ché la diritta via era smarrita; ahi quanto a ' +
    'dir qual era è cosa dura';
  const pieces = cutCaption(text, 0, text.length);
  assert.ok(pieces.length >= 2);
  assert.equal(text.slice(pieces[0].start, pieces[0].end), 'Nel mezzo del cammin di nostra vita, mi ritrovai per una selva oscura,');
  for (const { start, end } of pieces) assert.ok(end - start <= 84);
  assert.equal(pieces.map(({ start, end }) => text.slice(start, end)).join(' '), text);
});

test('splits a word longer than a caption, but not inside a character', () => {
  const text = '😀'.repeat(100);
  const pieces = cutCaption(text, 0, text.length, 25);
  assert.equal(pieces.map(({ start, end }) => text.slice(start, end)).join(''), text);
  for (const { start, end } of pieces) assert.ok((end - start) % 2 === 0 && end - start <= 26);
});

test('words move from upcoming to spoken as they are heard', () => {
  const text = 'Uno. Due tre quattro.';
  const track = new CaptionTrack(text);
  assert.equal(track.lineOf(), null);
  track.sentence(place(text, 'Due tre quattro.'));
  assert.deepEqual(track.lineOf(), { said: '', word: '', rest: 'Due tre quattro.' });
  track.heard(place(text, 'tre'));
  assert.deepEqual(track.lineOf(), { said: 'Due ', word: 'tre', rest: ' quattro.' });
});

test('the caption advances with the word that is heard', () => {
  const text = 'alfa beta gamma delta epsilon zeta eta theta iota kappa lambda mi ni xi omicron pi rho sigma tau ypsilon';
  const track = new CaptionTrack(text);
  track.sentence({ utf16_start: 0, utf16_end: text.length });
  track.heard(place(text, 'alfa'));
  const first = track.lineOf();
  assert.ok(!first.rest.includes('ypsilon'));
  track.heard(place(text, 'ypsilon'));
  const last = track.lineOf();
  assert.equal(last.word, 'ypsilon');
  assert.equal(last.rest, '');
  assert.ok(!last.said.includes('alfa'));
});

test('positions are UTF-16: characters beyond the basic plane count as two', () => {
  const text = '😀 ciao';
  const track = new CaptionTrack(text);
  track.sentence({ utf16_start: 0, utf16_end: 7 });
  track.heard({ utf16_start: 3, utf16_end: 7 });
  assert.deepEqual(track.lineOf(), { said: '😀 ', word: 'ciao', rest: '' });
});

/** The caption shown when the word at that position of the source is heard. */
function heardIn(source, word, markup = 'ssml') {
  const track = new CaptionTrack(source, markup);
  track.sentence({ utf16_start: 0, utf16_end: source.length });
  const start = source.indexOf(word);
  track.heard({ utf16_start: start, utf16_end: start + word.length });
  return track.lineOf();
}

test('captions show the words of marked-up text, not its tags', () => {
  const source = '<?xml version="1.0"?>\n<speak version="1.1">\n  <p>Ciao, <emphasis level="strong">bella</emphasis>\n  gente &amp; amici!</p></speak>';
  assert.deepEqual(heardIn(source, 'bella'), { said: 'Ciao, ', word: 'bella', rest: ' gente & amici!' });
  assert.deepEqual(heardIn(source, 'amici'), { said: 'Ciao, bella gente & ', word: 'amici', rest: '!' });
});

test('shows a word that contains a tag or a reference completely', () => {
  assert.equal(heardIn('<s>un <emphasis>elefan</emphasis>tino qui</s>', 'elefan</emphasis>tino').word, 'elefantino');
  assert.equal(heardIn('<s>perch&#xE9; no?</s>', 'perch&#xE9;').word, 'perché');
  assert.equal(heardIn('<s>ecco &#128512; qui</s>', '&#128512;').word, '😀');
});

test('captions omit comments, instructions, declarations and silent elements', () => {
  const source =
    '<!DOCTYPE apml SYSTEM "x.dtd" [<!-- > -->]><apml><!-- niente <b> --><audio src="a>b.wav"><desc>un suono</desc>Uno</audio> <![CDATA[<due>]]> tre</apml>';
  assert.deepEqual(heardIn(source, 'tre'), { said: 'Uno <due> ', word: 'tre', rest: '' });
  assert.equal(heardIn('<s><metadata>a<metadata>b</metadata>c</metadata>Sì</s>', 'Sì').said, '');
});

test('plain text keeps its tags', () => {
  assert.equal(heardIn('a <b> c &amp; d', 'c', 'plain').said, 'a <b> ');
});

test('malformed markup takes bounded time', () => {
  for (const text of ['<'.repeat(1e4), '<a '.repeat(3e3), '<a b="'.repeat(2e3), '<!--'.repeat(2e3), '&'.repeat(1e4), `<!DOCTYPE ${'['.repeat(2e3)}`])
    assert.equal(new PlainText(`x${text}`, 'ssml').text[0], 'x');
});

test('a caption fits its room, and splits again when the room changes', () => {
  const text = 'alfa beta gamma delta epsilon zeta eta theta iota kappa lambda';
  for (const captions of [new CaptionTrack(text), new HeardCaptions()]) {
    captions.sentence({ text, utf16_start: 0, utf16_end: text.length });
    captions.heard(place(text, 'delta'));
    const whole = ({ said, word, rest }) => said + word + rest;
    assert.equal(whole(captions.lineOf()), text);
    assert.equal(whole(captions.lineOf(20)), 'delta epsilon zeta');
    assert.equal(captions.lineOf(20).word, 'delta');
    assert.equal(whole(captions.lineOf(84)), text);
  }
});

test('external captions show the last words that fit; the track shows until captions are given', () => {
  const captions = new GivenCaptions(() => 'from the track');
  const shown = () => captions.lineOf(20)?.rest;
  assert.equal(shown(), 'from the track');
  captions.give('Papà beve vino rosso. La mamma parla piano.');
  assert.equal(shown(), 'parla piano.');
  captions.give('');
  assert.equal(captions.lineOf(20), null);
  captions.give(null);
  assert.equal(shown(), 'from the track');
});
