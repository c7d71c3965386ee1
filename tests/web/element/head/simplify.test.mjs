// SPDX-License-Identifier: MIT
// Fewer triangles: what is left stays near what was there, in every pose, and keeps its outline.
import assert from 'node:assert/strict';
import test from 'node:test';
import { simplify, neighboursFirst, renumbered } from '../../../../web/element/head/mesh/simplify.mjs';

const N = 30;

/** A sheet of 30 by 30 squares of 2 mm. @param {(x: number, y: number) => number} height */
function sheet(height) {
  const position = [];
  const index = [];
  for (let y = 0; y <= N; y++) for (let x = 0; x <= N; x++) position.push(2 * x, 2 * y, height(2 * x, 2 * y));
  for (let y = 0; y < N; y++)
    for (let x = 0; x < N; x++) {
      const a = y * (N + 1) + x;
      index.push(a, a + 1, a + N + 2, a, a + N + 2, a + N + 1);
    }
  return { position: Float32Array.from(position), index: Uint16Array.from(index), vertices: (N + 1) ** 2, smooth: null };
}

function run(work) {
  for (;;) {
    const { done, value } = work.next();
    if (done) return value;
  }
}

/** The height of a surface over a place. */
function heightAt({ position }, index, x, y) {
  for (let t = 0; t < index.length; t += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => position.subarray(3 * index[t + k], 3 * index[t + k] + 3));
    const area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    const s = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / area;
    const u = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area;
    if (s >= -1e-6 && u >= -1e-6 && s + u <= 1 + 1e-6) return a[2] + s * (b[2] - a[2]) + u * (c[2] - a[2]);
  }
  return NaN;
}

const hill = (x, y) => 6 * Math.exp(-((x - 30) ** 2 + (y - 30) ** 2) / 150);
const farthest = (part, index) => {
  let most = 0;
  for (let v = 0; v < part.vertices; v++) {
    const [x, y, z] = part.position.subarray(3 * v, 3 * v + 3);
    most = Math.max(most, Math.abs(heightAt(part, index, x, y) - z));
  }
  return most;
};

test('removes many triangles, few where the surface bends, and keeps the surface in place', () => {
  const part = sheet(hill);
  const [some, fewer] = run(simplify(part, { blocks: [part.position], places: 1 }, [0.1, 0.4]));
  assert.ok(some.length < 0.5 * part.index.length, `${some.length / 3} triangles`);
  assert.ok(fewer.length < 0.7 * some.length, `${fewer.length / 3} triangles`);
  assert.ok(farthest(part, some) < 0.2, `${farthest(part, some)} mm`);
  assert.ok(farthest(part, fewer) < 0.8, `${farthest(part, fewer)} mm`);
  for (const corner of [0, N, N * (N + 1), (N + 1) ** 2 - 1]) assert.ok(fewer.includes(corner), 'the outline is whole');
});

test('keeps detail that bends only in another pose, or differs only in light', () => {
  const part = sheet(() => 0);
  const flat = run(simplify(part, { blocks: [part.position], places: 1 }, [0.2]))[0];
  const posed = run(simplify(part, { blocks: [part.position, sheet(hill).position], places: 2 }, [0.2]))[0];
  const shade = Float32Array.from(sheet(hill).position, (value, i) => (i % 3 === 2 ? value : 0));
  const lit = run(simplify(part, { blocks: [part.position, shade], places: 1 }, [0.2]))[0];
  assert.ok(flat.length < 0.1 * part.index.length, `${flat.length / 3} triangles of a plane`);
  assert.ok(posed.length > 3 * flat.length, `${posed.length / 3} of one that will bend`);
  assert.ok(lit.length > 3 * flat.length, `${lit.length / 3} of one with a shadow on it`);
  assert.ok(farthest(sheet(hill), posed) < 0.4, `${farthest(sheet(hill), posed)} mm`);
});

test('keeps seams of the texture and small parts', () => {
  const part = sheet(() => 0);
  const middle = (N / 2) * (N + 1) + N / 2;
  part.smooth = Uint16Array.from({ length: part.vertices }, (_, v) => (v === middle + 1 ? middle : v));
  const [left] = run(simplify(part, { blocks: [part.position], places: 1 }, [1]));
  assert.ok(left.includes(middle) && left.includes(middle + 1));
  const small = { ...part, index: part.index.slice(0, 300) };
  assert.deepEqual(run(simplify(small, { blocks: [part.position], places: 1 }, [1, 2])), [small.index, small.index]);
});

const triangles = (index) => Array.from({ length: index.length / 3 }, (_, t) => {
  const corners = [...index.slice(3 * t, 3 * t + 3)];
  const least = corners.indexOf(Math.min(...corners));
  return [...corners.slice(least), ...corners.slice(0, least)].join(); // the same way round
}).sort();

test('orders triangles after their neighbours, and loses none', () => {
  const part = sheet(hill);
  const mixed = Uint16Array.from({ length: part.index.length }, (_, i) => part.index[3 * ((Math.floor(i / 3) * 617) % (part.index.length / 3)) + (i % 3)]);
  const ordered = neighboursFirst(mixed, part.vertices);
  assert.deepEqual(triangles(ordered), triangles(part.index));
  const { index, kept } = renumbered(ordered);
  assert.deepEqual([...index.map((v) => kept[v])], [...ordered]);
  assert.deepEqual([...new Set(index)], [...kept.keys()], 'numbered as they come');
  /** Vertices that are shaded again, when the last 24 are kept. */
  const shaded = (list) => {
    const last = [];
    let count = 0;
    for (const v of list) {
      if (last.includes(v)) continue;
      count++;
      last.push(v);
      if (last.length > 24) last.shift();
    }
    return count / (list.length / 3);
  };
  assert.ok(shaded(index) < 0.8, `${shaded(index)} for each triangle; before: ${shaded(mixed)}`);
  assert.ok(shaded(mixed) > 2);
});
