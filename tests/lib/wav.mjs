// SPDX-License-Identifier: GPL-3.0-or-later

/** Makes a WAV file. @param {Int16Array} samples interleaved @param {number} rate in Hz */
export function wavOf(samples, rate, channels = 1) {
  const header = Buffer.alloc(44);
  header.write('RIFF    WAVEfmt ');
  [[4, samples.byteLength + 36], [16, 16], [24, rate], [28, rate * channels * 2], [40, samples.byteLength]].forEach(([at, value]) => header.writeUInt32LE(value, at));
  [[20, 1], [22, channels], [32, channels * 2], [34, 16]].forEach(([at, value]) => header.writeUInt16LE(value, at));
  header.write('data', 36);
  return Buffer.concat([header, Buffer.from(samples.buffer, samples.byteOffset, samples.byteLength)]);
}
