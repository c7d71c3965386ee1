// SPDX-License-Identifier: MIT
import { createAudioDriver, SilentDriver } from './drivers.mjs';
import { HeardClock, PositionMap } from './clock.mjs';
import { acquireContext, releaseContext } from './shared-context.mjs';

const NO_AUDIO_RATE = 48000;
const RESUME_PATIENCE_MS = 250;
const DEVICE_PATIENCE_MS = 1500; // once the user has touched the page: what then does not start has nothing to sound on
const STANDSTILL_MS = 2000; // of an audio clock that should run
const STANDSTILL_LOOKS = 5; // and it was looked at: a page that slept proves nothing
const GESTURES = ['pointerdown', 'keydown', 'touchend'];

/**
 * Plays mono samples at `rate`, and says which of them is heard now. Positions count the samples written since the
 * beginning. While the browser forbids sound (no gesture of the user yet) the samples go by unheard, at the same pace;
 * from the moment on that sound is allowed the rest is heard.
 */
export class Player {
  /**
   * @param {(sound: 'off'|'on'|'blocked'|'none', reason?: string) => void} onsound reason: `autoplay` (blocked), `no-audio`
   *   (the browser has none), `no-device` (nothing to sound on), `no-worklet` (on, but the page has to do the work)
   * @param {object} [platform] acquire(), release(), createDriver(), touched(), setTimeout of tests
   */
  constructor(onsound, platform = {}) {
    this.onsound = onsound;
    this.platform = {
      acquire: acquireContext,
      release: releaseContext,
      createDriver: createAudioDriver,
      touched: (gesture) => globalThis.navigator?.userActivation?.hasBeenActive ?? gesture,
      setTimeout: (call, milliseconds) => globalThis.setTimeout(call, milliseconds),
      page: globalThis.document,
      ...platform,
    };
    this.sound = 'off';
    this.reason = undefined;
    this.context = null;
    this.written = 0;
    this.underruns = 0;
    this.clock = new HeardClock();
    this.silent = null;
    this.audio = null;
    this.held = false;
    this.complete = true; // nothing more is to come of what was written
    this.resuming = null; // the context being resumed
    this.dead = false; // nothing to sound on, as far as is known
    this.look = { time: -1, at: 0, count: 0 }; // when the audio clock was seen to run
    this.#forget();
    this.onstate = () => this.#stateChanged();
    this.ongesture = () => this.#resume(true);
  }

  get rate() {
    return this.context?.sampleRate ?? NO_AUDIO_RATE;
  }

  /** Gets ready to play; to be called in the handler of a user's gesture when there is one. */
  async open() {
    if (!this.context && this.sound === 'off') {
      this.context = this.platform.acquire();
      this.#goSilent(); // until the sound is there
      if (!this.context) {
        this.#setSound('none', 'no-audio');
        return;
      }
      this.context.addEventListener('statechange', this.onstate);
    }
    if (this.context && this.context.state !== 'running') await this.#resume(false);
    else await this.#stateChanged();
  }

  close() {
    this.#listen(false);
    this.audio?.close();
    if (this.context) {
      this.context.removeEventListener('statechange', this.onstate);
      this.platform.release();
    }
    this.context = this.audio = this.silent = null;
    this.sound = 'off';
    this.dead = false;
    this.clock.reset();
  }

  /** Asks for sound. Once the user has touched the page nothing but a missing device is in the way. */
  async #resume(gesture) {
    const { context } = this;
    if (this.resuming === context && !gesture) return;
    this.resuming = context;
    const late = () => this.context === context && context.state !== 'running';
    const wait = (milliseconds) => new Promise((resolve) => this.platform.setTimeout(resolve, milliseconds));
    context.resume().catch(() => {}); // without a device some promises never settle
    await wait(RESUME_PATIENCE_MS);
    if (late() && this.platform.touched(gesture)) {
      await wait(DEVICE_PATIENCE_MS);
      this.dead ||= late();
    }
    if (this.resuming === context) this.resuming = null;
    if (this.context === context) await this.#stateChanged();
  }

  /** @param {Float32Array} block is given away */
  write(block) {
    if (!block.length) return;
    this.written += block.length;
    this.complete = false;
    this.driver.push(block);
  }

  /** Marks the end of the speech: no more samples follow. */
  finish() {
    this.complete = true;
    this.driver?.finish();
  }

  /** Falls silent at once. Samples that were written but not heard count as heard. */
  flush() {
    this.complete = true;
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
    this.#watch(now);
    let frame;
    if (this.audio) {
      frame = (this.clock.at(this.context, now) + ahead) * this.rate;
    } else {
      if (this.sound !== 'off') this.silent.run(now / 1000); // the page already knows that there is no sound
      frame = (now / 1000 + ahead) * this.rate;
    }
    const { position, running } = this.map.at(frame);
    return { position: position + this.offset, running };
  }

  /** An audio clock that stands still, though it should run, has no device: then the speech goes on without. */
  #watch(now) {
    if (this.context?.state !== 'running') return;
    const { currentTime } = this.context;
    if (currentTime !== this.look.time) {
      const revived = this.dead && this.silent && this.look.time >= 0;
      this.look = { time: currentTime, at: now, count: 0 };
      if (revived) {
        this.dead = false;
        this.#stateChanged();
      }
    } else if (this.audio && ++this.look.count >= STANDSTILL_LOOKS && now - this.look.at > STANDSTILL_MS) {
      this.dead = true;
      const { position } = this.map.at(currentTime * this.rate);
      const left = Math.max(0, this.written - this.offset - position);
      this.audio.close();
      this.audio = null;
      this.#goSilent(left);
      this.#setSound('none', 'no-device');
    }
  }

  /** @param {number} [left] samples that were written, and not heard */
  #forget(left = 0) {
    this.map = new PositionMap();
    this.offset = this.written - left; // of the positions of the driver that is used now
  }

  #report(driver, report) {
    if (driver !== this.driver) return;
    this.map.add(report);
    this.underruns = report.underruns;
  }

  #goSilent(left = 0) {
    this.silent = new SilentDriver(this.rate, (report) => this.#report(this.silent, report));
    if (this.held) this.silent.hold();
    this.#forget(left);
    if (left) this.silent.push(new Float32Array(left)); // zeros do: they are not heard
    if (left && this.complete) this.silent.finish();
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
        this.#setSound('none', 'no-audio');
      }
      this.starting = false;
    } else if (running) {
      if (this.audio) this.#setSound('on', this.reason);
    } else if (this.dead || this.context.state === 'closed') {
      this.#setSound('none', 'no-device');
    } else if (!this.resuming) {
      this.#setSound('blocked', 'autoplay');
    }
  }

  async #goAloud() {
    const early = [];
    let audio = null;
    const report = (message) => (audio && this.audio === audio ? this.#report(audio, message) : early.push(message));
    const { context } = this;
    const { driver, reason } = await this.platform.createDriver(context, report);
    if (this.context !== context) {
      driver.close(); // closed meanwhile
      return;
    }
    audio = driver;
    const rest = this.silent.buffer.drain();
    const complete = this.silent.buffer.complete;
    this.silent = null;
    this.audio = audio;
    this.map = new PositionMap();
    this.offset = this.written - rest.length;
    early.forEach((message) => this.#report(audio, message));
    if (this.held) audio.hold();
    if (rest.length) audio.push(rest);
    if (complete) audio.finish();
    this.dead = false;
    this.look = { time: -1, at: 0, count: 0 };
    this.#setSound('on', reason);
  }

  #setSound(sound, reason) {
    if (sound === this.sound) return;
    this.sound = sound;
    this.reason = reason;
    this.#listen(sound === 'blocked');
    this.onsound(sound, reason);
  }

  /** Any touch of the page by the user allows sound. */
  #listen(on) {
    const change = on ? 'addEventListener' : 'removeEventListener';
    for (const gesture of GESTURES) this.platform.page[change](gesture, this.ongesture, { capture: true });
  }
}
