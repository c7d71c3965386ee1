// SPDX-License-Identifier: MIT
// The lights of the portrait, linear colours. Directions point to the light; x is to the right of the picture.

const unit = (v) => v.map((value) => value / Math.hypot(...v));

export const KEY = { direction: unit([-0.55, 0.55, 0.72]), color: [2.0, 1.88, 1.72] };
export const FILL = { direction: unit([0.85, 0.1, 0.55]), color: [0.42, 0.47, 0.55] };
export const RIM = { direction: unit([0.6, 0.45, -0.75]), color: [1.3, 1.35, 1.45] };
export const SKY = [0.5, 0.53, 0.58];
export const GROUND = [0.3, 0.25, 0.22];
