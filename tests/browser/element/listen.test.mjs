// SPDX-License-Identifier: GPL-3.0-or-later
// Live voices in the page: a sentence from the browser's microphone, and one that an <audio> element plays. Every /p b m/ must be closed, in the drawn
// frames and in the pixels.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before } from 'node:test';
import { launch } from '../../lib/browser.mjs';
import { build, Daemon } from '../../lib/daemon.mjs';
import { microphoneFlags } from '../../lib/microphone.mjs';
import { isClosed } from '../../lib/mouth.mjs';
import { mouthPixels } from '../../lib/mouth-pixels.mjs';
import { patient } from '../../lib/patient.mjs';
import { wavOf } from '../../lib/wav.mjs';

const SENTENCE = 'Papà beve. La mamma parla piano.', VOICE = 'festival:lp';
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
let daemon, browser, painter, screen, spoken;

before(async () => {
  const file = (name) => path.join(folder, name);
  const { status, stderr } = spawnSync(path.join(build, 'server/cli/faccia'), ['say', '-l', 'it', '-v', VOICE, '--wav', file('a.wav'), '--json', file('a.json'), SENTENCE]);
  assert.equal(status, 0, String(stderr));
  const data = fs.readFileSync(file('a.wav')), rate = data.readUInt32LE(24), samples = new Int16Array(data.buffer.slice(data.byteOffset + 44));
  spoken = { rate, samples, phones: JSON.parse(fs.readFileSync(file('a.json'))).phones };
  const padded = new Int16Array(samples.length + 2 * rate);
  padded.set(samples, rate);
  fs.writeFileSync(file('fake.wav'), wavOf(padded, rate));
  daemon = await Daemon.start();
  browser = await launch({ webgl: false, flags: microphoneFlags(file('fake.wav')) });
  painter = await launch();
  screen = await mouthPixels(painter);
});
after(async () => {
  fs.rmSync(folder, { recursive: true });
  await painter?.close();
  await browser?.close();
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});

/** Opens a page that records what it receives, and the bytes of sound it sends; plain: a browser without an audio encoder. */
async function visit({ plain = false } = {}) {
  const context = await browser.newContext();
  // In a script of the page, because evaluated code would count as a user gesture.
  await context.addInitScript(() => addEventListener('DOMContentLoaded', () => {
    const asked = customElements.whenDefined('talking-head').then(() => document.querySelector('talking-head').listen().done);
    asked.then(() => (window.early = 'heard'), (error) => (window.early = error.name));
  }));
  if (plain) await context.addInitScript(() => delete window.AudioEncoder);
  const page = await context.newPage();
  page.problems = [];
  page.sent = { codec: null, bytes: [] };
  page.on('websocket', (socket) => socket.on('framesent', ({ payload }) => {
    if (typeof payload !== 'string') page.sent.bytes.push(payload.length);
    else if (payload.includes('"voice"')) page.sent.codec = JSON.parse(payload).codec;
  }));
  page.on('pageerror', (error) => page.problems.push(String(error)));
  await page.goto(daemon.url);
  await page.waitForFunction(() => document.querySelector('talking-head').debug?.().connection === 'open');
  await page.evaluate(() => {
    window.came = { frames: [], audio: [], audioRate: 0, fps: 0, events: [] };
    const head = document.querySelector('talking-head'), { came } = window;
    for (const type of ['begin', 'end', 'error', 'warning']) head.addEventListener(type, ({ detail }) => came.events.push({ ...detail, type }));
    head.addEventListener('media', ({ detail: { fps, frames, audio, rate } }) => {
      came.fps = fps;
      came.audioRate = rate;
      came.frames.push(...frames.map((frame) => Array.from(frame)));
      if (audio) came.audio.push(...audio);
    });
  });
  return page;
}
const came = (page) => page.evaluate(() => window.came);

/** Start of the sentence in the received sound, s, by correlation of loudness. */
function found({ audio, audioRate }) {
  const loud = (samples, rate) => Array.from({ length: Math.floor((samples.length / rate) * 200) }, (_, i) => {
    const part = samples.slice(Math.floor((i * rate) / 200), Math.floor(((i + 1) * rate) / 200));
    return Math.sqrt(part.reduce((sum, x) => sum + x * x, 0) / part.length);
  });
  const a = loud(audio, audioRate), b = loud([...spoken.samples].map((x) => x / 32768), spoken.rate);
  const fit = (at) => b.reduce((sum, x, i) => sum + x * (a[at + i] ?? 0), 0) / Math.sqrt(b.reduce((sum, x, i) => sum + (a[at + i] ?? 0) ** 2, 0) + 1e-9);
  const places = Array.from({ length: Math.max(1, a.length - b.length + 20) }, (_, i) => i);
  return places.reduce((best, at) => (fit(at) > fit(best) ? at : best), 0) / 200;
}

/** Checks for each /p b m/ that a frame within 40 ms of it has closed lips. */
async function check(all) {
  const begin = found(all), { fps } = all;
  const { frames } = all;
  const phones = spoken.phones.map((p) => ({ ...p, start: p.start + begin, end: p.end + begin }));
  const bilabials = phones.filter((p) => /^[pbm]/.test(p.ipa));
  assert.ok(bilabials.length >= 6, `${bilabials.length}`);
  const around = ({ start, end }) => frames.filter((_, k) => k / fps > start - 0.04 && k / fps < end + 0.04);
  const open = bilabials.filter((p) => !around(p).some(isClosed));
  assert.deepEqual(open.map(({ ipa, start }) => `${ipa} at ${start.toFixed(2)}`), []);
  const vowels = phones.filter((p) => /^[aeo]/.test(p.ipa) && p.end - p.start > 0.06);
  const wide = vowels.filter((p) => around(p).some((f) => -(f[4] + f[5]) > 40));
  assert.ok(vowels.length >= 4 && wide.length >= 0.7 * vowels.length, `${wide.length} of ${vowels.length} vowels are open`);
  return bilabials.map(around);
}

/** Checks codec and amount of the sent sound, in blocks or packets of 20 ms. */
function checkSent({ sent }, codec, t) {
  assert.equal(sent.codec, codec);
  assert.ok(sent.bytes.length > 100, `${sent.bytes.length} messages`);
  const kilobits = (8 * sent.bytes.reduce((sum, x) => sum + x, 0)) / (20 * sent.bytes.length);
  t.diagnostic(`${codec}: ${kilobits.toFixed(1)} kbit/s`);
  if (codec === 'opus') assert.ok(kilobits < 48, `${kilobits} kbit/s of Opus`);
  else assert.ok(Math.abs(kilobits - 384) < 8, `${kilobits} kbit/s of samples`);
}

for (const codec of ['opus', 'pcm']) patient(`a sentence through the microphone moves her lips, and every /p b m/ of it is closed: ${codec}`, async (t) => {
  const page = await visit();
  await page.waitForFunction(() => window.early);
  assert.equal(await page.evaluate(() => window.early), 'NotAllowedError', 'the microphone is asked for when the user does something');
  assert.deepEqual((await came(page)).events, []);
  await page.evaluate((codec) => {
    const button = document.createElement('button');
    button.id = 'mic';
    button.style.cssText = 'position: fixed; left: 0; top: 0; z-index: 9999';
    button.textContent = 'mic';
    button.onclick = () => (window.listening = document.querySelector('talking-head').listen(null, { lang: 'it', sound: false, ...(codec === 'pcm' && { codec }) }));
    document.body.append(button);
  }, codec);
  await page.click('#mic');
  await page.evaluate(() => window.listening.caption('what a recogniser heard'));
  await page.waitForFunction(() => document.querySelector('talking-head').shadowRoot.querySelector('.captions').textContent === 'what a recogniser heard');
  const seconds = spoken.samples.length / spoken.rate + 2; // one loop of the fake microphone
  await page.waitForFunction((needed) => window.came.audio.length > needed * window.came.audioRate && window.came.audioRate, 2 * seconds + 1, { timeout: 60000 });
  await page.evaluate(() => window.listening.stop());
  const end = await page.evaluate(() => window.listening.done);
  assert.equal(end.reason, 'done');
  const all = await came(page), begin = all.events.find((e) => e.type === 'begin');
  assert.equal(begin.captions, false);
  assert.deepEqual(all.events.filter((e) => e.type === 'error'), []);
  assert.deepEqual(page.problems, []);
  checkSent(page, codec === 'pcm' ? 'pcm_s16le' : codec, t);
  await check(all);
  await page.close();
});

for (const plain of [false, true]) patient(`she follows a sound of the page: <talking-head for>, whenever it plays; in pixels, too: ${plain ? 'in a browser that codes no sound' : 'as Opus'}`, async (t) => {
  const page = await visit({ plain });
  // begins with silence, because the first moments pass before the server listens
  const address = `/v1/speech?lang=it&voice=${VOICE}&markup=ssml&text=${encodeURIComponent(`<speak><break time="2s"/>${SENTENCE}</speak>`)}`;
  await page.evaluate((src) => {
    const audio = document.createElement('audio');
    audio.id = 'sound';
    audio.controls = true;
    const track = document.createElement('track');
    track.kind = 'captions';
    track.src = URL.createObjectURL(new Blob(['WEBVTT\n\n00:00.000 --> 01:00.000\n<v Anna>Papà <b>beve</b>.'], { type: 'text/vtt' }));
    track.default = true;
    audio.append(track);
    audio.src = src;
    document.body.prepend(audio);
    document.querySelector('talking-head').setAttribute('lang', 'it');
    document.querySelector('talking-head').for = 'sound';
  }, address);
  await page.click('h1, header, main').catch(() => {});
  await page.evaluate(() => document.querySelector('#sound').play());
  await page.waitForFunction(() => document.querySelector('talking-head').shadowRoot.querySelector('.captions').textContent === 'Papà beve.');
  await page.waitForFunction(() => window.came.events.some((e) => e.type === 'end'), null, { timeout: 60000 });
  const all = await came(page);
  assert.equal(all.events.find((e) => e.type === 'end').reason, 'done');
  assert.deepEqual(all.events.filter((e) => e.type === 'error'), []);
  checkSent(page, plain ? 'pcm_s16le' : 'opus', t);
  for (const [i, shown] of (await check(all)).entries()) {
    const areas = (await screen.look(shown)).map(({ area }) => area);
    assert.ok(Math.min(...areas) < 1, `/p b m/ ${i}: ${areas.map((area) => area.toFixed(1))} mm² are open`);
  }
  assert.deepEqual(page.problems, []);
  await page.close();
});
