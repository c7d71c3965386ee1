// SPDX-License-Identifier: GPL-3.0-or-later
// Statistics and /proc reading for the benchmarks.
import fs from 'node:fs';

export const median = (values) => {
  const sorted = [...values].sort((a, b) => a - b);
  const middle = sorted.length >> 1;
  return sorted.length % 2 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
};

export const quantile = (values, q) => [...values].sort((a, b) => a - b)[Math.min(values.length - 1, Math.floor(q * values.length))];

const statOf = (pid) => {
  const stat = fs.readFileSync(`/proc/${pid}/stat`, 'latin1');
  return stat.slice(stat.lastIndexOf(')') + 2).split(' ');
};

/** CPU seconds that a process and its children that still run have used, to a hundredth. */
export function cpuSeconds(pid) {
  let sum = 0;
  for (const name of fs.readdirSync('/proc').filter((name) => /^\d+$/.test(name))) {
    try {
      const fields = statOf(name);
      if (name === String(pid) || fields[1] === String(pid)) sum += (Number(fields[11]) + Number(fields[12])) / 100;
    } catch {
      // it has ended meanwhile
    }
  }
  return sum;
}

/** CPU seconds of a process, of all its threads, by the scheduler's own account. */
export const cpuOf = (pid) => fs.readdirSync(`/proc/${pid}/task`)
  .reduce((sum, task) => sum + Number(fs.readFileSync(`/proc/${pid}/task/${task}/schedstat`, 'latin1').split(' ')[0]) / 1e9, 0);

/** The processes that a process has started and that still run. */
export const childrenOf = (pid) => fs.readdirSync('/proc').filter((name) => /^\d+$/.test(name)).filter((name) => {
  try {
    return statOf(name)[1] === String(pid);
  } catch {
    return false; // it has ended meanwhile
  }
}).map(Number);
