// SPDX-License-Identifier: GPL-3.0-or-later
import { test } from 'node:test';

/**
 * A test of a promise that the daemon keeps only if it gets processor time: delayed for longer than its media lead, it drops what is too
 * late. Tries three times, because a bug fails every time and a busy machine rarely does.
 */
export const patient = (name, run) =>
  test(name, async (t) => {
    for (let turn = 1; ; turn++)
      try {
        return await run(t);
      } catch (error) {
        if (turn === 3) throw error;
        t.diagnostic(`once more: ${error.message}`);
      }
  });
