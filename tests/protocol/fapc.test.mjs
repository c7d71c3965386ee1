// SPDX-License-Identifier: MIT
// The low bit-rate coding against its vectors, and against damage.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import { test } from 'node:test';
import { FapcDecoder, FapcEncoder, FapcError, fapcFrame, fapcStep } from '../../protocol/fapc/fapc.mjs';

const { streams, bad } = JSON.parse(fs.readFileSync(new URL('../../protocol/vectors/fapc.json', import.meta.url)));

const dense = ({ values, viseme, expression }) => {
  const frame = fapcFrame();
  for (const [n, value] of Object.entries(values)) {
    frame.mask[n] = 1;
    frame.values[n] = value;
  }
  if (viseme) frame.viseme.set(viseme);
  if (expression) frame.expression.set(expression);
  frame.mask[1] = viseme ? 1 : 0;
  frame.mask[2] = expression ? 1 : 0;
  return frame;
};

for (const [i, { name, quality, packets }] of streams.entries())
  test(`decodes stream ${i}, ${name}, quality ${quality}`, () => {
    const encoder = new FapcEncoder(quality);
    const decoder = new FapcDecoder();
    for (const packet of packets) {
      const bytes = Buffer.from(packet.bytes, 'hex');
      assert.deepEqual(Buffer.from(encoder.encode(packet.frames.map(dense), packet.intra)), bytes);
      assert.deepEqual(decoder.decode(bytes, packet.frames.length), packet.decoded.map(dense));
      if (quality === 0 && name === 'wild') assert.deepEqual(packet.decoded, packet.frames);
    }
  });

for (const { name, bytes } of bad)
  test(`rejects ${name}`, () => {
    const [first, second] = streams[0].packets.map((packet) => Buffer.from(packet.bytes, 'hex'));
    const decoder = new FapcDecoder();
    decoder.decode(first, 3);
    assert.throws(() => decoder.decode(Buffer.from(bytes, 'hex'), 3), FapcError);
    assert.throws(() => decoder.decode(second, 3), FapcError);
    decoder.decode(first, 3);
  });

const speech = (t) => {
  const frame = fapcFrame();
  frame.mask.fill(1, 3);
  for (let n = 3; n <= 68; n++) frame.values[n] = Math.round(300 * Math.sin(t / (n % 7) + n));
  return frame;
};

test('every value is within half a step', () => {
  for (const quality of [0, 1, 5, 13, 31]) {
    const encoder = new FapcEncoder(quality);
    const decoder = new FapcDecoder();
    for (let t = 0; t < 100; t++) {
      const frame = speech(t);
      const [out] = decoder.decode(encoder.encode([frame]), 1);
      for (let n = 3; n <= 68; n++) assert.ok(Math.abs(out.values[n] - frame.values[n]) <= fapcStep(n, quality) / 2);
    }
  }
});

test('decodes from any start packet; after a loss shows only correct frames', () => {
  const encoder = new FapcEncoder();
  const packets = Array.from({ length: 40 }, (_, t) => encoder.encode([speech(t)], t % 10 === 0));
  const whole = new FapcDecoder();
  const truth = packets.map((packet) => whole.decode(packet, 1));
  const late = new FapcDecoder();
  for (let t = 5; t < 40; t++) {
    if (t < 10) assert.throws(() => late.decode(packets[t], 1), FapcError);
    else assert.deepEqual(late.decode(packets[t], 1), truth[t]);
  }
  const lossy = new FapcDecoder();
  for (let t = 0; t < 40; t++) {
    if (t === 23) continue;
    if (t > 23 && t < 30) assert.throws(() => lossy.decode(packets[t], 1), FapcError);
    else assert.deepEqual(lossy.decode(packets[t], 1), truth[t]);
    assert.equal(lossy.ready, !(t > 23 && t < 30));
  }
});

test('damaged packets end in bounded time, and decoding recovers at the next start packet', () => {
  let seed = 1;
  const random = (n) => (seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0) % n;
  const encoder = new FapcEncoder();
  const decoder = new FapcDecoder();
  for (let t = 0; t < 3000; t++) {
    const intra = t % 10 === 0;
    let packet = encoder.encode([speech(t)], intra);
    if (!intra) {
      packet = packet.slice(0, random(packet.length + 1));
      for (let k = 0; k < 4 && packet.length; k++) packet[random(packet.length)] = random(256);
    }
    try {
      decoder.decode(packet, 1);
    } catch (error) {
      assert.ok(error instanceof FapcError && !intra, String(error.stack));
    }
  }
});
