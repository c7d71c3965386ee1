// SPDX-License-Identifier: MIT
// The backdrop `room`: a warm wall far out of focus, with the light of the window that lights the face. It is made of soft
// ellipses, so that nothing has to be loaded: as CSS for a page, or painted on a canvas.

const WALL = ['#c3b09a', '#8d7a67']; // above and below

/** How strong a soft ellipse is, by the share of its radius: that of a pane keeps its strength longest. */
const SOFT = [[0, 1], [0.3, 0.82], [0.6, 0.36], [0.85, 0.07], [1, 0]];
const PANE = [[0, 1], [0.45, 0.92], [0.7, 0.45], [0.9, 0.08], [1, 0]];
const RIM = [[0, 0], [0.45, 0], [0.7, 0.3], [1, 1]];

/** Shares of the width and the height, the first on top. */
const ELLIPSES = [
  { at: [0.5, 0.42], size: [0.9, 0.9], color: [38, 27, 20], most: 0.5, stops: RIM },
  // the window's light on the wall, on the side that the lamp shines to
  ...[0, 1].flatMap((column) => [0, 1, 2].map((row) => ({
    at: [0.75 + 0.17 * column, 0.13 + 0.17 * row + 0.05 * column], size: [0.105, 0.108],
    color: [255, 233, 200], most: 0.52 - 0.07 * row - 0.1 * column, stops: PANE,
  }))),
  { at: [0.8, 0.3], size: [0.6, 0.6], color: [255, 224, 184], most: 0.34, stops: SOFT },
  // a plant and what it stands on
  { at: [0.06, 0.6], size: [0.2, 0.3], color: [72, 82, 58], most: 0.6, stops: SOFT },
  { at: [0.2, 0.74], size: [0.16, 0.2], color: [88, 96, 66], most: 0.42, stops: SOFT },
  { at: [0.1, 1], size: [0.5, 0.26], color: [58, 44, 34], most: 0.7, stops: SOFT },
];

const rgba = ({ color, most }, share) => `rgb(${color.join(' ')} / ${(most * share).toFixed(3)})`;
const percent = (share) => `${(100 * share).toFixed(1)}%`;

/** The value of `background` in CSS. */
export const roomCss = [
  ...ELLIPSES.map((one) => {
    const stops = one.stops.map(([at, share]) => `${rgba(one, share)} ${percent(at)}`);
    return `radial-gradient(${one.size.map(percent).join(' ')} at ${one.at.map(percent).join(' ')}, ${stops.join(', ')})`;
  }),
  `linear-gradient(${WALL.join(', ')})`,
].join(', ');

/** Paints the same. @param {CanvasRenderingContext2D} context @param {number} width @param {number} height */
export function paintRoom(context, width, height) {
  const wall = context.createLinearGradient(0, 0, 0, height);
  WALL.forEach((color, i) => wall.addColorStop(i, color));
  context.fillStyle = wall;
  context.fillRect(0, 0, width, height);
  for (const one of [...ELLIPSES].reverse()) {
    const [x, y, across, down] = [one.at[0] * width, one.at[1] * height, one.size[0] * width, one.size[1] * height];
    const light = context.createRadialGradient(0, 0, 0, 0, 0, 1);
    for (const [at, share] of one.stops) light.addColorStop(at, rgba(one, share));
    context.setTransform(across, 0, 0, down, x, y);
    context.fillStyle = light;
    context.fillRect(-x / across, -y / down, width / across, height / down);
  }
  context.resetTransform();
}
