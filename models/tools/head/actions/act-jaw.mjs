// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * The jaw: FAPs 3, 14, 15 and 18. The skin's share of the jaw rotation comes from the mesh's mouth-open target (the angle equivalent to its
 * displacement at each vertex, relative to the chin's), minus the movement by the lips' FAPs: FAP 3 alone does not move the lips.
 */
import { along } from '../../lib/actions.mjs';
import { ellipsoid } from '../../lib/zones.mjs';

/** Makes the tongue's tip follow by 0.8 of the chin's path: TIP_PER_JAW of server/face/engines/fapmap.c. */
const TONGUE_SHARE = 0.82;

function teethWeight({ teeth, fdp }, pivot) {
  const arm = (z) => z - pivot[2];
  return Math.min(1, arm(fdp['2.1'][2]) / arm(teeth.front));
}

export function jawActions(actions, ctx, grid, tuning) {
  const { p, fdp, fapu, topology } = ctx;
  const pivot = ctx.point(tuning.condyle);
  pivot[0] = 0;
  const { whole, weights } = jawWeights(ctx, grid, pivot, tuning);
  const isTongue = ctx.inGroup('helper-tongue');
  const isTeeth = ctx.inGroup('helper-lower-teeth');
  const share = (v, skin = weights) => (isTeeth[v] ? teethShare : isTongue[v] ? tongueShare(v) : skin[v]);
  // The edge of the lower incisors moves down by the chin's value of FAP 3, because it lies farther in front of the condyles.
  const teethShare = teethWeight(ctx, pivot);
  const root = ctx.fdp['6.2'][2] - tuning.tongueRoot;
  const tongueShare = (v) => Math.min(TONGUE_SHARE, Math.max(0.2, (p[v * 3 + 2] - root) / tuning.tongueRoot + 0.2));

  // The condyle glides forward while it turns, so the chin goes down more than back.
  const glide = tuning.glide;
  const chin = fdp['2.1'];
  const drop = (angle) => {
    const y = chin[1] - pivot[1],
      z = chin[2] - pivot[2];
    return -(y * Math.cos(angle) - z * Math.sin(angle) - y);
  };
  const reference = (tuning.reference * fapu.MNS) / 1024;
  let low = 0,
    high = 1;
  for (let i = 0; i < 60; i++) {
    const mid = (low + high) / 2;
    if (drop(mid) < reference) low = mid;
    else high = mid;
  }
  actions.turn({
    name: 'jaw',
    fap: 3,
    pivot,
    axis: [1, 0, 0],
    radians: low / tuning.reference,
    at: (v) => share(v),
    rigid: { teeth_lower: teethShare },
  });
  actions.plainMove(3, 'both', (v) => along(share(v) * glide, [0, 0, 1]));

  // No other FAP moves the lower lip sideways, so it follows the jaw here.
  actions.move(14, 'both', (v) => along(share(v, whole), [0, 0, 1]));
  actions.move(15, 'both', (v) => along(share(v, whole), [-1, 0, 0]));

  const boss = ellipsoid(fdp['2.10'], tuning.chinRadii, 0.1);
  const skin = new Set(topology.faces.flatMap((f) => f.v));
  actions.move(
    18,
    'both',
    (v, x, y, z) => skin.has(v) && !grid.inMouth[v] && along(boss(x, y, z), [0, 1, 0.15]),
  );
}

/** `whole`: everything that moves with the jaw; `weights`: the same without the part moved by the lips' FAPs. */
function jawWeights(ctx, grid, pivot, tuning) {
  const { p, topology } = ctx;
  const open = ctx.target(tuning.openTarget);
  const raw = new Float64Array(p.length / 3);
  const angle = (v) => {
    const y = p[v * 3 + 1] - pivot[1],
      z = p[v * 3 + 2] - pivot[2];
    return (open[v * 3 + 2] * y - open[v * 3 + 1] * z) / (y * y + z * z);
  };
  const unit = angle(ctx.fdpVertex['2.1']);
  for (const f of topology.faces) for (const v of f.v) raw[v] = Math.min(1, Math.max(0, angle(v) / unit));
  let w = raw;
  for (let pass = 0; pass < tuning.smoothing; pass++) {
    const next = Float64Array.from(w);
    for (let v = 0; v < w.length; v++) {
      if (!topology.near[v].length) continue;
      next[v] = (w[v] + topology.near[v].reduce((sum, n) => sum + w[n], 0) / topology.near[v].length) / 2;
    }
    w = next;
  }
  // Inside the mouth the loops from the lower lip to the bag's floor belong to the jaw, those of the upper
  // lip do not.
  for (let v = 0; v < w.length; v++) {
    if (grid.inMouth[v])
      w[v] = grid.lower[v] > 0.5 ? Math.max(w[v], tuning.floor) : Math.min(w[v], tuning.roof);
  }
  const top = w[ctx.fdpVertex['2.1']];
  const whole = w.map((x) => Math.min(1, x / top));
  return { whole, weights: whole.map((x, v) => x * (1 - Math.min(1, grid.inner[v] + grid.outer[v]))) };
}
