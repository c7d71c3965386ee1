// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * Hair: the package's texture tells where strands run (the direction across which brightness changes least)
 * and which regions are light; new strands are drawn by smearing noise along that direction, in the recipe's
 * colours.
 */
import { hex, luma, ramp } from '../../lib/color.mjs';
import { blur } from '../../lib/image.mjs';
import { noise } from './noise.mjs';

/** Recolours the image in place. */
export function paintHair({ size, data }, look) {
  const light = new Float32Array(size * size);
  for (let i = 0; i < light.length; i++)
    light[i] = Math.log(4 + luma([data[i * 4], data[i * 4 + 1], data[i * 4 + 2]]));
  const flow = strandDirections(light, size, look.flowBlur);
  const strands = smear(size, flow, look);
  const broad = blur(light, size, look.broadBlur);
  const detail = blur(light, size, 0.7);
  const sorted = Float32Array.from(broad).sort();
  const low = sorted[Math.floor(sorted.length * 0.02)],
    high = sorted[Math.floor(sorted.length * 0.99)];
  const stops = look.ramp.map(([at, text]) => [at, hex(text)]);
  for (let i = 0; i < light.length; i++) {
    const shine = (broad[i] - low) / (high - low);
    const own = detail[i] - broad[i];
    const value = look.middle + (shine - 0.4) * look.shine + strands[i] * look.strands + own * look.detail;
    data.set(ramp(stops, value), i * 4);
  }
}

/** Unit vectors along the strands, from the structure tensor of the brightness. */
function strandDirections(light, size, radius) {
  const xx = new Float32Array(light.length),
    xy = new Float32Array(light.length),
    yy = new Float32Array(light.length);
  for (let y = 1; y < size - 1; y++) {
    for (let x = 1; x < size - 1; x++) {
      const i = y * size + x;
      const gx = light[i + 1] - light[i - 1],
        gy = light[i + size] - light[i - size];
      xx[i] = gx * gx;
      xy[i] = gx * gy;
      yy[i] = gy * gy;
    }
  }
  const [a, b, c] = [xx, xy, yy].map((m) => blur(m, size, radius));
  const out = new Float32Array(light.length * 2);
  for (let i = 0; i < light.length; i++) {
    const angle = 0.5 * Math.atan2(2 * b[i], a[i] - c[i]) + Math.PI / 2;
    out[i * 2] = Math.cos(angle);
    out[i * 2 + 1] = Math.sin(angle);
  }
  return out;
}

/** Line integral of noise along the strands, brought to about -1..1. */
function smear(size, flow, look) {
  const grain = new Float32Array(size * size);
  for (let y = 0; y < size; y++)
    for (let x = 0; x < size; x++) {
      grain[y * size + x] =
        noise(x / look.grain, y / look.grain) * 0.6 +
        noise(x / (look.grain * 3) + 70, y / (look.grain * 3)) * 0.7;
    }
  const out = new Float32Array(size * size);
  const steps = Math.round(look.length / 2); // of 3 texels
  for (let y = 0; y < size; y++) {
    for (let x = 0; x < size; x++) {
      const from = y * size + x;
      let sum = grain[from],
        n = 1;
      for (let sign = -1; sign <= 1; sign += 2) {
        let px = x + 0.5,
          py = y + 0.5,
          dx = flow[from * 2] * sign,
          dy = flow[from * 2 + 1] * sign;
        for (let k = 0; k < steps; k++) {
          px += dx * 3;
          py += dy * 3;
          if (px < 0 || py < 0 || px >= size || py >= size) break;
          const i = (py | 0) * size + (px | 0);
          sum += grain[i];
          n++;
          const fx = flow[i * 2],
            fy = flow[i * 2 + 1];
          const along = fx * dx + fy * dy < 0 ? -1 : 1;
          dx = fx * along;
          dy = fy * along;
        }
      }
      out[from] = (sum / n) * Math.sqrt(n) * 0.6;
    }
  }
  return out;
}
