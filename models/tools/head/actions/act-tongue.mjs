// SPDX-License-Identifier: GPL-3.0-or-later
/** The tongue: FAPs 43 to 47, weighted by the distance behind the tip. */
import { along } from '../../lib/actions.mjs';
import { ellipsoid, plateau } from '../../lib/zones.mjs';

export function tongueActions(actions, ctx, tuning) {
  const mine = ctx.inGroup('helper-tongue');
  const tip = ctx.fdp['6.1'];
  const behind = (z, reach) => plateau(tip[2] - z, 0, reach);
  actions.move(43, 'both', (v, x, y, z) => mine[v] && along(behind(z, tuning.shiftReach), [-1, 0, 0]));
  actions.move(
    44,
    'both',
    (v, x, y, z) => mine[v] && along(behind(z, tuning.raiseReach), [0, 1, tuning.raiseBack]),
  );
  actions.move(45, 'both', (v, x, y, z) => mine[v] && along(behind(z, tuning.thrustReach), [0, 0, 1]));
  // Forward movement puts it between the teeth, below the edge of the upper ones.
  actions.plainMove(45, 'positive', (v, x, y, z) => mine[v] && along(behind(z, tuning.raiseReach), [0, -(tuning.thrustDown ?? 0.2), 0]));
  const body = ellipsoid(ctx.fdp['6.2'], tuning.bodyRadii, 0.1);
  actions.move(46, 'both', (v, x, y, z) => mine[v] && along(body(x, y, z), [0, 1, 0]));
  // Rolling: both borders turn up about the middle line; mm for one radian is the distance from that line.
  actions.plainMove(
    47,
    'both',
    (v, x, y, z) => mine[v] && along(behind(z, tuning.rollReach) * Math.abs(x), [-0.3 * Math.sign(x), 1, 0]),
  );
}
