// SPDX-License-Identifier: MIT
import assert from 'node:assert/strict';
import test from 'node:test';
import { FIRST, listed, ownName, pageLanguage, spokenLanguage } from '../../../web/pages/shared/languages.js';

test('selects the first browser language that the page has texts for', () => {
  const known = ['it', 'pt', 'tr', 'en'];
  assert.equal(pageLanguage(['tr-TR', 'en'], known), 'tr');
  assert.equal(pageLanguage(['de-AT', 'de', 'pt-PT', 'en'], known), 'pt');
  assert.equal(pageLanguage(['de'], known), 'en');
  assert.equal(pageLanguage([], known), 'en');
});

test('selects the speech language closest to the browser’s', () => {
  const offered = ['cmn', 'en', 'it', 'pt-BR', 'tr', 'pt', 'de', 'en-GB'];
  assert.equal(spokenLanguage(['it-CH'], offered), 'it');
  assert.equal(spokenLanguage(['pt'], offered), 'pt-BR', 'the one with lips of its own');
  assert.equal(spokenLanguage(['pt-PT'], offered), 'pt');
  assert.equal(spokenLanguage(['pt-PT'], FIRST), 'pt-BR');
  assert.equal(spokenLanguage(['en-gb'], offered), 'en-GB');
  assert.equal(spokenLanguage(['xx', 'de-AT'], offered), 'de');
  assert.equal(spokenLanguage(['xx'], offered, 'tr'), 'tr');
});

test('lists languages by their own names, the four first, the others by name', () => {
  const { first, others } = listed(['sv', 'tr', 'de', 'en', 'pt-BR', 'es', 'it', 'de', 'x_bad'], 'it');
  assert.deepEqual(first.map(({ name }) => name), ['Italiano', 'Português (Brasil)', 'Türkçe', 'English']);
  assert.deepEqual(others.map(({ name }) => name), ['Deutsch', 'Español', 'Svenska', 'x_bad']);
  assert.deepEqual(listed(['pt', 'tr', 'it', 'en', 'de']).first.map(({ tag }) => tag), ['it', 'pt', 'tr', 'en']);
  assert.equal(ownName('tr'), 'Türkçe');
});
