// SPDX-License-Identifier: GPL-3.0-or-later
/** What is wrong with a file, and where: a line, a byte, a member such as "accessors[3]". */
export class FileError extends Error {
  constructor(place, what) {
    super(place ? `${place}: ${what}` : what);
    this.place = place;
  }
}

/** More than any head has, and little enough to be held. */
export const MOST = { bytes: 256 << 20, numbers: 12e6, meshes: 512, depth: 64, image: 8 << 20 };
