// SPDX-License-Identifier: GPL-3.0-or-later
/** Lips and corners: FAPs 4 to 13, 16, 17 and 51 to 60. */
import { along } from '../../lib/actions.mjs';
import { cardinalBasis, clamp, plateau, raisedCosine, smoothstep } from '../../lib/zones.mjs';

/** Feature points along a lip: right corner, half-way, middle, half-way, left corner. */
const NODES = [-1, -0.5, 0, 0.5, 1];
const CORNER_R = 0,
  HALF_R = 1,
  MIDDLE = 2,
  HALF_L = 3,
  CORNER_L = 4;

const UPPER = [
  [4, 51, MIDDLE],
  [8, 55, HALF_L],
  [9, 56, HALF_R],
];
const LOWER = [
  [5, 52, MIDDLE],
  [10, 57, HALF_L],
  [11, 58, HALF_R],
];
const CORNERS = [
  [6, 53, 12, 59, CORNER_L, 1],
  [7, 54, 13, 60, CORNER_R, -1],
];

/**
 * The middle of a lip moves as a wider piece than a cubic between the nodes has it: people's openings are round below, not pointed. Power of the
 * distance from the middle, as a share of that to the feature points half-way.
 */
const FULL_MIDDLE = 1.6;

/** Pressed lip, mm per mm of its outer contour: the red moves back and towards the other lip. */
const ROLL = { back: 1.1, up: 0.35 };
/**
 * Rounded lips, in front of the teeth: protruded lips hang lower (mm per mm); so do lips whose corners are drawn together, and the wet inside of
 * the upper lip moves down behind its border (mm per mm of each corner). Both lips move down, so the opening stays. The corners follow protruded lips
 * (mm per mm of each lip): left where they are, they would pull a round opening to a V.
 */
const ROUNDING = { hang: 1, hangLower: 0.4, draw: 0.12, curtain: 0.3, corners: 0.8 };
/**
 * These values hold for incisors whose edge is that many mm below the line of the lips. If the edge is at the line (with age), protruded lips
 * hang that much less per mm, so that they rise from the lower teeth (both, so the opening stays), and a retracted lower lip rises to the edge.
 */
const HIGH_TEETH = { below: 2.36, hang: 1.2, hangLower: 1.25, rise: 0.2 };

/** @param {object} tuning the recipe's `faps.mouth` */
export function mouthActions(actions, ctx, grid, tuning) {
  const roll = { ...ROLL, ...tuning.roll },
    rounding = { ...ROUNDING, ...tuning.rounding };
  const high = clamp(1 - (ctx.teeth.line - ctx.teeth.edge) / HIGH_TEETH.below, 0, 1);
  const cubic = cardinalBasis(NODES, tuning.cornerSteepness);
  const basis = (node, s) => cubic(node, Math.abs(s) < 0.5 ? Math.sign(s) * 0.5 * (2 * Math.abs(s)) ** FULL_MIDDLE : s);
  const isLower = (v) => grid.lower[v] > 0.5;
  const isUpper = (v) => grid.lower[v] < 0.5;

  /**
   * Both contours of one lip point; `forward` is z for each unit of y, for the inner and the outer contour.
   */
  const lipPoint = (inner, outer, node, mine, up, sign, forward) => {
    actions.move(
      inner,
      sign,
      (v) => mine(v) && along(grid.inner[v] * basis(node, grid.s[v]), [0, up, forward.inner * up]),
    );
    actions.move(
      outer,
      sign,
      (v) => mine(v) && along(grid.outer[v] * basis(node, grid.s[v]), [0, up, forward.outer * up]),
    );
    // Moving the outer contour towards the other lip thins the lip: its red rolls in.
    if (sign === 'positive')
      actions.plainMove(outer, sign, (v) => {
        const red = mine(v) && !grid.inMouth[v] ? 4 * grid.inner[v] * grid.outer[v] : 0;
        return red && along(red * basis(node, grid.s[v]), [0, up * roll.up, -roll.back]);
      });
  };
  for (const [inner, outer, node] of UPPER) {
    lipPoint(inner, outer, node, isUpper, -1, 'positive', tuning.upperDown);
    lipPoint(inner, outer, node, isUpper, -1, 'negative', tuning.upperUp);
  }
  for (const [inner, outer, node] of LOWER) {
    lipPoint(inner, outer, node, isLower, 1, 'positive', tuning.lowerUp);
    lipPoint(inner, outer, node, isLower, 1, 'negative', tuning.lowerDown);
  }

  for (const [stretchIn, stretchOut, raiseIn, raiseOut, node, side] of CORNERS) {
    const pull = (v) => Math.max(0, grid.s[v] * side) ** tuning.stretchPower;
    const corner = ctx.fdpVertex[side > 0 ? '8.3' : '8.4'];
    for (const [sign, back, cheek] of [
      ['positive', tuning.stretchBack, tuning.stretchCheek],
      ['negative', tuning.purseForward, tuning.purseCheek],
    ]) {
      const dir = (v) => [side, 0, -back * Math.abs(grid.s[v])];
      const beyond = cheekField(ctx, grid, cheek, corner, side);
      actions.move(stretchIn, sign, (v) => along(grid.inner[v] * pull(v), dir(v)));
      actions.move(stretchOut, sign, (v) => sum(along(grid.outer[v] * pull(v), dir(v)), beyond(v)));
    }
    actions.move(raiseIn, 'both', (v) => along(grid.inner[v] * basis(node, grid.s[v]), [0, 1, 0]));
    const up = (v) => along(grid.outer[v] * basis(node, grid.s[v]), [0, 1, tuning.raiseForward]);
    const beyond = cheekField(ctx, grid, tuning.raiseCheek, corner, side);
    actions.move(raiseOut, 'positive', (v) => sum(up(v), beyond(v)));
    actions.move(raiseOut, 'negative', up);
  }

  /** Protrusion moves the whole lip, its outer contour and adjacent skin, less towards the corners. */
  const push = (fap, mine, lift) => {
    for (const sign of ['positive', 'negative']) {
      actions.move(fap, sign, (v) => {
        if (!mine(v)) return null;
        const share =
          grid.inner[v] + grid.outer[v] * (sign === 'positive' ? tuning.pushOuter : tuning.pullOuter);
        const w = share * raisedCosine(Math.abs(grid.s[v]) / tuning.pushWidth);
        return along(w, [0, sign === 'positive' ? lift * (1 - grid.outer[v]) * (1 - grid.inner[v]) : 0, 1]);
      });
    }
  };
  push(16, isLower, -tuning.pushEvert);
  push(17, isUpper, tuning.pushEvert);
  const middle = (v) => (grid.inner[v] + grid.outer[v]) * plateau(Math.abs(grid.s[v]), 0.4, tuning.pushWidth);
  const corners = (v) => (grid.inner[v] + grid.outer[v]) * (basis(CORNER_L, grid.s[v]) + basis(CORNER_R, grid.s[v]));
  for (const [fap, mine, hang] of [
    [16, isLower, rounding.hangLower - high * HIGH_TEETH.hangLower],
    [17, isUpper, rounding.hang - high * HIGH_TEETH.hang],
  ])
    actions.plainMove(fap, 'positive', (v) => along((mine(v) ? middle(v) * hang : 0) + corners(v) * rounding.corners, [0, -1, 0]));
  actions.plainMove(16, 'negative', (v) => isLower(v) && along(middle(v) * high * HIGH_TEETH.rise, [0, -1, 0]));
  for (const fap of [6, 7]) {
    actions.plainMove(fap, 'negative', (v) => along(middle(v) * rounding.draw, [0, 1, 0])); // times a value below 0
    actions.plainMove(fap, 'negative', (v) => {
      // Half way into the mouth, where nothing follows the border any more.
      const w = isUpper(v) && grid.inMouth[v] ? 4 * grid.inner[v] * (1 - grid.inner[v]) : 0;
      return w && along(w * rounding.curtain * plateau(Math.abs(grid.s[v]), 0.4, 1), [0, 1, -0.2]);
    });
  }
}

/**
 * Effect of an expression target of the mesh on one half of the face outside the lips' zones: cheeks, folds beside the nose. Scaled so that the
 * target's corner of the mouth would move by one unit along `axis`;
 * only the recipe's `axes` count.
 */
function cheekField(ctx, grid, { target, axis, axes, gain }, corner, side) {
  const field = ctx.target(target);
  const unit = Math.abs(field[corner * 3 + axis]) / gain;
  const skin = new Set(ctx.topology.faces.flatMap((f) => f.v));
  return (v) => {
    if (!skin.has(v) || grid.inMouth[v]) return null;
    const rest = 1 - Math.min(1, grid.inner[v] + grid.outer[v]);
    const half = smoothstep(-6, 6, ctx.p[v * 3] * side);
    const w = (rest * half) / unit;
    return w ? axes.map((on, k) => on * w * field[v * 3 + k]) : null;
  };
}

function sum(a, b) {
  return a && b ? a.map((x, k) => x + b[k]) : (a ?? b);
}
