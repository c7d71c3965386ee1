// SPDX-License-Identifier: GPL-3.0-or-later
// What goes wrong, one thing after the other or several at once; each is put right again.
import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';
import { setTimeout as sleep } from 'node:timers/promises';

/** @param {object} world daemons, workers, redis, startDaemon, startWorker, disk, netem @param {import('../lib/chaos.mjs').Chance} chance */
export function faultsOf(world, chance) {
  const between = (low, high) => low + chance.below(high - low);
  const freeze = async ({ process }, ms) => {
    process.kill('SIGSTOP');
    await sleep(ms);
    process.kill('SIGCONT');
  };
  const anyDaemon = () => chance.below(world.daemons.length);
  const faults = {
    'a daemon killed': async () => {
      const at = anyDaemon();
      const dead = world.daemons[at];
      dead.process.kill('SIGKILL');
      await dead.exited;
      await sleep(between(500, 4000));
      world.daemons[at] = await world.startDaemon();
    },
    'a daemon stopped in order': async () => {
      const at = anyDaemon();
      await world.daemons[at].stop();
      world.daemons[at] = await world.startDaemon();
    },
    'a daemon frozen': () => freeze(world.daemons[anyDaemon()], between(300, 6000)),
    'a worker killed': async () => {
      const at = chance.below(world.workers.length);
      world.workers[at].process.kill('SIGKILL');
      await sleep(between(500, 3000));
      world.workers[at] = await world.startWorker();
    },
    'a worker frozen': () => freeze(world.workers[chance.below(world.workers.length)], between(500, 6000)),
    'Redis killed': async () => {
      world.redis.stop();
      await sleep(between(100, 5000));
      world.redis.again();
    },
    'Redis frozen': () => freeze(world.redis, between(200, 4000)),
    'Redis emptied': async () => void world.redis.cli('flushall'),
    'connections to Redis cut': async () => {
      for (const type of ['normal', 'pubsub']) world.redis.cli('client', 'kill', 'type', type);
    },
  };
  faults['the way to Redis slow'] = async () => {
    world.road.delay = between(20, 900);
    await sleep(between(500, 5000));
    world.road.delay = 0;
  };
  if (world.netem)
    faults['the network slow'] = async () => {
      const rule = (...words) => execFileSync('tc', ['qdisc', 'change', 'dev', 'lo', 'root', 'netem', ...words]);
      rule('delay', `${between(5, 150)}ms`, '20ms', 'loss', `${chance.below(3)}%`);
      await sleep(between(1000, 6000));
      rule('delay', '0ms');
    };
  if (world.disk)
    faults['the disk full'] = async () => {
      const filler = path.join(world.disk, 'filler');
      try {
        fs.writeFileSync(filler, Buffer.alloc(32 << 20));
      } catch {
        // it is full
      }
      await sleep(between(1000, 6000));
      fs.rmSync(filler);
    };
  return faults;
}
