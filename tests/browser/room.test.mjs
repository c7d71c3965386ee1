// SPDX-License-Identifier: GPL-3.0-or-later
// Two pages in one room: what a script says there is heard, seen and captioned on both, at the same time.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { launch, openPage } from '../lib/browser.mjs';
import { Daemon } from '../lib/daemon.mjs';

let daemon, browser, pages;
before(async () => {
  daemon = await Daemon.start();
  browser = await launch();
  pages = await Promise.all([1, 2].map(() => openPage(browser, daemon.url)));
});
after(async () => {
  await browser?.close();
  assert.equal((await daemon.stop()).code, 0);
});

test('two pages hear what is said in their room', async () => {
  for (const page of pages)
    await page.evaluate(() => {
      const element = document.querySelector('talking-head');
      window.heard = [];
      window.shown = new Set();
      setInterval(() => window.shown.add(element.shadowRoot.querySelector('.captions').textContent), 50);
      for (const type of ['joined', 'begin', 'word', 'end'])
        element.addEventListener(type, ({ detail }) => {
          window.heard.push({ ...detail, type, jaw: element.faps[3] ?? 0 });
        });
      element.setAttribute('room', 'hall');
    });
  for (const page of pages) await page.waitForFunction(() => window.heard.some((e) => e.type === 'joined'));
  const answer = await daemon.get('/v1/say?room=hall&lang=it', { method: 'POST', body: 'La mamma mangia la banana. Il papà beve.' });
  assert.equal(answer.status, 202);
  for (const page of pages) await page.waitForFunction(() => window.heard.some((e) => e.type === 'end'), null, { timeout: 60000 });
  for (const page of pages) {
    const { heard, shown } = await page.evaluate(() => ({ heard: window.heard, shown: [...window.shown] }));
    const words = heard.filter((e) => e.type === 'word');
    assert.deepEqual(words.map((w) => w.text), ['La', 'mamma', 'mangia', 'la', 'banana', 'Il', 'papà', 'beve']);
    assert.equal(heard.at(-1).reason, 'done');
    for (const sentence of ['La mamma mangia la banana.', 'Il papà beve.']) assert.ok(shown.includes(sentence), sentence);
    assert.ok(words.some((w) => w.jaw > 50), 'the jaw moved');
    assert.deepEqual(page.problems, []);
  }
});
