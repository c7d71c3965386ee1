// SPDX-License-Identifier: GPL-3.0-or-later
// Compares requests with received messages, and reports broken guarantees:
// - every `speak` has exactly one `end`, sent to its client while that is connected;
// - nothing is heard twice: a restart is announced (`warning` `room-away`), and nothing begins after its end;
// - order: the requests of one speaker begin in order; two listeners of a room hear common utterances in the same order (of a repeated one,
//   the repetition counts);
// - no unreported gap in the media.

const PROMISES = ['no end', 'two ends', 'heard twice', 'out of order', 'another order', 'a gap', 'nonsense'];

export class Checker {
  constructor() {
    this.broken = Object.fromEntries(PROMISES.map((name) => [name, 0]));
    this.examples = [];
    this.from = Date.now();
    this.asked = new Map(); // id -> what became of it
    this.waiting = new Map(); // id -> start time of requests without an end
    this.pairs = new Map(); // 'room a b': b followed a
    this.heard = { begins: 0, chunks: 0, ends: 0, again: 0, late: 0 };
  }

  /** heard: preceding messages, which are shown with the first few. */
  break(promise, what, heard = []) {
    this.broken[promise]++;
    if (this.broken[promise] <= 6) this.examples.push(`${promise}: ${what}`, ...(this.broken[promise] <= 2 ? heard : []));
  }

  ask(id, about) {
    this.asked.set(id, { ...about, at: `${((Date.now() - this.from) / 1000).toFixed(2)} s`, ends: [], lost: false });
    this.waiting.set(id, Date.now());
  }

  /** To who asked. */
  answer(id, end) {
    const asked = this.asked.get(id);
    if (!asked) return;
    this.waiting.delete(id);
    asked.ends.push(`${end} at ${((Date.now() - this.from) / 1000).toFixed(2)} s`);
    if (asked.ends.length === 2) this.break('two ends', `${id} ${JSON.stringify(asked)}`);
  }

  /** The connection of the request was lost. */
  lose(id) {
    const asked = this.asked.get(id);
    if (asked && !asked.ends.length) asked.lost = true;
    this.waiting.delete(id);
  }

  tally() {
    const all = [...this.asked.values()];
    const count = (fits) => all.filter(fits).length;
    for (const [id, asked] of this.asked) if (!asked.ends.length && !asked.lost) this.break('no end', `${id} ${JSON.stringify(asked)}`);
    return {
      asked: all.length,
      done: count(({ ends }) => ends[0]?.startsWith('done')),
      failed: count(({ ends }) => ends[0]?.startsWith('failed')),
      stopped: count(({ ends }) => ends[0]?.startsWith('stopped')),
      'lost with the connection of who asked': count(({ lost, ends }) => lost && !ends.length),
      ...this.heard,
      broken: this.broken,
    };
  }
}

/** A listener of a room: one connection. */
export class Ear {
  constructor(checker, room, name) {
    Object.assign(this, { checker, room, name, heard: false, known: new Map(), numbers: new Map(), last: new Map(), previous: null, lines: [] });
  }

  #keep(line) {
    if (this.lines.push(`    ${((Date.now() - this.checker.from) / 1000).toFixed(2)} s ${line}`) > 40) this.lines.shift();
  }

  #break(promise, what) {
    this.checker.break(promise, `${this.name}, ${this.room}: ${what}`, this.lines);
  }

  message(message) {
    const { checker } = this;
    if ((message.utterance !== undefined || message.code) && !['word', 'sentence'].includes(message.type)) this.#keep(`${message.type} ${message.utterance} ${message.id} ${message.reason ?? message.code ?? ''}`);
    if (message.type === 'begin') this.#begin(message);
    // a listener that reads too slowly learns that some of its pending media were dropped
    if (message.type === 'warning' && message.code === 'skipped' && message.utterance === undefined) for (const it of this.numbers.values()) it.next = null;
    const it = this.numbers.get(message.utterance);
    if (!it) return;
    if (message.type === 'warning' && message.code === 'room-away') {
      it.again = true;
      if (this.previous === it.id) this.previous = null;
    }
    if (message.type === 'warning' && message.code === 'skipped') it.next = null;
    if (message.type === 'end') {
      checker.heard.ends++;
      if (it.ended) this.#break('two ends', it.id);
      it.ended = true;
      const whole = Math.round(message.duration * it.rate);
      if (message.reason === 'done' && it.next !== null && Math.abs(whole - it.next) > 1) this.#break('a gap', `${it.id}: ${it.next} samples of ${whole}`);
    }
  }

  #begin(message) {
    const { checker } = this;
    const { id, utterance, rate } = message;
    checker.heard.begins++;
    const before = this.known.get(id);
    if (before && (before.ended || !before.again)) this.#break('heard twice', `${id}, ${before.ended ? 'ended' : 'not ended'}`);
    if (before) checker.heard.again++;
    // a new listener gets media from when the leader knows of it: one round trip later at a daemon without listeners of that format
    const it = { id, rate, next: this.heard ? 0 : null, ended: false, again: false };
    this.known.set(id, it);
    this.numbers.set(utterance, it);
    const [speaker, number] = [id?.split('-')[0], Number(id?.split('-')[1])];
    if (this.last.get(speaker) > number) this.#break('out of order', `${id} after ${this.last.get(speaker)}`);
    this.last.set(speaker, number);
    if (this.previous && !before) {
      checker.pairs.set(`${this.room} ${this.previous} ${id}`, this.name);
      const other = checker.pairs.get(`${this.room} ${id} ${this.previous}`);
      if (other) this.#break('another order', `${this.previous} ${id}, ${other} the other way`);
    }
    this.previous = before ? null : id;
  }

  /** Start and length of a media chunk. */
  media(utterance, start, samples) {
    this.checker.heard.chunks++;
    const it = this.numbers.get(utterance);
    this.heard = true;
    if (!it || !utterance) return;
    if (it.ended) this.#break('nonsense', `media of ${it.id} (${utterance}) after its end`);
    // a late joiner, or one that skipped media, continues from the current position
    if (it.next === null) this.checker.heard.late++;
    else if (start !== it.next) this.#break('a gap', `${it.id}: ${start} after ${it.next}`);
    it.next = start + samples;
  }
}
