// SPDX-License-Identifier: GPL-3.0-or-later
// The faults, injected one after the other or several at once; each is repaired afterwards.
import fs from 'node:fs';
import path from 'node:path';
import { setTimeout as sleep } from 'node:timers/promises';

/** @param {object} world daemons, workers, redis, startDaemon, startWorker, road, disk, ways, clocks @param {import('../lib/chaos.mjs').Chance} chance */
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
      world.daemons[at] = await world.startDaemon(at);
    },
    'a daemon stopped in order': async () => {
      const at = anyDaemon();
      await world.daemons[at].stop();
      world.daemons[at] = await world.startDaemon(at);
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
  faults['the way to Redis stands still'] = async () => {
    world.road.delay = Infinity;
    await sleep(between(200, 4000));
    world.road.delay = 0;
  };
  const { netem, tbf, loss } = world.ways;
  const forAWhile = async (end) => {
    await sleep(between(1000, 6000));
    end();
  };
  if (netem) faults['the network slow'] = () => forAWhile(netem(between(5, 150), chance.below(3)));
  else if (tbf) faults['the network narrow'] = () => forAWhile(tbf(between(4, 40)));
  if (loss) faults['packets to and from Redis lost'] = () => forAWhile(loss(between(5, 50)));
  if (world.clocks) {
    // as an operator or NTP steps them, by moments or by an hour, back and forth; then corrects them
    const step = async (name) => {
      const seconds = chance.of([2, 5, 30, 3600]) * chance.of([1, -1]);
      world.clocks.step(name, seconds);
      await sleep(between(1500, 8000));
      world.clocks.step(name, 0);
    };
    faults["a daemon's clock stepped"] = () => step(anyDaemon());
    faults['the clock of Redis stepped'] = () => step('redis');
  }
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
