// SPDX-License-Identifier: MIT
import { createAudioDriver, SilentDriver } from './drivers.mjs';
import { HeardClock, PositionMap } from './clock.mjs';
import { acquireContext, releaseContext } from './shared-context.mjs';

const NO_AUDIO_RATE = 48000;
const RESUME_PATIENCE_MS = 250;
const GESTURES = ['pointerdown', 'keydown', 'touchend'];

/**
 * Plays mono samples at `rate`, and says which of them is heard now. Positions count the samples written since the
 * beginning. While the browser forbids sound (no gesture of the user yet) the samples go by unheard, at the same pace;
 * from the moment on that sound is allowed the rest is heard.
 */
export class Player {
  /** @param {(sound: 'off'|'on'|'blocked'|'none') => void} onsound */
  constructor(onsound) {
    this.onsound = onsound;
    this.sound = 'off';
    this.context = null;
    this.written = 0;
    this.underruns = 0;
    this.clock = new HeardClock();
    this.silent = null;
    this.audio = null;
    this.held = false;
    this.#forget();
    this.onstate = () => this.#stateChanged();
    this.ongesture = () => this.context.resume();
  }

  get rate() {
    return this.context?.sampleRate ?? NO_AUDIO_RATE;
  }

  /** Gets ready to play; to be called in the handler of a user's gesture when there is one. */
  async open() {
    if (!this.context && this.sound === 'off') {
      this.context = acquireContext();
      this.#goSilent(); // until the sound is there
      if (!this.context) {
        this.#setSound('none');
        return;
      }
      this.context.addEventListener('statechange', this.onstate);
    }
    if (this.context && this.context.state !== 'running') {
      this.context.resume().catch(() => {});
      await new Promise((resolve) => setTimeout(resolve, RESUME_PATIENCE_MS));
    }
    await this.#stateChanged();
  }

  close() {
    for (const gesture of GESTURES) document.removeEventListener(gesture, this.ongesture, true);
    this.audio?.close();
    if (this.context) {
      this.context.removeEventListener('statechange', this.onstate);
      releaseContext();
    }
    this.context = this.audio = this.silent = null;
    this.sound = 'off';
    this.clock.reset();
  }

  /** @param {Float32Array} block is given away */
  write(block) {
    if (!block.length) return;
    this.written += block.length;
    this.driver.push(block);
  }

  /** All that was to be said has been written. */
  finish() {
    this.driver?.finish();
  }

  /** Silence, now. What was written but not heard counts as heard. */
  flush() {
    this.driver?.flush();
  }

  /** Halts, now, until `release`; what is written meanwhile waits. */
  hold() {
    this.held = true;
    this.driver?.hold();
  }

  release() {
    this.held = false;
    this.driver?.release();
  }

  get driver() {
    return this.audio ?? this.silent;
  }

  /**
   * @param {number} now performance.now()
   * @param {number} ahead seconds: what is heard then
   * @returns {{position: number, running: boolean}}
   */
  heard(now, ahead = 0) {
    if (!this.driver) return { position: this.written, running: false };
    let frame;
    if (this.audio) {
      frame = (this.clock.at(this.context, now) + ahead) * this.rate;
    } else {
      if (this.sound !== 'off') this.silent.run(now / 1000); // it is known that there is no sound
      frame = (now / 1000 + ahead) * this.rate;
    }
    const { position, running } = this.map.at(frame);
    return { position: position + this.offset, running };
  }

  #forget() {
    this.map = new PositionMap();
    this.offset = this.written; // of the positions of the driver that is used now
  }

  #report(driver, report) {
    if (driver !== this.driver) return;
    this.map.add(report);
    this.underruns = report.underruns;
  }

  #goSilent() {
    this.silent = new SilentDriver(this.rate, (report) => this.#report(this.silent, report));
    if (this.held) this.silent.hold();
    this.#forget();
  }

  async #stateChanged() {
    if (!this.context) return;
    this.clock.reset();
    const running = this.context.state === 'running';
    if (running && !this.audio && !this.starting) {
      this.starting = true;
      try {
        await this.#goAloud();
      } catch (error) {
        console.error('talking-head: no sound', error);
        this.#setSound('none');
      }
      this.starting = false;
    } else {
      this.#setSound(running ? 'on' : this.context.state === 'closed' ? 'none' : 'blocked');
    }
  }

  async #goAloud() {
    const early = [];
    let audio = null;
    const report = (message) => (audio && this.audio === audio ? this.#report(audio, message) : early.push(message));
    audio = await createAudioDriver(this.context, report);
    if (!this.context) {
      audio.close(); // closed meanwhile
      return;
    }
    const rest = this.silent.pump.drain();
    const complete = this.silent.pump.complete;
    this.silent = null;
    this.audio = audio;
    this.map = new PositionMap();
    this.offset = this.written - rest.length;
    early.forEach((message) => this.#report(audio, message));
    if (this.held) audio.hold();
    if (rest.length) audio.push(rest);
    if (complete) audio.finish();
    this.#setSound('on');
  }

  #setSound(sound) {
    if (sound === this.sound) return;
    this.sound = sound;
    for (const gesture of GESTURES) {
      if (sound === 'blocked') document.addEventListener(gesture, this.ongesture, true);
      else document.removeEventListener(gesture, this.ongesture, true);
    }
    this.onsound(sound);
  }
}
