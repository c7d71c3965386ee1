// SPDX-License-Identifier: GPL-3.0-or-later
// A sample of `tests/bench/mouth.mjs --pixels`: in a fast, joyful sentence, lip contacts are visible while their sounds are heard, and vowels
// visibly open.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { launch } from '../../lib/browser.mjs';
import { mouthPixels, readPixels } from '../../lib/mouth-pixels.mjs';
import { spoken, voiced } from '../../lib/mouth-poses.mjs';
import { sentences } from '../../lib/sentences.mjs';

let browser, screen;
before(async () => {
  browser = await launch();
  screen = await mouthPixels(browser);
});
after(() => browser?.close());

async function seen(contacts) {
  const track = spoken(voiced(sentences.it.slice(0, 2).join('\n'), 'happiness'), '--lang', 'it', '--rate', 320, '--markup', 'ssml', '--fps', 25, '--contacts', contacts);
  return readPixels(screen.look, track.phones, track);
}

test('shows closed lips at closures and open lips at vowels', async () => {
  const { lips, teeth, open, gaps, misses } = await seen('on');
  assert.ok(lips >= 5 && open >= 8, `${lips} ${teeth} ${open}`);
  assert.deepEqual(misses, []);
  // A vowel of 26 ms may lie between two frames.
  assert.ok(gaps.filter(({ mm }) => mm > 2).length >= 0.7 * open, `${gaps.map(({ mm }) => mm)}`);
});

test('leaves some closures open with contacts switched off', async () => {
  const { misses } = await seen('off');
  assert.ok(misses.length >= 1);
});
