// SPDX-License-Identifier: GPL-3.0-or-later
// Many clients at once send valid, damaged and hostile messages and requests in random order, split at random places, and
// disconnect at any time. The daemon must keep answering, speak normally afterwards, and stop cleanly. FACCIA_CHAOS_SECONDS and
// FACCIA_CHAOS_SEED set duration and seed; the artefacts contain everything that was sent.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { copyFileSync, createWriteStream, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import net from 'node:net';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { setTimeout as sleep } from 'node:timers/promises';
import { Chance, httpRequest, messageText, upgradeRequest, webSocketFrames } from '../../lib/chaos.mjs';
import { artefacts, build, Daemon, eventually, root } from '../../lib/daemon.mjs';

const seconds = Number(process.env.FACCIA_CHAOS_SECONDS ?? 15);
const seed = Number(process.env.FACCIA_CHAOS_SEED ?? 1);
const clients = 8;
/** ms without any answer after which the daemon counts as hanging. */
const silence = 20000;

/** A connection that never throws: errors are expected here. */
class Connection {
  constructor(port, log) {
    this.log = log;
    this.bytes = 0;
    this.heard = Buffer.alloc(0);
    this.socket = net.connect({ port, host: '127.0.0.1', allowHalfOpen: true });
    this.ended = new Promise((resolve) => this.socket.on('close', resolve).on('error', () => {}));
    this.socket.on('data', (data) => {
      this.bytes += data.length;
      if (this.heard.length < 4096) this.heard = Buffer.concat([this.heard, data]);
    });
  }

  /** Sends the bytes whole or in pieces. */
  async send(bytes, chance) {
    if (!this.socket.writable) return;
    this.log.write(`${this.socket.localPort ?? '-'} ${bytes.length > 2000 ? `${bytes.subarray(0, 2000).toString('latin1')}... ${bytes.length} bytes` : bytes.toString('latin1')}\n`);
    if (chance.one(3) && bytes.length > 1) {
      const cut = 1 + chance.below(Math.min(bytes.length - 1, 3000));
      this.socket.write(bytes.subarray(0, cut));
      await sleep(chance.below(3));
      bytes = bytes.subarray(cut);
    }
    if (this.socket.writable) this.socket.write(bytes);
  }

  async end(chance) {
    const how = chance.below(4);
    if (how === 0) this.socket.resetAndDestroy();
    else if (how === 1) this.socket.destroy();
    else this.socket.end(); // half-close
    if (how === 2) await Promise.race([this.ended, sleep(chance.below(200))]);
    this.socket.destroy();
    await this.ended;
  }
}

/** A WebSocket client that rarely follows the protocol. */
async function socketClient(port, chance, log) {
  const connection = new Connection(port, log);
  await connection.send(Buffer.concat([upgradeRequest(chance), ...(chance.one(4) ? webSocketFrames(chance, messageText(chance)) : [])]), chance);
  for (let i = chance.below(12); i > 0; i--) {
    const some = Array.from({ length: 1 + chance.below(3) }, () => webSocketFrames(chance, messageText(chance))).flat();
    await connection.send(Buffer.concat(some), chance);
    await sleep(chance.below(30));
  }
  await connection.end(chance);
}

/** Sends several pipelined requests. */
async function requestClient(port, chance, log) {
  const connection = new Connection(port, log);
  for (let i = 1 + chance.below(3); i > 0; i--) {
    await connection.send(Buffer.concat(Array.from({ length: 1 + chance.below(4) }, () => httpRequest(chance))), chance);
    await sleep(chance.below(20));
  }
  await connection.end(chance);
}

/** A well-behaved client, which must always get answers. */
async function goodClient(daemon, chance) {
  const stream = await daemon.stream(chance.one(2) ? '?room=hall' : '');
  for (let i = 0; i < 3; i++) {
    const from = stream.messages.length, id = String(chance.below(1e9));
    stream.send({ type: 'ping', id });
    await stream.wait({ type: 'pong', id }, { from, milliseconds: silence });
    await sleep(chance.below(50));
  }
  await stream.close();
}

/** Polls /healthz and records the statuses. */
async function watchHealth(daemon, until, statuses) {
  while (performance.now() < until) {
    const response = await daemon.get('/healthz', { signal: AbortSignal.timeout(silence) }).catch((error) => {
      if (error.name === 'TimeoutError' || statuses.length === 1) throw error;
    });
    assert.ok(!response || statuses.includes(response.status), `healthz answers ${response?.status}`);
    await response?.arrayBuffer();
    await sleep(200); // polling interval
  }
}

/** Checks that the daemon speaks normally, and that rooms contain only connected clients. */
async function speaksAsEver(daemon, token) {
  const query = token ? `?token=${token}` : '';
  const stream = await daemon.stream(query);
  stream.send({ type: 'speak', id: 'after', lang: 'it', text: 'Eccomi ancora qui.' });
  const end = await stream.wait({ type: 'end', id: 'after' }, { milliseconds: 60000 });
  assert.equal(end.reason, 'done');
  assert.ok(stream.chunks.length > 3);
  await stream.close();
  const left = async () => (await (await daemon.get(`/v1/rooms${query}`)).json()).rooms.length;
  await eventually(async () => !(await left()), 'no room: it does not outlive its members');
}

/** @param {{options: string[], token: string, statuses: number[]}} token: shared by all clients; statuses: allowed for /healthz */
async function chaos(seconds, { options = [], token, statuses = [200] } = {}) {
  const log = createWriteStream(path.join(artefacts, `chaos-messages${token ? '-limited' : ''}.log`));
  const daemon = await Daemon.start(['--media', folder, ...options]);
  const until = performance.now() + seconds * 1000;
  let done = 0;
  const client = async (number) => {
    const chance = new Chance(seed * 1000 + number);
    chance.token = token;
    for (; performance.now() < until; done++) {
      if (number === 0 && !token) await goodClient(daemon, chance);
      else if (chance.one(2)) await socketClient(daemon.port, chance, log);
      else await requestClient(daemon.port, chance, log);
    }
  };
  try {
    await Promise.all([watchHealth(daemon, until, statuses), ...Array.from({ length: clients }, (_, number) => client(number))]);
    assert.equal(daemon.process.exitCode, null, daemon.log);
    await speaksAsEver(daemon, token);
    assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
    assert.doesNotMatch(daemon.log, /Sanitizer|runtime error/);
    assert.ok(done > clients, `only ${done} connections`);
    console.log(`${done} connections`);
  } catch (error) {
    daemon.process.kill('SIGKILL');
    throw new Error(`${error.message}\n${daemon.log.slice(-4000)}`, { cause: error });
  } finally {
    log.end();
  }
}

const folder = mkdtempSync(path.join(tmpdir(), 'faccia-chaos-'));
copyFileSync(path.join(root, 'protocol/vectors/fap/all-faps.fap'), path.join(folder, 'all.fap'));
after(() => rmSync(folder, { recursive: true }));

test(`survives random messages with all interfaces open, seed ${seed}`, () => chaos(seconds * 0.7));

test(`survives random messages with tokens and small limits, seed ${seed}`, async () => {
  const secrets = path.join(folder, 'secrets');
  writeFileSync(secrets, 'a secret that is long enough for the daemon\n', { mode: 0o600 });
  const { stdout } = spawnSync(path.join(build, 'server/cli/faccia'), ['token', '--secret-file', secrets, '--subject', 'anna', '--rights', 'listen,speak'], { encoding: 'utf8' });
  const limits = { connections: 12, rooms: 2, queue: 3, text: 2000, message: 5000, play: 2048, 'per-address': 10 };
  const options = Object.entries(limits).flatMap(([name, limit]) => [`--max-${name}`, String(limit)]);
  await chaos(seconds * 0.3, { options: ['--secret-file', secrets, '--send-bytes', '4096', '--send-bytes-max', '65536', ...options], token: stdout.trim(), statuses: [200, 429, 503] });
});
