// SPDX-License-Identifier: GPL-3.0-or-later
// Lighthouse on the ten pages, as a desktop and as a phone: accessibility, best practices, SEO (each of 100), and the cumulative layout shift; then what it found.
// FACCIA_BUILD=build node tests/bench/run.mjs lighthouse [PAGE]...
import fs from 'node:fs';
import net from 'node:net';
import os from 'node:os';
import path from 'node:path';
import lighthouse, { desktopConfig } from 'lighthouse';
import { launch } from '../lib/browser.mjs';
import { Daemon, eventually, root } from '../lib/daemon.mjs';

const PAGES = {
  speak: '', library: 'library.html#mare:1', examples: 'examples.html', room: 'room.html?room=kitchen', operator: 'operator.html?room=kitchen&name=Anna', emotion: 'emotion.html',
  voices: 'voices.html', avatar: 'avatar.html', player: 'player.html', editor: 'editor.html',
};
const CATEGORIES = ['accessibility', 'best-practices', 'seo'];
const SHIFT = 'cumulative-layout-shift';

/** A port that is free now; Lighthouse speaks to the browser over it. */
async function freePort() {
  const server = net.createServer().listen(0, '127.0.0.1');
  await new Promise((resolve) => server.on('listening', resolve));
  const { port } = server.address();
  await new Promise((resolve) => server.close(resolve));
  return port;
}

const wanted = process.argv.slice(2);
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-lighthouse-'));
const daemon = await Daemon.start(['--library', path.join(root, 'models/library'), '--library-index', path.join(folder, 'index')]);
await eventually(async () => (await (await daemon.get('/v1/library')).json()).state === 'ready', 'the library to be read');
const port = await freePort();
const browser = await launch({ flags: [`--remote-debugging-port=${port}`] });
const found = [];
console.log('| page | screen | accessibility | best practices | SEO | layout shift |\n|---|---|---|---|---|---|');
for (const name of wanted.length ? wanted : Object.keys(PAGES))
  for (const [screen, config] of [['desktop', desktopConfig], ['phone', undefined]]) {
    const { lhr } = await lighthouse(`${daemon.url}/${PAGES[name]}`, { port, logLevel: 'error', throttlingMethod: 'provided', onlyCategories: CATEGORIES, onlyAudits: [SHIFT] }, config);
    const scores = CATEGORIES.map((category) => Math.round(100 * lhr.categories[category].score));
    console.log(`| ${name} | ${screen} | ${scores.join(' | ')} | ${(lhr.audits[SHIFT].numericValue ?? NaN).toFixed(3)} |`);
    for (const category of CATEGORIES)
      for (const { id, weight } of lhr.categories[category].auditRefs) {
        const { score, title, details } = lhr.audits[id];
        if (!weight || score === null || score >= 1) continue;
        found.push(`${name}, ${screen}: ${id}: ${title}`, ...(details?.items ?? []).map((item) => `    ${item.node?.snippet ?? item.description ?? JSON.stringify(item).slice(0, 300)}`));
      }
    if (lhr.runtimeError) found.push(`${name}, ${screen}: ${lhr.runtimeError.message}`);
  }
console.log(found.length ? `\n${found.join('\n')}` : '\nNothing was found.');
await browser.close();
await daemon.stop();
fs.rmSync(folder, { recursive: true });
