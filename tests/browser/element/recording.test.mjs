// SPDX-License-Identifier: GPL-3.0-or-later
// Recordings on a static site: `faccia say --bundle` writes them, <talking-head> speaks them, and no daemon runs.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { readBundle } from '../../../protocol/bundle.mjs';
import { FAP_VALUES, FaceTrack } from '../../../web/element/face/face-track.mjs';
import { launch, record } from '../../lib/browser.mjs';
import { build } from '../../lib/daemon.mjs';
import { servePages } from '../../lib/page-server.mjs';

const TEXT = 'Mamma, papà e il babbo. <mark name="poi"/> Poi la pioggia cade piano sul mare, e nessuno la sente. Buona notte a tutti quanti.';
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-recording-'));
const file = (name) => path.join(folder, name);
const say = (...args) => execFileSync(path.join(build, 'server/cli/faccia'), ['say', '--lang', 'it', ...args], { encoding: 'utf8' });
const bytesOf = (name) => ({ body: fs.readFileSync(name), type: 'application/octet-stream' });

let site, browser, recording;
before(async () => {
  say('--bundle', file('hello.faccia'), '--model-url', 'heads/mara.json', '--markup', 'ssml', `<speak>${TEXT}</speak>`);
  say('--bundle', file('whole.faccia'), '--model', 'mara', 'Io sono Mara.');
  say('--fapc', file('pair.fapc'), '--ogg', file('pair.ogg'), 'Ciao mamma.');
  recording = readBundle(fs.readFileSync(file('hello.faccia')));
  const whole = fs.readFileSync(file('hello.faccia'));
  const damaged = Buffer.from(whole);
  damaged[whole.length >> 1] ^= 1;
  const script = (name) => ({ body: fs.readFileSync(path.join(build, 'web', name)), type: 'text/javascript' });
  const page = (attributes) => '<!doctype html><html lang="it"><head><meta charset="utf-8"><link rel="icon" href="data:,"><script type="module" src="/talking-head.js"></script></head>' +
    `<body><talking-head quality="low" ${attributes}></talking-head></body></html>`;
  site = await servePages({
    ...Object.fromEntries(['talking-head.js', 'talking-head-worklet.js', 'opus-decoder.js'].map((name) => [`/${name}`, script(name)])),
    '/sounds/hello.faccia': bytesOf(file('hello.faccia')),
    '/sounds/whole.faccia': bytesOf(file('whole.faccia')),
    '/sounds/pair.fapc': bytesOf(file('pair.fapc')),
    '/sounds/pair.ogg': bytesOf(file('pair.ogg')),
    '/sounds/damaged.faccia': { body: damaged },
    '/sounds/cut.faccia': { body: whole.subarray(0, 100) },
    '/sounds/other.faccia': { body: Buffer.from('GIF89a, not a recording') },
    '/sounds/heads/mara.json': { body: fs.readFileSync(path.join(build, 'models/heads/mara.json')), type: 'application/json' },
    '/': page('src="sounds/hello.faccia"'),
    '/whole': page('src="sounds/whole.faccia"'),
    '/auto': page('src="sounds/whole.faccia" autoplay'),
    '/pair': page('src="sounds/pair.fapc" audio="sounds/pair.ogg" model="sounds/heads/mara.json"'),
    '/silent': page('src="sounds/pair.fapc" model="sounds/heads/mara.json"'),
    '/damaged': page('src="sounds/damaged.faccia"'),
    '/cut': page('src="sounds/cut.faccia"'),
    '/other': page('src="sounds/other.faccia"'),
    '/missing': page('src="sounds/missing.faccia"'),
    '/headless': page('src="sounds/hello.faccia" model="nobody.json"'),
  });
  browser = await launch();
});
after(async () => {
  await browser?.close();
  await site?.close();
  fs.rmSync(folder, { recursive: true });
});

/** Opens a page, with the events of its head in window.events, and asks for nothing but files of the site. */
async function open(where, { drawn = true, reducedMotion = 'reduce' } = {}) {
  const page = await browser.newPage({ viewport: { width: 500, height: 600 }, locale: 'it-IT', reducedMotion });
  page.asked = [];
  page.on('request', (request) => page.asked.push(request.url()));
  page.on('websocket', (socket) => page.asked.push(socket.url()));
  await page.addInitScript(() => {
    window.events = [];
    addEventListener('DOMContentLoaded', () => {
      const head = document.querySelector('talking-head');
      for (const type of ['begin', 'sentence', 'word', 'mark', 'paused', 'resumed', 'seeked', 'jumped', 'end', 'error', 'warning', 'ready', 'connection'])
        head.addEventListener(type, ({ detail }) => window.events.push({ ...detail, type, at: head.currentTime }));
    });
  });
  await page.goto(site.url + where);
  if (drawn) await page.waitForFunction(() => document.querySelector('talking-head').debug?.().frames > 0, null, { timeout: 180000 });
  return page;
}

const events = (page, ...types) => page.evaluate((wanted) => window.events.filter(({ type }) => wanted.includes(type)), types);
const until = (page, type, count = 1) => page.waitForFunction(([wanted, least]) => window.events.filter((event) => event.type === wanted).length >= least, [type, count], { timeout: 120000 });

test('speaks a recording: words come at their times, the face drawn is that of the file, closures are closed', async () => {
  const page = await open('/');
  await record(page);
  await page.getByRole('button', { name: 'Play' }).or(page.getByRole('button', { name: 'Riproduci' })).click();
  await until(page, 'end');
  const heard = await events(page, 'begin', 'sentence', 'word', 'mark', 'end');
  const log = await page.evaluate(() => {
    window.logging = false;
    return window.log;
  });
  const kinds = (list) => list.filter(({ type }) => type !== 'phone' && type !== 'speaker').map(({ type, text, name, time }) => [type, type === 'word' ? text : name, type === 'end' ? undefined : time]);
  assert.deepEqual(kinds(heard), kinds(recording.events));
  for (const { type, time, at } of heard) if (type === 'word' || type === 'mark') assert.ok(at >= time - 0.03 && at < time + 1, `${type} at ${time} came at ${at}`);
  assert.equal(heard.at(-1).reason, 'done');

  const track = new FaceTrack(recording.fps);
  track.put(0, recording.frames);
  const values = new Float32Array(FAP_VALUES);
  // from where the face has gone over to the speech
  const spoken = log.filter(({ running, frameTime, audioTime }) => running && frameTime > 0.7 && audioTime < recording.samples / 48000 - 0.3);
  assert.ok(spoken.length > 20, `${spoken.length} faces`);
  const lips = [4, 5, 51, 52]; // inner and outer, upper and lower
  for (const { frameTime, fapValues } of spoken) {
    track.sample(frameTime, values);
    for (const n of lips) assert.ok(Math.abs(fapValues[n] - values[n]) < 1, `FAP ${n} at ${frameTime}: ${fapValues[n]}, not ${values[n]}`);
  }
  const closures = recording.events.filter(({ type, ipa }) => type === 'phone' && /^[pbm]/.test(ipa));
  assert.ok(closures.length >= 8);
  for (const { time, duration, ipa } of closures) {
    const gaps = [];
    for (let t = time; t <= time + duration; t += 0.005) {
      track.sample(t, values);
      gaps.push(-values[4] - values[5]);
    }
    assert.ok(Math.min(...gaps) <= 0, `${ipa} at ${time} is open by ${Math.min(...gaps)}`);
  }
  const others = page.asked.filter((url) => !url.startsWith(`${site.url}/`) && !/^(data|blob):/.test(url));
  assert.deepEqual(others, []);
  await page.close();
});

test('pauses, goes on, seeks back and forth, jumps to a mark, stops, and speaks again', async () => {
  const page = await open('/');
  const time = () => page.evaluate(() => document.querySelector('talking-head').currentTime);
  const call = (name, ...args) => page.evaluate(([method, list]) => void document.querySelector('talking-head')[method](...list), [name, args]);
  assert.ok(Math.abs((await page.evaluate(() => document.querySelector('talking-head').duration)) - recording.samples / 48000) < 1e-6);
  await page.mouse.click(5, 590);
  await call('seek', 2);
  assert.equal(await time(), 2);
  await call('play');
  await until(page, 'word');
  const [first] = await events(page, 'word');
  assert.ok(first.time >= 2, `the first word at ${first.time}`);
  const [sentence] = await events(page, 'sentence');
  assert.ok(sentence.utf16_start <= first.utf16_start && sentence.utf16_end >= first.utf16_end, 'its sentence is told');

  await call('pause');
  await page.waitForTimeout(300);
  const held = await time();
  await page.waitForTimeout(500);
  assert.equal(await time(), held);
  await call('seek', 0.5); // while it is paused
  await call('resume');
  await page.waitForFunction(() => document.querySelector('talking-head').currentTime > 1, null, { timeout: 60000 });
  const words = (await events(page, 'word')).map(({ time: at }) => at);
  const back = words.findIndex((at, i) => i > 0 && at < words[i - 1]);
  assert.ok(back > 0 && words[back] >= 0.5 && words[back] < 1.5, `${words}`);
  assert.deepEqual((await events(page, 'paused', 'seeked', 'resumed')).map(({ type }) => type), ['seeked', 'paused', 'seeked', 'resumed']);

  await call('jump', 'poi');
  await until(page, 'mark');
  const mark = recording.events.find(({ type }) => type === 'mark');
  const [jumped] = await events(page, 'jumped');
  assert.equal(jumped.time, mark.time);
  await call('jump', 'nowhere');
  assert.deepEqual((await events(page, 'error')).map(({ code }) => code), ['unknown-mark']);

  await call('stop');
  await until(page, 'end');
  assert.equal((await events(page, 'end'))[0].reason, 'stopped');
  await call('seek', recording.samples / 48000 - 0.4);
  assert.equal((await page.evaluate(() => document.querySelector('talking-head').play())).reason, 'done');
  // the whole recording, from the start, once more; near the end all media have come, and one can still go back
  await call('play');
  await call('seek', recording.samples / 48000 - 1);
  await page.waitForFunction((end) => document.querySelector('talking-head').currentTime > end - 0.8, recording.samples / 48000, { timeout: 60000 });
  await call('seek', recording.samples / 48000 - 1.2);
  const after = await time();
  assert.ok(after < recording.samples / 48000 - 0.9, `${after}`);
  await until(page, 'end', 3);
  assert.deepEqual((await events(page, 'end')).map(({ reason }) => reason), ['stopped', 'done', 'done']);
  await page.close();
});

test('brings its own head, begins by itself, and speaks no text', async () => {
  const page = await open('/auto');
  await until(page, 'end');
  await until(page, 'ready');
  assert.deepEqual((await events(page, 'ready')).map(({ model }) => model), ['mara']);
  assert.deepEqual((await events(page, 'word')).map(({ text }) => text), ['Io', 'sono', 'Mara']);
  const refused = await page.evaluate(() => document.querySelector('talking-head').speak('Ciao'));
  assert.equal(refused.reason, 'failed');
  assert.equal((await events(page, 'error'))[0].code, 'no-server');
  await page.close();
});

test('lives on before and after it speaks: blinks, glances, and moves', async () => {
  const page = await open('/whole', { reducedMotion: 'no-preference' });
  await until(page, 'ready');
  /** The largest values of lids, gaze and head that are drawn until all have moved. */
  const lives = () => page.evaluate(async () => {
    const most = { lid: 0, gaze: 0, head: 0 };
    for (const end = Date.now() + 60000; Date.now() < end && !(most.lid > 500 && most.gaze > 5000 && most.head > 300); ) {
      await new Promise((resolve) => setTimeout(resolve, 10));
      const faps = window.log.at(-1)?.fapValues ?? [];
      most.lid = Math.max(most.lid, faps[19] ?? 0);
      most.gaze = Math.max(most.gaze, Math.abs(faps[23] ?? 0), Math.abs(faps[25] ?? 0));
      most.head = Math.max(most.head, Math.abs(faps[48] ?? 0), Math.abs(faps[49] ?? 0));
    }
    return most;
  });
  const alive = ({ lid, gaze, head }) => lid > 500 && gaze > 5000 && head > 300;
  await record(page);
  const before = await lives();
  assert.ok(alive(before), JSON.stringify(before));
  await page.mouse.click(5, 590);
  assert.equal((await page.evaluate(() => document.querySelector('talking-head').play())).reason, 'done');
  const after_ = await lives();
  assert.ok(alive(after_), JSON.stringify(after_));
  await page.close();
});

test('speaks a face and a sound in two files', async () => {
  const page = await open('/pair');
  await page.mouse.click(5, 590);
  const end = await page.evaluate(() => document.querySelector('talking-head').play());
  assert.equal(end.reason, 'done');
  assert.ok(end.duration > 0.5 && end.duration < 3);
  await page.close();
});

test('tells what is wrong with a recording, and where', async () => {
  for (const [where, code, byte, text] of [
    ['/damaged', 'bad-recording', fs.statSync(file('hello.faccia')).size - 12, /checksum/],
    ['/cut', 'bad-recording', 8, /ends within a part/],
    ['/other', 'bad-recording', 0, /FACCIA1/],
    ['/silent', 'bad-recording', 0, /attribute audio/],
    ['/missing', 'no-recording', undefined, /missing\.faccia/],
  ]) {
    const page = await open(where, { drawn: false });
    await until(page, 'error');
    const [error] = await events(page, 'error');
    assert.deepEqual([error.code, error.byte], [code, byte], where);
    assert.match(error.message, text);
    assert.match(await page.locator('talking-head .message').textContent(), text);
    const end = await page.evaluate(() => document.querySelector('talking-head').play());
    assert.deepEqual([end.reason, end.code], ['failed', 'no-recording']);
    await page.close();
  }
  const page = await open('/headless', { drawn: false });
  await until(page, 'error');
  assert.equal((await events(page, 'error'))[0].code, 'no-model');
  await page.mouse.click(5, 590);
  const end = page.evaluate(() => document.querySelector('talking-head').play());
  await until(page, 'word', 3); // it is heard and captioned all the same
  await page.evaluate(() => document.querySelector('talking-head').stop());
  assert.equal((await end).reason, 'stopped');
  await page.close();
});
