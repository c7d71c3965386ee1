// SPDX-License-Identifier: MIT
// Two heads of a film: who shows whom, and how the one who listens behaves.
import assert from 'node:assert/strict';
import test from 'node:test';
import { FAP_VALUES, FaceTrack } from '../../../web/element/face/face-track.mjs';
import { Duet, readWords, seated } from '../../../web/film/duet.mjs';

const words = `WEBVTT

00:00:00.100 --> 00:00:01.900
<v Anna &amp; Co>Hai <00:00:00.500>visto?

2
00:02.200 --> 00:03.900
<v.loud Ugo>No,
non la vedo.

00:00:04.000 --> 00:00:04.500
Si alzano.
`;

test('reads who says what, and when', () => {
  assert.deepEqual(readWords(words.replaceAll('\n', '\r\n')), [
    { start: 0.1, end: 1.9, who: 'Anna & Co', text: 'Hai visto?' },
    { start: 2.2, end: 3.9, who: 'Ugo', text: 'No,\nnon la vedo.' },
    { start: 4, end: 4.5, who: '', text: 'Si alzano.\n' },
  ]);
});

test('who is new takes the place of the one silent longest; the narrator has the first', () => {
  assert.deepEqual(seated(['', 'a', 'b', 'a', 'c', 'b', '', 'c'].map((who) => ({ who }))), [0, 0, 1, 0, 1, 0, 0, 1]);
});

/** A face whose jaw is always open. */
function track() {
  const all = new FaceTrack(25);
  const face = new Int32Array(FAP_VALUES);
  face[3] = 300;
  all.put(0, Array(150).fill(face));
  return all;
}

/** The faces of a whole film. */
function faces(still) {
  const duet = new Duet(track(), readWords(words), still);
  return Array.from({ length: 140 }, (_, k) => duet.at(k / 25).map((values) => values.slice()));
}

test('one speaks while the other rests, turned to it', () => {
  const film = faces(false);
  const [asks, answers] = [1.6, 3.6].map((time) => film[25 * time]);
  assert.deepEqual(asks.map((face) => face[3]), [300, 0]);
  assert.deepEqual(answers.map((face) => face[3]), [0, 300]);
  for (const [left, right] of [asks, answers]) assert.ok(left[49] > 0 && right[49] < 0, `${left[49]} ${right[49]}`);
  assert.ok(answers[0][49] > -answers[1][49]); // who listens turns further
  assert.ok(film.some(([, right]) => right[19] > 500)); // it blinks
});

test('films of the same scene are the same; still heads only speak', () => {
  assert.deepEqual(faces(false), faces(false));
  for (const pair of faces(true)) for (const face of pair) assert.ok(face.every((value, n) => n === 3 || value === 0));
});
