// SPDX-License-Identifier: GPL-3.0-or-later
// The command line, as its users call it.
import { spawnSync } from 'node:child_process';
import path from 'node:path';
import { build } from './daemon.mjs';

/** What a program says, without what a sanitizer notes of a thread that ends while it looks for leaks: that is none of its faults. */
export const saidBy = (stderr) => String(stderr).replace(/^==\d+==Unable to get registers from thread \d+\.\n/gm, '');

/**
 * Runs `faccia`.
 * @param {string[]} args
 * @param {{input?: string | Uint8Array, env?: object, from?: string}} options env: further variables; from: another build
 * @returns {{status: number, stdout: string, stderr: string, bytes: Buffer}} bytes: stdout as it is
 */
export function faccia(args, { input, env = {}, from = build } = {}) {
  const { status, stdout, stderr } = spawnSync(path.join(from, 'server/cli/faccia'), args, { input, env: { ...process.env, ...env }, maxBuffer: 1 << 30 });
  return { status, stdout: String(stdout), stderr: saidBy(stderr), bytes: stdout };
}
