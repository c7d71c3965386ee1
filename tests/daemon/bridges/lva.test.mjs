// SPDX-License-Identifier: GPL-3.0-or-later
// faccia-lva with a stand-in for Linux Voice Assistant, which is not packaged: it speaks its peripheral API (docs/peripheral_api.md there).
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { createHash } from 'node:crypto';
import { once } from 'node:events';
import fs from 'node:fs';
import net from 'node:net';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { WebSocketServer } from 'ws';
import { build, Daemon, eventually } from '../../lib/daemon.mjs';

let daemon, kiosk, assistant, door, told;
const start = (...options) => {
  const child = spawn(path.join(build, 'server/bridges/faccia-lva'), options);
  child.text = '';
  child.stderr.setEncoding('utf8').on('data', (text) => (child.text += text));
  child.stdout.resume();
  child.exited = once(child, 'exit').then(([code]) => code);
  return child;
};
/** Starts the assistant, which sends events to all peripherals. */
async function open(port = 0) {
  const server = new WebSocketServer({ port, host: '127.0.0.1' });
  await once(server, 'listening');
  const snapshot = { muted: false, volume: 0.8, ha_connected: true, last_stt_text: null, last_tts_text: null };
  server.on('connection', (socket) => socket.send(JSON.stringify({ event: 'snapshot', data: snapshot })));
  return {
    server, port: server.address().port,
    tell: (event, data) => server.clients.forEach((socket) => socket.send(typeof event === 'string' && !data && event.startsWith('raw:') ? event.slice(4) : JSON.stringify({ event, ...(data && { data }) }))),
    close: () => (server.clients.forEach((socket) => socket.terminate()), new Promise((resolve) => server.close(resolve))),
  };
}
/** Sends an event. Returns the next state that the room gets. */
async function shows(event, data) {
  const from = kiosk.messages.length;
  assistant.tell(event, data);
  return eventually(() => kiosk.messages.slice(from).find((m) => m.type === 'state'), `a state after ${event}`);
}
before(async () => {
  daemon = await Daemon.start();
  kiosk = await daemon.stream('?lang=it&room=kitchen');
  await kiosk.wait({ type: 'joined' });
  assistant = await open();
  door = start('--assistant', `ws://localhost:${assistant.port}`, '--room', 'kitchen', '--lang', 'it', '--url', daemon.url);
  await kiosk.wait({ type: 'state', state: 'idle' }); // the initial state
});
after(async () => {
  door.kill('SIGTERM');
  assert.equal(await door.exited, 0, door.text);
  await assistant.close();
  await kiosk.close();
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});

test('shows the state of the assistant', async () => {
  for (const [event, data, state, text] of [
    ['wake_word_detected', undefined, 'listening'], ['listening', undefined, 'listening'], ['stt_text', { text: 'Che tempo fa?' }, 'thinking', 'Che tempo fa?'],
    ['tts_text', { text: 'C’è il sole.' }, 'idle', 'C’è il sole.'], ['tts_finished', undefined, 'idle'], ['muted', { muted: true }, 'muted'], ['idle', undefined, 'muted'],
    ['muted', { muted: false }, 'idle'], ['pipeline_error', { reason: 'no-stt' }, 'idle', 'no-stt'], ['timer_ringing', { id: 't', name: 'Pasta', total_seconds: 60, seconds_left: 0 }, 'idle', 'Pasta'],
  ]) {
    const shown = await shows(event, data);
    assert.deepEqual([shown.state, shown.text], [state, text], event);
  }
  assert.ok(!kiosk.messages.some((m) => m.type === 'begin'), 'the assistant is heard itself');
});

test('the face speaks the answer when the assistant is silent', async () => {
  assistant.tell('volume_changed', { volume: 0 });
  assistant.tell('tts_text', { text: 'Piove a dirotto.' });
  await kiosk.wait({ type: 'sentence', text: 'Piove a dirotto.' });
  await kiosk.wait({ type: 'end', reason: 'done' });
  assistant.tell('volume_changed', { volume: 0.5 });
  assistant.tell('volume_muted', { muted: true });
  assistant.tell('tts_text', { text: 'Adesso nevica.' });
  await kiosk.wait({ type: 'sentence', text: 'Adesso nevica.' });
  assistant.tell('volume_muted', { muted: false });
  const from = kiosk.messages.length;
  await shows('tts_text', { text: 'E ora no.' });
  await shows('idle');
  assert.ok(!kiosk.messages.slice(from).some((m) => m.type === 'sentence'));
});

test('ignores invalid events, and reconnects to a lost assistant', async () => {
  for (const wrong of ['raw:x', 'raw:{"event":7}', 'raw:[]', `raw:${'x'.repeat(100000)}`]) assistant.tell(wrong);
  assert.equal((await shows('listening')).state, 'listening');
  const { port } = assistant;
  await assistant.close();
  await eventually(() => door.text.includes('the assistant is unreachable'), 'the loss');
  kiosk.messages.length = 0;
  const other = net.createServer((socket) => (socket.on('error', () => {}).resume(), socket.end('HTTP/1.1 200 OK\r\nContent-Length: 0\r\n\r\n'))).listen(port, '127.0.0.1');
  await eventually(() => door.text.includes('there is no WebSocket'), 'the refusal of what is no WebSocket');
  await new Promise((resolve) => other.close(resolve));
  assistant = await open(port);
  const found = (from) => eventually(() => door.text.slice(from).includes('connected to the assistant'), 'a new connection');
  await found(door.text.lastIndexOf('is unreachable'));
  const listens = async () => {
    kiosk.messages.length = 0;
    assistant.tell('listening');
    await kiosk.wait({ type: 'state', state: 'listening' });
  };
  await listens();
  // a message that is too long ends the connection; the bridge reconnects
  told = door.text.length;
  assistant.tell(`raw:"${'x'.repeat(1 << 21)}"`);
  await found(told);
  await listens();
});

/** A server that sends arbitrary frames to each client. */
async function strange(serve) {
  const came = [], sockets = [];
  const server = net.createServer((socket) => {
    came.push(Date.now());
    sockets.push(socket);
    socket.on('error', () => {});
    socket.once('data', (head) => {
      const key = /sec-websocket-key: (.*)\r/i.exec(head)[1];
      const accept = createHash('sha1').update(`${key}258EAFA5-E914-47DA-95CA-C5AB0DC85B11`).digest('base64');
      socket.write(`HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: ${accept}\r\n\r\n`);
      serve(socket);
    });
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  return { came, url: `ws://127.0.0.1:${server.address().port}`, close: () => (sockets.forEach((socket) => socket.destroy()), new Promise((resolve) => server.close(resolve))) };
}
const frame = (opcode, payload, size = payload.length) => {
  const head = Buffer.alloc(10);
  head[0] = 0x80 | opcode, head[1] = 127, head.writeBigUInt64BE(BigInt(size), 2);
  return Buffer.concat([head, payload]);
};
const resident = ({ pid }) => Number(/VmRSS:\s+(\d+)/.exec(fs.readFileSync(`/proc/${pid}/status`, 'utf8'))[1]);

test('discards messages that are too long and what follows; reconnects with backoff', async () => {
  let sent = 0;
  const server = await strange((socket) => { // ignores the close
    socket.write(frame(1, Buffer.alloc(0), 1 << 30));
    const more = () => {
      if (socket.destroyed || sent >= 64 << 20) return;
      sent += 1 << 20;
      if (socket.write(Buffer.alloc(1 << 20, 120))) setImmediate(more);
      else socket.once('drain', more);
    };
    more();
  });
  const lva = start('--assistant', server.url, '--url', daemon.url);
  await eventually(() => lva.text.includes('too long'), `the loss; ${lva.text}`);
  await eventually(() => server.came.length >= 3, 'the next tries');
  assert.ok(server.came[2] - server.came[1] > 800, `${server.came}`);
  assert.ok(sent < 32 << 20, 'most of it was not read');
  assert.ok(resident(lva) < (process.env.FACCIA_BUILD?.includes('sanitized') ? 200 : 40) << 10, `${resident(lva)} kB`);
  lva.kill('SIGTERM');
  assert.equal(await lva.exited, 0, lva.text);
  await server.close();
});

test('survives a server that disconnects while being answered', async () => {
  const pings = await strange((socket) => {
    for (let i = 0; i < 200; i++) socket.write(frame(9, Buffer.alloc(100)));
    socket.resetAndDestroy();
  });
  for (const [server, told] of [[pings, /unreachable/]]) {
    const lva = start('--assistant', server.url, '--url', daemon.url);
    await eventually(() => told.test(lva.text), `${told}; ${lva.text}`);
    await eventually(() => server.came.length >= 2, 'the next try');
    lva.kill('SIGTERM');
    assert.equal(await lva.exited, 0, lva.text);
    await server.close();
  }
});

test('retries a server that disconnects at any point of the handshake', async () => {
  const ways = [(socket) => socket.resetAndDestroy(), (socket) => socket.destroy(),
    (socket) => socket.once('data', () => (socket.write('HTTP/1.1 101 Switching'), socket.resetAndDestroy())), (socket) => socket.once('data', () => socket.end('HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\n'))];
  const doors = await Promise.all(ways.map(async (way) => {
    const server = net.createServer((socket) => (server.came++, way(socket.on('error', () => {}))));
    server.came = 0;
    await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
    return { server, lva: start('--assistant', `ws://127.0.0.1:${server.address().port}`, '--url', daemon.url) };
  }));
  for (const [i, { server, lva }] of doors.entries()) {
    await eventually(() => server.came >= 3, `the third try, ${i}; ${lva.text}`);
    lva.kill('SIGTERM');
    assert.equal(await lva.exited, 0, lva.text);
    await new Promise((resolve) => server.close(resolve));
  }
});

test('a flood of events ends with the last of them', async () => {
  for (let i = 0; i < 2000; i++) assistant.tell(i % 2 ? 'listening' : 'idle');
  assistant.tell('stt_text', { text: 'the last' });
  await kiosk.wait({ type: 'state', state: 'thinking', text: 'the last' });
  await shows('idle');
});

test('keeps speaking when the voice or language is unknown to the daemon', async () => {
  for (const options of [['--voice', 'nobody:x'], ['--lang', 'xx'], ['--voice', 'nobody:x', '--lang', 'xx']]) {
    const from = kiosk.messages.length;
    const other = start('--assistant', `ws://localhost:${assistant.port}`, '--room', 'kitchen', '--speak', 'always', '--url', daemon.url, ...options);
    await kiosk.wait({ type: 'state' }, { from }); // the initial state
    await new Promise((resolve) => setTimeout(resolve, 300)); // it looks on in the room, too
    assistant.tell('tts_text', { text: `Parla ${options.join(' ')}.` });
    await kiosk.wait((m) => m.type === 'sentence' && m.text.startsWith(`Parla ${options[0]}`), { from });
    await kiosk.wait({ type: 'end', reason: 'done' }, { from });
    other.kill('SIGTERM');
    assert.equal(await other.exited, 0, other.text);
    assert.match(other.text, /it is spoken without/);
  }
});

test('reports wrong options', async () => {
  for (const options of [['--assistant', 'http://x'], ['--assistant', 'ws://x'], ['--speak', 'loud'], ['--nothing'], ['x'], ['--url', 'kitchen']]) assert.equal(await start(...options).exited, 2, String(options));
  assert.equal(await start('--help').exited, 0);
});
