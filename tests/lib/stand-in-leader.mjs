// SPDX-License-Identifier: GPL-3.0-or-later
// A stand-in for a room's leader: holds the lease, records packets from a daemon, and sends arbitrary ones (server/rooms/shared/shared_internal.h).
import { spawn } from 'node:child_process';
import { eventually } from './daemon.mjs';

/** A daemon's name as a number: FNV-1a, as shared_daemon in leader.c. */
function ofName(name) {
  let hash = 2166136261;
  for (const c of Buffer.from(name)) hash = Math.imul(hash ^ c, 16777619) >>> 0;
  return BigInt(hash & 0x7fffffff || 1) << 32n;
}

export class StandInLeader {
  /** @param {import('./redis.mjs').Redis} redis @param {string} room @param {number} token @param {{lease?: boolean}} options lease: false: does not take the lease, so it acts as a replica */
  static async open(redis, room, token, { lease = true } = {}) {
    const leader = Object.assign(new StandInLeader(), { redis, room, token, name: token.toString(16).padStart(32, 'f'), heard: [] });
    leader.ear = spawn('redis-cli', ['-p', redis.port, 'subscribe', `faccia:to:${leader.name}`], { stdio: ['ignore', 'pipe', 'ignore'] });
    let text = '';
    leader.ear.stdout.setEncoding('utf8').on('data', (more) => {
      const lines = (text += more).split('\n');
      text = lines.pop();
      for (const line of lines) if (line.startsWith('{')) leader.heard.push(JSON.parse(line));
    });
    await eventually(() => redis.cli('pubsub', 'channels').includes(leader.name), 'the stand-in to listen');
    if (lease) redis.cli('set', `faccia:lease:room:${room}`, `${leader.name} ${token}`, 'px', '60000');
    return leader;
  }

  /** Waits for a packet from a daemon. @param {string} kind @param {(head: object) => boolean} fits */
  told(kind, fits = () => true) {
    return eventually(() => this.heard.find((head) => head.kind === kind && fits(head)), `${kind}; heard ${JSON.stringify(this.heard)}`);
  }

  /** Sends a packet. @param {string} to @param {string} kind @param {object} rest of the head; a BigInt is written with all digits */
  tell(to, kind, rest, body = '') {
    const head = JSON.stringify({ v: 5, kind, room: this.room, token: this.token, from: this.name, ...rest }, (_, value) => (typeof value === 'bigint' ? `#${value}` : value)).replace(/"#(\d+)"/g, '$1');
    this.redis.cli('publish', `faccia:to:${to}`, `${head}\n${body}`);
  }

  recap(to) {
    this.tell(to, 'recap', { speaks: 0, past: 0 });
  }

  /** Accepts a forwarded command. @param {object} command the head received */
  answer({ from, number, visit }, utterance) {
    this.tell(from, 'answer', { number, visit, status: 202, answer: { type: 'accepted', room: this.room, utterance } });
  }

  /** Answers that it is not the leader (yet) and has not run the command. */
  pass({ from, number, visit }) {
    this.tell(from, 'answer', { number, visit, status: 0 });
  }

  /** Sends events. @param {object} command the command that caused them, or null */
  say(to, command, ...messages) {
    const bodies = messages.map((message) => JSON.stringify(message));
    const whose = command ? { command: ofName(command.from) | BigInt(command.number) } : {};
    this.tell(to, 'said', { parts: messages.map(({ type }, i) => ({ event: type, size: bodies[i].length, line: 0, ...whose })) }, bodies.join(''));
  }

  close() {
    this.ear.kill();
  }
}
