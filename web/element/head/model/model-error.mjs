// SPDX-License-Identifier: MIT

export class ModelError extends Error {
  /** @param {string} place in the model, such as "parts[0].position.scale" @param {string} what is wrong there */
  constructor(place, what) {
    super(place ? `${place}: ${what}` : what);
    this.place = place;
  }
}
