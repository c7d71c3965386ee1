// SPDX-License-Identifier: GPL-3.0-or-later
// A page with a daemon that requires tokens: the three ways for browsers to present one, and the element's attribute.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { launch } from '../../lib/browser.mjs';
import { build, Daemon } from '../../lib/daemon.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-token-'));
const secrets = path.join(folder, 'secrets');
fs.writeFileSync(secrets, 'x'.repeat(40));
const token = (...options) => spawnSync(path.join(build, 'server/cli/faccia'), ['token', '--secret-file', secrets, '--subject', 'anna', ...options], { encoding: 'utf8' }).stdout.trim();

let daemon, browser, page;
before(async () => {
  daemon = await Daemon.start(['--secret-file', secrets]);
  browser = await launch({ webgl: false });
  page = await browser.newPage();
  await page.goto(daemon.url);
});
after(async () => {
  await browser?.close();
  assert.equal((await daemon.stop()).code, 0);
  fs.rmSync(folder, { recursive: true });
});

/** Speaks "Sì." on a socket of the page and returns the final message. */
const speaks = (query, protocols, first) =>
  page.evaluate(([address, list, message]) => new Promise((resolve, reject) => {
    const socket = new WebSocket(`${location.origin.replace('http', 'ws')}/v1/stream?lang=it&audio=none&fap=none${address}`, list);
    socket.onerror = () => reject(new Error('refused'));
    socket.onopen = () => [message, { type: 'speak', text: 'Sì.' }].forEach((m) => m && socket.send(JSON.stringify(m)));
    socket.onmessage = ({ data }) => {
      const said = JSON.parse(data);
      if (said.type === 'end') resolve(said.reason);
    };
  }), [query, protocols, first]);

test('accepts a token in the address, among the sub-protocols, and in the first message', async () => {
  assert.equal(await speaks('', []), 'failed');
  assert.equal(await speaks(`&token=${token()}`, ['faccia.v1']), 'done');
  assert.equal(await speaks('', ['faccia.v1', `token.${token()}`]), 'done');
  assert.equal(await speaks('', ['faccia.v1', `token.${token().slice(0, -4)}AAAA`]), 'failed');
  assert.equal(await speaks('', [], { type: 'authorize', token: token() }), 'done');
});

test('the element sends its own token', async () => {
  const heard = await page.evaluate((text) => new Promise((resolve) => {
    const element = document.querySelector('talking-head');
    const list = [];
    for (const type of ['authorized', 'joined', 'begin', 'end'])
      element.addEventListener(type, () => {
        list.push(type);
        if (type === 'joined') element.speak('Sì.', { lang: 'it' });
        if (type === 'end') resolve(list);
      });
    element.setAttribute('token', text);
    element.setAttribute('room', 'hall');
  }), token('--room', 'hall'));
  assert.deepEqual(heard.slice(-4), ['authorized', 'joined', 'begin', 'end']);
});
