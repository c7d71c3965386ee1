// SPDX-License-Identifier: GPL-3.0-or-later
/** Lips and corners: FAPs 4 to 13, 16, 17 and 51 to 60. */
import { along } from './actions.mjs';
import { cardinalBasis, raisedCosine } from './zones.mjs';

/** Feature points along a lip: right corner, half-way, middle, half-way, left corner. */
const NODES = [-1, -0.5, 0, 0.5, 1];
const CORNER_R = 0, HALF_R = 1, MIDDLE = 2, HALF_L = 3, CORNER_L = 4;

const UPPER = [[4, 51, MIDDLE], [8, 55, HALF_L], [9, 56, HALF_R]];
const LOWER = [[5, 52, MIDDLE], [10, 57, HALF_L], [11, 58, HALF_R]];
const CORNERS = [[6, 53, 12, 59, CORNER_L, 1], [7, 54, 13, 60, CORNER_R, -1]];

/** @param {object} tuning the recipe's `faps.mouth` */
export function mouthActions(actions, grid, tuning) {
  const basis = cardinalBasis(NODES, tuning.cornerSteepness);
  const isLower = (v) => grid.lower[v] > 0.5;
  const isUpper = (v) => grid.lower[v] < 0.5;

  /** Both contours of one lip point; `forward` is z for each unit of y, for the inner and the outer contour. */
  const lipPoint = (inner, outer, node, mine, up, sign, forward) => {
    actions.move(inner, sign, (v) => mine(v) && along(grid.inner[v] * basis(node, grid.s[v]), [0, up, forward.inner * up]));
    actions.move(outer, sign, (v) => mine(v) && along(grid.outer[v] * basis(node, grid.s[v]), [0, up, forward.outer * up]));
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
    for (const [sign, back] of [['positive', tuning.stretchBack], ['negative', tuning.purseForward]]) {
      const dir = (v) => [side, 0, -back * Math.abs(grid.s[v])];
      actions.move(stretchIn, sign, (v) => along(grid.inner[v] * pull(v), dir(v)));
      actions.move(stretchOut, sign, (v) => along(grid.outer[v] * pull(v), dir(v)));
    }
    actions.move(raiseIn, 'both', (v) => along(grid.inner[v] * basis(node, grid.s[v]), [0, 1, 0]));
    actions.move(raiseOut, 'both', (v) => along(grid.outer[v] * basis(node, grid.s[v]), [0, 1, tuning.raiseForward]));
  }

  /** Pushing: the whole lip, its outer contour and the skin beside it, less towards the corners. */
  const push = (fap, mine, lift) => {
    for (const sign of ['positive', 'negative']) {
      actions.move(fap, sign, (v) => {
        if (!mine(v)) return null;
        const share = grid.inner[v] + grid.outer[v] * (sign === 'positive' ? tuning.pushOuter : tuning.pullOuter);
        const w = share * raisedCosine(Math.abs(grid.s[v]) / tuning.pushWidth);
        return along(w, [0, sign === 'positive' ? lift * (1 - grid.outer[v]) * (1 - grid.inner[v]) : 0, 1]);
      });
    }
  };
  push(16, isLower, -tuning.pushEvert);
  push(17, isUpper, tuning.pushEvert);
}
