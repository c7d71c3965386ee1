// SPDX-License-Identifier: GPL-3.0-or-later
// The element under the strict content security policy printed in web/docs/element/looks.md.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { PNG } from 'pngjs';
import { launch } from '../../lib/browser.mjs';
import { Daemon, root } from '../../lib/daemon.mjs';
import { fiveLines, servePages } from '../../lib/page-server.mjs';

const documented = fs.readFileSync(path.join(root, 'web/docs/element/looks.md'), 'utf8').match(/```csp\n([^]*?)```/)[1].replace(/\s+/g, ' ').trim();

let daemon, browser, server;
before(async () => {
  daemon = await Daemon.start();
  browser = await launch();
  server = await servePages({});
});
after(async () => {
  await browser?.close();
  await server?.close();
  assert.equal((await daemon.stop()).code, 0);
});

const policyOf = (text) => text.replaceAll('http://127.0.0.1:8080', daemon.url).replaceAll('ws://127.0.0.1:8080', daemon.url.replace('http', 'ws'));

/** Opens a page under the policy and records events and violations. */
async function open(policy, attributes, prepare = () => {}) {
  server.files['/'] = { body: fiveLines(daemon.url, attributes), headers: { 'content-security-policy': policyOf(policy) } };
  const page = await browser.newPage({ viewport: { width: 500, height: 600 } });
  await page.addInitScript(prepare);
  await page.addInitScript(() => {
    window.violations = [];
    window.heard = [];
    document.addEventListener('securitypolicyviolation', (e) => window.violations.push(`${e.effectiveDirective} ${e.blockedURI} ${e.sourceFile}:${e.lineNumber}`));
    for (const type of ['ready', 'sound', 'begin', 'end', 'error'])
      document.addEventListener(type, (e) => e.target.localName === 'talking-head' && window.heard.push({ type, ...e.detail }), true);
  });
  await page.goto(server.url);
  return page;
}

/** Speaks and returns the maximum loudness. */
const speak = (page) => page.evaluate(async () => {
  const connect = AudioNode.prototype.connect;
  let loudest = 0;
  AudioNode.prototype.connect = function (to, ...rest) {
    if (to !== this.context.destination) return connect.call(this, to, ...rest);
    const meter = this.context.createAnalyser();
    const block = new Float32Array(meter.fftSize);
    setInterval(() => {
      meter.getFloatTimeDomainData(block);
      loudest = Math.max(loudest, ...block.map(Math.abs));
    }, 20);
    connect.call(meter, this.context.destination);
    return connect.call(this, meter, ...rest);
  };
  const end = await document.querySelector('talking-head').speak('La mamma parla.', { lang: 'it' });
  return { end, loudest };
});

const ready = (page) => page.waitForFunction(() => window.heard.some(({ type }) => type === 'ready'), null, { timeout: 60000 });
const heard = (page, type) => page.evaluate((wanted) => window.heard.filter((e) => e.type === wanted), type);

test('draws and plays under the documented policy without a violation', async () => {
  assert.match(documented, /default-src 'none'/);
  assert.match(documented, /require-trusted-types-for 'script'; trusted-types 'none'/);
  assert.doesNotMatch(documented, /blob:|unsafe-inline|unsafe-eval/);
  const page = await open(documented);
  await ready(page);
  await page.mouse.click(5, 5); // browsers allow sound only after a user gesture
  const { end, loudest } = await speak(page);
  assert.equal(end.reason, 'done');
  assert.ok(loudest > 0.05, `loudest sample ${loudest}`);
  assert.deepEqual(await heard(page, 'sound'), [{ type: 'sound', sound: 'on' }]);
  const png = PNG.sync.read(await page.locator('talking-head canvas').screenshot());
  const colours = new Set();
  for (let i = 0; i < png.data.length; i += 400) colours.add(png.data.readUIntBE(i, 3) & 0xf0f0f0);
  assert.ok(colours.size > 40, `${colours.size} colours`);
  const block = await page.evaluate(() => getComputedStyle(document.querySelector('talking-head').shadowRoot.querySelector('canvas')).position);
  assert.equal(block, 'absolute', 'the styles are applied');
  assert.deepEqual(await page.evaluate(() => window.violations), []);
  await page.close();
});

test('plays sound without an AudioWorklet, and reports the fallback', async () => {
  const page = await open(documented.replace(/script-src [^;]*/, '$&/talking-head.js'));
  await ready(page);
  await page.mouse.click(5, 5);
  const { end, loudest } = await speak(page);
  assert.equal(end.reason, 'done');
  assert.ok(loudest > 0.05, `loudest sample ${loudest}`);
  assert.deepEqual(await heard(page, 'sound'), [{ type: 'sound', sound: 'on', reason: 'no-worklet' }]);
  await page.close();
});

test('requests PCM without WebCodecs and WebAssembly', async () => {
  const page = await open(documented, '', () => {
    delete window.AudioDecoder;
    window.asked = [];
    const { send } = WebSocket.prototype;
    WebSocket.prototype.send = function (text) {
      window.asked.push(JSON.parse(text));
      return send.call(this, text);
    };
  });
  await ready(page);
  await page.mouse.click(5, 5);
  const { end, loudest } = await speak(page);
  assert.equal(end.reason, 'done');
  assert.ok(loudest > 0.05, `loudest sample ${loudest}`);
  const asked = await page.evaluate(() => window.asked);
  assert.deepEqual(asked.filter(({ type }) => type === 'media'), [{ type: 'media', audio: 'pcm_s16le' }]);
  await page.close();
});

test('names a policy that does not allow the server, in the picture and as an error', async () => {
  const page = await open(documented.replace(/connect-src [^;]*/, "connect-src 'self'"), 'lang="en"');
  await page.waitForFunction(() => window.heard.some(({ type }) => type === 'error'));
  assert.deepEqual((await heard(page, 'error')).map(({ code }) => code), ['blocked-by-policy']);
  const message = page.locator('talking-head [part=message]');
  assert.match(await message.textContent(), /content security policy.*connect-src http:\/\/127/);
  await page.close();
});
