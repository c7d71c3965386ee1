// SPDX-License-Identifier: GPL-3.0-or-later
// Walks what the guides say, in fresh folders, as a stranger would: a page of one's own, also opened from a file by mistake; a kitchen whose tablet and operator
// come from the network with tokens, by the links and QR codes that are printed; a portal and a script with tokens. Those of frameworks: tests/browser/element/builds.test.mjs.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { once } from 'node:events';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import jsQR from 'jsqr';
import { launch } from '../../lib/browser.mjs';
import { build, Daemon, eventually, root } from '../../lib/daemon.mjs';

const guide = (name) => fs.readFileSync(path.join(root, 'web/docs/start', name), 'utf8');
const blocks = (text, language) => [...text.matchAll(new RegExp('^```' + language + '(?: [^\\n]*)?\\n([^]*?)^```', 'gm'))].map(([, code]) => code);

let browser;
const folders = [];
before(async () => (browser = await launch({ webgl: false, flags: ['--autoplay-policy=no-user-gesture-required'] })));
after(async () => {
  await browser?.close();
  for (const folder of folders) fs.rmSync(folder, { recursive: true });
});

/** Makes an empty folder with the build, as the top of the tree has it. */
function fresh() {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-journey-'));
  folders.push(folder);
  fs.symlinkSync(path.resolve(build), path.join(folder, 'build'));
  return folder;
}

const quiet = { ...process.env, FACCIA_STOP_SECONDS: '0', FACCIA_MAX_PER_ADDRESS: '0', FACCIA_MAX_REQUESTS: '0' };

/** Runs commands on a terminal, and returns what it shows. */
function onTerminal(folder, commands) {
  const { stdout, status } = spawnSync('script', ['-qec', commands, '/dev/null'], { cwd: folder, encoding: 'utf8', env: quiet });
  assert.equal(status, 0, stdout);
  return stdout.replaceAll('\r', '');
}

/** Reads the QR code among lines of a terminal, as a camera would. */
function scanned(shown) {
  const rows = [...shown.matchAll(/\x1b\[30;107m([ ▀▄█]+)\x1b\[0m/g)].flatMap(([, line]) => ['▀█', '▄█'].map((dark) => [...line].map((c) => dark.includes(c))));
  const [scale, across] = [4, rows[0].length];
  const width = scale * across;
  const pixels = new Uint8ClampedArray(4 * width * scale * rows.length).fill(255);
  for (let y = 0; y < scale * rows.length; y++)
    for (let x = 0; x < width; x++) if (rows[Math.floor(y / scale)][Math.floor(x / scale)]) pixels.fill(0, 4 * (y * width + x), 4 * (y * width + x) + 3);
  return jsQR(pixels, width, scale * rows.length)?.data;
}

/** Starts a daemon for other machines on a terminal. Returns what it shows, and the address: outside, or on this machine where it has no other. */
async function onOtherMachines(t, folder, options) {
  const terminal = spawn('script', ['-qefc', `echo $$ >pid; exec build/server/daemon/facciad --port 0 ${options}`, '/dev/null'], { cwd: folder, env: quiet, stdio: ['ignore', 'pipe', 'ignore'] });
  let shown = '';
  terminal.stdout.setEncoding('utf8').on('data', (piece) => (shown += piece.replaceAll('\r', '')));
  const ended = once(terminal, 'exit');
  const stop = () => {
    if (terminal.exitCode === null) process.kill(Number(fs.readFileSync(path.join(folder, 'pid'), 'utf8')), 'SIGTERM');
    return ended;
  };
  t.after(stop);
  await eventually(() => /ready: /.test(shown), 'the voices', 240000);
  const { port } = new URL(shown.match(/listening on (\S+)/)[1]);
  const [, outside] = shown.match(/on other machines: (\S+)/) ?? [];
  return { at: outside ?? `http://127.0.0.1:${port}/`, port, shown, outside, stop };
}

/** The options of `sh server/run.sh` in a block. */
const optionsOf = (block) => block.match(/^sh server\/run\.sh (.*)$/m)[1];
/** The same block without that line. */
const besides = (block) => block.replace(/^sh server\/run\.sh .*\n/m, '');

const connected = (page) => page.waitForFunction(() => document.querySelector('talking-head').debug?.().connection === 'open', null, { timeout: 60000 });
const visit = async (address) => {
  const page = await browser.newPage({ locale: 'en-GB', viewport: { width: 800, height: 600 } });
  await page.addInitScript(() => {
    window.heard = [];
    for (const type of ['word', 'end', 'error']) document.addEventListener(type, ({ target, detail }) => target.localName === 'talking-head' && window.heard.push(detail.text ?? detail.reason ?? detail.code), true);
  });
  await page.goto(address);
  return page;
};
const heard = (page, what) => page.waitForFunction((each) => window.heard.includes(each), what, { timeout: 60000 });

test('a page of one’s own, opened from a file: it says what to do, and does it then', async () => {
  const folder = fresh();
  let daemon = await Daemon.start();
  const here = (text) => text.replaceAll('127.0.0.1:8080', `127.0.0.1:${daemon.port}`);
  const file = path.join(folder, 'page.html');
  fs.writeFileSync(file, here(blocks(guide('page.md'), 'html')[0]));
  const page = await visit(pathToFileURL(file).href);
  const message = page.locator('talking-head [part=message]');
  await message.waitFor({ timeout: 60000 });
  const [, options] = (await message.textContent()).match(/facciad (--origin null)$/);
  const { port } = daemon;
  await daemon.stop();
  daemon = await Daemon.start(['--port', String(port), ...options.split(' ')]);
  await connected(page);
  await page.click('button');
  await heard(page, 'done');
  assert.equal(await message.isVisible(), false);
  assert.deepEqual((await page.evaluate(() => window.heard)).filter((what) => !/-/.test(what)), ['Buongiorno', 'a', 'tutti', 'done']);
  await page.close();
  assert.equal((await daemon.stop()).code, 0);
});

test('a kitchen with tokens: links and QR codes for tablet and operator, and what each of them may', async (t) => {
  const folder = fresh();
  const [, text] = guide('kitchen.md').split('## Screens on other machines');
  const [start, links, program, say] = blocks(text, 'sh');
  fs.mkdirSync(path.join(folder, 'scenes'));

  // the daemon on a terminal, by the second line of the first block; the first makes the secret
  const [secret, run] = start.trim().split('\n');
  onTerminal(folder, secret);
  const options = run.replace(/^sh server\/run\.sh /, '');
  assert.match(options, /^--host 0\.0\.0\.0 --remote --secret-file secret --scenes scenes$/);
  const { at, shown, outside, stop } = await onOtherMachines(t, folder, options);
  if (outside) assert.equal(scanned(shown), outside, 'the QR code is the address');
  else t.diagnostic('this machine has no address but loopback: pages come from there');

  // the two links, by the two commands of the second block
  const [tablet, operator] = links.trim().replaceAll('http://192.168.1.20:8080/', at).split('\n').map((command) => {
    const printed = onTerminal(folder, command);
    const link = printed.match(/^http\S+$/m)[0];
    assert.equal(scanned(printed), link);
    return link;
  });
  const screen = await visit(tablet);
  await connected(screen);
  assert.equal(new URL(screen.url()).searchParams.get('token'), null, 'the token is taken out of the address');
  const desk = await visit(operator);
  await connected(desk);
  await desk.fill('#text', 'Dinner is ready.');
  await desk.click('#speak');
  await heard(screen, 'done');
  assert.deepEqual(await screen.evaluate(() => window.heard), ['Dinner', 'is', 'ready', 'done']);

  // the operator's rights are enough to keep a scene on the server; the tablet's are not
  await desk.click('#store summary');
  await desk.fill('#scene-name', 'supper');
  await desk.click('#keep-scene');
  await eventually(() => fs.existsSync(path.join(folder, 'scenes/supper.json')), 'the scene');
  const token = new URL(tablet).searchParams.get('token');
  const answer = await fetch(new URL('/v1/scenes/other', at), { method: 'PUT', body: '{"lines":[]}', headers: { authorization: `Bearer ${token}`, 'content-type': 'application/json' } });
  assert.equal(answer.status, 403);
  assert.equal((await answer.json()).code, 'forbidden');

  // a program, by the third block and the fourth
  onTerminal(folder, program);
  onTerminal(folder, say.replace('--wait', `--url ${at} --wait`));
  await heard(screen, 'eggs');

  // without a token the page asks for one
  const stranger = await visit(new URL('/room.html?room=kitchen', at).href);
  await stranger.waitForSelector('#access .why:not(:empty)');
  for (const page of [screen, desk, stranger]) await page.close();
  assert.deepEqual(await stop(), [0, null]);
});

test('a portal with tokens: the link opens a text and reads it; a program searches; without a token the page asks for one', async (t) => {
  const folder = fresh();
  fs.symlinkSync(path.join(root, 'models'), path.join(folder, 'models'));
  const [, text] = guide('portal.md').split('## For readers on other machines');
  const [start, link, program] = blocks(text, 'sh');
  onTerminal(folder, besides(start));
  const { at, port, stop } = await onOtherMachines(t, folder, `${optionsOf(start)} --library-index index`);
  const printed = onTerminal(folder, link.replace('http://192.168.1.20:8080/', at)).match(/^http\S+$/m)[0];
  const reader = await visit(printed);
  await reader.waitForSelector('[id="mare:1:l1"]');
  await connected(reader);
  assert.equal(new URL(reader.url()).searchParams.get('token'), null, 'the token is taken out of the address');
  await reader.click('#play');
  await heard(reader, 'calmo');

  const { results } = JSON.parse(onTerminal(folder, program.replace('127.0.0.1:8080', `127.0.0.1:${port}`).replace('curl', 'curl -s')));
  assert.ok(results.length > 0);

  const stranger = await visit(new URL('/library.html?at=mare:1', at).href);
  await stranger.waitForSelector('#access .why:not(:empty)');
  for (const page of [reader, stranger]) await page.close();
  assert.deepEqual(await stop(), [0, null]);
});

test('a script with a token: a file of sound, and a room that hears it; without the token it is told what is missing', async (t) => {
  const folder = fresh();
  const [, text] = guide('script.md').split('requires [tokens]');
  const [make, send] = blocks(text, 'sh');
  onTerminal(folder, make);
  const { at, port, stop } = await onOtherMachines(t, folder, '--secret-file secret');
  const token = fs.readFileSync(path.join(folder, 'script.token'), 'utf8').trim();
  const hall = await visit(new URL(`/room.html?room=hall&token=${token}`, at).href);
  await connected(hall);
  onTerminal(folder, send.replaceAll('127.0.0.1:8080', `127.0.0.1:${port}`));
  await heard(hall, 'tavola');
  assert.match(fs.readFileSync(path.join(folder, 'hello.wav'), 'latin1').slice(0, 12), /^RIFF....WAVE/s);
  const refused = await fetch(`http://127.0.0.1:${port}/v1/speech?lang=it`, { method: 'POST', body: 'Buongiorno.' });
  assert.deepEqual([refused.status, (await refused.json()).code], [401, 'token-needed']);
  await hall.close();
  assert.deepEqual(await stop(), [0, null]);
});
