// SPDX-License-Identifier: GPL-3.0-or-later
// A Redis server on a free port, without persistence.
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

  /** Restarts it, empty, after it was killed. */
  again() {
    const login = this.password ? ['--requirepass', this.password] : [];
    this.process = spawn('redis-server', ['--port', this.port, '--bind', '127.0.0.1', '--save', '', ...login], { stdio: 'ignore', env: { ...process.env, ...this.env } });
  }

  /** Runs redis-cli and returns its output. */
  cli(...words) {
    const login = this.password ? ['-a', this.password, '--no-auth-warning'] : [];
    return execFileSync('redis-cli', ['-p', this.port, '-n', this.database, ...login, ...words]).toString().trim();
  }

  /** Returns the keys that match the pattern. */
  names(pattern = '*') {
    return this.cli('--scan', '--pattern', pattern).split('\n').filter(Boolean);
  }

  stop() {
    this.process.kill('SIGKILL');
  }
}
