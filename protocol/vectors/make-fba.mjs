// SPDX-License-Identifier: MIT
// Writes fba.json: packets of fba.mjs with their contents, for both implementations. node make-fba.mjs > fba.json
import { FbaDecoder, FbaEncoder, fbaFrame } from '../fba.mjs';

/** Repeatable noise, 0..1 (a linear congruential generator). */
const noise = (seed) => () => (seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0) / 2 ** 32;

const make = {
  /** A mouth that moves, mirrored, with outer lips that follow, and a head that sways. */
  speech(frame, t) {
    const open = Math.round(300 + 250 * Math.sin(t / 2));
    const set = (n, value) => {
      frame.mask[n] = 1;
      frame.values[n] = Math.round(value);
    };
    for (let n = 3; n <= 68; n++) set(n, 0);
    set(3, open);
    for (const n of [5, 10, 11]) set(n, -open * 0.8);
    for (const n of [52, 57, 58]) set(n, -open * 0.7);
    for (const n of [6, 7, 53, 54]) set(n, 60 * Math.sin(t / 3));
    for (const n of [19, 20]) set(n, t % 20 < 3 ? 900 : 10);
    set(48, 5000 * Math.sin(t / 15));
    set(23, 9000 * Math.sign(Math.sin(t / 9)));
    set(24, 9000 * Math.sign(Math.sin(t / 9)));
  },
  /** Anything. */
  wild(frame, t, random) {
    for (let n = 1; n <= 68; n++) frame.mask[n] = random() < 0.5 ? 1 : 0;
    for (let n = 3; n <= 68; n++) if (frame.mask[n]) frame.values[n] = Math.round((random() - 0.5) * 2 ** Math.floor(random() * 26));
    if (frame.mask[1]) frame.viseme.forEach((_, i) => (frame.viseme[i] = random() * 256));
    if (frame.mask[2]) frame.expression.forEach((_, i) => (frame.expression[i] = random() * 256));
  },
  /** A mask that changes, FAP 1 that blends. */
  high(frame, t) {
    frame.mask[1] = 1;
    frame.viseme.set([1 + ((t >> 3) % 14), 2, (t * 8) % 64, 1]);
    if (t > 6) frame.mask[2] = 1;
    if (t > 6) frame.expression.set([1, 40, 0, 0, 0, 1]);
    for (const n of [3, 31 + (t >> 2)]) {
      frame.mask[n] = 1;
      frame.values[n] = t * 20;
    }
  },
  extremes(frame, t) {
    for (const n of [3, 20, 47, 48]) {
      frame.mask[n] = 1;
      frame.values[n] = [0, 2147483647, -2147483648, 16777216, -16777216, 1, -1][(t + n) % 7];
    }
  },
};

const plan = [
  ['speech', 5, 30, 3, 4],
  ['speech', 0, 12, 3, 2],
  ['speech', 31, 12, 5, 9],
  ['wild', 0, 6, 2, 2],
  ['wild', 3, 6, 3, 9],
  ['high', 5, 20, 4, 3],
  ['extremes', 0, 8, 1, 3],
  ['extremes', 7, 8, 4, 9],
];

const sparse = (frame) => ({
  values: Object.fromEntries([...frame.mask.keys()].filter((n) => n > 2 && frame.mask[n]).map((n) => [n, frame.values[n]])),
  ...(frame.mask[1] ? { viseme: [...frame.viseme] } : {}),
  ...(frame.mask[2] ? { expression: [...frame.expression] } : {}),
});

const streams = plan.map(([name, quality, count, per, every], number) => {
  const random = noise(number + 1);
  const encoder = new FbaEncoder(quality);
  const decoder = new FbaDecoder();
  const packets = [];
  for (let t = 0; t < count; t += per) {
    const frames = Array.from({ length: Math.min(per, count - t) }, (_, i) => {
      const frame = fbaFrame();
      make[name](frame, t + i, random);
      return frame;
    });
    const intra = packets.length % every === 0;
    const bytes = encoder.encode(frames, intra);
    packets.push({
      intra,
      bytes: Buffer.from(bytes).toString('hex'),
      frames: frames.map(sparse),
      decoded: decoder.decode(bytes, frames.length).map(sparse),
    });
  }
  return { name, quality, packets };
});

const lines = streams.map(({ name, quality, packets }) =>
  `  {"name": "${name}", "quality": ${quality}, "packets": [\n${packets.map((p) => `    ${JSON.stringify(p)}`).join(',\n')}\n  ]}`,
);
console.log(`{\n "title": "FBA packets with their contents, made by make-fba.mjs",\n "streams": [\n${lines.join(',\n')}\n ]\n}`);
