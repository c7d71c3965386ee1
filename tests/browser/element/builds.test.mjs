// SPDX-License-Identifier: GPL-3.0-or-later
// Walks the pages of web/docs/frameworks: their code, with the packed npm package and a token, in an application of each framework, with the framework's own tools from npm.
// Types are checked; it is built, served and drawn, and speaks by its worklet. It takes minutes and a registry: `sh tests/run.sh long`, or FACCIA_LONG=1 node --test [--test-name-pattern=Angular] tests/browser/element/builds.test.mjs.
// Prints a row of the table in web/docs/frameworks/index.md for each.
import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import { once } from 'node:events';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { gzipSync } from 'node:zlib';
import { PNG } from 'pngjs';
import { launch } from '../../lib/browser.mjs';
import { artefacts, build, Daemon, eventually, root } from '../../lib/daemon.mjs';
import { further, long } from '../../lib/long.mjs';
import { servePages } from '../../lib/page-server.mjs';
import { now, sign } from '../../lib/tokens.mjs';
import { apps } from '../apps/builds.mjs';

const TYPES = { '.js': 'text/javascript', '.html': 'text/html; charset=utf-8', '.css': 'text/css' };
const secret = 'a secret of thirty-two letters ..';
const top = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-builds-'));
let daemon, browser, tarball;
before(async () => {
  if (!long) return;
  const folder = path.join(top, 'talking-head');
  execFileSync('node', [path.join(root, 'web/package/pack.mjs'), folder, process.env.FACCIA_WEB ?? path.join(build, 'web')]);
  fs.mkdirSync(artefacts, { recursive: true });
  tarball = path.join(top, execFileSync('npm', ['pack', '--silent', '--pack-destination', top], { cwd: folder, encoding: 'utf8' }).trim());
  fs.writeFileSync(path.join(top, 'secret'), secret);
  daemon = await Daemon.start(['--secret-file', path.join(top, 'secret')]);
  browser = await launch({ flags: ['--autoplay-policy=no-user-gesture-required'] });
});
after(async () => {
  fs.rmSync(top, { recursive: true });
  await browser?.close();
  if (daemon) assert.equal((await daemon.stop()).code, 0);
});

/** Serves a folder, compressed as a site would. */
function serveFolder(folder) {
  const files = {};
  for (const entry of fs.readdirSync(folder, { recursive: true })) {
    const file = path.join(folder, entry);
    if (fs.statSync(file).isFile())
      files[`/${entry}`] = { body: gzipSync(fs.readFileSync(file)), type: TYPES[path.extname(entry)] ?? 'application/octet-stream', headers: { 'content-encoding': 'gzip' } };
  }
  return servePages({ ...files, '/': files['/index.html'] });
}

/** Starts an application's own server. */
async function serveItself(line, cwd) {
  const [program, ...words] = line.split(' ');
  const server = spawn(path.join(cwd, 'node_modules/.bin', program), words, { cwd });
  let out = '';
  for (const stream of [server.stdout, server.stderr]) stream.setEncoding('utf8').on('data', (text) => (out += text));
  const [, port] = await eventually(() => out.match(/localhost:(\d+)/), `the port of ${program}`, 240000);
  return {
    url: `http://localhost:${port}`,
    close() {
      server.kill();
      return once(server, 'exit');
    },
  };
}

/** Counts pixels of skin in the picture of the element. */
async function skin(tab, name) {
  const picture = await tab.locator('talking-head').screenshot();
  fs.writeFileSync(path.join(artefacts, `build-${name}.png`), picture);
  const { data } = PNG.sync.read(picture);
  let count = 0;
  for (let i = 0; i < data.length; i += 4) if (data[i] > 100 && data[i] > data[i + 1] + 15 && data[i + 1] > data[i + 2]) count++;
  return count;
}

for (const [name, { packages, files, copy, node, commands, out, serve }] of Object.entries(apps))
  test(`${name}: a typed build shows the head, and it speaks by its worklet`, further, async (t) => {
    const short = name.replace(/\W+/g, '-').toLowerCase();
    const folder = path.join(top, short);
    const attributes = `src="${daemon.url.replace('http', 'ws')}/v1/stream" token="${sign({ secret, claims: { exp: now() + 3600 } })}" quality="low"`;
    for (const [file, text] of Object.entries({ 'package.json': '{"private":true,"type":"module"}', ...files })) {
      fs.mkdirSync(path.dirname(path.join(folder, file)), { recursive: true });
      fs.writeFileSync(path.join(folder, file), text.replace(/src="ws:[^"]*"/, attributes));
    }
    const modules = path.join(folder, 'node_modules');
    const env = { ...process.env, NEXT_TELEMETRY_DISABLED: '1', ASTRO_TELEMETRY_DISABLED: '1', CI: '1' };
    const run = (program, ...words) => execFileSync(program, words, { cwd: folder, env, encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe'] });
    run('npm', 'install', '--no-audit', '--no-fund', tarball, ...packages);
    if (copy) fs.cpSync(...copy.map((place) => path.join(folder, place)), { recursive: true });
    for (const line of commands) {
      const [program, ...words] = line.split(' ');
      try {
        run(node ? path.join(modules, node) : process.execPath, fs.realpathSync(path.join(modules, '.bin', program)), ...words);
      } catch ({ stdout, stderr }) {
        assert.fail(`${line}: ${stdout}${stderr}`);
      }
    }

    const server = serve ? await serveItself(serve, folder) : await serveFolder(path.join(folder, out));
    if (serve) assert.match(await (await fetch(server.url)).text(), /<talking-head [^>]*lang="it"/, 'rendered on the server');
    const tab = await browser.newPage();
    const problems = [];
    tab.on('pageerror', (error) => problems.push(String(error)));
    tab.on('console', (message) => ['error', 'warning'].includes(message.type()) && /talking-head|Failed|hydrat/i.test(message.text()) && problems.push(message.text()));
    tab.on('response', (answer) => answer.ok() || problems.push(`${answer.status()} ${answer.url()}`));
    let bytes = 0; // before the first picture, which is the poster: without the head, the worklet and decoders
    const counted = new Set();
    const network = await tab.context().newCDPSession(tab);
    await network.send('Network.enable');
    network.on('Network.responseReceived', ({ requestId, response: { url } }) =>
      (url.startsWith(server.url) ? !/talking-head-|opus-decoder/.test(path.basename(url)) : url.endsWith('.webp')) && counted.add(requestId));
    network.on('Network.loadingFinished', ({ requestId, encodedDataLength }) => counted.has(requestId) && (bytes += encodedDataLength));
    await tab.addInitScript(() => {
      window.worklets = [];
      const { addModule } = window.AudioWorklet.prototype;
      window.AudioWorklet.prototype.addModule = function (address) {
        window.worklets.push(new URL(address, location.href).href);
        return addModule.call(this, address);
      };
      customElements.whenDefined('talking-head').then(({ prototype }) => {
        const { speak } = prototype;
        prototype.speak = function (...given) {
          const spoken = speak.apply(this, given);
          spoken.then((end) => (window.spoken = end.reason), (error) => (window.spoken = String(error)));
          return spoken;
        };
      });
    });
    try {
      await tab.goto(server.url);
      await tab.waitForFunction(() => document.querySelector('talking-head').debug?.().drawCalls > 0, null, { timeout: 240000 });
      await tab.click('button');
      await tab.waitForFunction(() => window.spoken, null, { timeout: 60000 }).catch((error) => problems.push(String(error)));
      assert.deepEqual([await tab.evaluate(() => window.spoken), ...problems], ['done']);
      const pixels = await skin(tab, short);
      assert.ok(pixels > 2000, `${pixels} pixels of skin`);
      const { worklets, ...sound } = await tab.evaluate(() => {
        const head = document.querySelector('talking-head');
        return { sound: head.debug().sound, instead: head.debugParts().player.reason ?? null, worklets: window.worklets };
      });
      assert.deepEqual(sound, { sound: 'on', instead: null }, 'by the worklet, and by nothing in its place');
      assert.equal(worklets.length, 1);
      assert.ok(worklets[0].startsWith(`${server.url}/`), `the worklet is a file of the application, not ${worklets[0]}`);
      assert.deepEqual(problems, []);
      const versions = packages.filter((each) => !/^@types|typescript|tsc|check|rxjs|tslib|react-dom|node-|@angular\/(?!core|build)/.test(each)).map((each) => {
        const [, id] = each.match(/^(.+)@/);
        return `${id} ${JSON.parse(fs.readFileSync(path.join(modules, id, 'package.json'), 'utf8')).version}`;
      });
      t.diagnostic(`| ${name} | ${versions.join(', ')} | ${commands.join(', ')} | ${(bytes / 1000).toFixed(0)} kB | yes |`);
    } finally {
      await tab.close();
      await server.close();
    }
  });
