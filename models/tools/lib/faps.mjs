// SPDX-License-Identifier: GPL-3.0-or-later
/**
 * FAPs 3 to 68 from the protocol's table, with the direction in which a positive value moves the feature
 * point.
 */
import fs from 'node:fs';

/** x to the head's own left, y up, z forward. */
const DIRECTIONS = {
  up: [0, 1, 0],
  down: [0, -1, 0],
  left: [1, 0, 0],
  right: [-1, 0, 0],
  forward: [0, 0, 1],
};

const table = JSON.parse(
  fs.readFileSync(new URL('../../../protocol/fap-table.json', import.meta.url), 'utf8'),
);

/**
 * @type {Object<number, {name: string, unit: string, point: string, direction: number[]|null, bidirectional:
 *   boolean, headTurn: boolean}>}
 */
export const FAPS = Object.fromEntries(
  table.faps
    .filter((f) => f.number >= 3)
    .map((f) => [
      f.number,
      {
        name: f.name,
        unit: f.unit,
        point: f.fdp.split('/')[0],
        bidirectional: f.bidirectional,
        direction: f.unit === 'AU' ? null : (DIRECTIONS[f.direction] ?? null),
        headTurn: f.number >= 48 && f.number <= 50,
      },
    ]),
);
