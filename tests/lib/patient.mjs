// SPDX-License-Identifier: GPL-3.0-or-later
import { test } from 'node:test';

/**
 * A test of what the daemon promises where it gets its processor in time: held up for longer than media are early, it leaves out
 * what is too late by then. Whoever is wrong is wrong three times; a machine is rarely.
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
