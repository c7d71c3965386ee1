// SPDX-License-Identifier: GPL-3.0-or-later
/** Validates binary FBX before a reader that trusts it: nodes end within their parents, lists have their stated lengths. */
import zlib from 'node:zlib';
import { FileError, MOST } from '../limits.mjs';

export const BINARY = 'Kaydara FBX Binary  \0';
const START = 27; // after the magic, two bytes and the version
const FOOTER = 176; // maximum size of the data after the last node
const SIZES = { Y: 2, C: 1, B: 1, I: 4, F: 4, D: 8, L: 8 };
const LISTS = { f: 4, d: 8, l: 8, i: 4, b: 1, c: 1 };
const TEXTS = ['S', 'R'];

/** @param {Buffer} bytes of a binary FBX file @param {import('../limits.mjs').Budget} budget @throws {FileError} with the byte that is wrong */
export function checkFbx(bytes, budget) {
  const version = bytes.length < START ? 0 : bytes.readUInt32LE(23);
  if (version < 6400 || version > 8000) throw new FileError('byte 23', `version ${version} is not read: save as FBX 7.4, or as GLB`);
  const long = version >= 7500;
  const head = long ? 25 : 13;
  const whole = (at) => (long ? Number(bytes.readBigUInt64LE(at)) : bytes.readUInt32LE(at));
  const size = long ? 8 : 4;

  function list(at, end, kind) {
    if (at + 12 > end) throw new FileError(`byte ${at}`, 'a list is cut short');
    const [count, packed, length] = [0, 4, 8].map((more) => bytes.readUInt32LE(at + more));
    budget.keep(count / 4, `byte ${at}`); // the result is counted separately
    const wanted = count * LISTS[kind];
    const next = at + 12 + (packed ? length : wanted);
    if (packed > 1 || next > end) throw new FileError(`byte ${at}`, `a list of ${count} numbers goes beyond its node`);
    if (!packed) return next;
    let there;
    try {
      there = zlib.inflateSync(bytes.subarray(at + 12, next), { maxOutputLength: Math.max(1, wanted) }).length;
    } catch (error) {
      throw new FileError(`byte ${at}`, `a list of ${count} numbers cannot be unpacked: ${error.message}`);
    }
    if (there !== wanted) throw new FileError(`byte ${at}`, `a list of ${count} numbers has ${there} bytes`);
    return next;
  }

  function property(at, end) {
    if (at >= end) throw new FileError(`byte ${at}`, 'a property is missing');
    const kind = String.fromCharCode(bytes[at]);
    if (kind in LISTS) return list(at + 1, end, kind);
    const known = kind in SIZES;
    if (!known && !TEXTS.includes(kind)) throw new FileError(`byte ${at}`, `there is no property of kind "${JSON.stringify(kind).slice(1, -1)}"`);
    if (!known && at + 5 > end) throw new FileError(`byte ${at}`, 'a property is cut short');
    const next = at + 1 + (known ? SIZES[kind] : 4 + bytes.readUInt32LE(at + 1));
    if (next > end) throw new FileError(`byte ${at}`, 'a property goes beyond its node');
    return next;
  }

  /** @returns {number} end of the node; 0: the null node that ends a list */
  function node(at, within, depth) {
    if (at + head > within) throw new FileError(`byte ${at}`, 'a node is cut short');
    const [end, properties] = [whole(at), whole(at + size)];
    if (!end) return 0;
    const first = at + head + bytes[at + head - 1];
    if (depth > MOST.depth || end <= at || end > within || first > end) throw new FileError(`byte ${at}`, `a node ends at byte ${end}, not before byte ${within}`);
    let place = first;
    for (let i = 0; i < properties; i++) place = property(place, end);
    while (place < end) place = node(place, end, depth + 1) || place + head;
    if (place !== end) throw new FileError(`byte ${at}`, `a node goes on to byte ${place}, and says that it ends at byte ${end}`);
    return end;
  }

  for (let at = START; at < bytes.length - FOOTER; ) {
    const next = node(at, bytes.length, 0);
    if (!next) return;
    at = next;
  }
}
