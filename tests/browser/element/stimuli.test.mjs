// SPDX-License-Identifier: GPL-3.0-or-later
// The page of the listening test, opened from disk like by listeners: sound and face are in sync, and answers are saved.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { launch } from '../../lib/browser.mjs';
import { faccia } from '../../lib/command.mjs';
import { artefacts, Daemon, root } from '../../lib/daemon.mjs';
import { servePages } from '../../lib/page-server.mjs';

const UPPER = 4;
const LOWER = 5;
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
const kit = path.join(folder, 'kit');

let daemon, browser, page;
before(async () => {
  daemon = await Daemon.start(['--origin', 'null']);
  const set = JSON.parse(fs.readFileSync(path.join(root, 'models/stimuli/pt-BR.json')));
  set.items = set.items.filter((item) => ['papa', 'lala'].includes(item.name));
  set.snrs = [-12];
  fs.writeFileSync(path.join(folder, 'set.json'), JSON.stringify(set));
  const { status, stderr } = faccia(['stimuli', '--out', kit, '--set', path.join(folder, 'set.json'), '--server', daemon.url,
    '--engine', 'dominance', '--engine', 'still', '--faces', 'head,pictures']);
  assert.equal(status, 0, stderr);
  browser = await launch();
  page = await browser.newPage({ viewport: { width: 800, height: 500 }, acceptDownloads: true });
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  await addFilm();
});
after(async () => {
  await browser?.close();
  fs.rmSync(folder, { recursive: true });
  assert.equal((await daemon.stop()).code, 0);
});

/** Adds a video of sixty pictures as a fourth mode, as an experimenter adds videos of a real speaker. */
async function addFilm() {
  const film = await page.evaluate(async () => {
    const canvas = document.createElement('canvas');
    const context = canvas.getContext('2d');
    const recorder = new MediaRecorder(canvas.captureStream(25), { mimeType: 'video/webm' });
    const parts = [];
    recorder.ondataavailable = (event) => parts.push(event.data);
    recorder.start();
    for (let i = 0; i < 60; i++) {
      context.fillRect(Math.random() * 200, 0, 20, 99);
      await new Promise(requestAnimationFrame);
    }
    recorder.stop();
    await new Promise((resolve) => (recorder.onstop = resolve));
    return Array.from(new Uint8Array(await new Blob(parts).arrayBuffer()));
  });
  fs.writeFileSync(path.join(kit, 'film.webm'), Buffer.from(film));
  changeData((data) => {
    data.modes.push({ name: 'film', kind: 'video' });
    for (const trial of data.trials.filter(({ mode }) => mode === 'audio')) data.trials.push({ ...trial, mode: 'film', video: 'film.webm' });
  });
}

/** Returns the kit's page with modified data. */
function changeData(change) {
  const place = /(<script type="application\/json" id="data">)(.*?)(<\/script>)/s;
  const file = path.join(kit, 'index.html');
  const html = fs.readFileSync(file, 'utf8').replace(place, (_, open, json, close) => {
    const data = JSON.parse(json);
    change(data);
    return open + JSON.stringify(data) + close;
  });
  fs.writeFileSync(file, html);
  return html;
}

/** Records the gap of the lips in FAP units during a word, until it can be confirmed; about two seconds. */
const watch = () => page.evaluate(async ([upper, lower]) => {
  const all = [...document.querySelectorAll('talking-head')];
  const button = document.querySelector('#answer button');
  const gaps = [];
  const video = document.querySelector('video');
  document.querySelector('#answer input[value="papa"]').click();
  const since = performance.now();
  while (button.disabled) {
    if (document.querySelector('#test').hidden) throw new Error(`interrupted: ${document.querySelector('#pause p').textContent}`);
    if (performance.now() - since > 90000) throw new Error('the word has neither ended nor been interrupted');
    const values = (all.find((one) => !one.classList.contains('away')) ?? all[0]).debug().fapValues;
    gaps.push(-(values[upper] + values[lower]));
    await new Promise(requestAnimationFrame);
  }
  const seen = all.filter((one) => !one.classList.contains('away')).map((one) => (one.debug().level === 'pictures' ? 'pictures' : 'head'));
  return { gaps, seen, filmed: !video.classList.contains('away') && video.currentTime > 0 };
}, [UPPER, LOWER]);

test('runs a listener through all blocks and analyses the answers', async () => {
  await page.goto(`file://${kit}/index.html?quality=low`);
  await page.fill('[name="listener"]', 'Anna, 1');
  await page.click('#welcome button');
  assert.equal(await page.isVisible('#welcome'), true, 'not without consent');
  await page.check('#consent input');
  await page.click('#welcome button');
  const watched = [];
  for (let block = 0; block < 5; block++) {
    await page.waitForSelector('#pause button', { timeout: 90000 });
    await page.click('#pause button');
    for (let trial = 0; trial < 2; trial++) {
      watched.push(await watch());
      assert.equal(await page.locator('#answer input').count(), 3, 'two words and "none of these"');
      if (trial === 0) {
        fs.mkdirSync(artefacts, { recursive: true });
        await page.screenshot({ path: path.join(artefacts, `stimuli-${block}.png`) });
      }
      await page.focus('#answer button');
      await page.keyboard.type('lal');
      assert.equal(await page.inputValue('[name=word]:checked'), 'lala', 'its first letters choose a word');
      await page.waitForTimeout(1100);
      await page.keyboard.type('p');
      assert.equal(await page.inputValue('[name=word]:checked'), 'papa');
      await page.keyboard.press('Enter');
    }
  }
  const [download] = await Promise.all([page.waitForEvent('download'), page.click('#done button')]);
  const file = path.join(folder, 'answers.csv');
  await download.saveAs(file);
  assert.deepEqual(page.problems, []);

  const [head, ...rows] = fs.readFileSync(file, 'utf8').trim().split('\r\n');
  assert.equal(head, 'listener,block,trial,mode,snr,item,answer,correct,seconds');
  assert.equal(rows.length, 10);
  const fields = rows.map((row) => row.match(/^"Anna, 1",(\d),(\d),(\w+),-12,(\w+),papa,([01]),[\d.]+$/));
  for (const [i, [, block, , mode, item, correct]] of fields.entries()) {
    assert.equal(Number(block), Math.floor(i / 2) + 1);
    assert.equal(correct === '1', item === 'papa');
    assert.deepEqual(watched[i].seen, { dominance: ['head'], still: ['head'], pictures: ['pictures'] }[mode] ?? []);
    assert.equal(watched[i].filmed, mode === 'film');
    if (mode !== 'dominance' && mode !== 'pictures') assert.ok(Math.max(...watched[i].gaps) <= 0, 'the face kept still');
  }
  // even with slow drawing, the mouth is seen open during two words
  assert.ok(Math.max(...watched.flatMap(({ gaps }) => gaps)) > 60, 'the mouth opened');
  const modes = fields.map((field) => field[3]);
  assert.deepEqual([...new Set(modes)].sort(), ['audio', 'dominance', 'film', 'pictures', 'still']);

  fs.writeFileSync(path.join(folder, 'other.csv'), fs.readFileSync(file, 'utf8').replaceAll('Anna', 'Bea').replace(/,1,([\d.]+\r\n)/, ',0,$1'));
  const { status, stdout } = faccia(['anova', '--csv', file, '--csv', path.join(folder, 'other.csv')]);
  assert.equal(status, 0);
  assert.match(stdout, /-12 {2}all +4 {4}5 /);
});

test('repeats a word whose sound or film stalls, then skips it', async () => {
  const html = changeData((data) => {
    data.modes = data.modes.filter(({ kind }) => kind === 'audio' || kind === 'video'); // no face, so no loading
  });
  const media = (name, type, cut) => ({ body: fs.readFileSync(path.join(kit, name)), type, cut, headers: { 'cache-control': 'no-store' } });
  const [papa, lala] = ['papa', 'lala'].map((name) => `/wav/${fs.readdirSync(path.join(kit, 'wav')).find((file) => file.startsWith(name))}`);
  const files = { '/': html, [lala]: media(lala, 'audio/wav'), [papa]: media(papa, 'audio/wav', 30000), '/film.webm': media('film.webm', 'video/webm', 200) };
  const server = await servePages(files);
  const visitor = await browser.newPage({ acceptDownloads: true });
  const told = [];
  try {
    await visitor.goto(`${server.url}/?patience=3`);
    await visitor.fill('[name="listener"]', 'Anna');
    await visitor.check('#consent input');
    await visitor.click('#welcome button');
    for (let state; state !== 'done'; ) {
      state = await visitor.waitForFunction(() => {
        if (!document.querySelector('#test').hidden) document.querySelector('#answer input[value="papa"]').click();
        return ['pause', 'done'].find((id) => !document.getElementById(id).hidden) ?? (document.querySelector('#answer button').disabled ? null : 'heard');
      }, null, { timeout: 60000 }).then((handle) => handle.jsonValue());
      const text = await visitor.textContent('#pause p');
      if (state === 'pause' && text.includes('O som ou o filme parou')) {
        told.push(text.match(/\((\S+): /)[1]);
        if (told.length === 1) await visitor.screenshot({ path: path.join(artefacts, 'stimuli-interrupted.png') });
        if (text.includes('film.webm')) delete files['/film.webm'].cut;
        if (told.filter((name) => papa.endsWith(name)).length === 3) delete files[papa].cut;
      }
      if (state === 'pause') await visitor.click('#pause button');
      if (state === 'heard') await visitor.click('#answer button');
    }
    const [download] = await Promise.all([visitor.waitForEvent('download'), visitor.click('#done button')]);
    const file = path.join(folder, 'interrupted.csv');
    await download.saveAs(file);
    const rows = fs.readFileSync(file, 'utf8').trim().split('\r\n').slice(1).map((row) => row.split(','));
    assert.ok(told.includes('film.webm') && told.includes(papa.slice(1)), `${told}`);
    assert.deepEqual(rows.filter((row) => row[6] === 'interrupted').map((row) => row.slice(5).join()), ['papa,interrupted,,']);
    assert.deepEqual(rows.filter((row) => row[6] === 'papa').map((row) => row[5]).sort(), ['lala', 'lala', 'papa']);
  } finally {
    await visitor.close();
    await server.close();
  }
});
