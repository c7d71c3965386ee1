// SPDX-License-Identifier: GPL-3.0-or-later
// Every language of espeak-ng: all phones have lip shapes, bilabials close, labiodentals touch, front rounded vowels are round.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { build, Daemon } from '../../lib/daemon.mjs';
import { parseFap } from '../../lib/fapfile.mjs';
import { samples } from '../../lib/languages.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
let daemon;
before(async () => {
  daemon = await Daemon.start();
});
after(async () => {
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  fs.rmSync(folder, { recursive: true });
});
const faccia = (args) => spawnSync(path.join(build, 'server/cli/faccia'), args, { maxBuffer: 1 << 28 });

test('each of its languages has a sample', async () => {
  const { voices } = await (await daemon.get('/v1/voices')).json();
  const plain = voices.filter((v) => v.plugin === 'espeak' && !v.id.includes('+')).map((v) => v.id.replace('espeak:', ''));
  assert.ok(plain.length > 120, `${plain.length} voices`);
  const without = plain.filter((id) => !samples[id.replace(/^yue-.*/, 'yue')]);
  assert.deepEqual(without, []);
});

for (const [id, text] of Object.entries(samples))
  test(`${id}: speaks, and every phone has a viseme`, async () => {
    const response = await daemon.get(`/v1/speech?format=json&voice=espeak:${id}`, {
      method: 'POST', body: `${text} 1 2 3 10 21 100`, headers: { 'content-type': 'text/plain' },
    });
    assert.equal(response.status, 200);
    const { phones, warnings } = await response.json();
    assert.deepEqual(warnings, []);
    assert.ok(phones.filter((phone) => phone.ipa).length > text.length / 4, `${phones.length} phones`);
  });

// Sentences with their numbers of /p b m/ and /f v/, counted by hand; adjacent ones, as in "compra", count separately.
const sentences = {
  fr: ['Ma maman a bu une bonne soupe. Papa vend beaucoup de pommes. Vive la fête.', 11, 4],
  de: ['Meine Mama backt oben Brot. Papa hat viele Blumen vom Baum. Fünf Affen.', 13, 5],
  es: ['Mi mamá compra pan para Pepe. El papá fuma poco.', 14, 1],
  pl: ['Mama ma psa. Babcia piła wodę, a pan kupił buty. Fala i wóz.', 10, 3],
  ru: ['Мама мыла раму. Папа пил воду, а бабушка пела. Фабрика и вода.', 11, 3],
  ar: ['باب البيت مفتوح. محمد يحب الموز. في مصر فيل.', 9, 3],
  zh: ['妈妈跑步。爸爸买苹果。明天北方的风很大，飞机不飞。', 11, 4],
  ja: ['ママは パンを たべます。ぶたも ぼくも まめが すき。', 11, 0],
  hi: ['माँ ने मेरी बात मानी। पिता पानी पीते हैं। बाबू फल बेचता है।', 11, 0],
  sw: ['Mama anapika mboga. Baba anapenda maembe. Fundi anavua samaki.', 12, 2],
  el: ['Η μαμά μου πίνει πολύ. Ο μπαμπάς πάει περίπατο. Φέρε το βιβλίο.', 10, 3],
  hu: ['A mama babot pakol. A papa piros almát eszik. Fehér fa, víz.', 9, 3],
};
for (const [lang, [text, bilabials, labiodentals]] of Object.entries(sentences))
  test(`${lang}: lips close on all bilabials, and reach the teeth`, () => {
    const { status, stdout, stderr } = faccia(['eval', '--lang', lang, '--engine', 'dominance', '--rates', '80,200,320', '--json', '-', text]);
    assert.equal(status, 0, String(stderr));
    assert.equal(String(stderr), '');
    for (const row of JSON.parse(stdout).rows) {
      assert.equal(row.bilabials, bilabials);
      assert.equal(row.labiodentals, labiodentals);
      for (const name of ['lips_seen', 'lips_held']) assert.equal(row[name], 1, `${name} at ${row.rate}`);
      if (labiodentals) for (const name of ['teeth_seen', 'teeth_held']) assert.equal(row[name], 1, `${name} at ${row.rate}`);
      assert.ok(row.opening > 0.2 && row.opening < 1.3, `opening ${row.opening}`);
    }
  });

/** Averages the middle frames of all vowels with these names. Returns a function from FAP number to value. */
function vowelShape(lang, text, names) {
  const fap = path.join(folder, 'a.fap');
  const json = path.join(folder, 'a.json');
  const { status, stderr } = faccia(['say', '--lang', lang, '--still', '--rate', '120', '--fap', fap, '--json', json, text]);
  assert.equal(status, 0, String(stderr));
  const { fps, frames } = parseFap(fs.readFileSync(fap, 'utf8'));
  const found = JSON.parse(fs.readFileSync(json)).phones.filter((phone) => names.includes(phone.ipa));
  assert.ok(found.length >= 2, `${found.length} of ${names} in ${text}`);
  const middles = found.map((phone) => frames[Math.round(((phone.start + phone.end) / 2) * fps)]);
  return (n) => middles.reduce((sum, frame) => sum + frame[n], 0) / middles.length;
}

// FAPs 53 and 54: inner corners outwards; 17 and 16: upper and lower lip forward; 4 and 5: lips down and up.
const width = (shape) => shape(53) + shape(54);
const forward = (shape) => shape(16) + shape(17);
const gap = (shape) => -(shape(4) + shape(5));
for (const [lang, round, spread, y, i] of [
  ['fr', 'Lulu a su. Tu as lu.', 'Lili a ci. Ti as li.', ['y', 'yː'], ['i', 'iː']],
  ['de', 'Die Hüte. Süße Tüte.', 'Die Hiebe. Siege, tiefe.', ['y', 'yː'], ['i', 'iː']],
])
  test(`${lang}: /y/ is round where /i/ is spread`, () => {
    const [rounded, wide] = [vowelShape(lang, round, y), vowelShape(lang, spread, i)];
    assert.ok(width(rounded) < width(wide) - 100, `width ${width(rounded)} beside ${width(wide)}`);
    assert.ok(forward(rounded) > forward(wide) + 50, `protrusion ${forward(rounded)} beside ${forward(wide)}`);
  });

test('openness follows height: French /y ø œ/ and /i e a/', () => {
  const shapes = ['i', 'e', 'a'].map((ipa) => vowelShape('fr', 'Si ses sa, dit dé da, lit les la.', [ipa]));
  assert.ok(gap(shapes[0]) < gap(shapes[1]) && gap(shapes[1]) < gap(shapes[2]), shapes.map(gap).join(' '));
  const rounded = [['y'], ['ø', 'øː'], ['œ', 'œː']].map((ipa) => vowelShape('fr', 'Su, ceux, seul. Du, deux, deuil. Lu, leur, lieu.', ipa));
  assert.ok(gap(rounded[0]) < gap(rounded[1]) && gap(rounded[1]) < gap(rounded[2]), rounded.map(gap).join(' '));
});

test('converts names to IPA: dots of retroflexes, numbers of tones, letters of X-SAMPA', async () => {
  for (const [id, text, spoken] of [
    ['cmn-latn-pinyin', '水', /^ʂ w ei$/], ['cmn-latn-pinyin', '很', /^χ ə n$/], ['yue', '三', /^s aa m$/], ['ky', 'чай', /^tʃ ɑ j$/],
  ]) {
    const response = await daemon.get(`/v1/speech?format=json&voice=espeak:${id}`, { method: 'POST', body: text, headers: { 'content-type': 'text/plain' } });
    const { phones } = await response.json();
    assert.match(phones.map(({ ipa }) => ipa).filter(Boolean).join(' '), spoken);
  }
});

test('speaks a language without a pack on request', async () => {
  const stream = await daemon.stream();
  const { languages, more_languages: more } = await stream.wait({ type: 'hello' });
  assert.ok(!languages.some(({ tag }) => tag === 'und'));
  for (const tag of ['fr-FR', 'de', 'sw', 'ja']) assert.ok(more.includes(tag), tag);
  for (const tag of ['it', 'pt-BR', 'en-US', 'und']) assert.ok(!more.includes(tag), tag);
  assert.equal(new Set(more).size, more.length);
  for (const [lang, spoken] of [['fr', 'fr-FR'], ['de-AT', 'de'], ['no', 'nb'], ['zh-TW', 'cmn']]) {
    stream.send({ type: 'speak', id: lang, lang, text: '1.' });
    assert.equal((await stream.wait({ type: 'begin', id: lang })).lang, spoken);
    assert.equal((await stream.wait({ type: 'end', id: lang })).reason, 'done');
  }
  for (const lang of ['und', 'xx']) {
    stream.send({ type: 'speak', id: lang, lang, text: '1.' });
    assert.equal((await stream.wait({ type: 'error', id: lang })).code, 'unknown-language');
  }
  assert.deepEqual(stream.messages.filter(({ type }) => type === 'warning'), []);
  await stream.close();
});

test('accepts a language without a pack as the default', async () => {
  const french = await Daemon.start(['--lang', 'fr']);
  const response = await french.get('/v1/speech?format=json', { method: 'POST', body: 'Une pomme.', headers: { 'content-type': 'text/plain' } });
  const { lang, warnings } = await response.json();
  assert.deepEqual(await french.stop(), { code: 0, signal: null });
  assert.equal(lang, 'fr-FR');
  assert.deepEqual(warnings, []);
});

test('languages that alternate in one text keep their own lip shapes', async () => {
  const body = '<speak xml:lang="it">Buongiorno. <lang xml:lang="fr">La rue, le feu, un bruit.</lang> <lang xml:lang="de">Schöne Mädchen.</lang></speak>';
  const response = await daemon.get('/v1/speech?format=json', { method: 'POST', body, headers: { 'content-type': 'application/ssml+xml' } });
  const { phones, warnings } = await response.json();
  assert.deepEqual(warnings, []);
  for (const ipa of ['y', 'ø', 'ʁ']) assert.ok(phones.some((phone) => phone.ipa === ipa), ipa);
});
