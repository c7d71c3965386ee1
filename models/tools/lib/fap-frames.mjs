// SPDX-License-Identifier: GPL-3.0-or-later
const LENGTHS = [4, 6]; // values of viseme and expression

/** The frames of a .fap file (MPEG-4 FAPs as text, version 2.1), as lists by FAP number. @param {string} text @returns {number[][]} */
export function readFapFrames(text) {
  const [, ...lines] = text.trim().split('\n');
  const frames = [];
  for (let i = 0; i + 1 < lines.length; i += 2) {
    const flags = lines[i].split(' ').map(Number);
    const [, ...values] = lines[i + 1].split(' ').map(Number); // the frame's number comes first
    const frame = Array(69).fill(0);
    flags.forEach((flag, n) => {
      if (!flag) return;
      const [value] = values.splice(0, LENGTHS[n] ?? 1);
      if (n > 1) frame[n + 1] = value;
    });
    frames.push(frame);
  }
  return frames;
}
