// SPDX-License-Identifier: GPL-3.0-or-later
// Replays the examples of the written protocol against the daemon.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { after, before, test } from 'node:test';
import WebSocket from 'ws';
import { contains, Daemon, root } from '../../lib/daemon.mjs';
import { violations } from '../../lib/schema.mjs';

const text = fs.readFileSync(path.join(root, 'protocol/README.md'), 'utf8');
const examples = (kind) => [...text.matchAll(new RegExp('```' + kind + '\\n([^]*?)```', 'g'))].map((match) => match[1].trim().split('\n'));

let daemon;
before(async () => (daemon = await Daemon.start()));
after(async () => assert.deepEqual(await daemon.stop(), { code: 0, signal: null }));

test('finds the examples', () => {
  assert.ok(examples('stream').length >= 6);
  assert.ok(examples('http').length >= 5);
});

for (const lines of examples('stream'))
  test(`stream: ${lines[0]}`, async () => {
    const stream = await daemon.stream();
    await stream.wait({ type: 'hello', protocol: 1 });
    let from = stream.messages.length;
    for (const line of lines) {
      const body = line.slice(2);
      if (line.startsWith('> ')) {
        stream.send(body);
      } else {
        const found = await stream.wait(JSON.parse(body), { from });
        from = stream.messages.indexOf(found) + 1;
      }
    }
    for (const { arrived, ...message } of stream.messages) assert.equal(violations('server', message), null, `${arrived} ${message.type}`);
    await stream.close();
  });

for (const lines of examples('text'))
  test(`text: ${lines[0]}`, async () => {
    const socket = new WebSocket(`ws://127.0.0.1:${daemon.port}/v1/stream?lang=it`, 'faccia.text.v1');
    const heard = [];
    let wake = () => {};
    socket.on('message', (data, binary) => wake(heard.push(binary ? 'media' : String(data))));
    await new Promise((resolve) => socket.on('open', resolve));
    let from = 0;
    for (const line of lines) {
      if (line.startsWith('> ')) {
        socket.send(line.slice(2));
        continue;
      }
      const pattern = new RegExp(`^${line.slice(2).split('...').map((part) => part.replace(/[.+*?()[\]]/g, '\\$&')).join('.*')}$`);
      while (!heard.slice(from).some((l) => pattern.test(l))) await new Promise((resolve) => (wake = resolve));
      from = heard.findIndex((l, i) => i >= from && pattern.test(l)) + 1;
    }
    assert.ok(!heard.includes('media'));
    socket.close();
  });

for (const lines of examples('http'))
  test(`http: ${lines[0]}`, async () => {
    const [, method, address, type, body] = lines[0].match(/^> (\S+) (\S+)(?: (\S+) (.*))?$/);
    const response = await daemon.get(address, { method, body, headers: type ? { 'content-type': type } : {} });
    const [, status, answered] = lines[1].match(/^< (\d+) (\S+)$/);
    assert.equal(response.status, Number(status));
    assert.equal(response.headers.get('content-type'), answered);
    const value = await response.json();
    if (lines[2]) assert.ok(contains(value, JSON.parse(lines[2].slice(2))), JSON.stringify(value).slice(0, 300));
  });
