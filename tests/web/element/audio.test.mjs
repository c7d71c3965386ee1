// SPDX-License-Identifier: MIT
import assert from 'node:assert/strict';
import test from 'node:test';
import { HeardClock, PositionMap } from '../../../web/element/audio/clock.mjs';
import { mono } from '../../../web/element/audio/mixdown.mjs';
import { PlayoutBuffer, Ring } from '../../../web/element/audio/playout-buffer.mjs';
import { Resampler } from '../../../web/element/audio/resampler.mjs';

const ramp = (from, count) => Float32Array.from({ length: count }, (_, i) => from + i);

test('the ring keeps the order across its end and when it grows', () => {
  const ring = new Ring(16);
  const out = [];
  let written = 0;
  for (const [put, take] of [[10, 7], [12, 9], [40, 5], [3, 44]]) {
    ring.push(ramp(written, put));
    written += put;
    const block = new Float32Array(take);
    out.push(...block.subarray(0, ring.read(block)));
  }
  assert.equal(ring.length, 0);
  assert.deepEqual(out, [...ramp(0, 65)]);
});

/** A buffer, its reports, and what it has played. */
function rig(rate = 1000) {
  const reports = [];
  const buffer = new PlayoutBuffer(rate, (report) => reports.push(report));
  const played = [];
  let frame = 0;
  return {
    buffer,
    reports,
    played,
    map() {
      const map = new PositionMap();
      reports.forEach((report) => map.add(report));
      return map;
    },
    run(quanta, size = 20) {
      for (let i = 0; i < quanta; i++, frame += size) {
        const out = new Float32Array(size);
        buffer.render(out, frame);
        played.push(...out);
      }
    },
  };
}

test('a position before all stored reports is that of the first one', () => {
  const map = new PositionMap();
  for (let i = 0; i < 20; i++) map.add({ frame: 100 * i, position: 100 * i, running: true });
  assert.deepEqual(map.at(2000), { position: 2000, running: true });
  assert.deepEqual(map.at(500), { position: 1800, running: true }, 'a clock that was set back by a suspended sound');
});

test('the buffer waits for its preroll, then position and clock advance together', () => {
  const { buffer, played, reports, run, map } = rig();
  buffer.push(ramp(1, 60));
  run(2);
  assert.deepEqual(reports, [], 'less than the preroll: nothing yet');
  buffer.push(ramp(61, 60));
  run(3);
  assert.deepEqual(reports, [{ frame: 40, position: 0, running: true, underruns: 0 }]);
  assert.deepEqual(played.slice(40, 100), [...ramp(1, 60)]);
  assert.deepEqual(map().at(39), { position: 0, running: false });
  assert.deepEqual(map().at(75), { position: 35, running: true });
});

test('a complete short utterance starts without the preroll, and its end is not an underrun', () => {
  const { buffer, reports, run } = rig();
  buffer.push(ramp(1, 30));
  buffer.finish();
  run(4);
  assert.deepEqual(reports, [
    { frame: 0, position: 0, running: true, underruns: 0 },
    { frame: 30, position: 30, running: false, underruns: 0 },
  ]);
});

test('late samples stop the position, and nothing is lost or shifted afterwards', () => {
  const { buffer, played, reports, run, map } = rig();
  buffer.push(ramp(1, 100));
  run(8); // 60 frames without samples
  buffer.push(ramp(101, 200));
  run(3);
  assert.equal(reports[1].running, false);
  assert.equal(reports[1].underruns, 1);
  assert.equal(reports[1].frame, 100);
  assert.equal(reports[2].frame, 160);
  assert.deepEqual(map().at(130), { position: 100, running: false });
  assert.deepEqual(map().at(170), { position: 110, running: true });
  assert.equal(played[170], 111, 'sample at position 110');
});

test('a flush silences within five milliseconds, and the rest counts as heard', () => {
  const { buffer, played, reports, run, map } = rig(48000);
  buffer.push(new Float32Array(48000).fill(1));
  run(100, 128);
  buffer.flush();
  run(4, 128);
  const after = played.slice(12800);
  assert.ok(after[0] > 0.98 && after[100] < 0.7, 'fades');
  assert.ok(after.slice(241).every((sample) => sample === 0));
  assert.ok(after.every((sample, i) => i === 0 || Math.abs(sample - after[i - 1]) < 0.01), 'no click');
  assert.deepEqual(reports.at(-1), { frame: 12800, position: 48000, running: false, underruns: 0 });
  buffer.push(new Float32Array(9600).fill(0.5));
  run(1, 128);
  assert.equal(map().at(12800 + 512 + 10).position, 48010);
});

test('another buffer can take over the remaining samples', () => {
  const { buffer, run } = rig();
  buffer.push(ramp(1, 200));
  run(3);
  assert.deepEqual([...buffer.drain()], [...ramp(61, 140)]);
});

test('resampling keeps a tone, its phase and its length, however the stream is cut', () => {
  for (const [from, to] of [[22050, 48000], [16000, 44100], [24000, 48000], [48000, 22050], [48000, 48000]]) {
    const tone = (rate) => (_, i) => 0.5 * Math.sin((2 * Math.PI * 1000 * i) / rate);
    const input = Float32Array.from({ length: from / 2 }, tone(from));
    const resampler = new Resampler(from, to);
    const out = [];
    for (let at = 0, size = 1; at < input.length; at += size, size = 1 + ((size * 7) % 997))
      out.push(...resampler.push(input.subarray(at, at + size)));
    out.push(...resampler.finish());
    assert.equal(out.length, to / 2, `${from} to ${to}`);
    const worst = out
      .slice(to / 10, -to / 10)
      .reduce((max, sample, i) => Math.max(max, Math.abs(sample - tone(to)(null, i + to / 10))), 0);
    assert.ok(worst < 0.5 * 10 ** (-60 / 20), `${from} to ${to}: error ${worst}`);
  }
});

test('downsampling filters out frequencies that it cannot represent', () => {
  const input = Float32Array.from({ length: 48000 }, (_, i) => Math.sin((2 * Math.PI * 15000 * i) / 48000));
  const out = new Resampler(48000, 16000).push(input).slice(1000, -1000);
  assert.ok(Math.max(...out.map(Math.abs)) < 0.01);
});

test('the resampler accepts 16 bit', () => {
  const resampler = new Resampler(8000, 8000);
  assert.deepEqual([...resampler.push(Int16Array.of(16384, -32768)), ...resampler.finish()], [0.5, -1]);
});

test('the heard clock follows the timestamps smoothly, and jumps when it must', () => {
  const clock = new HeardClock();
  const context = { currentTime: 0, getOutputTimestamp: () => ({ contextTime: context.stamp, performanceTime: context.at }) };
  let before = 0;
  for (let now = 1000; now < 3000; now += 16) {
    context.currentTime = now / 1000 - 0.9;
    context.at = Math.floor(now / 100) * 100; // stated now and then, 3 ms off to one side or the other
    context.stamp = context.at / 1000 - 0.95 + (context.at % 200 ? 0.003 : -0.003);
    const heard = clock.at(context, now);
    assert.ok(Math.abs(heard - (now / 1000 - 0.95)) < 0.0035);
    if (before) assert.ok(heard > before && heard - before < 0.018);
    before = heard;
  }
  context.currentTime += 1;
  context.stamp += 1;
  assert.ok(clock.at(context, 3000) > before + 0.9, 'a jump is followed at once');
});

test('the heard clock works without timestamps, and ignores impossible ones', () => {
  const plain = { currentTime: 5, outputLatency: 0.04 };
  assert.equal(new HeardClock().at(plain, 1000), 4.96);
  const future = { currentTime: 5, baseLatency: 0.01, getOutputTimestamp: () => ({ contextTime: 9, performanceTime: 1000 }) };
  assert.equal(new HeardClock().at(future, 1000), 4.99);
});

test('the heard clock follows the context where time stamps run twice as fast as time', () => {
  const clock = new HeardClock();
  for (let now = 400; now < 4000; now += 50) {
    const played = (now - 400) / 1000; // seconds since the context was started
    const context = { currentTime: played, baseLatency: 0.006, getOutputTimestamp: () => ({ contextTime: played - 0.006, performanceTime: 400 + 2000 * played }) };
    const heard = clock.at(context, now);
    assert.ok(Math.abs(heard - played) <= 0.06, `${heard} of ${played}`);
  }
});

test('hold silences within five milliseconds and stops the clock; release continues without a click', () => {
  const { buffer, played, run, map } = rig();
  buffer.push(new Float32Array(300).fill(1));
  run(5);
  buffer.hold();
  run(10);
  assert.ok(played.slice(105, 300).every((sample) => sample === 0), 'silent');
  assert.deepEqual(map().at(290), { position: 100, running: false });
  buffer.push(new Float32Array(50).fill(1));
  buffer.release();
  run(5);
  assert.deepEqual(map().at(350), { position: 150, running: true });
  const step = Math.max(...played.slice(90, 400).map((sample, i, all) => (i ? Math.abs(sample - all[i - 1]) : 0)));
  assert.ok(step < 0.25, `a step of ${step}`);
  assert.equal(map().at(390).position, 190, 'nothing was lost');
});

test('a second channel that is the inverted first does not silence it; ordinary stereo is averaged', () => {
  const buffer = (...channels) => ({ numberOfChannels: channels.length, getChannelData: (c) => channels[c] });
  const left = Float32Array.from({ length: 8000 }, (_, i) => 0.5 * Math.sin(i / 12));
  const power = (samples) => samples.subarray(400).reduce((sum, x) => sum + x * x, 0);
  const inverted = mono(buffer(left, left.map((x) => -x)));
  assert.ok(Math.abs(power(inverted) / power(left) - 1) < 0.01, `${power(inverted)} of ${power(left)}`);
  const other = left.map((_, i) => 0.3 * Math.sin(i / 7));
  mono(buffer(left, other)).forEach((x, i) => assert.ok(Math.abs(x - (left[i] + other[i]) / 2) < 1e-6));
  assert.equal(mono(buffer(left)), left);
});
