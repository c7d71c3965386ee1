// SPDX-License-Identifier: GPL-3.0-or-later
// The page of the library with a play, and with dialogue in prose: who speaks is shown, heard, and has a face of its own.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { violations } from '../../lib/axe.mjs';
import { launch } from '../../lib/browser.mjs';
import { artefacts, Daemon, eventually, root } from '../../lib/daemon.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-play-'));
let daemon, browser, page;
before(async () => {
  fs.mkdirSync(path.join(folder, 'works'));
  fs.copyFileSync(path.join(root, 'models/library/la-chiave.xml'), path.join(folder, 'works/la-chiave.xml'));
  fs.writeFileSync(path.join(folder, 'works/libro.md'), '---\ntitle: Libro\nlang: it\n---\n# Uno\n\nA.\n\n## Primo\n\nB.\n\n### Inizio\n\nC.\n\n## Secondo\n\nD.\n\n# Due\n\nE.\n');
  fs.writeFileSync(path.join(folder, 'works/novella.md'), '---\ntitle: Novella\nlang: it\n---\n# Uno\n\nEra sera. — pensava il gatto.\n\n«Chi va là?» disse Renzo.\n\nLucia rispose: «Sono *io*, apri». E tacque.\n\n«Entrate dunque.»\n');
  daemon = await Daemon.start(['--library', path.join(folder, 'works'), '--library-index', path.join(folder, 'index'), '--editing'], { FACCIA_STATE: folder });
  await eventually(async () => (await (await daemon.get('/v1/library')).json()).state === 'ready', 'the library');
  browser = await launch({ webgl: false });
  page = await browser.newPage({ viewport: { width: 1100, height: 800 }, locale: 'it-IT', serviceWorkers: 'block', reducedMotion: 'reduce' });
  page.setDefaultTimeout(90000);
  await page.addInitScript(() => {
    globalThis.heard = [];
    document.addEventListener('DOMContentLoaded', () => {
      for (const type of ['speaker', 'word', 'begin'])
        document.getElementById('head').addEventListener(type, ({ detail }) => globalThis.heard.push({ type, ...detail, head: document.getElementById('head').getAttribute('model'), shown: document.getElementById('who').textContent }));
    });
  });
  await page.goto(`${daemon.url}/library.html#la-chiave:2`);
  await page.waitForFunction(() => document.querySelector('#connection').dataset.state === 'open' && document.querySelectorAll('#persons li').length === 6);
});
after(async () => {
  await browser?.close();
  assert.equal((await daemon.stop()).code, 0);
  fs.rmSync(folder, { recursive: true });
});

/** Reads the section to the end of a word, and returns what was heard: [speaker, words]. */
async function read(until) {
  await page.evaluate(() => (globalThis.heard.length = 0));
  await page.click('#play');
  await page.waitForFunction((word) => globalThis.heard.some(({ type, text }) => type === 'word' && text.includes(word)), until);
  await page.keyboard.press('Escape');
  const events = await page.evaluate(() => globalThis.heard);
  const found = [];
  for (const { type, speaker, text } of events)
    if (type === 'word') {
      const who = speaker?.name ?? '';
      if (found.at(-1)?.[0] !== who) found.push([who, '']);
      found.at(-1)[1] += `${text} `;
    }
  return { events, found: found.map(([who, said]) => [who, said.trim()]) };
}

test('the persons are listed, and each is heard with its own voice and face, without stage directions', async () => {
  await page.click('#roles summary');
  assert.match(await page.textContent('#persons li:first-child'), /^Anselmo vecchio orologiaio · uomo/);
  assert.deepEqual(await violations(page), []);
  await page.screenshot({ path: path.join(artefacts, 'play.png') });
  const { events, found } = await read('Quale');
  assert.deepEqual(found.map(([who]) => who), ['', 'Lisetta', 'Anselmo', 'Lisetta']);
  assert.match(found[1][1], /^Buongiorno,? Anselmo\.? È ancora caldo/);
  assert.ok(!found.some(([, said]) => /posando|ira|bottega/.test(said)), JSON.stringify(found));
  const voices = new Set(events.filter(({ type }) => type === 'begin').map(({ voice }) => voice));
  assert.ok(voices.size >= 3, [...voices].join(' ')); // Lisetta's, Anselmo's, the narrator's
  const cast = Object.fromEntries((await (await daemon.get('/v1/library/works/la-chiave/cast')).json()).cast.map((member) => [member.id, member]));
  const said = events.filter(({ type, speaker }) => type === 'word' && speaker);
  assert.ok(said.length > 10);
  for (const { speaker, head, shown } of said) assert.deepEqual([head, shown], [cast[speaker.id].head, speaker.name]);
  assert.notEqual(cast.lisetta.head, cast.anselmo.head);
});

test('stage directions and names are read by a narrator when that is chosen', async () => {
  for (const id of ['directions', 'names']) await page.check(`#${id}`);
  await page.evaluate(() => document.getElementById('passage').querySelector('h2').scrollIntoView());
  await page.goto(`${daemon.url}/library.html#la-chiave:3`);
  await page.waitForFunction(() => document.querySelector('#passage h2, #passage h3')?.textContent === 'Scena seconda');
  const { found } = await read('presa');
  assert.deepEqual(found.map(([who]) => who), ['', 'Nina', '', 'Nina']);
  assert.match(found[0][1], /Scena seconda .*Entra Nina.* Nina$/);
  assert.match(found[2][1], /piangendo/);
  await page.uncheck('#faces');
  assert.equal(await page.evaluate(() => document.getElementById('head').getAttribute('model')), null);
});

test('two who talk are shown side by side: each says its own words, and the other looks at it', async () => {
  const scene = await browser.newPage({ viewport: { width: 1200, height: 800 }, locale: 'it-IT', serviceWorkers: 'block', reducedMotion: 'no-preference' });
  scene.setDefaultTimeout(90000);
  await scene.addInitScript(() => localStorage.setItem('faccia.roles', JSON.stringify({ faces: true, pair: true, directions: false, names: false })));
  await scene.goto(`${daemon.url}/library.html#la-chiave:2`);
  await scene.waitForFunction(() => document.querySelector('#connection').dataset.state === 'open' && document.querySelectorAll('#portrait talking-head').length === 2);
  const cast = Object.fromEntries((await (await daemon.get('/v1/library/works/la-chiave/cast')).json()).cast.map((member) => [member.id, member]));
  const seats = () => scene.$$eval('#portrait talking-head', (heads) => heads.map(({ persona, model }) => [persona, model]));
  assert.deepEqual(await seats(), ['lisetta', 'anselmo'].map((id) => [id, cast[id].head])); // before anybody speaks
  assert.deepEqual(await scene.$$eval('#portrait > .who', (names) => names.map(({ textContent }) => textContent)), ['Lisetta', 'Anselmo']);
  await scene.waitForFunction(() => document.getElementById('head-partner').debug?.().connection === 'open');
  await scene.evaluate(() => {
    globalThis.seen = { lisetta: [], anselmo: [] };
    let who = null;
    const heads = document.querySelectorAll('#portrait talking-head');
    heads[0].addEventListener('speaker', ({ detail }) => (who = detail.speaker));
    heads[0].addEventListener('word', () => globalThis.seen[who]?.push({ faps: [...heads].map((head) => head.debug().fapValues), captions: [...heads].map((head) => head.shadowRoot.querySelector('.captions').textContent) }));
  });
  await scene.click('#play');
  await scene.waitForFunction(() => document.querySelector('#portrait > .who:last-child').classList.contains('speaks'));
  await scene.screenshot({ path: path.join(artefacts, 'scene.png') });
  await scene.waitForFunction(() => globalThis.seen.anselmo.length > 8);
  await scene.keyboard.press('Escape');
  const { lisetta, anselmo } = await scene.evaluate(() => globalThis.seen);
  const most = (list, of, faps) => Math.max(...list.flatMap((at) => faps.map((n) => Math.abs(at.faps[of][n]))));
  for (const [list, speaks] of [[lisetta, 0], [anselmo, 1]]) {
    const tail = list.slice(3); // after the change
    assert.ok(most(tail, speaks, [3, 4, 5, 8, 9]) > 60, 'the lips of who speaks move');
    assert.ok(most(tail, 1 - speaks, [3, 4, 5, 8, 9]) < 60, `those of the other do not: ${most(tail, 1 - speaks, [3, 4, 5, 8, 9])}`);
    const { captions } = tail.at(-1); // the other's last words have gone by then
    assert.ok(captions[speaks] && !captions[1 - speaks], JSON.stringify(captions));
  }
  const yaw = anselmo.at(-1).faps.map((faps) => faps[49] / 1745);
  assert.ok(yaw[0] > 4 && yaw[0] < 16, `Lisetta, on the left, has turned right: ${yaw}`);
  assert.ok(anselmo.at(-1).faps[0][23] > 0, 'and looks there');
  await scene.click('#roles summary');
  await scene.uncheck('#pair');
  assert.deepEqual(await scene.$$eval('#portrait talking-head', (heads) => heads.map(({ persona }) => persona)), [null]);
  await scene.close();
});

test('a weak device shows one face, which changes with who speaks', async () => {
  const cast = Object.fromEntries((await (await daemon.get('/v1/library/works/la-chiave/cast')).json()).cast.map((member) => [member.id, member]));
  for (const [memory, cores, width] of [[8, 2, 1100], [8, 8, 400]]) { // few cores, or a telephone
    const weak = await browser.newPage({ viewport: { width, height: 800 }, locale: 'it-IT', serviceWorkers: 'block', reducedMotion: 'reduce' });
    weak.setDefaultTimeout(90000);
    await weak.addInitScript(([deviceMemory, hardwareConcurrency]) => {
      for (const [name, value] of Object.entries({ deviceMemory, hardwareConcurrency })) Object.defineProperty(Navigator.prototype, name, { get: () => value });
      globalThis.shown = [];
      document.addEventListener('DOMContentLoaded', () => document.getElementById('head').addEventListener('word', ({ detail }) => {
        const heads = [...document.querySelectorAll('#portrait talking-head')].map((head) => head.getAttribute('model'));
        globalThis.shown.push([detail.speaker?.id ?? '', document.getElementById('who').textContent, heads.join(' ')].join('|'));
      }));
    }, [memory, cores]);
    await weak.goto(`${daemon.url}/library.html#la-chiave:2`);
    await weak.waitForFunction(() => document.querySelector('#connection').dataset.state === 'open' && document.querySelectorAll('#persons li').length === 6);
    assert.deepEqual(await weak.$$eval('#faces, #pair', (boxes) => boxes.map(({ checked }) => checked)), [true, false], `${cores} cores, ${width} wide`);
    await weak.click('#play');
    await weak.waitForFunction(() => ['anselmo|', 'lisetta|'].every((who) => globalThis.shown.some((one) => one.startsWith(who))));
    await weak.keyboard.press('Escape');
    const seen = new Set((await weak.evaluate(() => globalThis.shown)).filter((one) => !one.startsWith('|')));
    assert.deepEqual([...seen].sort(), ['anselmo', 'lisetta'].map((id) => `${id}|${cast[id].name}|${cast[id].head}`));
    await weak.close();
  }
});

test('an editor decides how a person speaks, hears it, and saves it beside the work', async () => {
  const edit = await browser.newPage({ viewport: { width: 1200, height: 900 }, locale: 'it-IT', serviceWorkers: 'block' });
  edit.setDefaultTimeout(90000);
  const file = path.join(folder, 'works/la-chiave.cast.json');
  const saved = async (check) => {
    await edit.click('#role button[type=submit]');
    await edit.waitForFunction(() => document.getElementById('role-news').textContent.includes('la-chiave.cast.json'));
    check(JSON.parse(fs.readFileSync(file, 'utf8')));
    await edit.evaluate(() => (document.getElementById('role-news').textContent = ''));
  };
  const castNow = async () => (await daemon.get('/v1/library/works/la-chiave/cast')).json();
  await edit.goto(`${daemon.url}/library.html#la-chiave:2`);
  await edit.waitForFunction(() => document.querySelector('#connection').dataset.state === 'open' && document.querySelectorAll('#persons li').length === 6);
  await edit.waitForFunction(() => document.getElementById('voice').options.length > 2);
  await edit.click('#roles summary');
  const before = (await castNow()).cast.find(({ id }) => id === 'anselmo');
  await edit.click('#persons li[data-who=anselmo] button');
  await edit.waitForSelector('#role:not([hidden])');
  assert.deepEqual(await edit.$eval('#role', ({ elements }) => [elements['role-voice'].value, elements['role-head'].value, elements['role-age'].value, Number(elements['role-rate'].value)]), [before.voice, before.head, 'old', before.rate]);
  const words = await edit.textContent('#role-first');
  assert.ok(words.length > 10 && before.first === words, words);
  assert.equal(await edit.getAttribute('#role-first', 'lang'), 'it');
  assert.deepEqual(await violations(edit), []);
  await edit.screenshot({ path: path.join(artefacts, 'cast-editor.png') });
  await edit.fill('#role-pitch', '0.7');
  await edit.selectOption('#role-affect', 'sadness');
  await edit.selectOption('#role-head', 'ettore');
  await edit.evaluate(() => document.getElementById('head').addEventListener('speaker', ({ detail }) => (globalThis.tried = detail.speaker)));
  await edit.click('#role-hear');
  await edit.waitForFunction(() => globalThis.tried === 'anselmo');
  await saved((text) => assert.deepEqual(text, { cast: { anselmo: { affect: 'sadness', head: 'ettore', pitch: 0.7 } } })); // only what was changed
  let after = (await castNow()).cast.find(({ id }) => id === 'anselmo');
  assert.deepEqual([after.pitch, after.affect, after.head, after.voice], [0.7, 'sadness', 'ettore', before.voice]);

  await edit.click('#persons li:last-child button');
  await edit.waitForFunction(() => document.querySelector('#role legend').textContent === 'Narratore');
  await edit.fill('#role-rate', '0.9');
  await saved((text) => assert.deepEqual([text.narrator, Object.keys(text.cast)], [{ rate: 0.9 }, ['anselmo']]));

  await edit.click('#persons li[data-who=anselmo] button');
  await edit.waitForFunction(() => document.getElementById('role-pitch').value === '0.7');
  await edit.click('#role-reset');
  await edit.waitForFunction(() => document.getElementById('role-news').textContent.includes('la-chiave.cast.json'));
  assert.deepEqual(JSON.parse(fs.readFileSync(file, 'utf8')), { narrator: { rate: 0.9 } });
  after = (await castNow()).cast.find(({ id }) => id === 'anselmo');
  assert.deepEqual([after.pitch, after.head], [before.pitch, before.head]);
  await edit.waitForFunction((head) => document.getElementById('role-head').value === head, before.head);

  fs.writeFileSync(file, '{"narrator":{"rate":0.8}}'); // another editor
  await edit.evaluate(() => {
    const ask = globalThis.fetch;
    globalThis.fetch = (address, options) => (options?.method === 'PUT' ? Promise.resolve(new Response('{"type":"error","code":"forbidden","message":"no"}', { status: 403 })) : ask(address, options));
  });
  await edit.fill('#role-pitch', '0.8');
  await edit.click('#role button[type=submit]');
  await edit.waitForSelector('#problem *');
  assert.deepEqual(JSON.parse(fs.readFileSync(file, 'utf8')), { narrator: { rate: 0.8 } });
  await edit.close();
});

test('in prose, whom the narrator names has a voice of its own if that is chosen, and the same editor', async () => {
  await page.goto(`${daemon.url}/library.html#novella:1`);
  await page.waitForFunction(() => document.querySelectorAll('#persons li').length === 3);
  assert.deepEqual(await page.$$eval('#persons li', (all) => all.map(({ dataset }) => dataset.who).sort()), ['', 'lucia', 'renzo']);
  if (!(await page.$eval('#roles', ({ open }) => open))) await page.click('#roles summary');
  assert.deepEqual(await page.$$eval('#dialogue, #directions, #names', (all) => all.map((box) => [box.id, box.checkVisibility()])), [['dialogue', true], ['directions', false], ['names', false]]);
  assert.equal(await page.textContent('[data-who=lucia]'), '«Sono io, apri»');
  assert.deepEqual((await read('Entrate')).found.map(([who]) => who), ['']);
  await page.check('#dialogue');
  await page.reload(); // from the beginning; the choice is kept
  await page.waitForFunction(() => document.querySelector('#connection').dataset.state === 'open' && document.querySelectorAll('#persons li').length === 3);
  await page.click('#roles summary');
  assert.deepEqual((await read('Entrate')).found.map(([who, words]) => [who, words.split(' ').at(-1)]), [['', 'gatto'], ['Renzo', 'là'], ['', 'rispose'], ['Lucia', 'apri'], ['', 'tacque'], ['Renzo', 'Entrate']]);
  assert.deepEqual(await violations(page), []);
  await page.click('#persons li[data-who=lucia] button');
  await page.waitForSelector('#role:not([hidden])');
  assert.match(await page.textContent('#role-first'), /Sono io/);
  await page.fill('#role-rate', '0.8');
  await page.screenshot({ path: path.join(artefacts, 'cast-prose.png') });
  await page.click('#role button[type=submit]');
  await page.waitForFunction(() => document.getElementById('role-news').textContent.includes('novella.cast.json'));
  assert.deepEqual(JSON.parse(fs.readFileSync(path.join(folder, 'works/novella.cast.json'), 'utf8')), { cast: { lucia: { rate: 0.8 } } });
  await page.uncheck('#dialogue');
});

test('the contents of a work are a tree', async () => {
  const tree = await browser.newPage({ viewport: { width: 1000, height: 700 }, locale: 'it-IT', serviceWorkers: 'block' });
  tree.setDefaultTimeout(90000);
  await tree.goto(`${daemon.url}/library.html#libro:3`);
  await tree.waitForSelector('#contents:not([hidden])');
  const read = () => tree.evaluate(() => {
    const of = (ol) => [...ol.children].map((item) => [item.firstChild.textContent, ...[...item.children].filter(({ localName }) => localName === 'ol').map(of)]);
    return of(document.querySelector('#contents ol'));
  });
  assert.deepEqual(await read(), [['Uno', [['Primo', [['Inizio']]], ['Secondo']]], ['Due']]);
  await tree.click('#contents summary');
  assert.equal(await tree.textContent('#contents [aria-current]'), 'Inizio');
  assert.deepEqual(await violations(tree), []);
  await tree.close();
});
