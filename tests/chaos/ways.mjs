// SPDX-License-Identifier: GPL-3.0-or-later
// Packet faults that this machine supports, in the private network that run.sh created for this program. Nothing outside is affected.
import { spawnSync } from 'node:child_process';

const runs = (program, ...words) => spawnSync(program, words, { stdio: 'ignore' }).status === 0;
const qdisc = (verb, ...words) => runs('tc', 'qdisc', verb, 'dev', 'lo', 'root', ...words);

/** The available ones of netem, tbf and loss; each is a function that starts a fault and returns a function that ends it. */
export function waysOf(port) {
  if (process.env.FACCIA_CHAOS_OWN_NETWORK !== '1') return {};
  const ways = {};
  const queue = (...words) => {
    if (!qdisc('replace', ...words)) throw new Error(`tc refuses ${words.join(' ')}`);
    return () => qdisc('del');
  };
  if (qdisc('replace', 'netem', 'delay', '0ms')) ways.netem = (ms, percent) => queue('netem', 'delay', `${ms}ms`, '20ms', 'loss', `${percent}%`);
  qdisc('del');
  // excess packets wait up to 200 ms and are then dropped
  if (qdisc('replace', 'tbf', 'rate', '1gbit', 'burst', '200kb', 'latency', '200ms')) ways.tbf = (mbit) => queue('tbf', 'rate', `${mbit}mbit`, 'burst', '200kb', 'latency', '200ms');
  qdisc('del');
  const rule = (verb, side, percent) =>
    runs('iptables', '-w', verb, 'INPUT', '-p', 'tcp', side, String(port), '-m', 'statistic', '--mode', 'random', '--probability', (percent / 100).toFixed(3), '-j', 'DROP');
  const drop = (verb, percent) => ['--dport', '--sport'].map((side) => rule(verb, side, percent)).every(Boolean);
  if (drop('-A', 1)) {
    drop('-D', 1);
    ways.loss = (percent) => {
      if (!drop('-A', percent)) throw new Error('iptables refuses');
      return () => drop('-D', percent);
    };
  }
  return ways;
}
