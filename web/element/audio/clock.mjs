// SPDX-License-Identifier: MIT

/** Maps frames of the audio clock to positions in the speech, from the reports of a playout buffer. */
export class PositionMap {
  constructor() {
    this.reports = [{ frame: -Infinity, position: 0, running: false }];
  }

  /** @param {{frame: number, position: number, running: boolean}} report in the order of their frames */
  add(report) {
    this.reports.push(report);
  }

  /** @returns {{position: number, running: boolean}} where a frame before all kept reports lies: as at the first of them */
  at(frame) {
    let i = this.reports.length - 1;
    while (i > 0 && this.reports[i].frame > frame) i--;
    if (i > 16) {
      this.reports.splice(0, i - 1); // queries never go back farther
      i = 1;
    }
    const { frame: start, position, running } = this.reports[i];
    return { position: running ? position + Math.max(0, frame - start) : position, running };
  }
}

const SMOOTHING = 0.05;
const JUMP_SECONDS = 0.06;
const FUTURE_MS = 50; // a time stamp is taken when sound is heard, not later; leeway for rounded clocks

/**
 * The audio clock, smooth. Browsers state the time of what comes out of the loudspeaker now and then, in steps and with
 * some jitter; between two statements it runs with the page's own clock, and small differences are worked off slowly.
 */
export class HeardClock {
  constructor() {
    this.offset = null;
  }

  /**
   * @param {{currentTime: number, outputLatency?: number, baseLatency?: number, getOutputTimestamp?: Function}} context
   * @param {number} now performance.now(), in milliseconds
   * @returns {number} the context's time of what is heard now, in seconds
   */
  at(context, now) {
    const stamp = context.getOutputTimestamp?.();
    let heard = context.currentTime - (context.outputLatency || context.baseLatency || 0);
    if (stamp && stamp.contextTime > 0 && Number.isFinite(stamp.performanceTime)) {
      const stamped = stamp.contextTime + (now - stamp.performanceTime) / 1000;
      // Ignores a context time that stands still or lies in the future, and a page time that lies in the future:
      // WebKitGTK's runs twice as fast as time.
      const ahead = stamped - context.currentTime;
      if (stamp.performanceTime <= now + FUTURE_MS && ahead <= 0.05 && ahead > -2) heard = stamped;
    }
    const offset = heard - now / 1000;
    if (this.offset === null || Math.abs(offset - this.offset) > JUMP_SECONDS) this.offset = offset;
    else this.offset += SMOOTHING * (offset - this.offset);
    return this.offset + now / 1000;
  }

  /** To be called when the context stops or starts. */
  reset() {
    this.offset = null;
  }
}
