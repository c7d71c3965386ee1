// SPDX-License-Identifier: GPL-3.0-or-later
// Statistics and /proc reading for the benchmarks.
import fs from 'node:fs';

export const median = (values) => {
  const sorted = [...values].sort((a, b) => a - b);
  const middle = sorted.length >> 1;
  return sorted.length % 2 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
};

export const quantile = (values, q) => [...values].sort((a, b) => a - b)[Math.min(values.length - 1, Math.floor(q * values.length))];

/** What runs: the number of each process, its parent's, and the CPU seconds that it has used, to a hundredth. */
export const processes = () => fs.readdirSync('/proc').filter((name) => /^\d+$/.test(name)).flatMap((name) => {
  try {
    const stat = fs.readFileSync(`/proc/${name}/stat`, 'latin1');
    const fields = stat.slice(stat.lastIndexOf(')') + 2).split(' ');
    return [{ pid: Number(name), parent: Number(fields[1]), seconds: (Number(fields[11]) + Number(fields[12])) / 100 }];
  } catch {
    return []; // it has ended meanwhile
  }
});

/** CPU seconds that a process and its children that still run have used, to a hundredth. */
export const cpuSeconds = (pid) => processes().filter((p) => p.pid === pid || p.parent === pid).reduce((sum, p) => sum + p.seconds, 0);

/** Seconds of all threads of a process, by the scheduler's own account. */
const accounted = (pid, column) => fs.readdirSync(`/proc/${pid}/task`)
  .reduce((sum, task) => sum + Number(fs.readFileSync(`/proc/${pid}/task/${task}/schedstat`, 'latin1').split(' ')[column]) / 1e9, 0);

/** CPU seconds of a process, and those for which it had something to do and no processor. */
export const cpuOf = (pid) => accounted(pid, 0);
export const waitOf = (pid) => accounted(pid, 1);

/** CPU seconds that all have used that this process has started, and those that they have started, but for some, by the scheduler's own account. */
export function descendantSeconds(except = []) {
  const all = new Map(processes().map((p) => [p.pid, p]));
  const ours = (pid) => all.has(pid) && !except.includes(pid) && (all.get(pid).parent === process.pid || ours(all.get(pid).parent));
  let sum = 0;
  for (const pid of all.keys())
    try {
      if (ours(pid)) sum += cpuOf(pid);
    } catch {
      // it has ended meanwhile
    }
  return sum;
}

/** The processes that a process has started and that still run. */
export const childrenOf = (pid) => processes().filter((p) => p.parent === pid).map((p) => p.pid);

/** Memory of a process that is not swapped out, kB. */
export const kilobytesOf = (pid) => Number(fs.readFileSync(`/proc/${pid}/status`, 'latin1').match(/VmRSS:\s+(\d+)/)[1]);
