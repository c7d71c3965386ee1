// SPDX-License-Identifier: GPL-3.0-or-later
// Starts the real daemon on a free port, and provides clients for it.
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import path from 'node:path';
import { after } from 'node:test';
import { fileURLToPath } from 'node:url';
import WebSocket from 'ws';
import { decodeChunk } from '../../protocol/chunk/chunk.mjs';
import { CompactReader, isCompact } from '../../protocol/chunk/compact.mjs';

export const root = path.resolve(fileURLToPath(import.meta.url), '../../..');
export const build = process.env.FACCIA_BUILD ?? path.join(root, 'build');
/** The ordinary build, for tests that take minutes with the sanitizers; it contains the models. */
export const ordinary = process.env.FACCIA_MODELS ? path.dirname(process.env.FACCIA_MODELS) : build;
export const artefacts = process.env.FACCIA_ARTEFACTS ?? path.join(root, 'build', 'test-artefacts');

// Kills daemons that a failed test left running, so that the test process ends. Hooks that stop daemons get some time first. Not for
// benchmarks.
const running = new Set();
const kill = () => running.forEach((child) => child.kill('SIGKILL'));
if (process.execArgv.some((option) => option.startsWith('--test'))) after(() => void setTimeout(kill, 20000).unref());

/** Polls until the condition returns something truthy, for states without a notification. Returns that value. */
export async function eventually(condition, what = String(condition), milliseconds = 120000) {
  const deadline = Date.now() + milliseconds;
  for (;;) {
    const value = await condition();
    if (value) return value;
    if (Date.now() > deadline) throw new Error(`waited in vain for ${what}`);
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
}

export class Daemon {
  /**
   * @param {string[]} options of facciad; env: further variables; program: started instead of facciad, which it execs;
   *   voices: false = do not wait for the voices
   */
  static async start(options = [], env = {}, { voices = true, program = path.join(build, 'server/daemon/facciad') } = {}) {
    const daemon = new Daemon();
    daemon.log = '';
    daemon.process = spawn(program, ['--port', '0', ...options], {
      stdio: ['ignore', 'ignore', 'pipe'],
      // stops without waiting for the end of speech; no limits per address, because all test clients share one
      env: { FACCIA_STOP_SECONDS: '0', FACCIA_MAX_PER_ADDRESS: '0', FACCIA_MAX_REQUESTS: '0', FACCIA_MAX_ROOMS_PER_ADDRESS: '0', FACCIA_MAX_VOICES_PER_ADDRESS: '0', ...process.env, ...env },
    });
    running.add(daemon.process);
    daemon.exited = once(daemon.process, 'exit').then(([code, signal]) => {
      running.delete(daemon.process);
      return { code, signal };
    });
    daemon.process.stderr.setEncoding('utf8').on('data', (text) => (daemon.log += text));
    const line = await daemon.logged(/listening on https?:\/\/(?:\[[^\]]*\]|[^:[]*):(\d+)\//, 240000);
    daemon.port = Number(line[1]);
    daemon.url = `http://127.0.0.1:${daemon.port}`;
    if (voices) await daemon.logged(/ready: |no voice plugin could be started/, 240000); // the daemon waits up to 30 s for voices, longer on a busy machine
    return daemon;
  }

  /** Waits until the log matches. Fails if the daemon exits first. */
  async logged(pattern, milliseconds = 120000) {
    const deadline = Date.now() + milliseconds;
    for (;;) {
      const match = this.log.match(pattern);
      if (match) return match;
      if (this.process.exitCode !== null || Date.now() > deadline)
        throw new Error(`the daemon did not log ${pattern}:\n${this.log}`);
      await new Promise((resolve) => setTimeout(resolve, 10));
    }
  }

  /** Stops the daemon with SIGTERM. A sanitizer report makes the exit code nonzero. */
  async stop() {
    this.process.kill('SIGTERM');
    return this.exited;
  }

  /** Returns the value of a metric; name: with its labels, if any. */
  async metric(name) {
    const report = await (await this.get('/metrics')).text();
    return Number(report.split('\n').find((line) => line.startsWith(`${name} `)).slice(name.length));
  }

  /** Calls act and waits until that many sentences were requested from voices. */
  async asks(act, sentences = 1) {
    const before = await this.metric('faccia_sentences_asked_total');
    act();
    while ((await this.metric('faccia_sentences_asked_total')) < before + sentences) await new Promise((resolve) => setTimeout(resolve, 10));
  }

  async get(address, options) {
    // A new connection each time: the daemon may close an idle one while a test blocks on a child process.
    return fetch(this.url + address, { ...options, headers: { connection: 'close', ...options?.headers } });
  }

  /** Waits until at most `most` connections are open, including that of the query itself. */
  async left(most) {
    await eventually(async () => (await (await this.get('/healthz')).json()).connections <= most, `no more than ${most} connections`);
  }

  /** Opens a stream with PCM and plain FAPs unless the query names an encoding. */
  stream(query = '', options = {}) {
    const media = /[?&](audio|fap)=/.test(query) ? '' : `${query ? '&' : '?'}audio=pcm&fap=plain`;
    return Stream.open(`ws://127.0.0.1:${this.port}/v1/stream${query}${media}`, options);
  }
}

/** A WebSocket client that records all messages. */
export class Stream {
  static async open(url, options, protocols = []) {
    const stream = new Stream();
    stream.messages = [];
    stream.chunks = [];
    stream.waiters = new Set();
    const reader = new CompactReader();
    stream.socket = new WebSocket(url, protocols, { perMessageDeflate: false, ...options });
    stream.socket.on('message', (data, binary) => {
      if (binary) {
        const chunk = { ...(isCompact(data) ? reader.decode(data) : decodeChunk(data)), bytes: data.length, arrived: performance.now() };
        stream.chunks.push(chunk);
        for (const event of chunk.events ?? []) stream.messages.push({ ...event, packed: true, arrived: chunk.arrived });
      } else stream.messages.push({ ...JSON.parse(data), arrived: performance.now() });
      for (const waiter of stream.waiters) waiter();
    });
    stream.closed = new Promise((resolve) => stream.socket.on('close', (code, reason) => resolve({ code, reason: String(reason) })));
    await new Promise((resolve, reject) => stream.socket.on('open', resolve).on('error', reject));
    return stream;
  }

  send(message) {
    this.socket.send(typeof message === 'string' ? message : JSON.stringify(message));
  }

  /** Waits for the first message from index `from` on that contains the pattern's members, or satisfies a function. */
  async wait(pattern, { from = 0, milliseconds = 60000 } = {}) {
    const fits = typeof pattern === 'function' ? pattern : (message) => contains(message, pattern);
    return this.until(() => this.messages.slice(from).find(fits), milliseconds, JSON.stringify(pattern) ?? String(pattern));
  }

  /** Waits until the condition returns something truthy. */
  until(condition, milliseconds = 60000, what = String(condition)) {
    return new Promise((resolve, reject) => {
      const timer = setTimeout(() => {
        this.waiters.delete(check);
        reject(new Error(`waited in vain for ${what}; heard ${JSON.stringify(this.messages.slice(-5))}`));
      }, milliseconds);
      const check = () => {
        const value = condition();
        if (!value) return;
        clearTimeout(timer);
        this.waiters.delete(check);
        resolve(value);
      };
      this.waiters.add(check);
      check();
    });
  }

  close() {
    this.socket.close();
    return this.closed;
  }
}

/** Tells whether the value contains everything in the pattern. "..." matches anything. */
export function contains(value, pattern) {
  if (pattern === '...') return value !== undefined;
  if (Array.isArray(pattern))
    return Array.isArray(value) && value.length === pattern.length && pattern.every((p, i) => contains(value[i], p));
  if (pattern && typeof pattern === 'object')
    return value && typeof value === 'object' && Object.keys(pattern).every((key) => contains(value[key], pattern[key]));
  return value === pattern;
}

/** Returns all FAP frames of an utterance in order: {time, values}. */
export function framesOf(chunks, utterance) {
  return chunks
    .filter((chunk) => utterance === undefined || chunk.utterance === utterance)
    .flatMap((chunk) => chunk.frames.map((values, i) => ({ time: (chunk.firstFrame + i) / chunk.fps, values })));
}
