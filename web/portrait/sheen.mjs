// SPDX-License-Identifier: MIT
// How skin shines in the portrait's light, which adds to the colour of its texture.
import { reliefOf } from './age.mjs';
import { luma } from './lab.mjs';

// Linear, of the specular reflection: measured on drawn heads of four skins, with textures darkened to a half and a quarter.
const SHEEN = 0.039;

// Light is linear: dark skin shows more of its shine, which is as strong as that of light skin.
const DARK = { light: [0.08, 0.3], specular: 0.22, roughness: 0.66 };

/** How a skin of a tone and age takes the light. */
export function surfaceOf(material, tone, age) {
  const dark = 1 - Math.min(1, Math.max(0, (luma(tone) - DARK.light[0]) / (DARK.light[1] - DARK.light[0])));
  const toward = (name) => material[name] + dark * (DARK[name] - material[name]);
  return { ...material, specular: Math.min(material.specular, toward('specular')), roughness: Math.max(material.roughness, toward('roughness')), relief: reliefOf(material.relief ?? 1, age) };
}

/** The linear light behind a drawn colour: the inverse of `filmic` (head/shader-surface.mjs), which presses what is bright. */
export function beforeFilm(c) {
  const pressed = Math.min(0.97, Math.max(...c));
  if (pressed <= 0.7) return [...c];
  const peak = 0.4 + 0.09 / (1 - pressed);
  const white = 1 - 1 / (0.2 * (peak - pressed) + 1);
  return c.map((x) => (Math.max(0, Math.min(x, pressed) - pressed * white) / (1 - white)) * (peak / pressed));
}

/**
 * By how much the base's texture must change so that its skin is drawn in the picture's tone: what is drawn is the texture
 * times the light, and what shines, as it would on a film.
 * @param {number[]} wanted linear @param {number[]} drawn linear: how the base's skin looks
 * @param {{was: number, is: number}} specular of the base's skin, and of the new one
 */
export function toneRatio(wanted, drawn, specular) {
  const matt = (colour, shine) => beforeFilm(colour).map((x) => Math.max(0.15 * x, x - SHEEN * shine));
  const from = matt(drawn, specular.was);
  return matt(wanted, specular.is).map((x, k) => x / from[k]);
}
