// SPDX-License-Identifier: GPL-3.0-or-later
// Lids of imported heads that leave a slit when they are closed: they are turned further, as far as that helps, and it is told.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import test from 'node:test';
import { closeLids } from '../../models/tools/import/actions/closed-lids.mjs';
import { models } from '../lib/built-heads.mjs';
import { violations } from '../lib/schema.mjs';

const mara = JSON.parse(fs.readFileSync(path.join(models, 'heads/mara.json'), 'utf8'));
const LEFT = [19, 21];
const turnOf = (head, fap) => head.turns.find((turn) => turn.fap === fap).radians;
/** Mara, some of whose lids turn by a share of what they should. */
const lazy = (share, faps) => ({ ...mara, turns: mara.turns.map((turn) => (faps.includes(turn.fap) ? { ...turn, radians: turn.radians * share } : turn)) });

test('lids that close stay as they are', () => {
  const { head, notes } = closeLids(mara);
  assert.equal(head, mara);
  assert.deepEqual(notes, []);
});

test('lids that leave a slit turn further, those of the other eye do not', () => {
  const slit = lazy(0.8, LEFT);
  const { head, notes } = closeLids(slit);
  assert.equal(notes.length, 1, notes.join('; '));
  assert.match(notes[0], /^the closed left lids left \d+ % of the eye open: they turn \d+ % further$/);
  for (const fap of LEFT) assert.ok(turnOf(head, fap) > 1.05 * turnOf(slit, fap));
  for (const fap of [20, 22]) assert.equal(turnOf(head, fap), turnOf(mara, fap));
  assert.equal(violations('head-model', head), null);
  assert.deepEqual(closeLids(head).notes, [], 'now they close');
});

test('what no turn closes is told', () => {
  const { head, notes } = closeLids(lazy(0.4, [19, 20, 21, 22]));
  assert.deepEqual(notes.map((note) => note.replace(/\d+/g, 'N')), ['left', 'right'].flatMap((side) =>
    [`the closed ${side} lids left N % of the eye open: they turn N % further`, `the closed ${side} lids leave N % of the eye open`]));
  assert.equal(violations('head-model', head), null);
});

test('a head without eyes has nothing to be seen', () => {
  const blind = { ...lazy(0.5, LEFT), parts: mara.parts.filter(({ name }) => !name.startsWith('eye_')) };
  assert.deepEqual(closeLids(blind).notes, []);
});
