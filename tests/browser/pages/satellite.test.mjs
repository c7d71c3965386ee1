// SPDX-License-Identifier: GPL-3.0-or-later
// A room's page as a satellite: Chromium's microphone is a file, its sound reaches a stand-in for an assistant, which recognises it with
// pocketsphinx; the page shows the assistant's states, and its face speaks the answer.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { launch } from '../../lib/browser.mjs';
import { artefacts, build, Daemon, eventually } from '../../lib/daemon.mjs';
import { POCKETSPHINX } from '../../lib/heard-speech.mjs';
import { microphoneFlags, sayInto } from '../../lib/microphone.mjs';
import { connect } from '../../lib/wyoming-events.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-satellite-'));
const PORT = 20000 + (process.pid % 20000); // the daemon and the satellite need to know each other's
let daemon, satellite, assistant, browser, page;

before(async () => {
  sayInto(path.join(folder, 'fake.wav'), 'the second one');
  daemon = await Daemon.start(['--recogniser', `tcp://127.0.0.1:${PORT}`]);
  satellite = spawn(path.join(build, 'server/bridges/faccia-satellite'), ['--listen', String(PORT), '--room', 'kitchen', '--lang', 'en', '--url', daemon.url], { stdio: ['ignore', 'ignore', 'pipe'] });
  let log = '';
  satellite.stderr.setEncoding('utf8').on('data', (text) => (log += text));
  await eventually(() => log.includes('listening on') && log.includes('connected to the daemon'), 'the satellite');
  assistant = await connect(PORT);
  assistant.send('run-satellite');
  browser = await launch({ webgl: false, flags: microphoneFlags(path.join(folder, 'fake.wav')) });
  page = await browser.newPage({ viewport: { width: 800, height: 700 } });
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  await page.goto(`${daemon.url}/room.html?room=kitchen&lang=en`);
  await shows('idle');
});
after(async () => {
  fs.rmSync(folder, { recursive: true });
  await browser?.close();
  satellite?.kill();
  assistant?.socket.destroy();
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});
const shows = (state, more) => page.waitForFunction(([state, more]) => document.body.dataset.state === state && (more === undefined || document.querySelector('#sign .more').textContent === more), [state, more], { timeout: 60000 });
const picture = (name) => page.screenshot({ path: path.join(artefacts, `satellite-${name}.png`) });

/** What pocketsphinx hears in the sound of the last pipeline. */
async function recognise() {
  await eventually(() => assistant.events.at(-1)?.type === 'audio-stop', 'the utterance');
  const from = assistant.events.findLastIndex(({ type }) => type === 'run-pipeline');
  const sound = Buffer.concat(assistant.events.slice(from).filter(({ type }) => type === 'audio-chunk').map(({ payload }) => payload));
  return spawnSync('sh', ['-c', `cat | ${POCKETSPHINX}`], { input: sound, encoding: 'utf8' }).stdout.trim();
}

test('what is said to the page is recognised by the assistant, and the face answers', async () => {
  await page.click('#talk');
  await page.click('#ears-yes');
  await shows('listening');
  await picture('listening');
  const words = await recognise();
  assert.equal(words, 'the second one');
  assistant.send('voice-stopped', { timestamp: 1 });
  await shows('thinking');
  assistant.send('transcript', { text: words });
  await shows('thinking', words);
  await picture('thinking');
  assistant.send('synthesize', { text: 'The **second** one it is, then. It takes a while to say that.', voice: { language: 'en' } });
  const format = { rate: 22050, width: 2, channels: 1 };
  assistant.send('audio-start', format);
  assistant.send('audio-chunk', format, Buffer.alloc(4410));
  assistant.send('audio-stop');
  await shows('speaking');
  await picture('speaking');
  await assistant.heard('played');
  await shows('idle');
});

test('shows errors, timers, and that it is switched off', async () => {
  assistant.send('error', { text: 'The lamp does not answer.', code: 'intent-failed' });
  await shows('error', 'The lamp does not answer.');
  assert.equal(await page.textContent('#sign .text'), 'Something went wrong');
  await picture('error');
  await shows('idle'); // after a while
  assistant.send('timer-started', { id: 't', total_seconds: 600, name: 'pasta' });
  await page.waitForFunction(() => /^⌛ pasta \d\d:\d\d$/.test(document.querySelector('#sign .more').textContent), null, { timeout: 60000 });
  await picture('timer');
  assistant.send('timer-cancelled', { id: 't' });
  assistant.send('pause-satellite');
  await shows('muted');
  assistant.send('run-satellite');
  await shows('idle', '');
});

test('shows the head that is chosen for the room', async () => {
  const command = (head) => daemon.get('/v1/rooms/kitchen/commands', { method: 'POST', headers: { 'content-type': 'application/json' }, body: JSON.stringify({ type: 'head', head }) });
  const wears = (model) => page.waitForFunction((model) => document.getElementById('head').getAttribute('model') === model, model, { timeout: 60000 });
  assert.equal((await command('mara')).status, 202);
  await wears('mara');
  assert.equal((await command('')).status, 202);
  await wears(null);
  assert.deepEqual(page.problems, []);
});
