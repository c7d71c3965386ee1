// SPDX-License-Identifier: GPL-3.0-or-later
// A small server of the Wyoming protocol with espeak-ng's voice. Runs in a thread, so that it serves while a test blocks on a child process.
// Posts its port. The speaker of the requested voice selects its misbehaviour.
import { spawnSync } from 'node:child_process';
import net from 'node:net';
import { parentPort } from 'node:worker_threads';

const sound = { rate: 22050, width: 2, channels: 1 };

/** Encodes an event like the servers' library: data after the header, or within it. */
const event = (type, data, payload, within) => {
  const body = Buffer.from(JSON.stringify(data));
  const lengths = { ...(within ? { data } : { data_length: body.length }), ...(payload && { payload_length: payload.length }) };
  return Buffer.concat([Buffer.from(`${JSON.stringify({ type, version: '1.5.2', ...lengths })}\n`), within ? Buffer.alloc(0) : body, payload ?? Buffer.alloc(0)]);
};

/** Takes the first complete event of the received bytes, or returns null. */
function take(bytes) {
  const end = bytes.indexOf('\n');
  if (end < 0) return null;
  const header = JSON.parse(bytes.subarray(0, end));
  const length = header.data_length ?? 0;
  if (bytes.length < end + 1 + length) return null;
  return { type: header.type, data: { ...header.data, ...(length && JSON.parse(bytes.subarray(end + 1, end + 1 + length))) } };
}

function answer(socket, { type, data: { text, voice } }) {
  if (type !== 'synthesize' || voice?.name !== 'it_IT-paola-medium') return socket.end(event('error', { text: `there is no voice ${voice?.name}` }));
  if (voice.speaker === 'huge') return socket.end('{"type": "audio-chunk", "payload_length": 99999999999}\n');
  if (voice.speaker === 'babble') return socket.end('HTTP/1.1 400 Bad Request\r\n\r\n');
  const pcm = spawnSync('espeak-ng', ['-v', 'it', '--stdout', '--', text], { maxBuffer: 1 << 26 }).stdout.subarray(44);
  const events = [event('audio-start', sound, null, true)];
  for (let at = 0; at < pcm.length; at += 2048) events.push(event('audio-chunk', { ...sound, timestamp: at }, pcm.subarray(at, at + 2048), at % 4096));
  if (voice.speaker !== 'hangs-up') events.push(event('audio-stop', { timestamp: pcm.length }));
  // sends in arbitrary pieces
  const bytes = Buffer.concat(events);
  socket.setNoDelay(true);
  for (let at = 0; at < bytes.length; at += 1777) socket.write(bytes.subarray(at, at + 1777));
  if (voice.speaker === 'hangs-up') return socket.end();
  return socket; // the client closes the connection
}

const server = net.createServer((socket) => {
  let bytes = Buffer.alloc(0);
  socket.on('error', () => {});
  socket.on('data', (part) => {
    bytes = Buffer.concat([bytes, part]);
    const request = take(bytes);
    if (!request) return;
    bytes = Buffer.alloc(0);
    answer(socket, request);
  });
});
server.listen(0, '127.0.0.1', () => parentPort.postMessage(server.address().port));
