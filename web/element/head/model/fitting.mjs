// SPDX-License-Identifier: MIT

/** Applies calibrations from the server one at a time; of those that arrive meanwhile only the last counts. */
export class Fitting {
  #next = null; // a message
  #busy = false;
  #taken = false; // there is one on the head

  /**
   * @param {object} ports calibrate(calibration|null) -> a promise; fitted(message): it is drawn; unfit(error): it cannot be
   */
  constructor(ports) {
    this.ports = ports;
  }

  /** Starts over on a new connection: its server sends the current calibration again. */
  begin() {
    this.#next = null;
    if (this.#taken) this.take({ reset: true });
  }

  /** @param {{reset?: boolean, featurePointsCoord?: object, textureCoord?: object, texture?: object}} message */
  async take(message) {
    this.#next = message;
    if (this.#busy) return;
    this.#busy = true;
    while (this.#next) {
      const now = this.#next;
      this.#next = null;
      try {
        const { reset, featurePointsCoord, textureCoord, texture } = now;
        await this.ports.calibrate(reset ? null : { featurePointsCoord, textureCoord, texture });
        this.#taken = !reset;
        if (now.type) this.ports.fitted(now);
      } catch (error) {
        this.ports.unfit(error);
      }
    }
    this.#busy = false;
  }
}
