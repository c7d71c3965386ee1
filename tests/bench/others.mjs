// SPDX-License-Identifier: GPL-3.0-or-later
// Measures the CPU use of other programs: everything but this process and its descendants.
import fs from 'node:fs';
import { processes } from './figures.mjs';

const STEP_MS = 500;
const HZ = 100; // of the times in /proc

/** CPU ticks of this process and its descendants. */
function own() {
  const all = new Map(processes().map((p) => [p.pid, p]));
  const ours = (pid) => pid === process.pid || (all.has(pid) && ours(all.get(pid).parent));
  return [...all.values()].reduce((sum, { pid, seconds }) => (ours(pid) ? sum + HZ * seconds : sum), 0);
}

/** CPU ticks of everything, including other virtual machines (steal). */
function all() {
  const [user, nice, system, , , irq, softirq, steal] = fs.readFileSync('/proc/stat', 'latin1').split('\n')[0].trim().split(/\s+/).slice(1).map(Number);
  return user + nice + system + irq + softirq + steal;
}

/** Samples until stopped. */
export function watchOthers() {
  const samples = [];
  const take = () => samples.push({ at: Number(process.hrtime.bigint()) / 1e6, ticks: all() - own() });
  take();
  const timer = setInterval(take, STEP_MS);
  return () => {
    clearInterval(timer);
    take();
    /** Number of processors used by others between two times of the monotonic clock in ms, plus half a second around. */
    return (from, to) => {
      const a = samples.findLast(({ at }) => at <= from - STEP_MS) ?? samples[0];
      const b = samples.find(({ at }) => at >= to + STEP_MS) ?? samples.at(-1);
      return ((b.ticks - a.ticks) * 1000) / HZ / (b.at - a.at);
    };
  };
}
