// SPDX-License-Identifier: GPL-3.0-or-later
// The element in an application of Next.js as it comes from npm, with the tsconfig that Next writes itself: types are checked, the page is rendered on the
// server, and the face is drawn. It takes minutes and a registry: FACCIA_LONG=1 node --test tests/browser/element/next.test.mjs, or `sh tests/run.sh long`.
import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { test } from 'node:test';
import { launch } from '../../lib/browser.mjs';
import { build, Daemon, eventually, root } from '../../lib/daemon.mjs';
import { long } from '../../lib/long.mjs';

const PACKAGES = ['next@15', 'react@19', 'react-dom@19', 'typescript@5', '@types/react@19', '@types/node@20'];
const FILES = {
  'package.json': '{"private":true}',
  'app/layout.tsx': 'export default function Layout({ children }: { children: React.ReactNode }) {\n  return <html lang="it"><body>{children}</body></html>;\n}\n',
  'app/page.tsx': "import Head from './head';\nexport default function Page() {\n  return <Head />;\n}\n",
  'app/head.tsx': `'use client';
import '@faccia/talking-head';
import '@faccia/talking-head/react';
import { useRef } from 'react';
import type { TalkingHead } from '@faccia/talking-head';
export default function Head() {
  const head = useRef<TalkingHead>(null);
  return <>
    <talking-head ref={head} src={process.env.NEXT_PUBLIC_FACCIA} lang="it" quality="low" style={{ display: 'block', width: '9rem', height: '12rem' }} />
    <button onClick={() => head.current?.speak('Ciao.').then(({ reason }) => (document.title = reason))}>Ciao</button>
  </>;
}
`,
};

test('Next builds a typed application with the element, and its page shows the head', { skip: !long && 'takes minutes: FACCIA_LONG=1' }, async (t) => {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-next-'));
  const daemon = await Daemon.start();
  const env = { ...process.env, NEXT_TELEMETRY_DISABLED: '1', NEXT_PUBLIC_FACCIA: `${daemon.url.replace('http', 'ws')}/v1/stream` };
  const run = (program, ...words) => execFileSync(program, words, { cwd: folder, env, encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe'] });
  for (const [name, text] of Object.entries(FILES)) {
    fs.mkdirSync(path.dirname(path.join(folder, name)), { recursive: true });
    fs.writeFileSync(path.join(folder, name), text);
  }
  run('npm', 'install', '--no-audit', '--no-fund', ...PACKAGES);
  run('node', path.join(root, 'web/package/pack.mjs'), path.join(folder, 'node_modules/@faccia/talking-head'), process.env.FACCIA_WEB ?? path.join(build, 'web'));
  const said = run('node_modules/.bin/next', 'build');
  t.diagnostic(`moduleResolution: ${JSON.parse(fs.readFileSync(path.join(folder, 'tsconfig.json'), 'utf8')).compilerOptions.moduleResolution}`);
  assert.match(said, /checking validity of types/);

  const server = spawn('node_modules/.bin/next', ['start', '-p', '0'], { cwd: folder, env });
  let out = '';
  for (const stream of [server.stdout, server.stderr]) stream.setEncoding('utf8').on('data', (text) => (out += text));
  const [, port] = await eventually(() => out.match(/localhost:(\d+)/), 'the port of Next', 240000);
  const page = `http://localhost:${port}/`;
  assert.match(await (await fetch(page)).text(), /<talking-head [^>]*lang="it"/, 'rendered on the server');
  const browser = await launch({ flags: ['--autoplay-policy=no-user-gesture-required'] });
  const tab = await browser.newPage();
  const problems = [];
  tab.on('pageerror', (error) => problems.push(String(error)));
  await tab.goto(page);
  await tab.waitForFunction(() => document.querySelector('talking-head').debug?.().drawCalls > 0, null, { timeout: 240000 });
  await tab.click('button');
  await tab.waitForFunction(() => document.title === 'done', null, { timeout: 240000 });
  assert.deepEqual(problems, []);
  await browser.close();
  server.kill();
  assert.equal((await daemon.stop()).code, 0);
  fs.rmSync(folder, { recursive: true });
});
