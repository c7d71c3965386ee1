// SPDX-License-Identifier: MIT
// Modules of the pages, without a browser: texts, errors, links and voices.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import test from 'node:test';
import * as texts from '../../../web/pages/texts/index.js';
import { makeLink, readLink } from '../../../web/pages/speak/link.js';
import { placeIn, placeOf } from '../../../web/pages/shared/problem.js';
import { isWithin, readHours, readWish } from '../../../web/pages/room/wish.js';
import { readCsv, readScene, writeCsv } from '../../../web/pages/operator/scene.js';
import { voicesOf } from '../../../web/pages/shared/voice-choice.js';

const folder = new URL('../../../web/pages/', import.meta.url);
const source = (name) => fs.readFileSync(new URL(name === 'speak' ? 'speak/index.html' : `${name}/${name}.html`, folder), 'utf8');
const part = (name) => fs.readFileSync(new URL(`shared/${name}.html`, folder), 'utf8');
const html = (name) => source(name).replace(/^ *<!-- include (\w+) -->\n/gm, (_, included) => part(included));
const { shared, errors, sayings, ...all } = texts; // three that are of no page alone

test('every text exists in every language', () => {
  for (const words of Object.values(texts))
    for (const lang of ['it', 'pt', 'tr']) assert.deepEqual(Object.keys(words[lang]).sort(), Object.keys(words.en).sort(), lang);
});

test('the pages use existing texts only, and share their frame', () => {
  for (const name of Object.keys(all))
    for (const [, word] of html(name).matchAll(/data-(?:text|label)="(\w+)"/g))
      assert.equal(typeof (all[name].en[word] ?? shared.en[word]), 'string', `${name}: ${word}`);
  for (const name of Object.keys(all).filter((each) => each !== 'room'))
    for (const included of ['header', 'access', 'footer']) assert.ok(source(name).includes(`<!-- include ${included} -->`), `${name}: ${included}`);
});

test('every page has a description; menu and first page link to existing pages', () => {
  const there = fs.readdirSync(folder).flatMap((name) => (name === 'speak' ? ['./'] : [`${name}.html`]));
  for (const name of [...Object.keys(all), 'examples']) assert.match(html(name), /<meta name="description" content=".{30,160}" \/>/, name);
  const links = [part('header'), source('speak')].flatMap((text) => [...text.matchAll(/href="([^"#?]+)"/g)].map(([, to]) => to)).filter((to) => /\.html$|\/$/.test(to));
  assert.ok(links.length > 12);
  for (const link of links)
    if (!link.startsWith('docs/')) assert.ok(there.includes(link), link);
    else assert.ok(fs.existsSync(new URL(`../docs/${link.slice(5).replace(/\.html$|\/?$/, '') || 'index'}.md`, folder)), link);
});

test('pages contain no inline scripts or styles', () => {
  for (const name of [...Object.keys(all), 'examples']) assert.doesNotMatch(html(name), /<style|style=|<script(?![^>]*src=)|\son\w+=|data:/);
  for (const name of fs.readdirSync(folder, { recursive: true }).filter((file) => file.endsWith('.js')))
    assert.doesNotMatch(fs.readFileSync(new URL(name, folder), 'utf8'), /innerHTML|outerHTML|insertAdjacentHTML|document\.write|\beval\b/, name);
});

test('every error that a page can show has a text', () => {
  const protocol = fs.readFileSync(new URL('../../../protocol/README.md', import.meta.url), 'utf8');
  const rows = protocol.split('## Error codes')[1].split('## Limits')[0].match(/^\| `.*?\|/gm).join('');
  // what only scripts do
  const others = `bad-json bad-message unknown-type binary-message unknown-format not-speaking unknown-mark unknown-utterance unfinished too-many-open unknown-media media-too-large
    bad-form unknown-command unknown-codec skipped unknown-member method-not-allowed unsupported-media-type upgrade-required bad-request bad-header bad-host
    bad-length bad-chunk bad-target bad-escape request-timeout uri-too-long headers-too-large unknown-method unknown-coding unknown-version
    unknown-expectation bad-handshake unknown-protocol unknown-element unknown-attribute missing-attribute ignored inside-word entity
    more-warnings bad-value voice-warning no-sound cancelled bad-option cannot-listen misaligned no-reference`.split(/\s+/);
  const codes = [...rows.matchAll(/`([a-z0-9-]+)`/g)].map(([, code]) => code).filter((code) => !others.includes(code));
  assert.ok(codes.length >= 30, `${codes.length}`);
  for (const code of ['token-needed', 'expired-token', 'voice-crashed', 'bad-xml', 'connection-lost', 'no-connection'])
    assert.ok(errors.tr[code], code);
  assert.deepEqual(codes.filter((code) => !errors.it[code]), []);
});

test('describes positions, and finds them in the text', () => {
  const say = (name, values) => `${name} ${Object.values(values).join(',')}`;
  assert.equal(placeOf({ line: 2, column: 7 }, say), 'atLine 2,7');
  assert.equal(placeOf({ byte: 0 }, say), 'atByte 0');
  assert.equal(placeOf({ field: 'lang' }, say), 'atField lang');
  assert.equal(placeOf({}, say), '');
  assert.equal(placeIn('uno\n😀due\n', 2, 2), 6, 'columns are characters');
  assert.equal(placeIn('uno', 1, 1), 0);
  assert.equal(placeIn('uno', 9, 9), 3);
});

test('a link stores the choices, restores them, and contains no token', () => {
  const state = { text: 'Così & più\nü', lang: 'pt-BR', voice: 'espeak:pt-br', rate: 200, markup: 'ssml', room: 'sala-1', captions: false };
  const link = makeLink('https://x.example/faccia/?token=secret&text=old#there', state);
  assert.ok(link.startsWith('https://x.example/faccia/?text='), link);
  assert.ok(!link.includes('secret') && !link.includes('#'));
  assert.deepEqual(readLink(new URL(link).search), state);
  assert.equal(makeLink('http://h/', { text: 'Ciao', lang: 'it', voice: '', rate: 150, markup: 'auto', room: '', captions: true }), 'http://h/?text=Ciao&lang=it');
  assert.deepEqual(readLink('?rate=9999&markup=odd&captions=on'), { rate: 240, captions: true });
  assert.deepEqual(readLink('?rate=fast'), {});
});

test('lists the voices of a language: its own, then those of its varieties', () => {
  const voices = ['en-GB', 'it', 'en', 'en-GB', 'pt'].map((lang, i) => ({ id: `v${i}`, lang }));
  const ids = (tag) => voicesOf(voices, tag).map(({ lang, voices: list }) => [lang, ...list.map(({ id }) => id)].join(' '));
  assert.deepEqual(ids('en'), ['en v2', 'en-GB v0 v3']);
  assert.deepEqual(ids('pt-BR'), ['pt v4']);
  assert.deepEqual(ids('tr'), []);
});

test('a room’s page reads its hours of sleep and its options from the address', () => {
  assert.deepEqual(readHours('22-7'), [1320, 420]);
  assert.deepEqual(readHours('13:30-14:05'), [810, 845]);
  for (const wrong of [null, '', 'night', '25-7', '1-2-3', '22:5-7']) assert.equal(readHours(wrong), null, wrong);
  assert.deepEqual([1319, 1320, 1439, 0, 419, 420].map((minute) => isWithin([1320, 420], minute)), [false, true, true, true, true, false]);
  assert.deepEqual([809, 810, 844, 845].map((minute) => isWithin([810, 845], minute)), [false, true, true, false]);
  const wish = readWish('http://h/room.html?room=cucina&clock&sleep=22-7&lang=it');
  assert.deepEqual(wish, { room: 'cucina', lang: 'it', head: null, view: 'face', clock: true, sleep: [1320, 420], distance: null, recogniser: null });
  assert.equal(readWish('http://h/room.html?distance=3').distance, 3);
  assert.equal(readWish('http://h/room.html?clock=0').clock, false);
});

test('a scene survives its table; errors have their position', () => {
  const scene = {
    title: '', lines: [
      { id: 'a', text: 'Ciao, "cara"\ncome va?', variants: ['Salve'], mood: 'joy 0.5', choices: [{ text: 'Bene', next: 'b' }, { text: 'Male' }], next: 'b' },
      { id: 'b', text: 'Ah.', variants: [], mood: '', choices: [] },
    ],
  };
  assert.deepEqual(readScene(scene), scene);
  assert.deepEqual(readCsv(writeCsv(scene)), scene);
  assert.deepEqual(readCsv('\uFEFFtext\r\nUno\r\n\r\n"Due, tre"\r\n').lines.map(({ id, text }) => [id, text]), [['1', 'Uno'], ['2', 'Due, tre']]);
  const wrong = (change) => {
    const copy = structuredClone(scene);
    change(copy.lines);
    return () => readScene(copy);
  };
  assert.throws(wrong((lines) => (lines[1].id = 'a')), { place: 'lines.1.id' });
  assert.throws(wrong((lines) => (lines[0].next = 'z')), { place: 'lines.0.next' });
  assert.throws(wrong((lines) => (lines[0].choices[1].next = 'z')), { place: 'lines.0.choices.1.next' });
  assert.throws(wrong((lines) => (lines[1].text = ' ')), { place: 'lines.1.text' });
  assert.throws(wrong((lines) => (lines[0].variants = 'x')), { place: 'lines.0.variants' });
  for (const none of [null, 7, {}, { lines: 1 }]) assert.throws(() => readScene(none), { place: 'lines' });
  assert.throws(() => readCsv('words\nCiao\n'), { place: '1' });
});
