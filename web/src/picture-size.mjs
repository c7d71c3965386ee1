// SPDX-License-Identifier: MIT
// How large a picture is, by its first bytes: one that is small as a file may be gigabytes when it is unpacked.

/**
 * @param {Uint8Array} bytes of a PNG, JPEG, WebP, AVIF or KTX2
 * @returns {[number, number]|null} null: it is none of these, or says nothing
 */
export function pictureSize(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const text = (at, length) => String.fromCharCode(...bytes.subarray(at, at + length));
  if (bytes.length < 32) return null;
  if (text(1, 3) === 'PNG') return [view.getUint32(16), view.getUint32(20)];
  if (text(1, 6) === 'KTX 20') return [view.getUint32(20, true), view.getUint32(24, true)];
  if (text(0, 4) === 'RIFF' && text(8, 4) === 'WEBP') return ofWebp(view, text(12, 4));
  if (text(4, 4) === 'ftyp') return ofAvif(view, bytes);
  return bytes[0] === 0xff && bytes[1] === 0xd8 ? ofJpeg(view) : null;
}

function ofWebp(view, kind) {
  const three = (at) => view.getUint16(at, true) | (view.getUint8(at + 2) << 16);
  if (kind === 'VP8X') return [1 + three(24), 1 + three(27)];
  if (kind === 'VP8L') return [1 + (view.getUint32(21, true) & 0x3fff), 1 + ((view.getUint32(21, true) >> 14) & 0x3fff)];
  return kind === 'VP8 ' ? [view.getUint16(26, true) & 0x3fff, view.getUint16(28, true) & 0x3fff] : null;
}

/** The largest of its properties `ispe`. */
function ofAvif(view, bytes) {
  let best = null;
  const most = Math.min(bytes.length - 16, 4096);
  for (let at = 0; at < most; at++)
    if (view.getUint32(at) === 0x69737065) {
      const size = [view.getUint32(at + 8), view.getUint32(at + 12)];
      if (!best || size[0] * size[1] > best[0] * best[1]) best = size;
    }
  return best;
}

function ofJpeg(view) {
  for (let at = 2; at + 9 < view.byteLength && view.getUint8(at) === 0xff; ) {
    const marker = view.getUint8(at + 1);
    const frame = marker >= 0xc0 && marker <= 0xcf && ![0xc4, 0xc8, 0xcc].includes(marker);
    if (frame) return [view.getUint16(at + 7), view.getUint16(at + 5)];
    at += marker === 0xff ? 1 : 2 + view.getUint16(at + 2);
  }
  return null;
}
