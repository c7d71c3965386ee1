// SPDX-License-Identifier: GPL-3.0-or-later
/** The textures of a head, as WebP: painted, or the package's with new colours. */
import { readAsset } from './asset-image.mjs';
import { occlusion } from './bake.mjs';
import { bleed, recolour, writeImage } from '../../lib/image.mjs';
import { normals } from '../../lib/mesh.mjs';
import { fadeHairline } from './hairline.mjs';
import { paintCards } from './paint-cards.mjs';
import { paintCloth } from './paint-cloth.mjs';
import { eyeSky, paintEye } from './paint-eye.mjs';
import { paintHair } from './paint-hair.mjs';
import { paintSkin } from './paint-skin.mjs';
import { paintStrands } from './paint-strands.mjs';
import { paintTeeth } from './paint-teeth.mjs';

const PAINTERS = {
  eye: paintBothEyes,
  skin: paintSkin,
  asset: paintAsset,
  cloth: paintCloth,
  strands: paintStrands,
  teeth: ({ size }, { ctx }) => paintTeeth(size, ctx.figures),
};

/** @param {{ctx: object, recipe: object, parts: object[], eyeSpec: object}} scene */
export async function makeTextures(scene) {
  const out = {};
  for (const [name, spec] of Object.entries(scene.recipe.textures)) {
    const image = await PAINTERS[spec.paint](spec, scene);
    const data = await writeImage(image, spec.quality ?? 85);
    out[name] = { type: 'image/webp', width: spec.size, height: spec.size, data };
  }
  return out;
}

function paintBothEyes({ size }, { recipe, parts, eyeSpec }) {
  const named = (name) => parts.find((part) => part.name === name);
  const { occlusion: rules } = recipe.skin;
  const sky = ['eye_l', 'eye_r'].map((name) =>
    occlusion(
      named(name),
      normals(named(name).position, named(name).index, null),
      [{ part: named('skin'), weight: 1 }],
      { ...rules, bias: 0.3 },
    ),
  );
  return { size, data: paintEye(size, eyeSpec, recipe.eyes.look, eyeSky(eyeSpec, sky)) };
}

async function paintAsset(spec, scene) {
  const named = (name) => scene.parts.find((part) => part.name === name);
  const image = await readAsset(spec, scene);
  if (spec.ramp) recolour(image, spec.ramp);
  if (spec.strands) paintHair(image, spec.strands);
  if (spec.hairline) fadeHairline(image, named('hair'), named('skin'), spec.hairline);
  bleed(image, spec.size / 32);
  const carded = scene.parts.find(({ material, square }) => square && material === spec.material);
  if (carded) paintCards(image, carded.square, spec.strands?.ramp ?? spec.ramp);
  return image;
}

const COARSE = 256; // texels: enough to see where hair ends

/** Where a part's picture of hair will be opaque. @returns {Promise<(u: number, v: number) => boolean>} */
export async function opacityOf(spec, scene, skin) {
  const image = await readAsset(spec, scene, COARSE);
  if (spec.hairline) fadeHairline(image, scene.parts[0], skin, spec.hairline);
  const cell = (x) => Math.min(COARSE - 1, Math.max(0, Math.floor(x * COARSE)));
  return (u, v) => image.data[4 * (cell(1 - v) * COARSE + cell(u)) + 3] > 127;
}
