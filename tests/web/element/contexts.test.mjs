// SPDX-License-Identifier: MIT
import assert from 'node:assert/strict';
import test from 'node:test';
import { Contexts } from '../../../web/element/stage/contexts.mjs';

function rig(most, count) {
  let due = [];
  const contexts = new Contexts(most, (call) => due.push(call));
  const stages = Array.from({ length: count }, () => ({
    visible: false, drawing: false, refused: 0,
    enter() {
      this.drawing = true;
    },
    leave() {
      this.drawing = false;
    },
    refuse() {
      this.refused++;
    },
  }));
  /** All these come into sight, or go out of it, at once. */
  const see = (which, on) => {
    for (const i of which) {
      stages[i].visible = on;
      contexts.ask(stages[i]);
    }
    const calls = due;
    due = [];
    calls.forEach((call) => call());
  };
  const drawing = () => stages.flatMap(({ drawing: on }, i) => (on ? [i] : []));
  stages.forEach((stage) => contexts.ask(stage));
  return { contexts, stages, see, drawing };
}

test('uses the full limit of contexts; a head that scrolls into view replaces one out of view', () => {
  const { see, drawing, stages } = rig(2, 4);
  assert.deepEqual(drawing(), [0, 1]);
  see([1], true);
  see([3], true);
  assert.deepEqual(drawing(), [1, 3]);
  assert.deepEqual(stages.map(({ refused }) => refused), [0, 0, 0, 0]);
});

test('with all drawn heads in view, reports the limit to another head, which gets the next free context', () => {
  const { see, drawing, stages, contexts } = rig(2, 4);
  see([2, 1, 0], true);
  assert.deepEqual(drawing(), [0, 1]);
  assert.equal(stages[2].refused, 1);
  see([0], false);
  assert.deepEqual(drawing(), [1, 2]);
  contexts.leave(stages[1]);
  assert.deepEqual(drawing().filter((i) => i !== 1), [2, 3]);
});
