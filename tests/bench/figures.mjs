// SPDX-License-Identifier: GPL-3.0-or-later
// Statistics and /proc reading for the benchmarks.
import fs from 'node:fs';

export const median = (values) => {
  const sorted = [...values].sort((a, b) => a - b);
  const middle = sorted.length >> 1;
  return sorted.length % 2 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
};

export const quantile = (values, q) => [...values].sort((a, b) => a - b)[Math.min(values.length - 1, Math.floor(q * values.length))];

/** Lists all processes: pid, parent's pid, and CPU seconds to a hundredth. */
export const processes = () => fs.readdirSync('/proc').filter((name) => /^\d+$/.test(name)).flatMap((name) => {
  try {
    const stat = fs.readFileSync(`/proc/${name}/stat`, 'latin1');
    const fields = stat.slice(stat.lastIndexOf(')') + 2).split(' ');
    return [{ pid: Number(name), parent: Number(fields[1]), seconds: (Number(fields[11]) + Number(fields[12])) / 100 }];
  } catch {
    return []; // it has just ended
  }
});

/** CPU seconds of a process and its running children, to a hundredth. */
export const cpuSeconds = (pid) => processes().filter((p) => p.pid === pid || p.parent === pid).reduce((sum, p) => sum + p.seconds, 0);

/** A column of the scheduler's accounting, summed over the threads of a process, s. */
const accounted = (pid, column) => fs.readdirSync(`/proc/${pid}/task`)
  .reduce((sum, task) => sum + Number(fs.readFileSync(`/proc/${pid}/task/${task}/schedstat`, 'latin1').split(' ')[column]) / 1e9, 0);

/** cpuOf: CPU seconds of a process; waitOf: seconds that it waited for a processor. */
export const cpuOf = (pid) => accounted(pid, 0);
export const waitOf = (pid) => accounted(pid, 1);

/** CPU seconds of all descendants of this process, except some, by the scheduler's accounting. */
export function descendantSeconds(except = []) {
  const all = new Map(processes().map((p) => [p.pid, p]));
  const ours = (pid) => all.has(pid) && !except.includes(pid) && (all.get(pid).parent === process.pid || ours(all.get(pid).parent));
  let sum = 0;
  for (const pid of all.keys())
    try {
      if (ours(pid)) sum += cpuOf(pid);
    } catch {
      // it has just ended
    }
  return sum;
}

/** The running children of a process. */
export const childrenOf = (pid) => processes().filter((p) => p.parent === pid).map((p) => p.pid);

/** Resident memory of a process, kB. */
export const kilobytesOf = (pid) => Number(fs.readFileSync(`/proc/${pid}/status`, 'latin1').match(/VmRSS:\s+(\d+)/)[1]);
