// SPDX-License-Identifier: GPL-3.0-or-later
// Embeds a work in a page of another origin under a strict policy: in a frame, in a sandboxed frame as WordPress makes it of a pasted link, and
// as captions of a video. The frames show text and play sound.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { launch } from '../../lib/browser.mjs';
import { Daemon, artefacts, eventually, root } from '../../lib/daemon.mjs';
import { servePages } from '../../lib/page-server.mjs';

let daemon, browser, site, folder;
before(async () => {
  site = await servePages({});
  folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-embed-'));
  daemon = await Daemon.start(['--library', path.join(root, 'models/library'), '--library-index', path.join(folder, 'index'), '--embed', site.url, '--origin', site.url, '--origin', 'null']);
  await eventually(async () => (await (await daemon.get('/v1/library')).json()).state === 'ready', 'the library to be read');
  browser = await launch({ webgl: false });
});
after(async () => {
  await browser?.close();
  await site?.close();
  assert.equal((await daemon.stop()).code, 0);
  fs.rmSync(folder, { recursive: true });
});

/** Opens the site's page with this body, under a policy that allows only frames and media of the daemon. */
async function open(body) {
  const policy = `default-src 'none'; frame-src ${daemon.url}; media-src ${daemon.url}`;
  site.files['/'] = { body: `<!doctype html><html lang="it"><title>Sito</title><body>${body}</body></html>`, headers: { 'content-security-policy': policy } };
  const page = await browser.newPage({ viewport: { width: 760, height: 820 }, locale: 'it-IT' });
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  page.on('console', (message) => message.type() === 'error' && page.problems.push(message.text()));
  await page.goto(site.url);
  return page;
}

async function readIn(page, name) {
  const frame = page.frames().find((one) => one.url().startsWith(daemon.url)) ?? await page.waitForEvent('framenavigated', (one) => one.url().startsWith(daemon.url));
  await frame.waitForSelector('[id="mare:1:l4"]');
  await frame.waitForFunction(() => document.querySelector('#connection').dataset.state === 'open');
  await frame.evaluate(() => void (window.words = []) || document.querySelector('#head').addEventListener('reading', ({ detail }) => window.words.push(detail.text)));
  await frame.click('#play');
  await frame.waitForFunction(() => window.words.includes('mare'));
  await page.screenshot({ path: path.join(artefacts, `embed-${name}.png`) });
  await frame.press('body', 'Escape');
  assert.deepEqual(page.problems, []);
  await page.close();
}

const oembed = async () => (await (await daemon.get('/oembed?url=/library/mare/1')).json()).html;

test('shows and reads the text in a frame of another origin', async () => {
  await readIn(await open(await oembed()), 'frame');
});

test('does so in a sandbox without an origin, with the fragment that WordPress appends', async () => {
  const html = await oembed();
  const sandboxed = html.replace('<iframe', '<iframe class="wp-embedded-content" sandbox="allow-scripts" security="restricted"').replace(/ src="([^"]+)"/, ' src="$1#?secret=o41vb25CJD" data-secret="o41vb25CJD"').replace(' allow="autoplay"', '');
  assert.match(sandboxed, /at=mare:1#\?secret=/);
  await readIn(await open(sandboxed), 'sandbox');
});

test('captions of a passage are cues with word times', async () => {
  const page = await open(`<video crossorigin><track default kind="captions" srclang="it" src="${daemon.url}/v1/speech?passage=mare:1&amp;format=vtt"></video>`);
  const cues = await page.evaluate(async () => {
    const element = document.querySelector('track');
    if (element.readyState !== 2) await new Promise((resolve, reject) => {
      element.addEventListener('load', resolve, { once: true });
      element.addEventListener('error', () => reject(new Error('no captions')), { once: true });
    });
    const parts = (cue) => [...cue.getCueAsHTML().childNodes].filter((node) => node.nodeName === 'timestamp' || node.target === 'timestamp').map((node) => node.data);
    return [...element.track.cues].map((cue) => ({ from: cue.startTime, to: cue.endTime, text: cue.getCueAsHTML().textContent, times: parts(cue) }));
  });
  assert.ok(cues.length > 5);
  assert.match(cues.map(({ text }) => text).join(' '), /la barca dorme legata alla riva;/);
  for (const { from, to, text, times } of cues) {
    assert.ok(to > from, text);
    assert.equal(times.length, text.trim().split(/\s+/).length - 1, text);
  }
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('a static site that follows the instructions literally shows the frame and the element under its policy', async () => {
  const guide = fs.readFileSync(path.join(root, 'web/docs/library/embedding.md'), 'utf8');
  const here = (text) => text.replaceAll('https://faccia.example.org', daemon.url).replaceAll('wss://faccia.example.org', daemon.url.replace('http', 'ws'));
  const [frame, element] = [...guide.matchAll(/```html\n([^]*?)```/g)].map(([, lines]) => here(lines));
  const [, script] = here(guide).match(/in a script of the site[,:] `([^`]+)`/);
  const [, policy] = here(guide).match(/```csp\n([^]*?)```/);
  const [, frames] = here(guide).match(/`(frame-src [^`]+)`/);
  const csp = `default-src 'none'; ${frames}; ${policy.replace(/\s+/g, ' ').replace('script-src', "script-src 'self'")}`;
  site.files['/'] = {
    body: `<!doctype html><html lang="it"><head><meta charset="utf-8"><title>Sito</title><script type="module" src="site.js"></script></head><body>
      <article id="text"><p>La mamma prepara il pane.</p></article>${element}${frame}</body></html>`,
    headers: { 'content-security-policy': csp },
  };
  site.files['/site.js'] = { body: script, type: 'text/javascript' };
  const page = await browser.newPage({ viewport: { width: 760, height: 1400 }, locale: 'it-IT' });
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  page.on('console', (message) => message.type() === 'error' && page.problems.push(message.text()));
  await page.goto(site.url);
  await page.waitForFunction(() => document.querySelector('#mara').debug?.().connection === 'open');
  await page.evaluate(() => void (window.words = []) || document.querySelector('#mara').addEventListener('reading', ({ detail }) => window.words.push(detail.text)));
  await page.click('#read');
  await page.waitForFunction(() => window.words.join(' ') === 'La mamma prepara il pane', null, { timeout: 60000 });
  assert.equal(await page.frameLocator('iframe').locator('[id="mare:1:l3"].linked').count(), 1);
  await readIn(page, 'static');
});
