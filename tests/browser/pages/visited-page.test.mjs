// SPDX-License-Identifier: GPL-3.0-or-later
// Requests that a visited web page can make Chromium send to a daemon on the user's machine.
import assert from 'node:assert/strict';
import http from 'node:http';
import { after, before, test } from 'node:test';
import { launch } from '../../lib/browser.mjs';
import { Daemon } from '../../lib/daemon.mjs';

let browser, daemon, visited;
before(async () => {
  // both names resolve to this machine, as a router's or an attacker's name may
  browser = await launch({ webgl: false, flags: ['--host-resolver-rules=MAP evil.example 127.0.0.1,MAP face.example 127.0.0.1'] });
  daemon = await Daemon.start(['--host-name', 'face.example']);
  visited = http.createServer((_, response) => response.writeHead(200, { 'content-type': 'text/html' }).end('<!DOCTYPE html><title>Elsewhere</title>'));
  await new Promise((resolve) => visited.listen(0, '127.0.0.1', resolve));
});
after(async () => {
  await browser.close();
  visited.close();
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});

/** Lets a page of another origin load the address as image, sound, script, frame, form and with fetch. Returns the statuses. */
async function embedded(address) {
  const page = await browser.newPage();
  const answers = [];
  page.on('response', (response) => response.url().startsWith(address) && answers.push(response.status()));
  await page.goto(`http://evil.example:${visited.address().port}/`);
  const asked = await page.evaluate(async (url) => {
    const settled = (element) => new Promise((resolve) => {
      for (const event of ['load', 'error', 'loadeddata']) element.addEventListener(event, () => resolve(event));
      setTimeout(resolve, 3000, 'nothing');
    });
    for (const [name, attribute] of [['img', 'src'], ['audio', 'src'], ['script', 'src'], ['iframe', 'src']]) {
      const element = document.createElement(name);
      const done = settled(element);
      element[attribute] = url;
      document.body.append(element);
      element.load?.();
      await done;
    }
    await fetch(url, { mode: 'no-cors' }).catch(() => {});
    await fetch(url, { method: 'POST', mode: 'no-cors', body: 'Ciao.' }).catch(() => {});
    await fetch(url, { method: 'POST', mode: 'no-cors', body: new URLSearchParams({ text: 'Ciao.' }) }).catch(() => {});
    navigator.sendBeacon(url, 'Ciao.');
    return 8;
  }, address);
  await page.waitForTimeout(300);
  await page.close();
  return { asked, answers };
}

for (const host of ['0.0.0.0', '[::ffff:7f00:1]', '127.0.0.1', 'localhost', 'face.example', 'evil.example'])
  test(`by ${host}: does not speak for a page of another origin`, async () => {
    const counted = async () => [await daemon.metric('faccia_sentences_asked_total'), await daemon.metric('faccia_refused_total{why="origin"}')];
    const [spoken, refused] = await counted();
    const { asked, answers } = await embedded(`http://${host}:${daemon.port}/v1/speech?text=Ciao&lang=it`);
    const [spokenNow, refusedNow] = await counted();
    assert.equal(spokenNow, spoken);
    assert.ok(refusedNow >= refused + asked, `${asked} were to be refused, ${refusedNow - refused} were`);
    assert.deepEqual(answers.filter((status) => status < 400), [], String(answers));
  });

test('plays the same sound on a page of the daemon itself', async () => {
  const page = await browser.newPage();
  await page.goto(`${daemon.url}/`);
  const status = await page.evaluate(async () => (await fetch('/v1/speech?text=Ciao&lang=it')).status);
  assert.equal(status, 200);
  await page.close();
});
