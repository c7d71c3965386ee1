// SPDX-License-Identifier: MIT
// Media of the compact kind on their way in: in order, decoded, in time.
import assert from 'node:assert/strict';
import test from 'node:test';
import { OpusDecoder } from '../../../web/node_modules/opus-decoder/index.js';
import { encodeChunk } from '../../../protocol/chunk/chunk.mjs';
import { Demuxer } from '../../../web/element/stream/demuxer.mjs';
import { OpusSound } from '../../../web/element/audio/opus.mjs';

/** A compact chunk: position always told, Opus packets, no frames. */
const compact = (utterance, start, samples, firstPacket, packets) => {
  const varint = (n) => (n < 128 ? [n] : [(n & 127) | 128, ...varint(Math.floor(n / 128))]);
  const audio = packets.flatMap((packet) => [packet.length, ...packet]);
  return Uint8Array.from([
    0x80 | 0x40 | 0x20 | 0x02, ...varint(utterance), ...varint(22050), ...varint(2500), ...varint(start), ...varint(0),
    ...varint(firstPacket), ...varint(samples), 0, ...varint(audio.length), ...audio,
  ]).buffer;
};

/** A packet of silence (RFC 6716: SILK wideband, 20 ms, no bytes). */
const SILENCE = [0x48];

const rig = (sound) => {
  const came = [];
  const demuxer = new Demuxer({ hear: (message) => came.push(message), media: (chunk) => came.push(chunk) }, sound);
  return { demuxer, came };
};
const settle = () => new Promise((resolve) => setTimeout(resolve, 20));

test('passes data that needs no decoding at once', () => {
  const { demuxer, came } = rig(new OpusSound({ can: false }));
  demuxer.text({ type: 'begin' });
  demuxer.binary(encodeChunk({ audioCodec: 1, fapCodec: 0, utterance: 1, sampleRate: 8000, fps: 25, start: 0, samples: 4, firstFrame: 0, frames: [], audio: new Int16Array(4) }).buffer);
  assert.equal(came.length, 2);
  assert.equal(came[1].audio.length, 4);
});

test('packed events come before the media of their chunk', async () => {
  const { demuxer, came } = rig(new OpusSound({ can: false, load: async () => ({ OpusDecoder }) }));
  const word = [1, 0, 10, 0, 0, 2, 76, 97]; // "La", ten samples
  const position = [3, 0xa2, 0xac, 1, 0xc4, 0x13, 0, 0];
  demuxer.text('begin');
  demuxer.binary(Uint8Array.from([0x80 | 0x40 | 0x20 | 0x02 | 0x01, ...position, 0, 100, 0, 2, word.length, ...word, 1, SILENCE[0]]).buffer);
  demuxer.text('end');
  for (let i = 0; i < 100 && came.length < 4; i++) await settle();
  assert.equal(came[0], 'begin');
  assert.deepEqual(came[1], {
    type: 'word', utterance: 3, time: 0, sample: 0, duration: Math.round((10 / 22050) * 1e6) / 1e6,
    start: 0, utf16_start: 0, end: 2, utf16_end: 2, text: 'La',
  });
  assert.equal(came[2].audio.length, 960 - 312);
  assert.equal(came[3], 'end');
  demuxer.reset();
});

test('text messages wait for the sound before them', async () => {
  const release = [];
  const slow = { decode: ({ audio }) => new Promise((resolve) => release.push(() => resolve(new Float32Array(audio.length * 960)))), close() {} };
  const { demuxer, came } = rig(slow);
  demuxer.text('a');
  demuxer.binary(compact(1, 0, 2646, 0, [SILENCE, SILENCE]));
  demuxer.text('b');
  demuxer.binary(compact(1, 2646, 2646, 2, [SILENCE]));
  demuxer.text('c');
  await settle();
  assert.deepEqual(came, ['a']);
  release.shift()();
  await settle();
  assert.deepEqual(came.map((item) => item.audio?.length ?? item), ['a', 1920 - 312, 'b']);
  release.shift()();
  await settle();
  assert.deepEqual(came.map((item) => item.audio?.length ?? item), ['a', 1920 - 312, 'b', 960, 'c']);
  assert.deepEqual([came[1].audioStart, came[3].audioStart], [0, 1920 - 312]);
  assert.equal(came[1].audioRate, 48000);
});

test('a failed decoder gives silence, and later data passes', async () => {
  const { demuxer, came } = rig({ decode: () => Promise.reject(new Error('broken')), close() {} });
  demuxer.binary(compact(1, 0, 441, 0, [SILENCE]));
  demuxer.text('end');
  await settle();
  assert.equal(came[0].audio.length, 960 - 312);
  assert.equal(came[1], 'end');
});

test('without WebCodecs decodes in WebAssembly', async () => {
  const sound = new OpusSound({ can: false, load: async () => ({ OpusDecoder }) });
  const { demuxer, came } = rig(sound);
  for (let i = 0; i < 3; i++) demuxer.binary(compact(1, i * 441, 441, i, [SILENCE]));
  demuxer.binary(compact(2, 0, 441, 0, [SILENCE, SILENCE]));
  for (let i = 0; i < 100 && came.length < 4; i++) await settle();
  assert.deepEqual(came.map((chunk) => chunk.audio.length), [960 - 312, 960, 960, 1920 - 312]);
  demuxer.reset();
});
