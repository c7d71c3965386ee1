// SPDX-License-Identifier: MIT
// Reads the size of a picture from its header: a small file may unpack to gigabytes.

export const MOST_PIXELS = 1 << 26; // of one picture of a head or an avatar: 8192 x 8192

/**
 * Returns the reason why a picture must not be decoded.
 * @param {Uint8Array} bytes @param {number} most pixels @param {string[]} [kinds] as their types are called
 * @returns {string|null} null: none
 */
export function pictureTrouble(bytes, most = MOST_PIXELS, kinds = ['png', 'jpeg', 'webp']) {
  const size = kinds.includes(pictureKind(bytes)) ? pictureSize(bytes) : null;
  if (!size) return `is no picture that is read here: ${kinds.join(', ')}`;
  const [width, height] = size;
  return width > 0 && height > 0 && width * height <= most ? null : `has ${width} x ${height} points: it may have ${most}`;
}

/** @param {Uint8Array} bytes @returns {'png'|'jpeg'|'webp'|'gif'|'avif'|'bmp'|'ktx2'|null} avif: HEIC, too */
export function pictureKind(bytes) {
  const text = (at, length) => String.fromCharCode(...bytes.subarray(at, at + length));
  if (text(1, 3) === 'PNG') return 'png';
  if (text(1, 6) === 'KTX 20') return 'ktx2';
  if (text(0, 4) === 'RIFF' && text(8, 4) === 'WEBP') return 'webp';
  if (text(0, 4) === 'GIF8') return 'gif';
  if (text(0, 2) === 'BM') return 'bmp';
  if (text(4, 4) === 'ftyp') return 'avif';
  return bytes[0] === 0xff && bytes[1] === 0xd8 ? 'jpeg' : null;
}

/**
 * @param {Uint8Array} bytes of a PNG, JPEG, WebP, GIF, AVIF, BMP or KTX2
 * @returns {[number, number]|null} null: another format, or no size in it
 */
export function pictureSize(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  if (bytes.length < 32) return null;
  switch (pictureKind(bytes)) {
    case 'png':
      return view.getUint32(12) === 0x49484452 ? [view.getUint32(16), view.getUint32(20)] : null; // IHDR comes first
    case 'ktx2':
      return [view.getUint32(20, true), view.getUint32(24, true)];
    case 'webp':
      return ofWebp(view, String.fromCharCode(...bytes.subarray(12, 16)));
    case 'bmp':
      return ofBmp(view);
    case 'gif':
      return ofGif(view);
    case 'avif':
      return ofAvif(view);
    case 'jpeg':
      return ofJpeg(view);
    default:
      return null;
  }
}

function ofWebp(view, kind) {
  const three = (at) => view.getUint16(at, true) | (view.getUint8(at + 2) << 16);
  if (kind === 'VP8X') return [1 + three(24), 1 + three(27)];
  if (kind === 'VP8L') return [1 + (view.getUint32(21, true) & 0x3fff), 1 + ((view.getUint32(21, true) >> 14) & 0x3fff)];
  return kind === 'VP8 ' ? [view.getUint16(26, true) & 0x3fff, view.getUint16(28, true) & 0x3fff] : null;
}

/** The oldest header has 12 bytes; in others a height below 0 means lines from the top. */
function ofBmp(view) {
  if (view.getUint32(14, true) === 12) return [view.getUint16(18, true), view.getUint16(20, true)];
  return [18, 22].map((at) => Math.abs(view.getInt32(at, true)));
}

/** The screen, or the first picture where that is larger. */
function ofGif(view) {
  const screen = [view.getUint16(6, true), view.getUint16(8, true)];
  const at = 13 + (view.getUint8(10) & 0x80 ? 3 << ((view.getUint8(10) & 7) + 1) : 0);
  if (at + 9 > view.byteLength || view.getUint8(at) !== 0x2c) return screen;
  return [4, 6].map((offset, k) => Math.max(screen[k], view.getUint16(at + 1 + offset, true)));
}

/** The largest of the properties `ispe` in its boxes `meta`, wherever those stand (ISO/IEC 14496-12). */
function ofAvif(view) {
  let best = null;
  for (let at = 0; at + 8 <= view.byteLength; ) {
    const length = view.getUint32(at);
    const long = length === 1 && at + 16 <= view.byteLength;
    const end = length === 0 ? view.byteLength : at + (long ? Number(view.getBigUint64(at + 8)) : length);
    if (end < at + 8) return null;
    const most = view.getUint32(at + 4) === 0x6d657461 ? Math.min(end, view.byteLength) - 16 : -1; // meta
    for (let i = at + 8; i <= most; i++)
      if (view.getUint32(i) === 0x69737065) {
        const size = [view.getUint32(i + 8), view.getUint32(i + 12)];
        if (!best || size[0] * size[1] > best[0] * best[1]) best = size;
      }
    at = end;
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
