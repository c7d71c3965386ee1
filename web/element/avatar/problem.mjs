// SPDX-License-Identifier: MIT

/** The reason why an avatar cannot be shown. */
export class AvatarProblem extends Error {
  /** @param {'missing'|'too-large'|'not-glb'|'damaged'|'unsupported'|'no-face'|'bad-map'} reason @param {string} message */
  constructor(reason, message) {
    super(message);
    this.reason = reason;
  }
}
