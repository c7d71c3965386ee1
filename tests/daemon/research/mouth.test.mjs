// SPDX-License-Identifier: GPL-3.0-or-later
// A sample of tests/bench/mouth.mjs: every contact closes and every vowel opens, in each language, fast, neutral and in anger, with both blends.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Daemon } from '../../lib/daemon.mjs';
import { parseFap } from '../../lib/fapfile.mjs';
import { SHORT, addMouth, isClosed, readMouth, shownWithin } from '../../lib/mouth.mjs';
import { voiced } from '../../lib/mouth-poses.mjs';
import { sentences } from '../../lib/sentences.mjs';

let daemon;
before(async () => (daemon = await Daemon.start()));
after(async () => assert.deepEqual(await daemon.stop(), { code: 0, signal: null }));

const post = (query, body) => daemon.get(`/v1/speech?${query}`, { method: 'POST', body, headers: { 'content-type': 'application/ssml+xml' } });

async function look(text, lang, engine, blend, contacts = 'engine') {
  const query = `lang=${lang}&rate=320&fps=120&engine=${engine}&blend=${blend}&contacts=${contacts}`;
  const [json, fap] = await Promise.all([post(`${query}&format=json`, text).then((r) => r.json()), post(`${query}&format=fap`, text).then((r) => r.text())]);
  return readMouth(json.phones, parseFap(fap));
}

for (const [lang, engine] of [['it', 'dominance'], ['pt-BR', 'dominance'], ['pt-BR', 'context'], ['tr', 'dominance'], ['tr', 'syllable'], ['en', 'dominance']])
  test(`${lang}, ${engine}: lips close and vowels open at 320 words a minute`, async () => {
    const words = sentences[lang].slice(0, 4).join('\n');
    const sum = {};
    for (const [emotion, blend] of [[null, 'regions'], ['anger', 'regions'], ['anger', 'weighted']]) {
      const part = await look(voiced(words, emotion), lang, engine, blend);
      assert.deepEqual(part.misses, []);
      addMouth(sum, part);
    }
    assert.ok(sum.lips >= 15 && sum.open >= 15, `${sum.lips} ${sum.open}`);
    const shut = sum.gaps.filter(({ mm, seconds }) => seconds >= SHORT && mm < 3);
    assert.deepEqual(shut, []);
  });

test('with contacts off, lips miss some closures or vowels', async () => {
  const part = await look(voiced(sentences.it.slice(0, 4).join('\n'), 'anger'), 'it', 'dominance', 'weighted', 'off');
  assert.ok(part.misses.length > 0 || part.gaps.some(({ mm }) => mm < 3));
});

// Sentences that begin with a lip contact: the silence before the first sound must suffice, in every expression.
const BEGINNINGS = {
  it: 'Bene. Poi parte. Ma no! Beppe beve.', 'pt-BR': 'Bom dia. Pode vir. Meu pai! Bebe logo.',
  tr: 'Baba geldi. Bu ne? Pek iyi! Mavi boya.', en: 'But why? Put it down. My map! Bob, be quick.',
};
const EMOTIONS = [null, 'anger', 'happiness', 'sadness', 'surprise', 'disgust'];

for (const [lang, own] of [['it', []], ['pt-BR', ['context']], ['tr', ['syllable']], ['en', []]])
  test(`${lang}: lips are closed in time at an initial bilabial, in every expression, engine and blend`, async () => {
    const query = `lang=${lang}&rate=320&contacts=on`;
    const open = [];
    for (const emotion of EMOTIONS) { // each emotion also changes the voice
      const text = voiced(BEGINNINGS[lang], emotion);
      const { phones } = await post(`${query}&format=json`, text).then((r) => r.json());
      const first = phones.filter((phone, i) => 'pbm'.includes(phone.ipa[0]) && phone.ipa && (i === 0 || !phones[i - 1].ipa));
      assert.ok(first.length >= 4, JSON.stringify(phones));
      await Promise.all(['dominance', 'cohen-massaro', 'table', ...own].flatMap((engine) => ['regions', 'weighted'].map(async (blend) => {
        const fap = await post(`${query}&fps=25&engine=${engine}&blend=${blend}&format=fap`, text).then((r) => r.text());
        const { fps, frames } = parseFap(fap);
        for (const phone of first) {
          const shown = shownWithin(phone, fps);
          if (!frames.slice(shown.first, shown.end).some(isClosed)) open.push(`${engine}, ${blend}, ${emotion}: /${phone.ipa}/ at ${phone.start}`);
        }
      })));
    }
    assert.deepEqual(open, []);
  });
