// SPDX-License-Identifier: GPL-3.0-or-later
// faccia-lva beside a stand-in of Linux Voice Assistant that speaks its peripheral API (docs/peripheral_api.md there; it is packaged nowhere).
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import net from 'node:net';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { WebSocketServer } from 'ws';
import { build, Daemon, eventually } from '../lib/daemon.mjs';

let daemon, kiosk, assistant, door, told;
const start = (...options) => {
  const child = spawn(path.join(build, 'server/doors/faccia-lva'), options);
  child.text = '';
  child.stderr.setEncoding('utf8').on('data', (text) => (child.text += text));
  child.stdout.resume();
  child.exited = once(child, 'exit').then(([code]) => code);
  return child;
};
/** The assistant: events to all peripherals. */
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
/** Tells an event; gives the state that the room is told next. */
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
  await kiosk.wait({ type: 'state', state: 'idle' }); // the snapshot
});
after(async () => {
  door.kill('SIGTERM');
  assert.equal(await door.exited, 0, door.text);
  await assistant.close();
  await kiosk.close();
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});

test('what the assistant does is shown', async () => {
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

test('where the assistant is silent, the face says its answer', async () => {
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

test('what is no event costs nothing, and an assistant that goes is found again', async () => {
  for (const wrong of ['raw:x', 'raw:{"event":7}', 'raw:[]', `raw:${'x'.repeat(100000)}`]) assistant.tell(wrong);
  assert.equal((await shows('listening')).state, 'listening');
  const { port } = assistant;
  await assistant.close();
  await eventually(() => door.text.includes('the assistant is not there'), 'the loss');
  kiosk.messages.length = 0;
  const other = net.createServer((socket) => (socket.on('error', () => {}).resume(), socket.end('HTTP/1.1 200 OK\r\nContent-Length: 0\r\n\r\n'))).listen(port, '127.0.0.1');
  await eventually(() => door.text.includes('there is no WebSocket'), 'the refusal of what is no WebSocket');
  await new Promise((resolve) => other.close(resolve));
  assistant = await open(port);
  const found = (from) => eventually(() => door.text.slice(from).includes('the assistant is there'), 'a new connection');
  await found(door.text.lastIndexOf('is not there'));
  const listens = async () => {
    kiosk.messages.length = 0;
    assistant.tell('listening');
    await kiosk.wait({ type: 'state', state: 'listening' });
  };
  await listens();
  // a message that is too long ends the connection, which is made again
  told = door.text.length;
  assistant.tell(`raw:"${'x'.repeat(1 << 21)}"`);
  await found(told);
  await listens();
});

test('options that are wrong are told', async () => {
  for (const options of [['--assistant', 'http://x'], ['--assistant', 'ws://x'], ['--speak', 'loud'], ['--nothing'], ['x'], ['--url', 'kitchen']]) assert.equal(await start(...options).exited, 2, String(options));
  assert.equal(await start('--help').exited, 0);
});
