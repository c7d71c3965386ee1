// SPDX-License-Identifier: GPL-3.0-or-later
/** Selects the package's pictures for a recipe's textures, and adjusts their opacity. */
import path from 'node:path';
import { bleed, readImage } from '../../lib/image.mjs';
import { paintStrands } from './paint-strands.mjs';

const COARSE = 256; // texels: sufficient resolution to locate hair
const HALF = 0.5;
const SOLID = 220; // of 255: less opaque texels have the colour of the background
const SPECK = 4e-4; // share of all texels: smaller pieces are dirt

export async function readAsset(spec, scene, size = spec.size) {
  const image = await readImage(assetFile(spec, scene), size);
  if (spec.alpha) {
    sharpenAlpha(image, spec.alpha);
    dropSpecks(image);
    bleed(image, size / 16, SOLID); // keeps the ends of strands from darkening
  }
  return image;
}

/**
 * Returns the opaque areas of parts with holes.
 * @returns {Promise<Map<string, (u: number, v: number) => boolean>>} by the part's name; none for those without holes
 */
export async function opacities(scene) {
  const out = new Map();
  const { textures, materials } = scene.recipe;
  for (const { name, material, square } of scene.parts) {
    const look = materials[material];
    if (look?.alpha !== 'cutout' && look?.alpha !== 'blend') continue;
    const spec = textures[look.texture];
    const { size, data } = spec.paint === 'strands' ? paintStrands({ ...spec, size: COARSE }) : await readAsset(spec, scene, COARSE);
    const cell = (x) => Math.min(size - 1, Math.max(0, Math.floor(x * size)));
    const carded = (u, v) => square && [u, v].every((x, k) => x >= square[k] && x <= square[k] + square[2]);
    out.set(name, (u, v) => carded(u, v) || data[(cell(1 - v) * size + cell(u)) * 4 + 3] > 255 * HALF);
  }
  return out;
}

function assetFile(spec, { ctx, parts }) {
  if (spec.file) return ctx.assets.data(spec.file);
  const { proxy } = parts.find((part) => part.material === spec.material);
  return path.join(proxy.folder, proxy.texture);
}

/**
 * Alpha between `low` and `high` (0..1) becomes the whole range: thin strands survive the cut at one half.
 */
function sharpenAlpha({ data }, [low, high]) {
  for (let i = 3; i < data.length; i += 4)
    data[i] = Math.min(255, Math.max(0, ((data[i] / 255 - low) / (high - low)) * 255));
}

/** Removes small isolated pieces, which would float beside the hair as dots. */
function dropSpecks({ size, data }) {
  const seen = new Uint8Array(size * size);
  for (let start = 0; start < seen.length; start++) {
    if (seen[start] || data[start * 4 + 3] < 16) continue;
    const piece = [start];
    seen[start] = 1;
    for (let n = 0; n < piece.length; n++) {
      const i = piece[n],
        x = i % size;
      for (const j of [x + 1 < size ? i + 1 : -1, x ? i - 1 : -1, i + size, i - size]) {
        if (j < 0 || j >= seen.length || seen[j] || data[j * 4 + 3] < 16) continue;
        seen[j] = 1;
        piece.push(j);
      }
    }
    if (piece.length < SPECK * seen.length) for (const i of piece) data[i * 4 + 3] = 0;
  }
}
