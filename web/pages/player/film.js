// SPDX-License-Identifier: MIT
// A film of a speaker beside the face, on the same time line.

const DRIFT_S = 0.06; // between film and face, at most
export const FILM = /\.(mp4|webm|mov|m4v|ogv)$/i;

export class Film {
  #address = null;

  /** @param {HTMLVideoElement} video @param {HTMLInputElement} start where the film begins on the time line, in seconds */
  constructor(video, start) {
    Object.assign(this, { video, start });
  }

  /** @param {File} file */
  async open(file) {
    if (this.#address) URL.revokeObjectURL(this.#address);
    this.#address = URL.createObjectURL(file);
    await new Promise((resolve, reject) => {
      this.video.onloadeddata = resolve;
      this.video.onerror = () => reject(new Error(`${file.name}: ${this.video.error?.message || 'no film'}`));
      this.video.src = this.#address;
    });
  }

  /** Shows the moment of the time line. @param {number} seconds @param {boolean} playing */
  at(seconds, playing) {
    const { video } = this;
    if (!this.#address || !video.duration) return;
    const wanted = seconds - (Number(this.start.value) || 0);
    const within = wanted >= 0 && wanted < video.duration;
    const moment = Math.min(video.duration, Math.max(0, wanted));
    if (playing && within) {
      if (video.paused) video.play().catch(() => {});
      if (Math.abs(video.currentTime - moment) > DRIFT_S && !video.seeking) video.currentTime = moment;
      return;
    }
    if (!video.paused) video.pause();
    if (Math.abs(video.currentTime - moment) > 1e-3) video.currentTime = moment;
  }
}
