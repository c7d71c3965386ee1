// SPDX-License-Identifier: GPL-3.0-or-later
// Contact sheets: reduced pictures with labels.
import { PNG } from 'pngjs';

/** Reduces a picture by an integer factor, averaging pixels. */
export function reduce(png, factor) {
  const out = new PNG({ width: Math.floor(png.width / factor), height: Math.floor(png.height / factor) });
  for (let y = 0; y < out.height; y++)
    for (let x = 0; x < out.width; x++)
      for (let c = 0; c < 4; c++) {
        let sum = 0;
        for (let dy = 0; dy < factor; dy++)
          for (let dx = 0; dx < factor; dx++) sum += png.data[4 * ((y * factor + dy) * png.width + x * factor + dx) + c];
        out.data[4 * (y * out.width + x) + c] = sum / (factor * factor);
      }
  return out;
}

// A font of 3 x 5 pixels; each digit is a row (4 2 1 = left, middle, right).
const letters = {
  a: '25755', b: '65656', c: '34443', d: '65556', e: '74647', f: '74644', g: '34553', h: '55755', i: '72227', j: '11152', k: '55655', l: '44447', m: '57755', n: '65555', o: '25552',
  p: '65644', q: '25573', r: '65655', s: '34216', t: '72222', u: '55557', v: '55552', w: '55775', x: '55255', y: '55222', z: '71247', 0: '25552', 1: '26227', 2: '61247', 3: '61216',
  4: '55711', 5: '74616', 6: '34653', 7: '71224', 8: '25252', 9: '25716', '-': '00700', '=': '07070', ':': '02020', '.': '00002', '*': '05250', _: '00007', ' ': '00000',
};

/** Adds a line of text below the picture. */
export function label(png, text, scale = 2) {
  const out = new PNG({ width: png.width, height: png.height + 8 * scale });
  out.data.fill(255);
  PNG.bitblt(png, out, 0, 0, png.width, png.height, 0, 0);
  const ink = (x, y) => {
    for (let dy = 0; dy < scale; dy++)
      for (let dx = 0; dx < scale; dx++) {
        const px = x * scale + dx;
        if (px < out.width) out.data.fill(0, 4 * ((png.height + y * scale + dy) * out.width + px), 4 * ((png.height + y * scale + dy) * out.width + px) + 3);
      }
  };
  [...text.toLowerCase()].forEach((letter, i) => {
    [...(letters[letter] ?? letters['*'])].forEach((row, y) => {
      for (let x = 0; x < 3; x++) if ((Number(row) >> (2 - x)) & 1) ink(2 + 4 * i + x, 1 + y);
    });
  });
  return out;
}
