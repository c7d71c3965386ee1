// SPDX-License-Identifier: GPL-3.0-or-later
// Clocks on the wall that are stepped while a program runs (clock.c, preloaded): leases and expiry in Redis, the dates of tokens.
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';

/** NULL when there is no compiler, or it changes nothing here. */
export function clocksIn(folder) {
  const library = path.join(folder, 'clock.so');
  if (spawnSync('cc', ['-O1', '-shared', '-fPIC', '-o', library, path.join(import.meta.dirname, 'clock.c')], { stdio: 'ignore' }).status !== 0) return null;
  const fileOf = (name) => path.join(folder, `clock-${name}`);
  const clocks = {
    /** The variables of a program whose clock has that name. */
    env(name, command) {
      if (!fs.existsSync(fileOf(name))) clocks.step(name, 0);
      return { LD_PRELOAD: library, FACCIA_CLOCK_FILE: fileOf(name), FACCIA_CLOCK_OF: command };
    },
    /** So many seconds from the true time, at once. */
    step(name, seconds) {
      const file = fs.openSync(fileOf(name), fs.constants.O_RDWR | fs.constants.O_CREAT); // the same file: it is mapped
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
