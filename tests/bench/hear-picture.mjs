// SPDX-License-Identifier: GPL-3.0-or-later
// Draws web/hear.webp for the README: a person's voice sent over a daemon's stream in real time, and the recognised lips. From the top: the mouth at regular
// intervals, the sound, the gap of the lips; in the background the /p b m/ found by `faccia align` with the text, which the daemon does not know.
// Needs Debian's pocketsphinx-testdata. FACCIA_BUILD=build node tests/bench/run.mjs hear-picture [OUT]
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { setTimeout as sleep } from 'node:timers/promises';
import { launch } from '../lib/browser.mjs';
import { build, Daemon, framesOf, root } from '../lib/daemon.mjs';
import { headPage } from '../lib/head-page.mjs';

const [out = path.join(root, 'web/hear.webp')] = process.argv.slice(2);
const [TEXT, SOUND] = ['He might even have been made amiable himself.', '/usr/share/pocketsphinx/test/data/librivox/sense_and_sensibility_01_austen_64kb-0930.wav'];
const [WIDTH, TILES, TILE, WAVE, GAP, MARGIN] = [1260, 14, 72, 110, 120, 24];

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-picture-'));
fs.writeFileSync(path.join(folder, 'a.txt'), TEXT);
execFileSync(path.join(build, 'server/cli/faccia'), ['align', '-q', SOUND, '--text', path.join(folder, 'a.txt'), '-l', 'en', '--json', path.join(folder, 'a.json')]);
const { phones } = JSON.parse(fs.readFileSync(path.join(folder, 'a.json')));
const wav = fs.readFileSync(SOUND), rate = wav.readUInt32LE(24), samples = new Int16Array(wav.buffer.slice(wav.byteOffset + 44, wav.byteOffset + wav.length - (wav.length % 2)));

const daemon = await Daemon.start(), stream = await daemon.stream();
stream.send({ type: 'voice', id: 'v', rate, lang: 'en', fps: 50, still: true });
const begun = performance.now();
for (let at = 0; at < samples.length;) {
  const due = Math.min(samples.length, Math.floor(((performance.now() - begun) / 1000) * rate));
  if (due > at) stream.socket.send(samples.slice(at, due));
  at = due;
  await sleep(10);
}
stream.send({ type: 'close', id: 'v' });
const end = await stream.wait({ type: 'end', id: 'v' });
const frames = framesOf(stream.chunks), heard = stream.chunks.flatMap((c) => [...c.audio]), lead = heard.findIndex((x) => x) - samples.findIndex((x) => x);
await stream.close();
await daemon.stop();
fs.rmSync(folder, { recursive: true });
// On a busy machine the daemon inserts silence or resamples.
if (end.reason !== 'done' || lead || heard.length !== samples.length) throw new Error('the sound did not come back as it went: try again');

const seconds = samples.length / rate, x = (t) => (t / seconds) * WIDTH;
const distance = ({ values }) => -((values[4] ?? 0) + (values[5] ?? 0));
const said = phones.filter(({ ipa }) => /^[pbm]/.test(ipa));
const shown = said.filter(({ start, end }) => frames.some((f) => f.time > start - 0.04 && f.time < end + 0.04 && distance(f) <= 0));
console.log(`${shown.length} of ${said.length} /p b m/ are closed, 40 ms to either side`);

const browser = await launch(), page = await headPage(browser);
const head = JSON.parse(fs.readFileSync(path.join(build, 'models/heads/mara.json')));
await page.load('head', head);
const camera = { target: [0, head.fdp['2.2'][1] - 4, head.fdp['2.2'][2] - 8], distance: 520, fov: 5.6, width: 2 * (WIDTH / TILES), height: 2 * TILE, level: 'high' };
const mouths = [];
for (let i = 0; i < TILES; i++) {
  const frame = frames.reduce((best, f) => (Math.abs(f.time - ((i + 0.5) / TILES) * seconds) < Math.abs(best.time - ((i + 0.5) / TILES) * seconds) ? f : best));
  const png = await page.shot('head', Object.fromEntries(Object.entries(frame.values)), camera);
  mouths.push(`<image x="${(i * WIDTH) / TILES + 1}" width="${WIDTH / TILES - 2}" height="${TILE}" href="data:image/png;base64,${png.toString('base64')}"/>`);
}
const top = TILE + 8, bottom = top + WAVE + GAP, step = rate / 200, loudest = samples.reduce((most, s) => Math.max(most, Math.abs(s)), 1);
const wave = Array.from({ length: Math.floor(samples.length / step) }, (_, i) => {
  const part = samples.subarray(i * step, (i + 1) * step), size = (part.reduce((most, s) => Math.max(most, Math.abs(s)), 0) / loudest) * (WAVE / 2);
  return `M${x((i * step) / rate).toFixed(1)} ${(top + WAVE / 2 - size).toFixed(1)}v${(2 * size + 0.5).toFixed(1)}`;
}).join('');
const widest = Math.max(...frames.map(distance)), y = (f) => bottom - 4 - (Math.max(0, distance(f)) / widest) * (GAP - 20);
const curve = frames.map((f, i) => `${i ? 'L' : 'M'}${x(f.time).toFixed(1)} ${y(f).toFixed(1)}`).join('');
const closed = frames.filter((f) => distance(f) <= 0).map((f) => `<rect x="${x(f.time)}" y="${bottom - 5}" width="${x(0.02) + 0.5}" height="5" fill="#b3261e"/>`).join('');
const truth = said.map(({ ipa, start, end }) => `<rect x="${x(start)}" y="${top}" width="${x(end - start)}" height="${bottom - top}" fill="#d9e4f5"/><text x="${x((start + end) / 2)}" y="${bottom + 17}" text-anchor="middle">${ipa}</text>`).join('');
const svg = `<svg xmlns="http://www.w3.org/2000/svg" width="${WIDTH}" height="${bottom + MARGIN}" font-family="sans-serif" font-size="16"><rect width="100%" height="100%" fill="#fff"/>${truth}${mouths.join('')}`
  + `<path d="${wave}" stroke="#555" stroke-width="1.5"/><path d="${curve}" fill="none" stroke="#1b5e9e" stroke-width="2.5"/>${closed}</svg>`;
const sheet = await browser.newPage();
const data = await sheet.evaluate(async ({ svg, width, height }) => {
  const canvas = document.createElement('canvas'), image = new Image();
  Object.assign(canvas, { width, height });
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(svg)}`;
  await image.decode();
  canvas.getContext('2d').drawImage(image, 0, 0);
  return canvas.toDataURL('image/webp', 0.86);
}, { svg, width: WIDTH, height: bottom + MARGIN });
fs.writeFileSync(out, Buffer.from(data.split(',')[1], 'base64'));
await browser.close();
console.log(`${out}: ${fs.statSync(out).size} bytes`);
