// SPDX-License-Identifier: GPL-3.0-or-later
// What a benchmark needs beyond the two commands of the README: it is installed and built when it is asked for.
import { execFileSync } from 'node:child_process';
import path from 'node:path';
import { build, root } from '../lib/daemon.mjs';

const quiet = { stdio: ['ignore', 'ignore', 'inherit'] };

/** Debian packages, as run.sh installs them. */
export function needPackages(...packages) {
  execFileSync('sh', ['-euc', 'root=$1; shift; die() { echo "bench: $*" >&2; exit 1; }; . "$root/server/setup.sh"; need_packages "$@"', 'sh', root, ...packages], { stdio: 'inherit' });
}

const known = (target) => {
  try {
    return execFileSync('ninja', ['-C', build, '-t', 'query', target], { stdio: ['ignore', 'pipe', 'ignore'] }).length > 0;
  } catch {
    return false;
  }
};

/**
 * A program of this folder, built.
 * @param {string} name without `bench_` @param {...string} packages without which the build does not know it
 * @returns {string} its path
 */
export function needProgram(name, ...packages) {
  const target = `tests/bench/bench_${name}`;
  if (packages.length) needPackages(...packages);
  if (!known(target)) {
    console.error(`Configuring ${build} anew, for ${target}`);
    execFileSync('meson', ['setup', '--reconfigure', build], quiet);
  }
  execFileSync('ninja', ['-C', build, '--quiet', target], quiet);
  return path.join(build, target);
}
