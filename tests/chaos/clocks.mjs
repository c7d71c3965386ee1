// SPDX-License-Identifier: GPL-3.0-or-later
// Steps the wall clocks of running programs (clock.c, preloaded). This affects leases and expiry in Redis, and the dates of tokens.
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';

/** null without a compiler, or if preloading has no effect here. */
export function clocksIn(folder) {
  const library = path.join(folder, 'clock.so');
  if (spawnSync('cc', ['-O1', '-shared', '-fPIC', '-o', library, path.join(import.meta.dirname, 'clock.c')], { stdio: 'ignore' }).status !== 0) return null;
  const fileOf = (name) => path.join(folder, `clock-${name}`);
  const clocks = {
    /** Environment of a program with the clock of that name. */
    env(name, command) {
      if (!fs.existsSync(fileOf(name))) clocks.step(name, 0);
      return { LD_PRELOAD: library, FACCIA_CLOCK_FILE: fileOf(name), FACCIA_CLOCK_OF: command };
    },
    /** Sets the clock to that many seconds from the true time, immediately. */
    step(name, seconds) {
      const file = fs.openSync(fileOf(name), fs.constants.O_RDWR | fs.constants.O_CREAT); // keeps the file, because it is mapped
      const bytes = Buffer.alloc(8);
      bytes.writeBigInt64LE(BigInt(seconds));
      fs.writeSync(file, bytes, 0, 8, 0);
      fs.closeSync(file);
    },
  };
  clocks.step('try', -86400);
  const told = Number(spawnSync('date', ['+%s'], { encoding: 'utf8', env: { ...process.env, ...clocks.env('try', 'date') } }).stdout);
  return Math.abs(told - Date.now() / 1000 + 86400) < 60 ? clocks : null;
}
