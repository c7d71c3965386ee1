// SPDX-License-Identifier: MIT
import assert from 'node:assert/strict';
import test from 'node:test';
import { addProperties, upgradeProperties } from '../../../web/element/properties.mjs';

class Element {
  attributes = new Map();
  getAttribute(name) {
    return this.attributes.get(name) ?? null;
  }
  hasAttribute(name) {
    return this.attributes.has(name);
  }
  setAttribute(name, value) {
    this.attributes.set(name, String(value));
  }
  removeAttribute(name) {
    this.attributes.delete(name);
  }
}
class Head extends Element {}
addProperties(Head.prototype);

test('reflects texts and numbers; null and undefined remove the attribute', () => {
  const head = new Head();
  head.voice = 'espeak:it+f2';
  head.rate = '180';
  head.life = 0;
  assert.deepEqual([...head.attributes], [['voice', 'espeak:it+f2'], ['rate', '180'], ['life', '0']]);
  assert.deepEqual([head.voice, head.rate, head.life, head.src], ['espeak:it+f2', 180, 0, null]);
  for (const nothing of [null, undefined]) {
    head.voice = head.rate = head.life = nothing;
    assert.equal(head.attributes.size, 0);
    head.setAttribute('rate', '90');
  }
  for (const nonsense of ['', 'fast', NaN, -3, 0]) {
    head.rate = nonsense;
    assert.equal(head.rate, null, `rate ${nonsense}`);
  }
});

test('switches accept the truth values of templates', () => {
  const head = new Head();
  assert.deepEqual([head.captions, head.polite, head.still, head.turn], [true, true, null, null]);
  for (const no of [false, 'off', 'false', 'OFF']) {
    Object.assign(head, { captions: no, polite: no, still: no, turn: no });
    assert.deepEqual([head.captions, head.polite, head.still, head.turn], [false, false, false, false], String(no));
  }
  for (const yes of [true, 'on', '', 'true']) {
    Object.assign(head, { captions: yes, polite: yes, still: yes, turn: yes });
    assert.deepEqual([head.captions, head.polite, head.still, head.turn], [true, true, true, true], String(yes));
  }
  head.setAttribute('captions', 'false');
  assert.equal(head.captions, false);
  Object.assign(head, { captions: undefined, polite: null, still: null, turn: null });
  assert.deepEqual([head.captions, head.polite, head.still, head.turn], [true, true, null, null]);
});

test('the expression may be an object', () => {
  const head = new Head();
  head.expression = { joy: 0.4, surprise: 0.6 };
  assert.equal(head.getAttribute('expression'), 'surprise 0.6, joy 0.4');
  assert.deepEqual(head.expression, [{ name: 'surprise', intensity: 0.6 }, { name: 'joy', intensity: 0.4 }]);
  head.expression = 'fear';
  assert.deepEqual(head.expression, [{ name: 'fear', intensity: 1 }]);
  head.expression = null;
  assert.deepEqual(head.expression, []);
});

test('applies properties set before the upgrade', () => {
  const plain = new Element();
  Object.assign(plain, { rate: 200, captions: 'off', other: 1 });
  Object.setPrototypeOf(plain, Head.prototype);
  upgradeProperties(plain);
  assert.deepEqual([plain.rate, plain.captions, plain.other], [200, false, 1]);
  plain.rate = 100;
  assert.equal(plain.getAttribute('rate'), '100');
});
