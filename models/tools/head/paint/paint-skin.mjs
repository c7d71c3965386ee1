// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * The skin's texture, painted on the surface in millimetres: a base tone with some of the package's texture
 * in it, zones of colour round feature points, lips, lid margins, brows' underpainting, mottling, pores and
 * freckles, and ambient occlusion.
 */
import { closedLids } from '../actions/act-eyes.mjs';
import { opacities } from './asset-image.mjs';
import { dilate, eachTexel, occlusion } from './bake.mjs';
import { hex, mix } from '../../lib/color.mjs';
import { readImage } from '../../lib/image.mjs';
import { paintedShadow } from './lamp-shadow.mjs';
import { normals } from '../../lib/mesh.mjs';
import { beside } from '../hair/hang.mjs';
import { aboveLine } from '../hair/skull.mjs';
import { distanceTo } from './near-hair.mjs';
import { fractal, noise } from './noise.mjs';
import { behindMargin, eyeLines, lidPaint } from './paint-lids.mjs';
import { lipPaint, lipParameter } from './paint-lips.mjs';
import { neckPaint } from './paint-neck.mjs';
import { stubblePaint } from './paint-stubble.mjs';
import { ellipsoid, smoothstep } from '../../lib/zones.mjs';

const MOST_LIGHT = 1.1; // factor on the client's light, where its own shadow is too wide

export async function paintSkin(spec, scene) {
  const { ctx, recipe, parts } = scene;
  const look = recipe.skin;
  const part = parts.find((x) => x.name === 'skin');
  const size = spec.size;
  const source = await readImage(ctx.assets.data(look.file), 1024);
  // Lighting uses closed lids: folded skin would be painted dark, and appear during blinks.
  const seen = closedLids(ctx, part, recipe.faps.lids);
  const vertexNormals = normals(seen, part.index, part.smooth);
  const opaque = await opacities(scene);
  const shadow = paintedShadow(parts, seen, vertexNormals, ({ name }) => opaque.get(name), recipe.materials.skin, size / 2);
  const occluders = Object.entries(look.occlusion.parts).map(([name, weight]) => ({
    part: parts.find((x) => x.name === name),
    weight,
    opaque: opaque.get(name),
  }));
  const sky = occlusion({ position: seen }, vertexNormals, occluders, look.occlusion);
  // Colours of zones and lids are relative to a skin of the colour `zoneTone`.
  const tone = hex(look.tone),
    reference = hex(look.zoneTone);
  const alike = (c) => c.map((x, k) => Math.min(255, (x * tone[k]) / reference[k]));
  const zones = look.zones.flatMap((z) =>
    z.points.map((name) => ({
      weight: ellipsoid(
        ctx.fdp[name].map((x, k) => x + z.shift[k] * (k === 0 ? Math.sign(x) || 1 : 1)),
        z.radii,
        z.flat ?? 0,
      ),
      colour: alike(hex(z.colour)),
      strength: z.strength,
    })),
  );
  const onPart = (list) => part.refs.map((refs) => refs.reduce((sum, [v, w]) => sum + w * list[v], 0));
  const lips = lipParameter(ctx);
  const [lipT, lipDepth, lipS] = [lips.t, lips.depth, ctx.grid.s].map(onPart);
  const lids = eyeLines(ctx);
  const inner = onPart(behindMargin(ctx));
  const grown = hairRoots(look, parts, opaque);
  const neck = neckPaint(ctx, look.neck, recipe.materials.skin.subsurface);
  const ear = earZone(ctx.fdp, look.scalp.ears);
  const stubble = stubblePaint(ctx.fdp, look.stubble);
  const scalp = hex(look.scalp.colour);
  const lidLook = { ...look.lids, tone: alike(hex(look.lids.tone)), rim: alike(hex(look.lids.rim)) };
  const data = new Float32Array(size * size * 3);
  const done = eachTexel(part, size, (texel, a, b, c, wa, wb, wc) => {
    const at = (list, stride, k) =>
      wa * list[a * stride + k] + wb * list[b * stride + k] + wc * list[c * stride + k];
    const q = [at(part.position, 3, 0), at(part.position, 3, 1), at(part.position, 3, 2)];
    const attribute = (list) => wa * list[a] + wb * list[b] + wc * list[c];
    const lip = attribute(lipT),
      deep = attribute(lipDepth);
    // Closed lips shade each other. Little of that is painted, because it would stay when they open.
    const outside = smoothstep(9, 4, deep);
    const least = LEAST_ON_LIPS * smoothstep(1.6, 0.9, lip) * outside;
    const lamp = look.lampShadow * (1 - LAMP_BETWEEN_LIPS * smoothstep(0.45, 0.05, lip) * outside);
    const light = Math.min(1, Math.max(least, wa * sky[a] + wb * sky[b] + wc * sky[c]) / look.occlusion.open);
    const behind = scalpOf(look, recipe.parts.hair.grown, q);
    const hairy = behind > -look.scalp.soft ? smoothstep(-look.scalp.soft, look.scalp.soft, behind) * (1 - ear(q)) * (1 - parted(recipe.parts.hair.grown, q)) : 0;
    const bare = () => {
      let colour = mix(
        tone,
        sampled(source, at(part.sourceUv, 2, 0), at(part.sourceUv, 2, 1)),
        look.fromPackage,
      );
      for (const z of zones) {
        const w = z.weight(q[0], q[1], q[2]);
        if (w > 0) colour = mix(colour, z.colour, w * z.strength);
      }
      colour = neck(mottle(colour, q, look), q, [0, 1, 2].map((k) => at(vertexNormals, 3, k)));
      colour = lidPaint(colour, q, attribute(inner), lids, lidLook);
      colour = lipPaint(colour, q, lip, deep, attribute(lipS), look.lips);
      return grown(stubble(pores(colour, [0, 1, 2].map((k) => at(seen, 3, k)), look, lip), q, lip), q, behind, lip);
    };
    const roots = look.scalp.coils ? coiled(scalp, q, look.scalp.coils) : scalp;
    const colour = hairy === 1 ? roots : mix(bare(), roots, hairy);
    data.set(shade(darkened(colour, between(shadow, size / 2, texel, size), lamp), light, look.occlusion), texel * 3);
  });
  dilate(data, done, size, 12);
  return { size, data };
}

/** mm behind the hairline, uneven: that of grown hair, or a slope. */
function scalpOf({ scalp }, grown, q) {
  if (!grown) return q[1] - scalp.slope * q[2] - scalp.level + 4 * noise(q[0] / 5, q[1] / 5, q[2] / 5);
  const strokes = noise(q[0] / 0.9, q[1] / 5, q[2] / 2.5) + 0.8 * noise(q[0] / 5, q[1] / 5, q[2] / 5);
  return aboveLine(grown.line, q) + (grown.hangs ? 2 : 4) * strokes; // combed from a parting, hair does not stand on end
}

const PARTING = [0.4, 2.4]; // mm from the middle of a parting, between which skin becomes scalp
const SHOWN = 0.6; // of the skin's colour in its middle

/** How much of the skin a parting shows. */
function parted(grown, q) {
  if (!grown?.hangs || q[1] < 20) return 0;
  const { parting } = grown.hangs;
  const aside = Math.abs(beside(parting, q)) + 0.6 * noise(q[0] / 2, q[1] / 4, q[2] / 3);
  return SHOWN * smoothstep(PARTING[1], PARTING[0], aside) * smoothstep(parting.behind - 10, parting.behind + 10, q[2]);
}

/** Coils that lie on the scalp: lighter and darker than its colour. */
function coiled(colour, q, strength) {
  const curls = noise(q[0] / 1.1, q[1] / 1.1, q[2] / 1.1) + 0.6 * noise(q[0] / 0.6, q[1] / 0.6, q[2] / 0.6);
  return colour.map((x) => x * Math.max(0.2, 1 + strength * curls));
}

const LEAST_ON_LIPS = 0.7; // share of the sky's light that the painted lips get at least
const LAMP_BETWEEN_LIPS = 0.8; // of the lamp's shadow on the line where they touch, the share that is not painted

/**
 * Short hairs where hair and beard begin, so that neither has a hard border.
 * @returns {(colour: number[], q: number[], behind: number, lip: number) => number[]} behind: mm behind the line where the scalp
 *   begins; lip: 1 on the outer contour of the lips
 */
function hairRoots({ roots, scalp }, parts, opaque) {
  const fields = Object.entries(roots)
    .map(([name, root]) => ({ ...root, part: parts.find((one) => one.name === name) }))
    .filter(({ part }) => part)
    .map((root) => ({
      ...root,
      colour: hex(root.colour ?? scalp.colour),
      far: distanceTo(root.part, opaque.get(root.part.name), root.reach * 1.6),
    }));
  return (colour, q, behind, lip) => {
    let out = colour;
    for (const { far, reach, strength, colour: hair, before } of fields) {
      const mm = far(...q);
      if (mm > reach * 1.6) continue;
      const stroke = noise(q[0] / 0.45, q[1] / 5, q[2] / 5) * 0.45 + noise(q[0] / 3, q[1] / 6, q[2] / 6) * 0.35;
      const place = before === undefined ? 1 : smoothstep(before, before + 18, behind);
      const share = strength * place * smoothstep(1.1, 1.3, lip) * smoothstep(1.1 * reach, -0.1 * reach, mm + 0.45 * reach * stroke);
      out = mix(out, hair, share);
    }
    return out;
  };
}

/** A texel of a picture of half the size. */
function between(picture, half, texel, size) {
  const x = Math.min(half - 1.001, Math.max(0, (texel % size) / 2 - 0.25)),
    y = Math.min(half - 1.001, Math.max(0, Math.floor(texel / size) / 2 - 0.25));
  const i = Math.floor(x),
    j = Math.floor(y),
    fx = x - i,
    fy = y - j;
  const at = (j * half + i) * 3;
  const row = (from, k) => picture[from + k] * (1 - fx) + picture[from + 3 + k] * fx;
  return [0, 1, 2].map((k) => row(at, k) * (1 - fy) + row(at + half * 3, k) * fy);
}

/** Less light of the lamp, as a share of `strength`; colours are on the display's scale. */
function darkened(c, factor, strength) {
  return c.map((x, k) => x * (1 + strength * (Math.min(MOST_LIGHT, factor[k]) ** (1 / 2.2) - 1)));
}

/** 1 on the ears, between the top and the lobe of each. */
function earZone(fdp, radii) {
  const ears = [
    ['10.1', '10.5'],
    ['10.2', '10.6'],
  ].map(([top, lobe]) =>
    ellipsoid(
      fdp[top].map((x, k) => (x + fdp[lobe][k]) / 2),
      radii,
      0.75,
    ),
  );
  return ([x, y, z]) => Math.max(...ears.map((weight) => weight(x, y, z)));
}

/** Uneven blood and pigment: slow noise in redness and in lightness. */
function mottle(c, q, look) {
  const red = fractal(q[0] / 14, q[1] / 14, q[2] / 14, 3) * look.mottle;
  const light = fractal(q[0] / 22 + 50, q[1] / 22, q[2] / 22, 3) * look.mottle * 0.6;
  return [c[0] * (1 + light + red * 0.25), c[1] * (1 + light - red * 0.55), c[2] * (1 + light - red * 0.5)];
}

/** Pores, fine creases and a few freckles; not on the lips. */
function pores(c, q, look, lipT) {
  const skin = smoothstep(1, 1.25, lipT);
  if (!skin) return c;
  const fine =
    noise(q[0] / 0.55, q[1] / 0.55, q[2] / 0.55) * 0.6 + noise(q[0] / 0.28, q[1] / 0.28, q[2] / 0.28) * 0.4;
  const k = 1 + fine * look.pores * skin;
  const spot =
    smoothstep(0.62, 0.86, noise(q[0] / 1.9 + 9, q[1] / 1.9, q[2] / 1.9)) *
    Math.max(0, noise(q[0] / 13, q[1] / 13, q[2] / 13 + 4));
  const f = spot * look.freckles * skin;
  return [c[0] * k * (1 - f * 0.25), c[1] * k * (1 - f * 0.45), c[2] * k * (1 - f * 0.6)];
}

/** Occluded light is warmer: blue decreases first. */
function shade(c, light, { strength, tint }) {
  return c.map((x, k) => x * (1 - strength * (1 - light ** tint[k])));
}

function sampled(image, u, v) {
  const { size, data } = image;
  const x = Math.min(size - 1.001, Math.max(0, u * size - 0.5)),
    y = Math.min(size - 1.001, Math.max(0, (1 - v) * size - 0.5));
  const i = Math.floor(x),
    j = Math.floor(y),
    fx = x - i,
    fy = y - j;
  const at = (dx, dy, k) => data[((j + dy) * size + i + dx) * 4 + k];
  const channel = (k) =>
    (at(0, 0, k) * (1 - fx) + at(1, 0, k) * fx) * (1 - fy) + (at(0, 1, k) * (1 - fx) + at(1, 1, k) * fx) * fy;
  return [channel(0), channel(1), channel(2)];
}
