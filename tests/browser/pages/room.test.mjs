// SPDX-License-Identifier: GPL-3.0-or-later
// Two pages in one room: speech from a script is heard, seen and captioned on both at the same time.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { launch, openPage } from '../../lib/browser.mjs';
import { Daemon } from '../../lib/daemon.mjs';

const sentences = ['La mamma mangia la banana.', 'Il papà beve il vino rosso della cantina.'];
let daemon, browser, pages;
before(async () => {
  daemon = await Daemon.start();
  browser = await launch({ webgl: false });
  pages = await Promise.all([1, 2].map(() => openPage(browser, daemon.url)));
  for (const page of pages) await page.setViewportSize({ width: 360, height: 480 }); // small, because both are drawn at once
});
after(async () => {
  await browser?.close();
  assert.equal((await daemon.stop()).code, 0);
});

test('two pages play the speech of their room', async () => {
  for (const page of pages)
    await page.evaluate(() => {
      const element = document.querySelector('talking-head');
      window.heard = [];
      window.shown = new Set();
      window.jaw = 0;
      const captions = element.shadowRoot.querySelector('.captions');
      new MutationObserver(() => window.shown.add(captions.textContent)).observe(captions, { subtree: true, childList: true, characterData: true });
      setInterval(() => (window.jaw = Math.max(window.jaw, element.faps[3] ?? 0)), 20);
      for (const type of ['joined', 'begin', 'word', 'end'])
        element.addEventListener(type, ({ detail }) => window.heard.push({ ...detail, type }));
      element.setAttribute('room', 'hall');
    });
  for (const page of pages) await page.waitForFunction(() => window.heard.some((e) => e.type === 'joined'));
  const answer = await daemon.get('/v1/say?room=hall&lang=it', { method: 'POST', body: sentences.join(' ') });
  assert.equal(answer.status, 202);
  for (const page of pages) await page.waitForFunction(() => window.heard.some((e) => e.type === 'end'), null, { timeout: 60000 });
  for (const page of pages) {
    const { heard, shown, jaw } = await page.evaluate(() => ({ heard: window.heard, shown: [...window.shown], jaw: window.jaw }));
    const words = heard.filter((e) => e.type === 'word');
    assert.deepEqual(words.map((w) => w.text), sentences.join(' ').replace(/\./g, '').split(' '));
    assert.equal(heard.at(-1).reason, 'done');
    for (const sentence of sentences) assert.ok(shown.includes(sentence), `${sentence} is not among ${shown.join(' | ')}`);
    assert.ok(jaw > 50, `the jaw moved by ${jaw}`);
    assert.deepEqual(page.problems, []);
  }
});
