// SPDX-License-Identifier: MIT
// Speech where the browser refuses sound, or has no output device.
import assert from 'node:assert/strict';
import test from 'node:test';
import { Player } from '../../../web/element/audio/player.mjs';

const RATE = 1000;

/** A player, and a browser whose clock, gestures and audio the test plays. */
function rig({ state = 'suspended', touched = false, context: has = true } = {}) {
  const sounds = [];
  const world = { now: 0, touched, timers: [], driver: null, closed: 0 };
  const context = Object.assign(new EventTarget(), {
    state, sampleRate: RATE, currentTime: 0, asked: 0,
    resume() {
      this.asked++;
      return new Promise(() => {}); // never settles
    },
    change(to) {
      this.state = to;
      this.dispatchEvent(new Event('statechange'));
    },
  });
  const page = Object.assign(new EventTarget(), { gesture: () => page.dispatchEvent(new Event('pointerdown')) });
  const player = new Player((sound, reason) => sounds.push(reason ? `${sound} ${reason}` : sound), {
    page,
    acquire: () => (has ? context : null),
    release() {},
    touched: (gesture) => world.touched || gesture,
    setTimeout: (act, after) => world.timers.push({ act, at: world.now + after }),
    createDriver: async (_, report) => {
      world.driver = { report, pushed: 0, push: (block) => (world.driver.pushed += block.length), finish() {}, flush() {}, hold() {}, release() {}, close: () => world.closed++ };
      return { driver: world.driver };
    },
  });
  const settle = () => new Promise((resolve) => setTimeout(resolve));
  /** Lets time pass, and the element look every 40 ms. */
  const pass = async (milliseconds) => {
    await settle();
    for (const end = world.now + milliseconds; world.now < end; ) {
      world.now += 40;
      world.timers.filter(({ at }) => at <= world.now).forEach(({ act }) => act());
      world.timers = world.timers.filter(({ at }) => at > world.now);
      player.heard(world.now);
      await settle();
    }
  };
  return { player, context, page, sounds, world, pass, position: () => player.heard(world.now).position };
}

test('without a gesture sound is blocked, and the samples pass in silence', async () => {
  const { player, sounds, pass, position } = rig();
  player.open();
  player.write(new Float32Array(2000));
  player.finish();
  await pass(400);
  assert.deepEqual(sounds, ['blocked autoplay']);
  await pass(2400);
  assert.equal(position(), 2000);
});

test('turns sound on after a gesture', async () => {
  const { player, context, page, sounds, pass, world } = rig();
  player.open();
  player.write(new Float32Array(3000));
  await pass(1000);
  page.gesture();
  context.change('running');
  await pass(40);
  assert.deepEqual(sounds, ['blocked autoplay', 'on']);
  assert.ok(world.driver.pushed > 1000 && world.driver.pushed < 3000, 'the rest is heard');
});

test('reports no device when sound does not start after a gesture, and asks for no further gesture', async () => {
  const { player, context, page, sounds, pass, position } = rig();
  player.open();
  await pass(400);
  page.gesture();
  await pass(3000);
  assert.deepEqual(sounds, ['blocked autoplay', 'none no-device']);
  page.gesture();
  await pass(3000);
  assert.equal(context.asked, 2, 'it was asked for at the beginning, and by the first gesture');
  player.write(new Float32Array(500));
  player.finish();
  await pass(1000);
  assert.equal(position(), 500);
  context.change('running'); // a device has been plugged in
  await pass(40);
  assert.equal(sounds.at(-1), 'on');
});

test('reports no device on a page that was touched before, too', async () => {
  const { player, sounds, pass, position } = rig({ touched: true });
  player.open();
  player.write(new Float32Array(500));
  player.finish();
  await pass(3000);
  assert.deepEqual(sounds, ['none no-device']);
  assert.equal(position(), 500, 'what was to be said has gone by');
});

test('a stalled audio clock counts as no device: speech continues in silence, and with sound when it runs again', async () => {
  const { player, context, sounds, world, pass, position } = rig({ state: 'running' });
  player.open();
  await pass(40);
  assert.deepEqual(sounds, ['on']);
  player.write(new Float32Array(1500));
  player.finish();
  await pass(1600);
  assert.deepEqual(sounds, ['on'], 'it may yet begin');
  await pass(3000);
  assert.deepEqual(sounds, ['on', 'none no-device']);
  assert.equal(world.closed, 1);
  assert.equal(position(), 1500);
  context.currentTime = 0.5;
  await pass(40);
  assert.deepEqual(sounds, ['on', 'none no-device', 'on']);
  assert.equal(position(), 1500);
});

test('does not mistake a suspended page for a stalled clock', async () => {
  const { player, sounds, world, pass } = rig({ state: 'running' });
  player.open();
  await pass(40);
  world.now += 60000;
  await pass(40);
  assert.deepEqual(sounds, ['on']);
});

test('reports a browser without sound', async () => {
  const { player, sounds, pass, position } = rig({ context: false });
  player.open();
  player.write(new Float32Array(48000));
  player.finish();
  await pass(2000);
  assert.deepEqual(sounds, ['none no-audio']);
  assert.equal(position(), 48000);
});

test('asks again when closed while waiting for sound, and reopened', async () => {
  const { player, sounds, pass } = rig();
  player.open();
  await pass(80);
  player.close();
  player.open();
  await pass(400);
  assert.deepEqual(sounds, ['blocked autoplay']);
});
