// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * The eye's texture, painted: pupil, iris with fibres and a dark limbus, sclera with a warm rim and faint
 * vessels.
 */
import { hex, mix, ramp } from '../../lib/color.mjs';
import { eyeAngle } from '../../lib/eye.mjs';
import { fractal, noise } from './noise.mjs';
import { smoothstep } from '../../lib/zones.mjs';

const BARED = 0.62; // of the sky, visible from the area under the lower lid when the eye looks up

/**
 * @param {object} spec eye geometry @param {object} look the recipe's colours
 * @param {(angle: number, turn: number) => number} sky share of the sky that a point of the eye sees between
 *   the lids
 * @returns {Float32Array} size x size x 3
 */
export function paintEye(size, spec, look, sky) {
  const iris = look.iris.map(([at, colour]) => [at, hex(colour)]);
  const white = look.sclera.map(([at, colour]) => [at, hex(colour)]);
  const vessel = hex(look.vessel),
    limbus = hex(look.limbus),
    pupil = hex(look.pupilColour);
  const out = new Float32Array(size * size * 3);
  for (let j = 0; j < size; j++) {
    for (let i = 0; i < size; i++) {
      const x = (i + 0.5) / size - 0.5,
        y = 0.5 - (j + 0.5) / size;
      const angle = eyeAngle(spec, Math.hypot(x, y));
      const turn = Math.atan2(y, x);
      const inIris = (angle - spec.pupilAngle) / (spec.irisAngle - spec.pupilAngle);
      let c = sclera(white, vessel, spec, angle, x, y);
      const fibre = irisColour(iris, inIris, turn);
      const shade = mix(fibre, limbus, smoothstep(0.68, 1, inIris) * look.limbusStrength);
      c = mix(shade, c, smoothstep(0.97, 1.13, inIris));
      c = mix(pupil, c, smoothstep(-0.06, 0.1, inIris + 0.03 * noise(turn * 9, 4)));
      const open = Math.max(sky(angle, turn), BARED * smoothstep(0.1, 0.5, -Math.sin(turn)));
      const light = look.shadeFloor + (1 - look.shadeFloor) * smoothstep(0, look.shadeOpen, open);
      out.set(
        c.map((v, k) => v * light ** look.shadeTint[k]),
        (j * size + i) * 3,
      );
    }
  }
  return out;
}

/** The occlusion of both eyes' vertices, averaged, as a function of the place on the eye. */
export function eyeSky(spec, lists) {
  const n = spec.columns;
  const mean = (r, c) => {
    const v = r < 0 ? 0 : 1 + r * n + (((c % n) + n) % n);
    return lists.reduce((sum, list) => sum + list[v], 0) / lists.length;
  };
  return (angle, turn) => {
    let r = -1;
    while (r < spec.rings.length - 2 && spec.rings[r + 1] < angle) r++;
    const inner = r < 0 ? 0 : spec.rings[r],
      outer = spec.rings[r + 1];
    const t = Math.min(1, (angle - inner) / (outer - inner));
    const column = (turn / (2 * Math.PI)) * n,
      c = Math.floor(column),
      u = column - c;
    const around = (ring) => mean(ring, c) * (1 - u) + mean(ring, c + 1) * u;
    return around(r) * (1 - t) + around(r + 1) * t;
  };
}

/** Fibres: noise that is stretched along the radius and periodic around the iris. */
function irisColour(stops, r, turn) {
  const cx = Math.cos(turn),
    cy = Math.sin(turn);
  const fine = fractal(cx * 26, cy * 26, r * 1.6, 3);
  const coarse = noise(cx * 7 + 40, cy * 7, r * 1.1);
  const c = ramp(stops, Math.min(1, Math.max(0, r + 0.09 * coarse)));
  const light = 1 + 0.55 * fine + 0.16 * coarse;
  return c.map((v) => Math.min(255, v * light));
}

function sclera(stops, vessel, spec, angle, x, y) {
  const c = ramp(stops, (angle - spec.irisAngle) / (spec.span - spec.irisAngle));
  const far = smoothstep(spec.irisAngle * 1.4, spec.irisAngle * 2.6, angle);
  const line = Math.abs(fractal(x * 22 + 3, y * 34, 5, 3));
  return mix(c, vessel, far * 0.35 * smoothstep(0.035, 0, line));
}
