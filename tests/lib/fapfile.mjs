// SPDX-License-Identifier: GPL-3.0-or-later

/** Parses .fap text of the daemon: {fps, frames: arrays of values by FAP number}. */
export function parseFap(text) {
  const [header, ...lines] = text.trim().split('\n');
  const frames = [];
  for (let i = 0; i < lines.length; i += 2) {
    const flags = lines[i].split(' ').map(Number);
    const values = lines[i + 1].split(' ').map(Number);
    const frame = Array(69).fill(0);
    let at = 1; // the frame's number comes first
    flags.forEach((flag, n) => {
      if (!flag) return;
      if (n > 1) frame[n + 1] = values[at];
      at += n === 0 ? 4 : n === 1 ? 6 : 1;
    });
    frames.push(frame);
  }
  return { fps: Number(header.split(' ').at(-2)), frames };
}
