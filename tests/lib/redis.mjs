// SPDX-License-Identifier: GPL-3.0-or-later
// A Redis server on a free port, which keeps nothing on disk.
import { execFileSync, spawn } from 'node:child_process';
import net from 'node:net';

const freePort = () =>
  new Promise((resolve) => {
    const server = net.createServer().listen(0, '127.0.0.1', () => {
      const { port } = server.address();
      server.close(() => resolve(port));
    });
  });

export class Redis {
  /** @param {{password?: string, database?: number, env?: object}} options env: further variables */
  static async start({ password, database = 0, env = {} } = {}) {
    const redis = Object.assign(new Redis(), { password, database, env, port: await freePort() });
    const login = password ? `:${encodeURIComponent(password)}@` : '';
    redis.url = `redis://${login}localhost:${redis.port}/${database}`;
    redis.again();
    return redis;
  }

  /** After it was killed, with nothing in it. */
  again() {
    const login = this.password ? ['--requirepass', this.password] : [];
    this.process = spawn('redis-server', ['--port', this.port, '--bind', '127.0.0.1', '--save', '', ...login], { stdio: 'ignore', env: { ...process.env, ...this.env } });
  }

  /** What redis-cli says. */
  cli(...words) {
    const login = this.password ? ['-a', this.password, '--no-auth-warning'] : [];
    return execFileSync('redis-cli', ['-p', this.port, '-n', this.database, ...login, ...words]).toString().trim();
  }

  /** The names that match, in the order in which they are found. */
  names(pattern = '*') {
    return this.cli('--scan', '--pattern', pattern).split('\n').filter(Boolean);
  }

  stop() {
    this.process.kill('SIGKILL');
  }
}
