// SPDX-License-Identifier: GPL-3.0-or-later
// Times of the mouths in a film, from a TextGrid: as PRAAT writes it, long and short, and as faccia session does.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { nameOf } from '../../models/tools/pictures/names.mjs';
import { openSource, SourceError } from '../../models/tools/pictures/sources.mjs';
import { toTextGrid } from '../../models/tools/session/textgrid.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-grid-'));
after(() => fs.rmSync(folder, { recursive: true }));
const film = path.join(folder, 'film.mp4');
fs.writeFileSync(film, '');
const labels = (bytes) => {
  fs.writeFileSync(path.join(folder, 'a.TextGrid'), bytes);
  return openSource(film, path.join(folder, 'a.TextGrid'), nameOf).photographs.map(({ label }) => label);
};
const own = toTextGrid(2, [
  { name: 'a', intervals: [{ start: 0, end: 0.5, text: 'rest' }, { start: 0.5, end: 0.75, text: 'p1' }, { start: 1, end: 1.25, text: 'say "p1"' }] },
  { name: 'p1', intervals: [{ start: 1.5, end: 2, text: 'sh1' }] },
]);
const WANTED = ['rest at 0.25 s', 'p1 at 0.625 s', 'ʃ1 at 1.75 s'];

test('takes the middle of each interval that is named after a mouth, and nothing else', () => {
  assert.deepEqual(labels(own), WANTED);
  assert.deepEqual(labels(Buffer.from(`\ufeff${own}`, 'utf16le')), WANTED, 'in UTF-16');
});

test('reads the short form, and points', () => {
  const short = ['File type = "ooTextFile"', 'Object class = "TextGrid"', '', 0, 2, '<exists>', 2, '"IntervalTier"', '"a"', 0, 2, 2, 0, 0.5, '"rest"', 0.5, 0.75, '"p1"', '"TextTier"', '"points"', 0, 2, 1, 1.75, '"sh1"', ''].join('\n');
  assert.deepEqual(labels(short), WANTED);
});

test('refuses what is no TextGrid, and one without mouths', () => {
  assert.throws(() => labels('{"p1": 1}'), (e) => e instanceof SourceError && /no TextGrid/.test(e.message));
  assert.throws(() => labels(toTextGrid(1, [{ name: 'p1', intervals: [{ start: 0, end: 1, text: 'hello' }] }])), /no interval is named after a viseme/);
  assert.throws(() => openSource(film, path.join(folder, 'nowhere.TextGrid'), nameOf), SourceError);
});
