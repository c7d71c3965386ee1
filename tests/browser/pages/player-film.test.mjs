// SPDX-License-Identifier: GPL-3.0-or-later
// The Face Player films what it shows, in the browser: every frame once, with its sound; a film can be stopped.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { launch } from '../../lib/browser.mjs';
import { artefacts, Daemon } from '../../lib/daemon.mjs';

const FLAGS = Array(68).fill(1).map((_, i) => Number(i === 2)).join(' '); // open_jaw
const [FRAMES, OPEN, RATE] = [20, 12, 8000]; // the jaw opens at frame 12
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'player-film-'));
let daemon, browser, page;
before(async () => {
  daemon = await Daemon.start();
  browser = await launch();
  page = await browser.newPage({ locale: 'it-IT' });
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  await page.goto(`${daemon.url}/player.html`);
  await page.waitForFunction(() => document.querySelector('#head').debug?.().connection === 'open' && document.querySelector('#credits').textContent, null, { timeout: 120000 });
});
after(async () => {
  await browser?.close();
  fs.rmSync(folder, { recursive: true });
  assert.equal((await daemon.stop()).code, 0);
});

/** A tone of mono, 16 bits. */
function wav(seconds) {
  const samples = Math.round(seconds * RATE);
  const bytes = Buffer.alloc(44 + 2 * samples);
  bytes.write('RIFF\0\0\0\0WAVEfmt ');
  bytes.writeUInt32LE(36 + 2 * samples, 4);
  for (const [at, value] of [[16, 16], [24, RATE], [28, 2 * RATE], [40, 2 * samples]]) bytes.writeUInt32LE(value, at);
  for (const [at, value] of [[20, 1], [22, 1], [32, 2], [34, 16]]) bytes.writeUInt16LE(value, at);
  bytes.write('data', 36);
  for (let k = 0; k < samples; k++) bytes.writeInt16LE(Math.round(9000 * Math.sin((2 * Math.PI * 440 * k) / RATE)), 44 + 2 * k);
  return bytes;
}

const decode = (args) => {
  const { status, stdout, stderr } = spawnSync('ffmpeg', ['-v', 'error', ...args], { maxBuffer: 1 << 30 });
  assert.equal(status, 0, String(stderr));
  return stdout;
};

test('downloads a film of the face and its sound', async () => {
  const fap = `2.1 mio 25 ${FRAMES}\n${Array.from({ length: FRAMES }, (_, k) => `${FLAGS}\n${k} ${k < OPEN ? 0 : 700}\n`).join('')}`;
  await page.setInputFiles('#files', [
    { name: 'mio.fap', mimeType: 'text/plain', buffer: Buffer.from(fap) }, { name: 'mio.wav', mimeType: 'audio/wav', buffer: wav(FRAMES / 25) },
  ]);
  await page.waitForFunction((n) => document.querySelector('#scrub').max === String(n - 1), FRAMES);
  const downloaded = page.waitForEvent('download', { timeout: 400000 });
  downloaded.catch(() => {}); // told below
  await page.click('#film-make');
  assert.equal(await page.textContent('#film-make'), 'Interrompi il filmato');
  await page.waitForFunction(() => document.querySelector('#film-make').textContent === 'Scarica un filmato', null, { timeout: 400000 });
  assert.equal(await page.textContent('#problem'), '');
  const film = await downloaded;
  assert.match(film.suggestedFilename(), /^mio\.(mp4|webm)$/);
  const file = path.join(folder, film.suggestedFilename());
  await film.saveAs(file);
  fs.copyFileSync(file, path.join(artefacts, `player-film${path.extname(file)}`));
  const all = decode(['-i', file, '-fps_mode', 'passthrough', '-f', 'rawvideo', '-pix_fmt', 'gray', '-']);
  const shown = Array.from({ length: all.length / 640 / 480 }, (_, k) => all.subarray(k * 640 * 480, (k + 1) * 640 * 480));
  assert.equal(shown.length, FRAMES);
  const apart = (a, b) => a.reduce((sum, value, i) => sum + Math.abs(value - b[i]), 0) / a.length;
  const steps = shown.slice(1).map((picture, k) => apart(picture, shown[k]));
  assert.equal(steps.indexOf(Math.max(...steps)), OPEN - 1, `${steps}`);
  const [dark, bright, face] = [[20, 240], [620, 240], [320, 240]].map(([x, y]) => shown[0][640 * y + x]);
  assert.ok(dark > 50 && bright > dark + 10 && face > dark + 30, `a face before its room, lighter on the window's side: ${dark}, ${bright}, ${face}`);
  const sound = decode(['-i', file, '-ac', '1', '-ar', String(RATE), '-f', 's16le', '-']);
  const loud = Math.sqrt(Array.from({ length: sound.length / 2 }, (_, k) => sound.readInt16LE(2 * k) ** 2).reduce((a, b) => a + b) / (sound.length / 2));
  assert.ok(Math.abs(sound.length / 2 / RATE - FRAMES / 25) < 0.15 && loud > 4000 && loud < 9000, `${sound.length} ${loud}`);
  assert.deepEqual(page.problems, []);
});

test('stops a film', async () => {
  let downloads = 0;
  page.on('download', () => downloads++);
  await page.click('#film-make');
  await page.waitForFunction(() => document.querySelector('#film-progress').value > 0, null, { timeout: 400000 });
  await page.click('#film-make');
  await page.waitForFunction(() => document.querySelector('#film-make').textContent === 'Scarica un filmato', null, { timeout: 100000 });
  assert.deepEqual([await page.textContent('#news'), await page.textContent('#problem'), downloads], ['', '', 0]);
});

test('a browser without coders says so', async () => {
  await page.evaluate(() => (globalThis.VideoEncoder = undefined));
  await page.click('#film-make');
  await page.waitForFunction(() => document.querySelector('#problem').textContent, null, { timeout: 100000 });
  assert.match(await page.textContent('#problem'), /non sa fare filmati/);
});
