// SPDX-License-Identifier: MIT
import assert from 'node:assert/strict';
import test from 'node:test';
import { Turns } from '../../../web/element/speech/turns.mjs';

function rig() {
  const turns = new Turns();
  const granted = [];
  const speaker = (more) => ({ polite: true, paused: false, reachable: true, grant: (utterance) => granted.push(utterance), ...more });
  return { turns, granted, speaker };
}

test('grants turns in order of requests; requests of the current speaker join its turn', () => {
  const { turns, granted, speaker } = rig();
  const [a, b] = [speaker(), speaker()];
  turns.ask(a, 'a1');
  turns.ask(a, 'a2');
  turns.ask(b, 'b1');
  turns.ask(a, 'a3');
  assert.deepEqual(granted, ['a1', 'a2']);
  turns.leave('a1');
  assert.deepEqual(granted, ['a1', 'a2']);
  turns.leave('a2');
  assert.deepEqual(granted, ['a1', 'a2', 'b1']);
  turns.leave('b1');
  assert.deepEqual(granted, ['a1', 'a2', 'b1', 'a3']);
});

test('a speaker that does not wait speaks at once; others wait for it', () => {
  const { turns, granted, speaker } = rig();
  turns.ask(speaker(), 'a');
  turns.ask(speaker({ polite: false }), 'b');
  turns.ask(speaker(), 'c');
  turns.leave('a');
  assert.deepEqual(granted, ['a', 'b']);
  turns.leave('b');
  assert.deepEqual(granted, ['a', 'b', 'c']);
});

test('a priority request precedes the speaker’s own, at once while it is speaking', () => {
  const { turns, granted, speaker } = rig();
  const [a, b] = [speaker(), speaker()];
  turns.ask(a, 'a1');
  turns.ask(b, 'b1');
  turns.ask(b, 'b0', true);
  turns.ask(a, 'a0', true);
  assert.deepEqual(granted, ['a1', 'a0']);
  turns.leave('a1');
  turns.leave('a0');
  assert.deepEqual(granted, ['a1', 'a0', 'b0', 'b1']);
});

test('a paused or disconnected speaker delays no one', () => {
  const { turns, granted, speaker } = rig();
  const [a, b, c] = [speaker(), speaker({ reachable: false }), speaker()];
  turns.ask(a, 'a');
  turns.ask(b, 'b');
  turns.ask(c, 'c');
  a.paused = true;
  turns.next();
  assert.deepEqual(granted, ['a', 'c']);
  b.reachable = true;
  turns.next();
  assert.deepEqual(granted, ['a', 'c']);
  turns.leave('c');
  assert.deepEqual(granted, ['a', 'c', 'b']);
});

test('a returned turn comes again before others', () => {
  const { turns, granted, speaker } = rig();
  const [a, b] = [speaker(), speaker()];
  turns.ask(a, 'a1');
  turns.ask(a, 'a2');
  turns.ask(b, 'b');
  a.reachable = false;
  turns.giveBack(a, 'a1');
  turns.giveBack(a, 'a2');
  assert.deepEqual(granted, ['a1', 'a2', 'b']);
  a.reachable = true;
  turns.leave('b');
  assert.deepEqual(granted, ['a1', 'a2', 'b', 'a1', 'a2']);
});
