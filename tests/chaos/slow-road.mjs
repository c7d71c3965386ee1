// SPDX-License-Identifier: GPL-3.0-or-later
// A proxy to Redis that can be slowed down: data leaves that many ms later, in order; with Infinity not until the delay
// is over.
import net from 'node:net';

export class SlowRoad {
  delay = 0;

  static async open(port) {
    const road = new SlowRoad();
    const server = net.createServer((near) => {
      const far = net.connect(port, '127.0.0.1');
      road.#carry(near, far);
      road.#carry(far, near);
    });
    await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
    server.unref();
    road.url = `redis://localhost:${server.address().port}/0`;
    return road;
  }

  #carry(from, to) {
    // timers that are due together fire in any order
    const waiting = [];
    const leave = () => {
      while (waiting.length && this.delay !== Infinity && waiting[0].due <= performance.now()) waiting.shift().act();
      if (waiting.length) setTimeout(leave, Math.max(1, Math.ceil(waiting[0].due - performance.now())));
    };
    const later = (act) => {
      waiting.push({ act, due: Math.max(waiting.at(-1)?.due ?? 0, performance.now() + (this.delay === Infinity ? 0 : this.delay)) });
      if (waiting.length === 1) leave();
    };
    from.setNoDelay(true);
    from.on('data', (data) => later(() => to.destroyed || to.write(data)));
    from.on('close', () => later(() => to.destroy()));
    from.on('error', () => {});
  }
}
