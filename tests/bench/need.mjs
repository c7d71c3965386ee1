// SPDX-License-Identifier: GPL-3.0-or-later
// Installs and builds on demand what benchmarks need beyond the two commands of the README.
import { execFileSync } from 'node:child_process';
import path from 'node:path';
import { build, root } from '../lib/daemon.mjs';

const quiet = { stdio: ['ignore', 'ignore', 'inherit'] };

/** Installs Debian packages like run.sh. */
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
 * Builds a program of this folder.
 * @param {string} name without `bench_` @param {...string} packages that its build requires
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
