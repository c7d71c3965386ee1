// SPDX-License-Identifier: MIT

const AT = 1e-3; // so near it is the picture itself
const LEAST = 1e-9; // weight where three are equally far
const CONTACT = 80; // FAP units of opening, over which pictures of closed lips give way to those of open ones

const smooth = (x) => {
  const t = Math.min(1, Math.max(0, x));
  return t * t * (3 - 2 * t);
};

/**
 * Returns the two nearest pictures with the weights of Franke and Little (1980): the inverse distance minus that of the third
 * nearest, so that pictures fade in from and out to zero, and an exact match is shown alone.
 * For closed lips only pictures of closed lips count.
 * @param {number[]} at a place in the space of the pictures
 * @param {{at: number[], opening: number|null}[]} pictures opening: FAP units, null where nothing opens
 * @param {number|null} opening wanted
 * @returns {{index: number, weight: number}[]} one or two; the weights add up to 1
 */
export function nearest(at, pictures, opening) {
  const apart = opening === null ? 1 : smooth(opening / CONTACT);
  const found = pictures
    .map((picture, index) => ({ index, distance: distance(at, picture.at), share: picture.opening > 0 ? apart : 1 }))
    .filter(({ share }) => share > 0)
    .sort((a, b) => a.distance - b.distance);
  const [first, second, third] = found;
  if (!second || first.distance < AT) return [{ index: first.index, weight: 1 }];
  const radius = third ? third.distance : 2 * second.distance;
  const weigh = ({ distance: d, share }) => share * Math.max(LEAST, (radius - d) / (radius * Math.max(d, AT))) ** 2;
  const [a, b] = [weigh(first), weigh(second)];
  const weight = b / (a + b);
  return weight < 1 / 256
    ? [{ index: first.index, weight: 1 }]
    : [{ index: first.index, weight: 1 - weight }, { index: second.index, weight }];
}

function distance(a, b) {
  let sum = 0;
  for (let i = 0; i < a.length; i++) sum += (a[i] - b[i]) ** 2;
  return Math.sqrt(sum);
}
