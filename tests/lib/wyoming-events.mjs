// SPDX-License-Identifier: GPL-3.0-or-later
// Both ends of the Wyoming protocol, as its Python library speaks it: an assistant that connects, and a service that is connected to.
import { once } from 'node:events';
import net from 'node:net';
import { eventually } from './daemon.mjs';

/** Encodes an event: a line, its data, its payload. */
export function encode(type, data = {}, payload = Buffer.alloc(0)) {
  const text = Buffer.from(JSON.stringify(data));
  const head = { type, version: '1.8.0', data_length: text.length, ...(payload.length && { payload_length: payload.length }) };
  return Buffer.concat([Buffer.from(`${JSON.stringify(head)}\n`), text, payload]);
}

/** Calls `take` for each event of a socket. */
function read(socket, take) {
  let bytes = Buffer.alloc(0);
  socket.on('error', () => {});
  socket.on('data', (part) => {
    bytes = Buffer.concat([bytes, part]);
    for (let end; (end = bytes.indexOf(10)) >= 0; ) {
      const { type, data: inLine = {}, data_length = 0, payload_length = 0 } = JSON.parse(bytes.subarray(0, end));
      const from = end + 1, middle = from + data_length, to = middle + payload_length;
      if (bytes.length < to) return;
      take({ type, data: { ...inLine, ...(data_length && JSON.parse(bytes.subarray(from, middle))) }, payload: Buffer.from(bytes.subarray(middle, to)) });
      bytes = bytes.subarray(to);
    }
  });
}

/** A peer: events so far, and what to do with its socket. */
function peer(socket, take = () => {}) {
  const self = {
    socket, events: [],
    send: (type, data, payload) => socket.write(encode(type, data, payload)),
    /** Waits for an event from `from` on that `is` accepts. */
    heard: (type, { from = 0, is = () => true } = {}) =>
      eventually(() => self.events.slice(from).find((e) => e.type === type && is(e)), `${type}; ${self.events.slice(from).map((e) => e.type)}`),
    closed: () => eventually(() => socket.closed || socket.destroyed, 'the end of the connection'),
    kill: () => socket.resetAndDestroy(),
  };
  read(socket, (event) => {
    self.events.push(event);
    take(event, self);
  });
  return self;
}

export async function connect(port, take) {
  const socket = net.connect(port, '127.0.0.1');
  await once(socket, 'connect');
  return peer(socket, take);
}

/** Serves; take(event, peer) is called for each event. */
export async function serve(take, port = 0) {
  const peers = [];
  const server = net.createServer((socket) => peers.push(peer(socket, take)));
  await new Promise((resolve) => server.listen(port, '127.0.0.1', resolve));
  return { peers, port: server.address().port, close: () => (peers.forEach(({ socket }) => socket.destroy()), new Promise((resolve) => server.close(resolve))) };
}

/** Samples of a tone, 16-bit mono. */
export function tone(seconds, rate = 16000, level = 5000) {
  const pcm = Buffer.alloc(2 * Math.round(seconds * rate));
  for (let i = 0; i < pcm.length / 2; i++) pcm.writeInt16LE(Math.round(level * Math.sin(i * 0.13) * (0.6 + 0.4 * Math.sin(i * 0.002))), 2 * i);
  return pcm;
}
