// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the command line program.
import { spawnSync } from 'node:child_process';
import path from 'node:path';
import { build } from './daemon.mjs';

/** Removes a harmless message of the leak sanitizer (a thread that exits during the check) from a program's output. */
export const saidBy = (stderr) => String(stderr).replace(/^==\d+==Unable to get registers from thread \d+\.\n/gm, '');

/**
 * Runs `faccia`.
 * @param {string[]} args
 * @param {{input?: string | Uint8Array, env?: object, from?: string}} options env: further variables; from: another build
 * @returns {{status: number, stdout: string, stderr: string, bytes: Buffer}} bytes: raw stdout
 */
export function faccia(args, { input, env = {}, from = build } = {}) {
  const { status, stdout, stderr } = spawnSync(path.join(from, 'server/cli/faccia'), args, { input, env: { ...process.env, ...env }, maxBuffer: 1 << 30 });
  return { status, stdout: String(stdout), stderr: saidBy(stderr), bytes: stdout };
}
