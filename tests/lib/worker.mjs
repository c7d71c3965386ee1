// SPDX-License-Identifier: GPL-3.0-or-later
// Starts faccia-worker, which speaks for daemons on other machines.
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import path from 'node:path';
import { build, eventually } from './daemon.mjs';

const running = new Set();
process.once('exit', () => running.forEach((child) => child.kill('SIGKILL')));

export class Worker {
  /** @param {string[]} options */
  static async start(options) {
    const worker = new Worker();
    worker.log = '';
    worker.process = spawn(path.join(build, 'server/daemon/faccia-worker'), options, {
      stdio: ['ignore', 'ignore', 'pipe'],
      env: { FACCIA_STOP_SECONDS: '0', ...process.env },
    });
    worker.process.stderr.setEncoding('utf8').on('data', (text) => (worker.log += text));
    worker.exited = once(worker.process, 'exit').then(([code, signal]) => ({ code, signal }));
    running.add(worker.process);
    worker.process.once('exit', () => running.delete(worker.process));
    await worker.logged(/ready: |\(bad-/);
    return worker;
  }

  async logged(pattern) {
    return eventually(() => this.log.match(pattern), `the worker to log ${pattern}; it said:\n${this.log}`);
  }

  async stop() {
    this.process.kill('SIGTERM');
    return this.exited;
  }
}
