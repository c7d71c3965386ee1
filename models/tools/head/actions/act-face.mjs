// SPDX-License-Identifier: GPL-3.0-or-later
/** Brows, cheeks, nose and ears: FAPs 31 to 42 and 61 to 68, zones round their feature points. */
import { along } from '../../lib/actions.mjs';
import { cardinalBasis, ellipsoid, piecewise, plateau, smoothstep } from '../../lib/zones.mjs';

/**
 * A nose is not raised but wrinkled (AU 9): the muscle draws the wings and the skin beside them up, for each mm of the tip. Around the wing, mm.
 */
const WRINKLED = { shift: [3, 5, -3], radii: [17, 24, 24], direction: [0.12, 0.8, 0.2] };

const BROWS = [
  ['4.1', 31, 32],
  ['4.3', 33, 34],
  ['4.5', 35, 36],
];

export function faceActions(actions, ctx, tuning) {
  const skin = new Set(ctx.topology.faces.flatMap((f) => f.v));
  const outside = (v) => skin.has(v) && !ctx.grid.inMouth[v];
  browActions(actions, ctx, outside, tuning.brows);
  for (const zone of tuning.zones) {
    for (const [i, fap] of zone.faps.entries()) {
      const side = i === 0 ? 1 : -1;
      const centre = ctx.fdp[zone.points[i]].map((x, k) => x + zone.shift[k] * (k === 0 ? side : 1));
      const round = ellipsoid(centre, zone.radii, zone.flat);
      const beside = (x) => (zone.beside ? smoothstep(...zone.beside, Math.abs(x) - Math.abs(ctx.fdp['9.1'][0])) : 1); // mm outward of the nose's wing
      const weight = (x, y, z) => round(x, y, z) * beside(x);
      const direction = [
        zone.direction[0] * (zone.faps.length > 1 ? side : 1),
        zone.direction[1],
        zone.direction[2],
      ];
      actions.move(
        fap,
        'both',
        (v, x, y, z) => outside(v) && along(weight(x, y, z) * spared(ctx, x, y, z), direction),
      );
    }
  }
  wrinkleNose(actions, ctx, outside);
}

function wrinkleNose(actions, ctx, outside) {
  const { shift, radii, direction } = WRINKLED;
  for (const [point, side] of [['9.1', 1], ['9.2', -1]]) {
    const weight = ellipsoid(ctx.fdp[point].map((c, k) => c + shift[k] * (k ? 1 : side)), radii, 0.15);
    const lips = (v) => 1 - Math.min(1, ctx.grid.inner[v] + 0.6 * ctx.grid.outer[v]);
    actions.plainMove(63, 'positive', (v, x, y, z) => outside(v) && along(weight(x, y, z) * lips(v) * spared(ctx, x, y, z), [direction[0] * side, direction[1], direction[2]]));
  }
}

const SPARED = [2, 16]; // mm from the eyeball

/** 0 on the lids, 1 from some mm outside: cheeks and brows must not push the lids through the eyeballs. */
function spared({ eyes }, x, y, z, [near, clear] = SPARED) {
  const far = Math.min(
    ...['l', 'r'].map((side) => Math.hypot(x - eyes[side][0], y - eyes[side][1], z - eyes[side][2])),
  );
  return smoothstep(eyes.radius + near, eyes.radius + clear, far);
}

/**
 * Raised brows, mm: their movement fades to the lid's fold over a longer way, not down the root of the nose, and below the inner half of the hairs it
 * starts farther from the eyeball. A steep step between nose and lid would look like a pit.
 */
const RAISED = { below: 20, root: 0, clear: 20, hairs: [6, 12], inner: 3 };

/**
 * Along a brow the three points share the movement; it fades over the forehead above and to the lid's fold below. Between the brows both sides
 * add up to the whole, and their movement reaches down the root of the nose: no ridge is pinched there. The points lie near the brow's upper border:
 * the zone extends below them by the height of the brow, so that its hairs move without distortion.
 */
function browActions(actions, ctx, outside, tuning) {
  for (const side of [1, -1]) {
    const names = BROWS.map(([name]) => (side > 0 ? name : `4.${Number(name.slice(2)) + 1}`));
    const xs = names.map((n) => Math.abs(ctx.fdp[n][0]));
    const ys = names.map((n) => ctx.fdp[n][1]);
    const basis = cardinalBasis(xs);
    const fadeOf = ({ below: least, root, clear, hairs, inner }) => (x, y, z) => {
      const ax = x * side;
      const line = piecewise(xs, ys, ax);
      const below = least + root * smoothstep(xs[0], 0.4 * xs[0], Math.abs(ax));
      const vertical =
        y > line
          ? plateau(y - line, tuning.flat, tuning.above)
          : plateau(line - y, tuning.flatBelow, below);
      const inward = plateau(xs[0] - ax, 0, 2 * xs[0]);
      const outward = plateau(ax - xs[2], 0, tuning.outward);
      const [near, far] = tuning.spared;
      const start = clear ? far + (clear - far) * smoothstep(...hairs, line - y) * smoothstep(xs[1], xs[0] + inner, ax) : far;
      return vertical * inward * outward * plateau(-z, 0, 30) * spared(ctx, x, y, z, [near, start]);
    };
    for (const [sign, reach] of [['positive', RAISED], ['negative', tuning]]) {
      const fade = fadeOf(reach);
      BROWS.forEach(([, left, right], i) => {
        const share = (x) => basis(i, Math.max(xs[0], Math.min(xs[2], x * side)));
        actions.move(side > 0 ? left : right, sign, (v, x, y, z) => outside(v) && along(fade(x, y, z) * share(x), [0, 1, tuning.forward]));
      });
    }
    const [around, inner] = [ellipsoid(ctx.fdp[names[0]], tuning.squeezeRadii, 0.1), ctx.fdp[names[0]]];
    const squeeze = (x, y, z) => around(x, y, z) * plateau(inner[1] - y, ...tuning.squeezeBelow); // the brow, and not the sides of the nose
    actions.move(
      side > 0 ? 37 : 38,
      'both',
      (v, x, y, z) => outside(v) && along(squeeze(x, y, z), [-side, 0, tuning.squeezeForward]),
    );
  }
}
