// SPDX-License-Identifier: MIT
import { readMix } from './expression.mjs';
import { IdleFace } from './idle.mjs';

/**
 * What the server is asked for beside speech: to have the face idle while that is wanted, and the mood. It remembers
 * both, and asks again when the link is new.
 */
export class IdleController {
  /** @param {(message: object) => boolean} send @param {() => void} [changed] there is a mood now, or none any more */
  constructor(send, changed = () => {}) {
    this.send = send;
    this.changed = changed;
    this.face = new IdleFace();
    this.wanted = null; // what idling is to be: null, or further members of the message
    this.asked = 'null'; // what the server was asked for
    this.mix = []; // what was wished here
    this.room = []; // what the server has told of the room
  }

  /** Whether the face is to show a mood. */
  get moody() {
    return [...this.mix, ...this.room].some(({ intensity }) => intensity !== 0);
  }

  /** The link is new: nothing has been asked for. */
  linked() {
    this.face.reset();
    this.asked = 'null';
    if (this.mix.length) this.send({ type: 'express', mix: this.mix, ease: 0 });
    this.#ask();
  }

  unlinked() {
    this.face.reset();
    this.asked = 'null';
    this.room = []; // told anew
  }

  /** @param {object|null} wanted members of the idle message; null: no idling */
  idle(wanted) {
    this.wanted = wanted;
    this.#ask();
  }

  /** @param {object|object[]|string} mix see readMix @param {{ease?: number}} options seconds */
  express(mix, { ease } = {}) {
    this.mix = readMix(mix);
    this.send({ type: 'express', mix: this.mix, ...(ease === undefined ? {} : { ease }) });
    this.changed();
  }

  /** The mood of the room, whoever made it so: what was wished here before does not come back with the next link. */
  heard(mix) {
    if (this.mix.length) this.mix = mix;
    this.room = mix;
    this.changed();
  }

  #ask() {
    const wish = JSON.stringify(this.wanted);
    if (wish === this.asked || !this.send({ type: 'idle', on: Boolean(this.wanted), ...this.wanted })) return;
    this.asked = wish;
    if (!this.wanted) this.face.reset();
  }
}
