// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the commands of the documentation and the README as printed, page by page, with another port. Later commands of a page find the files
// of earlier ones. Blocks marked `sh not-run: REASON` are skipped; REASON names the test that runs them.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { build, Daemon, eventually, ordinary, root } from '../../lib/daemon.mjs';

const pages = ['README.md', ...fs.readdirSync(path.join(root, 'web/docs'), { recursive: true, encoding: 'utf8' }).filter((file) => file.endsWith('.md')).sort().map((file) => `web/docs/${file}`)];
/** The shell blocks of a page: { info, code }, info: the text after the language. */
const blocks = (page) =>
  [...fs.readFileSync(path.join(root, page), 'utf8').matchAll(/^```(\w+)(?: ([^\n]*))?\n([^]*?)^```/gm)].filter(([, language]) => language === 'sh').map(([, , info = '', code]) => ({ info, code }));

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-docs-'));
let daemon;
before(async () => {
  fs.mkdirSync(path.join(folder, 'scenes'));
  daemon = await Daemon.start(['--scenes', path.join(folder, 'scenes'), '--library', path.join(root, 'models/library'), '--library-index', path.join(folder, 'index')]);
  await eventually(async () => (await (await daemon.get('/v1/library')).json()).state === 'ready', 'the library to be read');
});
after(async () => {
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  fs.rmSync(folder, { recursive: true });
});

/** Makes a folder that looks like the top of the source tree. */
function tree(page) {
  const at = path.join(folder, page.replaceAll('/', '-'));
  fs.mkdirSync(at);
  for (const name of ['models', 'server', 'web', 'tests', 'protocol']) fs.symlinkSync(path.join(root, name), path.join(at, name));
  fs.symlinkSync(path.resolve(build), path.join(at, 'build'));
  return at;
}

/** Replaces `sh server/run.sh OPTIONS`, which would build and start a daemon, by a check that facciad accepts the options. */
const here = (code) =>
  code
    .replaceAll('127.0.0.1:8080', `127.0.0.1:${daemon.port}`)
    .replace(/^sh server\/run\.sh(.*)$/gm, (_, options) => `build/server/daemon/facciad ${options} --print-config >config.json`);

async function run(code, at) {
  const child = spawn('sh', ['-ec', code], { cwd: at, env: { ...process.env, FACCIA_MODELS: path.join(ordinary, 'models'), FACCIA_URL: daemon.url }, stdio: ['ignore', 'pipe', 'pipe'] });
  let out = '', complaints = '';
  child.stdout.on('data', (piece) => (out += piece));
  child.stderr.on('data', (piece) => (complaints += piece));
  const [status] = await once(child, 'close');
  assert.equal(status, 0, `${code}\n${complaints}\n${out.slice(0, 2000)}`);
  assert.doesNotMatch(out, /^\{"type":"error"/m, code);
  return out;
}

test('commands that are not run here name the test that runs them', () => {
  const left = pages.flatMap((page) => blocks(page).filter(({ info }) => info.startsWith('not-run:')).map(({ info, code }) => ({ page, info, code })));
  assert.ok(left.length < pages.flatMap(blocks).length / 2);
  for (const { page, info, code } of left) {
    const named = info.match(/tests\/[\w/-]+\.test\.mjs/)?.[0];
    if (!named) {
      assert.match(code, /^sh tests\/run\.sh$/m, `${page}: ${info}`); // tests/run.sh runs this test, so it is not started here
      continue;
    }
    const source = fs.readFileSync(path.join(root, named), 'utf8') + fs.readFileSync(path.join(root, 'tests/run.sh'), 'utf8');
    if (source.includes(`guide('${path.basename(page)}')`)) continue; // it runs the blocks of the page as they stand there
    for (const word of code.match(/[\w-]+\.(?:sh|mjs)\b|Containerfile|\bexport\b/g)) assert.ok(source.includes(word), `${named} has nothing of ${word}`);
  }
});

const heads = fs.existsSync(path.join(ordinary, 'models/heads/mara.glb'));
for (const page of pages.filter((one) => blocks(one).some(({ info }) => !info.startsWith('not-run:'))))
  test(page, async () => {
    const at = tree(page);
    for (const { info, code } of blocks(page)) {
      if (info.startsWith('not-run:') || (/needs=heads/.test(info) && !heads)) continue;
      const room = info.match(/room=(\S+)/)?.[1];
      const listener = room && (await daemon.stream(`?room=${room}`));
      await listener?.wait({ type: 'joined' });
      await run(here(code), at);
      if (room) assert.ok(await listener.wait({ type: 'end', reason: 'done' }));
      await listener?.close();
    }
    for (const name of fs.readdirSync(at).filter((one) => /\.(wav|ogg|fap|json|csv|svg|vrm)$/.test(one))) assert.ok(fs.statSync(path.join(at, name)).size > 50, `${name} is empty`);
  });
