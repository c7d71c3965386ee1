// SPDX-License-Identifier: GPL-3.0-or-later
// Runs headless Firefox with the parts of WebDriver BiDi that the tests need.
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import WebSocket from 'ws';

export class Firefox {
  #socket;
  #count = 0;
  #waiting = new Map(); // number of a command -> its promise
  #lines = [];
  #readers = new Set();

  static async launch() {
    const firefox = new Firefox();
    const profile = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-firefox-'));
    const options = ['--headless', '--no-remote', '--profile', profile, '--remote-debugging-port', '0', 'about:blank'];
    firefox.process = spawn('firefox-esr', options, { env: { ...process.env, HOME: profile }, stdio: ['ignore', 'ignore', 'pipe'] });
    firefox.profile = profile;
    const url = await new Promise((resolve, reject) => {
      let log = '';
      firefox.process.stderr.setEncoding('utf8').on('data', (text) => {
        log += text;
        const found = /WebDriver BiDi listening on (\S+)/.exec(log);
        if (found) resolve(found[1]);
      });
      firefox.process.on('error', reject).on('exit', () => reject(new Error(`Firefox ended:\n${log}`)));
    });
    await firefox.#connect(`${url}/session`);
    return firefox;
  }

  async #connect(url) {
    this.#socket = new WebSocket(url);
    await once(this.#socket, 'open');
    this.#socket.on('message', (text) => this.#hear(JSON.parse(text)));
    await this.#send('session.new', { capabilities: {} });
    await this.#send('session.subscribe', { events: ['log.entryAdded'] });
    const { contexts } = await this.#send('browsingContext.getTree');
    this.context = contexts[0].context;
  }

  #hear({ id, type, result, message, method, params }) {
    if (id) {
      const { resolve, reject } = this.#waiting.get(id);
      this.#waiting.delete(id);
      if (type === 'error') reject(new Error(message));
      else resolve(result);
    } else if (method === 'log.entryAdded') {
      this.#lines.push(params.text);
      for (const reader of this.#readers) reader();
    }
  }

  #send(method, params = {}) {
    return new Promise((resolve, reject) => {
      const id = ++this.#count;
      this.#waiting.set(id, { resolve, reject });
      this.#socket.send(JSON.stringify({ id, method, params }));
    });
  }

  open(url) {
    return this.#send('browsingContext.navigate', { context: this.context, url, wait: 'complete' });
  }

  /** A user's click. */
  click(x, y) {
    const actions = [{ type: 'pointerMove', x, y }, { type: 'pointerDown', button: 0 }, { type: 'pointerUp', button: 0 }];
    return this.#send('input.performActions', { context: this.context, actions: [{ type: 'pointer', id: 'mouse', actions }] });
  }

  /** Waits for the next console message with this prefix. */
  said(beginning) {
    return new Promise((resolve) => {
      const read = () => {
        const at = this.#lines.findIndex((line) => line.startsWith(beginning));
        if (at < 0) return;
        this.#readers.delete(read);
        resolve(this.#lines.splice(at, 1)[0]);
      };
      this.#readers.add(read);
      read();
    });
  }

  async close() {
    this.#socket?.close();
    const gone = once(this.process, 'exit');
    this.process.kill();
    await gone;
    fs.rmSync(this.profile, { recursive: true, force: true, maxRetries: 5 });
  }
}
