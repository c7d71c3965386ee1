// SPDX-License-Identifier: MIT

/** The reason why a picture is refused, with a stable identifier. */
export class PortraitError extends Error {
  /**
   * @param {'no_face'|'several_faces'|'too_small'|'turned'|'no_picture'|'too_large'|'too_few'|'parted'|'unlike'|
   *   'other_face'|'other_pose'|'left_out'} code the last five are of poses @param {string} message in English
   */
  constructor(code, message) {
    super(message);
    this.code = code;
  }
}
