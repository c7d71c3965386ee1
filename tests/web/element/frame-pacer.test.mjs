// SPDX-License-Identifier: GPL-3.0-or-later
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { FramePacer } from '../../../web/element/stage/frame-pacer.mjs';

const BEAT = 1000 / 60;

/** A pacer with simulated drawing times and clock. */
function slow() {
  const world = { now: 0, takes: 0, timers: [] };
  const pacer = new FramePacer(
    () => {
      const done = world.now + world.takes;
      return () => world.now >= done;
    },
    (call, milliseconds) => world.timers.push({ at: world.now + milliseconds, call }),
  );
  world.until = (time) => {
    for (;;) {
      const next = world.timers.filter(({ at }) => at <= time).sort((a, b) => a.at - b.at)[0];
      if (!next) break;
      world.timers.splice(world.timers.indexOf(next), 1);
      world.now = next.at;
      next.call();
    }
    world.now = time;
  };
  world.draw = (takes, beside = false) => {
    world.takes = takes;
    pacer.tick(world.now);
    pacer.drawn(world.now, beside, () => world.now);
  };
  /** Draws one and waits for it. */
  world.picture = (takes, beside) => {
    world.draw(takes, beside);
    world.until(world.now + Math.ceil((takes + 5) / BEAT) * BEAT);
  };
  return { world, pacer };
}

test('a fast frame appears at the next display refresh', () => {
  const { world, pacer } = slow();
  for (let i = 0; i < 10; i++) {
    world.picture(1);
    pacer.tick(world.now);
    assert.ok(Math.abs(pacer.ahead(world.now) - BEAT) < 0.01);
    assert.ok(Math.abs(pacer.ahead(world.now + 3) - (BEAT - 3)) < 0.01, 'begun late in the frame');
    assert.equal(pacer.busy, false);
  }
  world.draw(1);
  assert.equal(pacer.busy, false, 'the next one need not wait');
});

test('predicts the delay of a slow frame from those before it, within half a poll', () => {
  const { world, pacer } = slow();
  for (let i = 0; i < 5; i++) world.picture(45);
  pacer.tick(world.now);
  assert.ok(Math.abs(pacer.ahead(world.now) - 45) <= 2, pacer.ahead(world.now));
  world.picture(200);
  assert.ok(Math.abs(pacer.ahead(world.now) - 45) <= 2, 'one that was held up is no rule');
  for (let i = 0; i < 3; i++) world.picture(90);
  assert.ok(Math.abs(pacer.ahead(world.now) - 90) <= 2, 'three are');
});

test('slow frames do not wait for each other', () => {
  const { world, pacer } = slow();
  world.picture(45);
  world.draw(45);
  assert.equal(pacer.busy, true);
  world.until(world.now + 40);
  assert.equal(pacer.busy, true);
  world.until(world.now + 10);
  assert.equal(pacer.busy, false);
});

test('predicts frames during page changes from frames like them', () => {
  const { world, pacer } = slow();
  for (let i = 0; i < 5; i++) world.picture(45);
  assert.ok(Math.abs(pacer.ahead(world.now, true) - 45) <= 2, 'none of them so far');
  for (let i = 0; i < 5; i++) world.picture(60, true);
  assert.ok(Math.abs(pacer.ahead(world.now, true) - 60) <= 2);
  assert.ok(Math.abs(pacer.ahead(world.now) - 45) <= 2);
});

test('ignores frames whose end a busy or hidden page missed', () => {
  const { world, pacer } = slow();
  for (let i = 0; i < 5; i++) world.picture(45);
  for (let i = 0; i < 5; i++) {
    world.draw(45);
    const [timer] = world.timers.splice(0);
    world.now += 1000; // the timer comes that much later
    timer.call();
    assert.equal(pacer.busy, false);
  }
  assert.ok(Math.abs(pacer.ahead(world.now + 0) - 45) <= 2);
});

test('a frame that never ends delays the next one by a few seconds only', () => {
  const { world, pacer } = slow();
  for (let i = 0; i < 5; i++) world.picture(45);
  world.draw(Infinity);
  world.until(world.now + 2900);
  assert.equal(pacer.busy, true);
  world.until(world.now + 200);
  assert.equal(pacer.busy, false);
  assert.equal(world.timers.length, 0, 'nobody asks any more');
  pacer.tick(world.now);
  assert.ok(Math.abs(pacer.ahead(world.now) - 45) <= 2, 'it teaches nothing');
});

test('uses the refresh interval of the display', () => {
  const { world, pacer } = slow();
  for (let now = 0; now < 3000; now += 1000 / 75) pacer.tick((world.now = now));
  assert.ok(Math.abs(pacer.ahead(world.now) - 1000 / 75) < 0.1);
  pacer.tick(world.now + 5000); // a pause does not count as a beat
  assert.ok(Math.abs(pacer.ahead(world.now + 5000) - 1000 / 75) < 0.1);
});
