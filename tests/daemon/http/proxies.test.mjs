// SPDX-License-Identifier: GPL-3.0-or-later
// Two daemons behind nginx, and behind HAProxy, with the files of server/packaging and TLS: all clients of a room reach one daemon; when
// that daemon stops, the room continues at the other.
import assert from 'node:assert/strict';
import { execFileSync, spawn, spawnSync } from 'node:child_process';
import { once } from 'node:events';
import fs from 'node:fs';
import net from 'node:net';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import WebSocket from 'ws';
import { Daemon, eventually, root } from '../../lib/daemon.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-proxies-'));
fs.chmodSync(folder, 0o755);
const at = (name) => path.join(folder, name);
const read = (name) => fs.readFileSync(path.join(root, 'server/packaging', name), 'utf8');
const rooms = ['cucina', 'sala', 'camera', 'bagno', 'studio', 'portico', 'giardino', 'soffitta'];
let daemons = [];

const place = ({ port }) => `127.0.0.1:${port}`;
const free = () => new Promise((resolve) => {
  const server = net.createServer().listen(0, '127.0.0.1', () => {
    const { port } = server.address();
    server.close(() => resolve(port));
  });
});

/** For each proxy: its file, adapted to these daemons, and how to start it. */
const proxies = {
  nginx: (port) => {
    const site = read('nginx.conf').replace('127.0.0.1:8081', place(daemons[0])).replace('127.0.0.1:8082', place(daemons[1]))
      .replace('listen 443 ssl http2', `listen 127.0.0.1:${port} ssl http2`).replace('/etc/ssl/faccia/cert.pem', at('cert.pem')).replace('/etc/ssl/faccia/key.pem', at('key.pem'));
    fs.writeFileSync(at('nginx.conf'), `daemon off; pid ${at('pid')}; error_log stderr; worker_processes 1; user root;
      events { } http { access_log off; ${['client_body', 'proxy', 'fastcgi', 'uwsgi', 'scgi'].map((name) => `${name}_temp_path ${at(name)};`).join(' ')} ${site} }`);
    return ['nginx', ['-c', at('nginx.conf')]];
  },
  haproxy: (port) => {
    fs.writeFileSync(at('haproxy.cfg'), read('haproxy.cfg').replace('127.0.0.1:8081', place(daemons[0])).replace('127.0.0.1:8082', place(daemons[1]))
      .replace('bind :443', `bind 127.0.0.1:${port}`).replace('/etc/ssl/faccia/both.pem', at('both.pem')));
    return ['haproxy', ['-db', '-f', at('haproxy.cfg')]];
  },
};

before(async () => {
  execFileSync('openssl', ['req', '-x509', '-newkey', 'ec', '-pkeyopt', 'ec_paramgen_curve:prime256v1', '-nodes', '-days', '2', '-subj', '/CN=localhost',
    '-keyout', at('key.pem'), '-out', at('cert.pem')], { stdio: 'ignore' });
  fs.writeFileSync(at('both.pem'), fs.readFileSync(at('cert.pem'), 'utf8') + fs.readFileSync(at('key.pem'), 'utf8'));
  daemons = await Promise.all([0, 1].map(() => Daemon.start()));
});
after(async () => {
  await Promise.all(daemons.map((daemon) => daemon.stop()));
  fs.rmSync(folder, { recursive: true });
});

/** Opens a client of a room through the proxy. */
async function client(port, query, message) {
  const socket = new WebSocket(`wss://localhost:${port}/v1/stream?events=text&${query}`, { rejectUnauthorized: false });
  socket.heard = [];
  socket.on('message', (data, binary) => binary || socket.heard.push(JSON.parse(data)));
  await once(socket, 'open');
  if (message) socket.send(JSON.stringify(message));
  socket.joined = await eventually(() => socket.heard.find(({ type }) => type === 'joined'), 'joined');
  return socket;
}

const say = (port, room, text) => {
  const { status, stdout, stderr } = spawnSync('curl', ['-sk', '--data-binary', text, `https://localhost:${port}/v1/say?room=${room}&lang=it`], { encoding: 'utf8' });
  assert.equal(status, 0, stderr);
  return JSON.parse(stdout);
};
const roomsOf = async (daemon) => (await (await daemon.get('/v1/rooms')).json()).rooms.filter(({ listeners }) => listeners).map(({ name }) => name);

for (const [name, command] of Object.entries(proxies))
  test(`${name}: routes all clients of a room to one daemon, and to another when it dies`, async () => {
    const port = await free();
    const proxy = spawn(...command(port), { stdio: ['ignore', 'ignore', 'pipe'] });
    const exited = once(proxy, 'exit');
    let log = '';
    proxy.stderr.setEncoding('utf8').on('data', (data) => (log += data));
    const sockets = [];
    try {
      await eventually(() => assert.equal(proxy.exitCode, null, log) ?? spawnSync('curl', ['-skf', `https://localhost:${port}/healthz`]).status === 0, `${name}: ${log}`);
      for (const room of rooms) {
        sockets.push(await client(port, `room=${room}`), await client(port, `key=${room}`, { type: 'join', room }));
        assert.deepEqual(say(port, room, 'Ciao.').listeners, 2, room);
      }
      for (const socket of sockets) await eventually(() => socket.heard.find(({ type }) => type === 'begin'), 'begin');
      const [first, second] = await Promise.all(daemons.map(roomsOf));
      assert.deepEqual([...first, ...second].sort(), [...rooms].sort());
      assert.ok(first.length && second.length, `all at one: ${first} | ${second}`);

      // one daemon dies: its clients are disconnected, and the other daemon serves its rooms
      const lost = sockets.filter(({ joined }) => first.includes(joined.room));
      const closed = lost.map((socket) => once(socket, 'close'));
      daemons[0].process.kill('SIGKILL');
      await daemons[0].exited;
      await Promise.all(closed);
      const again = await eventually(() => client(port, `room=${first[0]}`).catch(() => null), 'the other daemon');
      sockets.push(again);
      assert.equal(say(port, first[0], 'Eccomi.').listeners, 1);
      await eventually(() => again.heard.find(({ type }) => type === 'begin'), 'begin');
    } finally {
      for (const socket of sockets) socket.terminate();
      proxy.kill('SIGTERM');
      await exited;
      daemons[0] = await Daemon.start();
    }
  });
