// SPDX-License-Identifier: GPL-3.0-or-later
// Uses of the element by pages: before insertion, moved, removed, many at once, script loaded twice.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { launch } from '../../lib/browser.mjs';
import { artefacts, Daemon } from '../../lib/daemon.mjs';
import { servePages } from '../../lib/page-server.mjs';

let daemon, browser, server;
before(async () => {
  daemon = await Daemon.start();
  browser = await launch();
  server = await servePages({ '/': '<!doctype html><meta charset="utf-8"><title>Test</title><link rel="icon" href="data:,"><style>talking-head { inline-size: 9rem; block-size: 12rem }</style><div id="here"></div><div id="there"></div>' });
});
after(async () => {
  await browser?.close();
  await server?.close();
  assert.equal((await daemon.stop()).code, 0);
});

/** Opens an empty page with the script that counts resources of elements and records their events. */
async function open({ scripts = [`${daemon.url}/talking-head.js`] } = {}) {
  const page = await browser.newPage({ viewport: { width: 900, height: 700 } });
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  await page.addInitScript(() => {
    window.notes = [];
    window.sockets = [];
    window.audio = [];
    window.pictures = [];
    for (const type of ['begin', 'end', 'sound', 'error'])
      document.addEventListener(type, (e) => e.target.localName === 'talking-head' && window.notes.push({ on: e.target.id, type, ...e.detail }), true);
    const counted = (Class, list) => class extends Class {
      constructor(...rest) {
        super(...rest);
        list.push(this);
      }
    };
    window.WebSocket = counted(window.WebSocket, window.sockets);
    window.AudioContext = counted(window.AudioContext, window.audio);
    const { getContext } = HTMLCanvasElement.prototype;
    HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
      const context = getContext.call(this, kind, ...rest);
      if (kind === 'webgl2' && context && this.isConnected) window.pictures.push(context); // not the context that probes for WebGL
      return context;
    };
  });
  await page.goto(server.url);
  for (const url of scripts) await page.addScriptTag({ type: 'module', url });
  await page.mouse.click(5, 5); // allows sound
  await page.evaluate((src) => {
    window.src = src;
    window.make = (id, more = {}) => Object.assign(document.createElement('talking-head'), { id, src, lang: 'it', quality: 'low', ...more });
    window.after = (element, type) => new Promise((resolve) => element.addEventListener(type, resolve, { once: true }));
  }, `${daemon.url.replace('http', 'ws')}/v1/stream`);
  return page;
}

test('accepts properties and speech before it is inserted into the page', async () => {
  const page = await open();
  const { rate, end, before: early } = await page.evaluate(async () => {
    const element = window.make('a', { rate: 180, captions: 'off', expression: { joy: 0.5 } });
    element.setAttribute('rate', '200');
    element.rate = 180;
    element.pose({ 3: 100 });
    element.express({ joy: 1 });
    element.pause();
    element.resume();
    element.jump('nowhere');
    element.stop();
    const before = { captions: element.captions, faps: element.faps, state: element.debug().connection };
    const promise = element.speak('Sì.');
    document.getElementById('here').append(element);
    const begin = window.after(element, 'begin');
    return { before, rate: (await begin).detail.rate && element.rate, end: await promise };
  });
  assert.deepEqual(early, { captions: false, faps: {}, state: 'closed' });
  assert.equal(rate, 180);
  assert.equal(end.reason, 'done');
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('accepts properties before the script has loaded', async () => {
  const page = await open({ scripts: [] });
  await page.evaluate(() => {
    const element = window.make('a', { rate: 180, captions: false, still: true });
    document.getElementById('here').append(element);
  });
  await page.addScriptTag({ type: 'module', url: `${daemon.url}/talking-head.js` });
  const end = await page.evaluate(async () => {
    const element = document.querySelector('talking-head');
    const { rate, captions, still } = element;
    return { rate, captions, still, ...(await element.speak('Sì.')) };
  });
  assert.deepEqual([end.rate, end.captions, end.still, end.reason], [180, false, true, 'done']);
  await page.close();
});

test('continues speaking when moved by append, by moveBefore, or by a short removal', async () => {
  const page = await open();
  const found = await page.evaluate(async () => {
    const element = window.make('a');
    const [here, there] = ['here', 'there'].map((id) => document.getElementById(id));
    here.append(element);
    await window.after(element, 'ready');
    const speech = element.speak('Uno, due, tre, quattro.');
    await window.after(element, 'word');
    there.append(element);
    await window.after(element, 'word');
    here.moveBefore?.(element, null);
    await window.after(element, 'word');
    element.remove();
    await new Promise((resolve) => setTimeout(resolve, 20));
    there.append(element);
    const { reason } = await speech;
    return { reason, sockets: window.sockets.length, pictures: window.pictures.length, audio: window.audio.length };
  });
  assert.deepEqual(found, { reason: 'done', sockets: 1, pictures: 1, audio: 1 });
  await page.close();
});

test('releases everything when removed while speaking, and works again when reinserted', async () => {
  const page = await open();
  const found = await page.evaluate(async () => {
    const element = window.make('a');
    const here = document.getElementById('here');
    here.append(element);
    await window.after(element, 'ready');
    const speech = element.speak('Uno, due, tre, quattro, cinque, sei.');
    await window.after(element, 'word');
    element.remove();
    const { reason } = await speech;
    const closed = () => window.sockets[0].readyState === 3 && window.audio[0].state === 'closed' && window.pictures[0].isContextLost();
    while (!closed()) await new Promise((resolve) => setTimeout(resolve, 20));
    here.append(element);
    await window.after(element, 'ready');
    const again = await element.speak('Sì.');
    const { frames } = element.debug();
    while (element.debug().frames === frames) await new Promise((resolve) => setTimeout(resolve, 20)); // until it is drawn
    const message = element.shadowRoot.querySelector('.message').hidden;
    return { reason, again: again.reason, message, sockets: window.sockets.length, pictures: window.pictures.length };
  });
  assert.deepEqual(found, { reason: 'stopped', again: 'done', message: true, sockets: 2, pictures: 2 });
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('two heads speak in the order of their requests; one with polite=off does not wait', async () => {
  const page = await open();
  const order = await page.evaluate(async () => {
    const [a, b] = [window.make('a'), window.make('b')];
    document.getElementById('here').append(a, b);
    await Promise.all([a.speak('Ciao.'), b.speak('Ciao a te.'), a.speak('Addio.')]);
    const turns = window.notes.filter(({ type }) => type === 'begin' || type === 'end').map(({ on, type }) => `${on} ${type}`);
    window.notes.length = 0;
    b.polite = false;
    const speech = a.speak('Uno, due, tre, quattro, cinque.');
    await window.after(a, 'word');
    await b.speak('Sì.');
    a.stop();
    await speech;
    return { turns, talks: window.notes.filter(({ type }) => type === 'begin' || type === 'end').map(({ on, type }) => `${on} ${type}`) };
  });
  assert.deepEqual(order.turns, ['a begin', 'a end', 'b begin', 'b end', 'a begin', 'a end']);
  assert.deepEqual(order.talks, ['a begin', 'b begin', 'b end', 'a end']);
  await page.close();
});

/**
 * Opens a page that reports events by its console. Nothing may be evaluated in it, because the browser counts that as a user gesture.
 * @returns {{page: object, said: (text: string) => Promise<string>}} said: waits for a line that contains the text
 */
async function untouched(prepare = '') {
  server.files['/untouched'] = `<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,">
    <style>talking-head { inline-size: 200px; block-size: 260px; position: absolute; inset: 0 }</style>
    <script>${prepare}</script><script type="module" src="${daemon.url}/talking-head.js"></script>
    <talking-head lang="it" quality="low" captions="off" src="${daemon.url.replace('http', 'ws')}/v1/stream"></talking-head>
    <script type="module">
      const head = document.querySelector('talking-head');
      const button = head.shadowRoot.querySelector('.sound');
      head.addEventListener('sound', ({ detail }) => console.log('sound', detail.sound, detail.reason, button.hidden));
      const speak = () => head.speak('Sì.').then(({ reason, sound }) => console.log('end', reason, sound, button.hidden));
      head.addEventListener('hello', speak);
      document.addEventListener('keydown', speak);
    </script>`;
  const page = await browser.newPage({ viewport: { width: 300, height: 300 } });
  const lines = [];
  const waiters = new Set();
  page.on('console', (message) => {
    lines.push(message.text());
    for (const waiter of waiters) waiter();
  });
  await page.goto(`${server.url}/untouched`);
  const said = (text) => new Promise((resolve) => {
    const look = () => {
      const line = lines.find((one) => one.startsWith(text));
      if (line === undefined) return;
      waiters.delete(look);
      lines.splice(lines.indexOf(line), 1);
      resolve(line);
    };
    waiters.add(look);
    look();
  });
  return { page, said };
}

test('reports blocked sound before the first click, and sound after a tap', async () => {
  const { page, said } = await untouched();
  assert.equal(await said('sound'), 'sound blocked autoplay false');
  assert.equal(await said('end'), 'end done blocked false');
  await page.mouse.click(100, 230); // the button
  assert.equal(await said('sound'), 'sound on undefined true');
  await page.keyboard.press('a');
  assert.equal(await said('end'), 'end done undefined true');
  await page.close();
});

test('requests a tap only once when sound never starts', async () => {
  const { page, said } = await untouched('AudioContext.prototype.resume = () => new Promise(() => {})'); // as without a sound device
  assert.equal(await said('sound'), 'sound blocked autoplay false');
  assert.equal(await said('end'), 'end done blocked false');
  await page.mouse.click(100, 230);
  assert.equal(await said('sound'), 'sound none no-device true');
  await page.keyboard.press('a');
  assert.equal(await said('end'), 'end done none true');
  await page.close();
});

test('draws as many of twenty heads as it can; the others report why, and replace removed ones', async () => {
  const page = await open();
  await page.evaluate(() => {
    document.head.append(Object.assign(document.createElement('style'), { textContent: 'talking-head { inline-size: 5rem; block-size: 6rem; font-size: 0.5rem }' }));
    for (let i = 0; i < 20; i++) document.getElementById('here').append(window.make(`h${i}`));
  });
  const messages = () => page.evaluate(() => [...document.querySelectorAll('talking-head')].filter((element) => !element.shadowRoot.querySelector('.message').hidden).length);
  await page.waitForFunction(() => window.notes.filter(({ code }) => code === 'too-many').length === 12);
  assert.equal(await messages(), 12);
  assert.equal(await page.evaluate(() => window.pictures.filter((context) => !context.isContextLost()).length), 8);
  fs.mkdirSync(artefacts, { recursive: true });
  await page.screenshot({ path: path.join(artefacts, 'twenty.png') });
  await page.evaluate(() => [...document.querySelectorAll('talking-head')].slice(0, 10).forEach((element) => element.remove()));
  await page.waitForFunction(() => window.pictures.filter((context) => !context.isContextLost()).length === 8 && window.pictures.length > 8);
  assert.equal(await messages(), 2);
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('with scripts of two servers on one page, the first defines the element and both servers play', async () => {
  const other = await Daemon.start();
  const page = await open({ scripts: [`${daemon.url}/talking-head.js`, `${other.url}/talking-head.js`, `${daemon.url}/talking-head.js?again`] });
  const ends = await page.evaluate(async (src) => {
    const [a, b] = [window.make('a'), window.make('b', { src })];
    document.getElementById('here').append(a, b);
    return (await Promise.all([a.speak('Sì.'), b.speak('No.')])).map(({ reason }) => reason);
  }, `${other.url}/v1/stream`);
  assert.deepEqual(ends, ['done', 'done']);
  assert.deepEqual(page.problems, []);
  await page.close();
  assert.equal((await other.stop()).code, 0);
});
