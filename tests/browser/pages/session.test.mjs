// SPDX-License-Identifier: GPL-3.0-or-later
// A recording session from the page to files that fit, speaker and make-set take: a browser with a camera and a microphone of its own, whose
// sound is a voice that says the item.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { mouthsIn } from '../../../models/tools/session/mouths.mjs';
import { findTone } from '../../../models/tools/session/tone.mjs';
import { launch } from '../../lib/browser.mjs';
import { faccia } from '../../lib/command.mjs';
import { artefacts, root } from '../../lib/daemon.mjs';
import { microphoneFlags } from '../../lib/microphone.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-session-'));
const file = (name) => path.join(folder, name);
after(() => fs.rmSync(folder, { recursive: true }));
const run = (...args) => faccia(['session', ...args]);
const programs = (name) => spawnSync(name, ['-version']).status === 0;

let browser, page;
before(async () => {
  assert.equal(faccia(['say', '--lang', 'pt-BR', '--wav', file('papa.wav'), 'papa, papa, papa.']).status, 0);
  browser = await launch({ webgl: false, flags: [...microphoneFlags(file('papa.wav')), '--autoplay-policy=no-user-gesture-required'] });
  page = await browser.newPage({ acceptDownloads: true });
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
});
after(() => browser?.close());

test('has the lists of the theses, as pages', () => {
  for (const [list, count] of [['pt-logatomes', 138], ['pt-sentences', 27], ['it-vcv', 105], ['tr-words', 14]]) {
    const { status, stdout, stderr } = run('--list', list, '-o', file(`${list}.html`));
    assert.equal(status, 0, stderr);
    assert.match(stdout, new RegExp(`: ${count} items`));
    assert.ok(!fs.readFileSync(file(`${list}.html`), 'utf8').includes('{{'));
  }
  fs.writeFileSync(file('lines.txt'), 'Uno.\n\nDue </script>.\n');
  assert.equal(run('--lines', file('lines.txt'), '--lang', 'it', '-o', file('lines.html')).status, 0);
  assert.equal(fs.readFileSync(file('lines.html'), 'utf8').match(/<\/script>/g).length, 2);
});

test('every Italian item has the phones that it shows', () => {
  const { items } = JSON.parse(fs.readFileSync(path.join(root, 'models/sessions/it-vcv.json'), 'utf8'));
  assert.equal(new Set(items.map(({ ipa }) => ipa)).size, 105);
  for (const { name, ipa } of items) assert.equal([...ipa][1], name[0], name);
});

const saved = []; // names of files
/** Clicks or types, and saves what is downloaded by it. */
async function download(work) {
  const [one] = await Promise.all([page.waitForEvent('download'), work()]);
  saved.push(one.suggestedFilename());
  await one.saveAs(file(`takes/${one.suggestedFilename()}`));
}

test('prompts, records with a tone, repeats and goes back, by keyboard', async () => {
  const list = { lang: 'pt-BR', title: 'Sessão', items: [{ name: 'papa', text: 'papa', note: 'devagar' }, { name: 'papi', text: 'papi' }] };
  fs.writeFileSync(file('list.json'), JSON.stringify(list));
  assert.equal(run('--list', file('list.json'), '-o', file('page.html')).status, 0);
  await page.goto(`file://${file('page.html')}?download`);
  await page.fill('[name=speaker]', 'Ana');
  await page.click('#welcome button');
  assert.equal(await page.isVisible('#session'), false, 'not without consent');
  await page.check('[name=consent]');
  await page.click('#welcome button');
  await page.waitForSelector('#session:not([hidden])');
  const press = (key) => page.keyboard.press(key);
  const take = async (key = ' ') => {
    await press(key);
    await page.waitForSelector('body.recording');
    await page.waitForTimeout(4000); // of recording
    await download(() => press(' '));
    await page.waitForSelector('body:not(.recording)');
  };
  assert.equal(await page.textContent('#text'), 'papa');
  assert.equal(await page.isDisabled('#repeat'), true);
  await take();
  await take('r');
  await press('ArrowRight');
  assert.equal(await page.textContent('#text'), 'papi');
  await take();
  await press('ArrowLeft');
  assert.match(await page.textContent('#count'), /Item 1 de 2, tomada 3/);
  fs.mkdirSync(artefacts, { recursive: true });
  await page.screenshot({ path: path.join(artefacts, 'session.png') });
  await download(() => page.click('#end'));
  assert.match(await page.textContent('#state'), /Todos os itens/);
  assert.deepEqual(saved, ['papa-1.webm', 'papa-2.webm', 'papi-1.webm', 'session.json']);
  assert.deepEqual(page.problems, []);
  const { takes } = JSON.parse(fs.readFileSync(file('takes/session.json'), 'utf8'));
  assert.deepEqual(takes.map(({ file: name, kept, speaker, text }) => [name, kept, speaker, text]), [['papa-1.webm', false, 'Ana', 'papa'], ['papa-2.webm', true, 'Ana', 'papa'], ['papi-1.webm', true, 'Ana', 'papi']]);
});

test('the takes become films, sounds, words, phones and mouths', { skip: !programs('ffmpeg') && 'ffmpeg is not installed' }, () => {
  const { status, stdout, stderr } = run('--cut', file('takes'), '-o', file('cut'), '--mouths', file('mouths'));
  assert.equal(status, 0, stderr);
  assert.deepEqual(stdout.trim().split('\n').map((line) => line.split(':')[0]), ['papa-2.webm', 'papi-1.webm'], 'the rejected take is left out');
  for (const ending of ['mp4', 'wav', 'txt', 'TextGrid', 'json']) assert.ok(fs.statSync(file(`cut/papa-2.${ending}`)).size, ending);
  const pcm = execFileSync('ffmpeg', ['-v', 'error', '-i', file('cut/papa-2.wav'), '-ar', '16000', '-f', 's16le', '-']);
  const samples = new Int16Array(pcm.buffer.slice(pcm.byteOffset, pcm.byteOffset + (pcm.length & ~1)));
  assert.equal(findTone(samples, 16000), null, 'the tone is cut off');
  assert.ok(samples.length / 16000 > 2 && samples.length / 16000 < 3.8, `${samples.length / 16000} s of about 3.1`);
  const [video, audio] = ['v', 'a'].map((stream) => Number(execFileSync('ffprobe', ['-v', 'error', '-select_streams', stream, '-show_entries', 'stream=duration', '-of', 'csv=p=0', file('cut/papa-2.mp4')]).toString()));
  assert.ok(Math.abs(video - audio) < 0.25, `film ${video} s, its sound ${audio} s`);
  // a TextGrid as faccia reads it
  const again = faccia(['align', '--lang', 'pt-BR', '--timing', file('cut/papa-2.TextGrid'), '--text', file('cut/papa-2.txt'), '--json', '-', file('cut/papa-2.wav')]);
  assert.equal(again.status, 0, again.stderr);
  const times = ({ phones }) => phones.filter(({ ipa }) => ipa).map(({ ipa, start }) => `${ipa} ${start.toFixed(2)}`);
  assert.deepEqual(times(JSON.parse(again.stdout)), times(JSON.parse(fs.readFileSync(file('cut/papa-2.json'), 'utf8'))));
  const mouths = fs.readdirSync(file('mouths'));
  for (const name of ['p1.png', 'p1-2.png', 'a.png', 'ah.png', 'ih.png']) assert.ok(mouths.includes(name), `${name} in ${mouths}`);
});

test('finds the context visemes of the thesis', () => {
  const word = (...phones) => mouthsIn(phones.map((ipa, i) => ({ ipa, start: i, end: i + 1 }))).map(({ viseme }) => viseme).join(' ');
  assert.equal(word('', 'p', 'a', 'p', 'ɐ'), 'p1 a p1 ah rest');
  assert.equal(word('f', 'u', 'f', 'i'), 'f2 u f2 ih');
  assert.equal(word('l', 'i', 'l', 'ʊ'), 'l1 i1 l4 uh');
  assert.equal(word('ʎ', 'a', 'ʎ', 'u'), 'lh1 a lh3 uh');
  assert.equal(word('t', 'i', 't', 'a'), 't1 i2 t1 ah');
  assert.equal(word('ʃ', 'u', 'ʃ', 'u'), 'sh2 u sh2 uh');
  assert.equal(word('ɛ', 'i'), 'eh ih');
});

test('refuses what it cannot use, with its place', () => {
  const list = (change) => fs.writeFileSync(file('bad.json'), JSON.stringify({ lang: 'it', items: [{ name: 'a', text: 'a' }], ...change }));
  for (const [change, message] of [
    [{ items: [] }, /bad\.json: no items/],
    [{ items: [{ name: '../a', text: 'a' }] }, /items\[0\]: the name must be letters/],
    [{ items: [{ name: 'a', text: 'a' }, { name: 'a', text: 'b' }] }, /items\[1\]: the name 'a' occurs twice/],
    [{ items: [{ name: 'a', text: ' ' }] }, /items\[0\]: a text/],
    [{ lang: 'italiano!' }, /lang: a language tag/],
    [{ repetitions: 0 }, /repetitions: 1 to 50/],
  ]) {
    list(change);
    const { status, stderr } = run('--list', file('bad.json'), '-o', file('bad.html'));
    assert.equal(status, 1);
    assert.match(stderr, message);
  }
  for (const [args, wanted, message] of [
    [[], 2, /one of --list, --lines and --cut/],
    [['--list', 'nowhere', '-o', file('x')], 1, /there is no list 'nowhere'; there are it-vcv/],
    [['--list', 'it-vcv'], 2, /--output/],
    [['--lines', file('lines.txt'), '-o', file('x')], 2, /--lang/],
    [['--cut', folder, '-o', file('x')], 1, /session\.json: there is none/],
  ]) {
    const { status, stderr } = run(...args);
    assert.equal(status, wanted, stderr);
    assert.match(stderr, message);
  }
  fs.mkdirSync(file('other'), { recursive: true });
  fs.writeFileSync(file('other/session.json'), JSON.stringify({ lang: 'it', takes: [{ file: '../a.webm', text: 'a' }] }));
  assert.match(run('--cut', file('other'), '-o', file('x')).stderr, /takes\[0\]: file: NAME\.webm/);
});
