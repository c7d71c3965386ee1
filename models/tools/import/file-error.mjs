// SPDX-License-Identifier: GPL-3.0-or-later
/** An error in a file with its place: a line, a byte, or a member such as "accessors[3]". */
export class FileError extends Error {
  constructor(place, what) {
    super(place ? `${place}: ${what}` : what);
    this.place = place;
  }
}

/** Limits: more than any head needs, but little enough for memory. */
export const MOST = { bytes: 256 << 20, numbers: 12e6, meshes: 512, depth: 64, image: 8 << 20 };
