// SPDX-License-Identifier: GPL-3.0-or-later
// A room's home that a test plays: it has the lease, hears what a daemon asks of it, and says what it likes (server/rooms/shared/shared_internal.h).
import { spawn } from 'node:child_process';
import { eventually } from './daemon.mjs';

/** A daemon's name as a number, FNV-1a (home_base.c). */
function ofName(name) {
  let hash = 2166136261;
  for (const c of Buffer.from(name)) hash = Math.imul(hash ^ c, 16777619) >>> 0;
  return BigInt(hash & 0x7fffffff || 1) << 32n;
}

export class StandInHome {
  /** @param {import('./redis.mjs').Redis} redis @param {string} room @param {number} token @param {{lease?: boolean}} options lease: whether it takes it; else it is a branch */
  static async open(redis, room, token, { lease = true } = {}) {
    const home = Object.assign(new StandInHome(), { redis, room, token, name: token.toString(16).padStart(32, 'f'), heard: [] });
    home.ear = spawn('redis-cli', ['-p', redis.port, 'subscribe', `faccia:to:${home.name}`], { stdio: ['ignore', 'pipe', 'ignore'] });
    let text = '';
    home.ear.stdout.setEncoding('utf8').on('data', (more) => {
      const lines = (text += more).split('\n');
      text = lines.pop();
      for (const line of lines) if (line.startsWith('{')) home.heard.push(JSON.parse(line));
    });
    await eventually(() => redis.cli('pubsub', 'channels').includes(home.name), 'the stand-in to listen');
    if (lease) redis.cli('set', `faccia:lease:room:${room}`, `${home.name} ${token}`, 'px', '60000');
    return home;
  }

  /** What a daemon has told it. @param {string} kind @param {(head: object) => boolean} fits */
  told(kind, fits = () => true) {
    return eventually(() => this.heard.find((head) => head.kind === kind && fits(head)), `${kind}; heard ${JSON.stringify(this.heard)}`);
  }

  /** Anything. @param {string} to @param {string} kind @param {object} rest of the head, in which a BigInt is written whole */
  tell(to, kind, rest, body = '') {
    const head = JSON.stringify({ v: 4, kind, room: this.room, token: this.token, from: this.name, ...rest }, (_, value) => (typeof value === 'bigint' ? `#${value}` : value)).replace(/"#(\d+)"/g, '$1');
    this.redis.cli('publish', `faccia:to:${to}`, `${head}\n${body}`);
  }

  recap(to) {
    this.tell(to, 'recap', { speaks: 0, past: 0 });
  }

  /** @param {object} order as it was told */
  answer({ from, number, visit }, utterance) {
    this.tell(from, 'answer', { number, visit, status: 202, answer: { type: 'accepted', room: this.room, utterance } });
  }

  /** It is not the home (yet), and has done nothing. */
  pass({ from, number, visit }) {
    this.tell(from, 'answer', { number, visit, status: 0 });
  }

  /** Events. @param {object} order what they are of, or null */
  say(to, order, ...messages) {
    const bodies = messages.map((message) => JSON.stringify(message));
    const whose = order ? { order: ofName(order.from) | BigInt(order.number) } : {};
    this.tell(to, 'said', { parts: messages.map(({ type }, i) => ({ event: type, size: bodies[i].length, line: 0, ...whose })) }, bodies.join(''));
  }

  close() {
    this.ear.kill();
  }
}
