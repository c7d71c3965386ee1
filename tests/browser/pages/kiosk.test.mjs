// SPDX-License-Identifier: GPL-3.0-or-later
// The page of a room on wall screens: answers are reachable, and it recovers from network failures.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import http from 'node:http';
import net from 'node:net';
import { once } from 'node:events';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { launch } from '../../lib/browser.mjs';
import { artefacts, build, Daemon, eventually } from '../../lib/daemon.mjs';

const SCREENS = [[800, 480], [640, 360], [480, 800], [1280, 400], [320, 568], [320, 480]];
const long = (n) => `${n}. Una risposta piuttosto lunga, come ne scrive chi non ha mai visto uno schermo piccolo`;
const OFFERS = {
  two: { question: 'Viene?', choices: ['Sì', 'No'] },
  eight: { question: 'Che cosa desidera?', choices: ['Uno', 'Due', 'Tre', 'Quattro', 'Cinque', 'Sei', 'Sette', 'Otto'] },
  long: { question: 'Che cosa desidera? '.repeat(20).trim(), choices: [1, 2, 3, 4, 5, 6, 7, 8].map(long) },
  word: { question: 'Parola', choices: ['Precipitevolissimevolmente'.repeat(6), 'No'] },
};
const TOUCH = 44; // minimum size of a touch target, CSS pixels

/** A proxy between browser and daemon that can be taken down and restored at the same address. */
class Network {
  #sockets = new Set();
  #server = null;

  async begin(to, port = 0) {
    this.#server = net.createServer((from) => {
      const onward = net.connect(Number(new URL(to).port), '127.0.0.1');
      for (const socket of [from, onward]) {
        this.#sockets.add(socket);
        socket.on('error', () => {});
        socket.on('close', () => {
          this.#sockets.delete(socket);
          from.destroy();
          onward.destroy();
        });
      }
      from.pipe(onward).pipe(from);
    }).listen(port, '127.0.0.1');
    await once(this.#server, 'listening');
    this.port = this.#server.address().port;
    this.url = `http://127.0.0.1:${this.port}`;
  }

  async end() {
    this.#server.close();
    for (const socket of this.#sockets) socket.destroy();
    await once(this.#server, 'close');
  }
}

let daemon, browser, script;
const network = new Network();
before(async () => {
  daemon = await Daemon.start();
  browser = await launch({ webgl: false });
  await network.begin(daemon.url);
  script = await daemon.stream('?room=atrio&watch=1');
});
after(async () => {
  await script?.close();
  await browser?.close();
  await network.end();
  assert.equal((await daemon.stop()).code, 0);
});

/** Opens the room's page through the proxy and waits until it is connected. */
async function open(context) {
  const page = await (context ?? browser).newPage(context ? undefined : { locale: 'it-IT' });
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(String(error)));
  page.on('console', (message) => message.type() === 'error' && page.problems.push(message.text()));
  await page.goto(`${network.url}/room.html?room=atrio`);
  await page.waitForFunction(() => document.body.dataset.state === 'idle', null, { timeout: 60000 });
  return page;
}

/** Positions of the answers, each after scrolling to it in its scrollable container. */
const reach = (page) => page.evaluate(() => {
  const inside = (box) => box.left >= -0.5 && box.top >= -0.5 && box.right <= innerWidth + 0.5 && box.bottom <= innerHeight + 0.5;
  const scrolls = (element) => {
    for (let at = element.parentElement; at; at = at.parentElement)
      if (/auto|scroll/.test(getComputedStyle(at).overflowY) && at.scrollHeight > at.clientHeight + 1) return at;
    return null;
  };
  const found = [];
  for (const button of document.querySelectorAll('#question .answers button')) {
    const box = scrolls(button);
    if (box) box.scrollTop += button.getBoundingClientRect().top - box.getBoundingClientRect().top;
    const rect = button.getBoundingClientRect();
    const frame = box?.getBoundingClientRect();
    // an answer taller than its container is only partly visible
    const seen = frame ? { left: rect.left, right: rect.right, top: Math.max(rect.top, frame.top), bottom: Math.min(rect.bottom, frame.bottom) } : rect;
    const at = document.elementFromPoint((seen.left + seen.right) / 2, (seen.top + seen.bottom) / 2);
    found.push({ inside: inside(seen), frame: !frame || inside(frame), height: seen.bottom - seen.top, width: seen.right - seen.left, hit: at === button });
    if (box) box.scrollTop = 0;
  }
  const face = document.querySelector('talking-head').getBoundingClientRect();
  return { found, shifted: [scrollY, document.body.scrollTop, document.querySelector('main').scrollTop], what: inside(document.querySelector('#question .what').getBoundingClientRect()), face: inside(face) && face.height };
});

test('small screens show the question and make every answer reachable', async () => {
  const page = await open();
  for (const [name, offer] of Object.entries(OFFERS)) {
    script.send({ type: 'choices', id: name, ...offer });
    await page.waitForFunction((count) => document.querySelectorAll('#question .answers button').length === count && !document.querySelector('#question').hidden, offer.choices.length);
    await page.waitForFunction((question) => document.querySelector('#question .what').textContent === question, offer.question);
    for (const [width, height] of SCREENS) {
      await page.setViewportSize({ width, height });
      const where = `${name} on ${width}x${height}`;
      const { found, shifted, what, face } = await reach(page);
      await page.screenshot({ path: `${artefacts}/kiosk-${width}x${height}-${name}.png` });
      assert.deepEqual(shifted, [0, 0, 0], where);
      assert.ok(what, `${where}: the question is not seen`);
      assert.ok(face, `${where}: the face is not seen`);
      assert.equal(found.length, offer.choices.length, where);
      found.forEach((each, i) => assert.ok(each.inside && each.frame && each.hit && each.height >= TOUCH && each.width >= TOUCH, `${where}: answer ${i + 1} ${JSON.stringify(each)}`));
    }
  }
  await page.setViewportSize({ width: 640, height: 360 });
  await page.locator('#question .answers button').last().tap().catch(() => page.locator('#question .answers button').last().click());
  await script.wait({ type: 'chosen', id: 'word', choice: 1 });
  await page.close();
});

test('captions beside a question leave the lips free', async () => {
  const page = await open();
  script.send({ type: 'choices', id: 'viene', ...OFFERS.two });
  await page.waitForSelector('#question .answers button');
  for (const [width, height] of [[720, 860], [390, 844], [1280, 800], [360, 640]]) {
    await page.setViewportSize({ width, height });
    const found = await page.evaluate(() => {
      const root = document.querySelector('talking-head').shadowRoot;
      const captions = root.querySelector('.captions');
      captions.classList.remove('empty');
      root.querySelector('.word').textContent = 'minestra';
      const [stage, box] = [root.querySelector('.stage'), captions].map((one) => one.getBoundingClientRect());
      return { over: stage.bottom - box.top, share: stage.height && (stage.bottom - box.top) / stage.height, height: stage.height };
    });
    // below the picture, or over its part below the chin
    assert.ok(found.height > 60 && found.share <= 0.18, `${width} x ${height}: ${JSON.stringify(found)}`);
  }
  script.send({ type: 'choices', choices: [] });
  await page.close();
});

test('small screens show both answers to a request for consent', async () => {
  const page = await open();
  script.send({ type: 'consent', consent: 'asked', text: 'Si annota che cosa si dice qui. '.repeat(20) });
  await page.waitForFunction(() => !document.querySelector('#consent').hidden);
  for (const [width, height] of SCREENS) {
    await page.setViewportSize({ width, height });
    for (const id of ['consent-yes', 'consent-no']) {
      const box = await page.locator(`#${id}`).boundingBox();
      assert.ok(box.y >= 0 && box.y + box.height <= height + 0.5 && box.x >= 0 && box.x + box.width <= width, `${id} on ${width}x${height}: ${JSON.stringify(box)}`);
    }
  }
  script.send({ type: 'consent', consent: 'none' });
  await page.close();
});

test('reports an unreachable server until it is reachable again', async () => {
  const page = await open();
  const news = () => page.evaluate(() => document.getElementById('news').textContent);
  assert.equal(await news(), '');
  await network.end();
  await eventually(news, 'the page to tell it');
  await network.begin(daemon.url, network.port);
  await page.waitForFunction(() => document.body.dataset.state === 'idle', null, { timeout: 60000 });
  await eventually(async () => !(await news()), 'it to be taken back', 5000);
  await page.close();
});

test('can be installed: the content security policy allows the manifest', async () => {
  const page = await open();
  const devtools = await page.context().newCDPSession(page);
  const { url, errors, data } = await devtools.send('Page.getAppManifest');
  assert.equal(url, `${network.url}/room.webmanifest`);
  assert.deepEqual(errors, []);
  const { display, icons } = JSON.parse(data);
  assert.equal(display, 'fullscreen');
  const images = await page.evaluate((list) => Promise.all(list.map(async ({ src, sizes, type }) => {
    const image = Object.assign(new Image(), { src });
    await image.decode();
    return [sizes, type, `${image.naturalWidth}x${image.naturalHeight}`];
  })), icons.filter(({ type }) => type === 'image/png'));
  assert.deepEqual(images, ['192x192', '512x512'].map((size) => [size, 'image/png', size]));
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('reloaded offline, shows what it waits for, and continues when the network is back', async () => {
  const context = await browser.newContext({ locale: 'it-IT', viewport: { width: 800, height: 480 } });
  const page = await open(context);
  await page.evaluate(() => navigator.serviceWorker.ready);
  await eventually(() => page.evaluate(() => Boolean(navigator.serviceWorker.controller)), 'the worker');
  const names = await page.evaluate(() => caches.keys());
  assert.equal(names.length, 1);
  assert.match(names[0], /^faccia-room-[0-9a-f]{16}$/);
  await network.end();
  await page.reload();
  await page.waitForFunction(() => document.getElementById('news').textContent, null, { timeout: 60000 });
  assert.deepEqual(await page.evaluate(() => [document.body.dataset.state, document.querySelector('#sign .text').textContent, document.querySelector('talking-head').room]), ['offline', 'Non connessa', 'atrio']);
  await page.screenshot({ path: `${artefacts}/kiosk-offline.png` });
  await network.begin(daemon.url, network.port);
  await page.waitForFunction(() => document.body.dataset.state === 'idle' && !document.getElementById('news').textContent, null, { timeout: 60000 });
  await context.close();
});

test('never uses the cache while the daemon answers, and a new version replaces it', async () => {
  const context = await browser.newContext({ locale: 'it-IT' });
  const page = await open(context);
  await eventually(() => page.evaluate(() => Boolean(navigator.serviceWorker.controller)), 'the worker');
  const found = await page.evaluate(async () => {
    const [name] = await caches.keys();
    const cache = await caches.open(name);
    await cache.put('room.css', new Response('stale'));
    const kept = (await cache.keys()).map(({ url }) => new URL(url).pathname).sort();
    await caches.open('faccia-room-0000000000000000');
    return { css: await (await fetch('room.css')).text(), kept };
  });
  assert.notEqual(found.css, 'stale');
  assert.deepEqual(found.kept, ['/icon-192.png', '/icon.svg', '/page.css', '/room-early.js', '/room.css', '/room.html', '/room.js', '/room.webmanifest', '/talking-head-worklet.js', '/talking-head.js']);
  // a worker of another version: as the daemon would give it after an upgrade
  const upgraded = http.createServer(async ({ url }, response) => {
    const answer = await daemon.get(url);
    const body = Buffer.from(await answer.arrayBuffer());
    response.writeHead(answer.status, { 'content-type': answer.headers.get('content-type') });
    response.end(url === '/room-worker.js' ? body.toString().replace(/VERSION = '\w+'/, "VERSION = 'ffffffffffffffff'") : body);
  });
  await network.end();
  await once(upgraded.listen(network.port, '127.0.0.1'), 'listening');
  await page.evaluate(async () => (await navigator.serviceWorker.getRegistration('room.html')).update());
  await eventually(async () => JSON.stringify(await page.evaluate(() => caches.keys())) === '["faccia-room-ffffffffffffffff"]', 'the new version alone', 120000);
  await context.close();
  upgraded.closeAllConnections();
  upgraded.close();
  await network.begin(daemon.url, network.port);
});

// Browsers block sound in pages without a user gesture. Evaluating code in a page counts as a gesture, so this page reports by its console.
test('reports an announcement to faccia-say as unheard on a screen without a touch, and as heard after one', async () => {
  const whole = await launch({ webgl: false, whole: true }); // the headless shell has no such policy
  const page = await whole.newPage({ locale: 'it-IT' });
  const lines = [];
  page.on('console', (message) => lines.push(message.text()));
  page.on('pageerror', (error) => lines.push(`error ${error}`));
  await page.addInitScript(() => addEventListener('DOMContentLoaded', () => {
    const told = () => document.body.dataset.state === 'idle' && console.log('idle');
    new MutationObserver(told).observe(document.body, { attributeFilter: ['data-state'] });
    document.querySelector('talking-head').addEventListener('sound', ({ detail }) => console.log(`sound ${detail.sound}`));
    told();
  }));
  await page.goto(`${network.url}/room.html?room=atrio`);
  const said = (line) => eventually(() => lines.includes(line), `"${line}" among ${lines}`, 120000);
  await said('idle');
  await said('sound blocked'); // reported before the first speech, in time for an announcement
  const say = async () => {
    const child = spawn(path.join(build, 'server/bridges/faccia-say'), ['--url', daemon.url, '--room', 'atrio', '--lang', 'it', '--wait', 'La cena è pronta.']);
    let told = '';
    child.stderr.setEncoding('utf8').on('data', (text) => (told += text));
    const [status] = await once(child, 'close');
    return { status, told };
  };
  for (let i = 0; i < 2; i++) {
    const { status, told } = await say();
    assert.equal(status, 6, told);
    assert.match(told, /clicks or taps/);
  }
  await page.mouse.click(5, 5);
  await said('sound on');
  assert.deepEqual(await say(), { status: 0, told: '' });
  assert.deepEqual(lines.filter((line) => line.startsWith('error')), []);
  await whole.close();
});
