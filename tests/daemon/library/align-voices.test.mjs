// SPDX-License-Identifier: GPL-3.0-or-later
// Alignment of speakers with another pitch and other vocal tracts than the aligner's own voices, also in noise: places of words and phones, and that
// confidence tells which of them are right. The speakers are Festival's voices, changed by sox.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { errors } from '../../lib/boundaries.mjs';
import { faccia } from '../../lib/command.mjs';
import { ordinary } from '../../lib/daemon.mjs';
import { say } from '../../lib/speech.mjs';
import { wavOf } from '../../lib/wav.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
after(() => fs.rmSync(folder, { recursive: true }));
const file = (name) => path.join(folder, name);

const english = ['The farmer sold his old horse before the winter came.', 'Please close the window and bring me a cup of tea.', 'Both children found a small green box under the bridge.',
  'We never thought that the journey would last five days.', 'Her father keeps a very good map of the coast.'];
const italian = ['La mamma prepara il pane, e il bambino mangia una mela.', 'Il sole tramonta presto durante l\'inverno.', 'Pippo beve il tè dopo pranzo.', 'Vorrei sapere dove abita la signora Bianchi.',
  'Il fabbro porta sempre con sé un piccolo libro verde.'];
const elsewhere = { en: 'Seven barrels of salted fish were left behind on the pier.', it: 'Nessuno aveva parlato della tempesta al giovane capitano.' };

/** Says lines with a voice that sox changes by `effect`; times are of the changed sound. */
function spoken(voice, lang, lines, effect, scale = 1) {
  const { status, stderr, json, pcm, rate } = say(['-l', lang, '-v', voice], lines.join('\n'), {}, ordinary);
  assert.equal(status, 0, stderr);
  fs.writeFileSync(file('plain.wav'), wavOf(pcm, rate));
  execFileSync('sox', [file('plain.wav'), '-b', '16', file('sound.wav'), ...effect], { stdio: 'pipe' });
  const scaled = (list) => list.map((item) => ({ ...item, start: item.start * scale, end: item.end * scale }));
  return { phones: scaled(json.phones), words: scaled(json.words) };
}

function aligned(lines, lang) {
  fs.writeFileSync(file('text.txt'), lines.join('\n'));
  const { status, stderr } = faccia(['align', file('sound.wav'), '--text', file('text.txt'), '-l', lang, '--json', file('found.json')], { from: ordinary });
  assert.equal(status, 0, stderr);
  return { stderr, ...JSON.parse(fs.readFileSync(file('found.json'))) };
}

const share = (list, is) => list.filter(is).length / list.length;

for (const [what, voice, lang, lines, effect, scale] of [
  ['a larger man', 'festival:kal', 'en', english, ['speed', '0.88'], 1 / 0.88],
  ['a child', 'festival:lp', 'it', italian, ['speed', '1.2', 'tempo', '0.85'], 1 / (1.2 * 0.85)],
  ['a higher voice', 'festival:pc', 'it', italian, ['pitch', '350'], 1],
])
  test(`${what}: half of the phones begin within 20 ms, nine in ten within 60 ms; words that are said are certain`, () => {
    const truth = spoken(voice, lang, lines, effect, scale), found = aligned(lines, lang);
    const { pairs, phones, median, p90 } = errors(truth.phones, found.phones);
    assert.ok(pairs > 0.7 * phones, `${pairs} of ${phones} phones are the same`);
    assert.ok(median <= 20 && p90 <= 60, `phones are off by ${median} ms (half), ${p90} ms (90 %)`);
    const starts = new Map(truth.words.map((w) => [w.byte_start, w.start]));
    const words = found.words.filter((w) => starts.has(w.byte_start)), sure = words.filter((w) => w.confidence >= 0.8);
    const near = (w) => Math.abs(w.start - starts.get(w.byte_start)) <= 0.1;
    assert.ok(words.length > 30 && sure.length > 0.7 * words.length, `${sure.length} of ${words.length} words are certain`);
    assert.ok(share(sure, near) >= 0.9, `${share(sure, near)} of the certain words begin within 0.1 s`);
  });

for (const [voice, lang, lines] of [['festival:kal', 'en', english], ['festival:lp', 'it', italian]])
  test(`${voice}: a sentence that is not said has no certain words`, () => {
    spoken(voice, lang, lines, ['speed', '0.94']);
    const other = lines.with(2, elsewhere[lang]), from = Buffer.byteLength(other.slice(0, 2).join('\n')) + 1, to = from + Buffer.byteLength(other[2]);
    const found = aligned(other, lang), inside = (w) => w.byte_start >= from && w.byte_end <= to;
    const said = found.words.filter((w) => !inside(w)), unsaid = found.words.filter(inside);
    const mean = (list) => list.reduce((sum, w) => sum + w.confidence, 0) / list.length;
    assert.ok(unsaid.length > 6 && mean(unsaid) < 0.4 && share(unsaid, (w) => w.confidence >= 0.8) <= 0.2, JSON.stringify(unsaid.map((w) => [w.text, w.confidence])));
    assert.ok(mean(said) > 0.75, `the others: ${mean(said)}`);
  });

test('in noise as loud as a quarter of the voice, words that are certain are right', () => {
  const truth = spoken('festival:kal', 'en', english, ['speed', '0.94'], 1 / 0.94);
  const data = fs.readFileSync(file('sound.wav')), rate = data.readUInt32LE(24), at = data.indexOf('data') + 8;
  const pcm = new Int16Array(data.buffer.slice(data.byteOffset + at, data.byteOffset + data.length - ((data.length - at) % 2)));
  const level = Math.sqrt(pcm.reduce((sum, x) => sum + x * x, 0) / pcm.length);
  let state = 1;
  const noisy = pcm.map((x) => {
    state = (Math.imul(state, 1664525) + 1013904223) | 0;
    return Math.max(-32768, Math.min(32767, x + (state / 2 ** 31) * level * 0.25 * Math.sqrt(3)));
  });
  fs.writeFileSync(file('sound.wav'), wavOf(noisy, rate));
  const starts = new Map(truth.words.map((w) => [w.byte_start, w.start])), { words } = aligned(english, 'en');
  const sure = words.filter((w) => w.confidence >= 0.8 && starts.has(w.byte_start));
  assert.ok(sure.length > words.length / 3, `${sure.length} of ${words.length} words are certain`);
  assert.ok(share(sure, (w) => Math.abs(w.start - starts.get(w.byte_start)) <= 0.1) >= 0.85, JSON.stringify(sure.map((w) => [w.text, w.start - starts.get(w.byte_start)])));
});
