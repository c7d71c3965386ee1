// SPDX-License-Identifier: MIT
// Events inside compact media chunks: ../README.md, section "Packed events".
import { ChunkError } from './chunk.mjs';

const KINDS = ['sentence', 'word', 'mark', 'phone'];
const decoder = new TextDecoder('utf-8', { fatal: true, ignoreBOM: true });
const encoder = new TextEncoder();

/**
 * The events of a chunk as the messages that they stand for (without `stream` and `id`).
 * @param {Uint8Array} bytes of them all
 * @param {{utterance: number, sampleRate: number}} chunk
 * @returns {object[]}
 */
export function unpackEvents(bytes, { utterance, sampleRate }) {
  const events = [];
  let at = 0;
  const number = () => {
    let value = 0;
    for (let scale = 1; scale <= 2 ** 28; scale *= 128) {
      if (at === bytes.length) throw new ChunkError('an event is cut short', at);
      const b = bytes[at++];
      if (scale === 2 ** 28 && b > 15) break;
      value += (b & 0x7f) * scale;
      if (b < 0x80) return value;
    }
    throw new ChunkError('a number of more than 32 bits', at - 1);
  };
  const text = () => {
    const size = number();
    if (size > bytes.length - at) throw new ChunkError('an event is cut short', bytes.length);
    at += size;
    try {
      return [decoder.decode(bytes.subarray(at - size, at)), size];
    } catch {
      throw new ChunkError('text that is not UTF-8', at - size);
    }
  };
  const seconds = (samples) => Math.round((samples / sampleRate) * 1e6) / 1e6;
  while (at < bytes.length) {
    const type = KINDS[bytes[at]];
    if (!type) throw new ChunkError('an event of a kind that is not known here', at);
    at++;
    const sample = number();
    const event = { type, utterance, time: seconds(sample), sample };
    if (type !== 'mark') event.duration = seconds(number());
    if (type === 'mark') [event.name] = text();
    else if (type === 'phone') [event.ipa] = text();
    else {
      event.start = number();
      event.utf16_start = event.start - number();
      if (event.utf16_start < 0) throw new ChunkError('a place that cannot be', at);
      const [said, size] = text();
      Object.assign(event, { end: event.start + size, utf16_end: event.utf16_start + said.length, text: said });
    }
    events.push(event);
  }
  return events;
}

/**
 * The other way.
 * @param {object[]} events messages @param {number} sampleRate
 * @returns {Uint8Array}
 */
export function packEvents(events, sampleRate) {
  const bytes = [];
  const put = (value) => {
    for (; value >= 0x80; value = Math.floor(value / 128)) bytes.push((value % 128) | 0x80);
    bytes.push(value);
  };
  for (const event of events) {
    bytes.push(KINDS.indexOf(event.type));
    put(event.sample);
    if (event.type !== 'mark') put(Math.round(event.duration * sampleRate));
    if ('start' in event) {
      put(event.start);
      put(event.start - event.utf16_start);
    }
    const text = encoder.encode(event.text ?? event.name ?? event.ipa);
    put(text.length);
    bytes.push(...text);
  }
  return Uint8Array.from(bytes);
}
