// SPDX-License-Identifier: GPL-3.0-or-later
// Processes that a process has started, and whether they still run.
import fs from 'node:fs';

/** @returns {{pid: number, parent: number, begun: string, zombie: boolean}|null} null: there is none of that number */
function look(pid) {
  try {
    const stat = fs.readFileSync(`/proc/${pid}/stat`, 'latin1');
    const [state, parent, ...rest] = stat.slice(stat.lastIndexOf(')') + 2).split(' ');
    return { pid: Number(pid), parent: Number(parent), begun: rest[17], zombie: state === 'Z' };
  } catch {
    return null;
  }
}

/** All processes below one, with their command lines. @param {number} pid */
export function descendantsOf(pid) {
  const all = fs.readdirSync('/proc').filter((name) => /^\d+$/.test(name)).flatMap((name) => look(name) ?? []);
  const below = (parent) => all.filter((one) => one.parent === parent).flatMap((one) => [one, ...below(one.pid)]);
  return below(pid).map((one) => {
    try {
      return { ...one, command: fs.readFileSync(`/proc/${one.pid}/cmdline`, 'utf8').replaceAll('\0', ' ').trim() };
    } catch {
      return { ...one, command: '' };
    }
  });
}

/** Those that still run; a number may have been given to another process since. */
export const stillRunning = (processes) => processes.filter(({ pid, begun }) => {
  const now = look(pid);
  return now && !now.zombie && now.begun === begun;
});
