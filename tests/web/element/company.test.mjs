// SPDX-License-Identifier: MIT
// What company adds to a face, and who of a scene shows a speech.
import assert from 'node:assert/strict';
import test from 'node:test';
import { Company } from '../../../web/element/face/company.mjs';
import { Seat } from '../../../web/element/scene.mjs';

const DEGREE = 1745.33;

/** Runs a company for some seconds, and returns each FAP over time. */
function run(company, seconds, how, from = 0) {
  const frames = [];
  for (let i = 0; i < seconds * 50; i++) {
    const values = new Float32Array(69);
    company.add(from + i / 50, values, { side: 0, speaks: false, blinks: false, ...how });
    frames.push(values);
  }
  return (n) => frames.map((values) => values[n] / DEGREE);
}

test('turns to the other smoothly, less while it speaks, and back', () => {
  const company = new Company(() => 0.5);
  const listening = run(company, 3, { side: 1 })(49);
  assert.ok(listening.at(-1) > 8 && listening.at(-1) < 12, `${listening.at(-1)}`);
  assert.ok(Math.max(...listening.slice(1).map((yaw, i) => Math.abs(yaw - listening[i]))) < 1);
  const speaking = run(company, 3, { side: 1, speaks: true }, 3)(49).at(-1);
  assert.ok(speaking > 2 && speaking < listening.at(-1) / 2);
  assert.ok(company.moving);
  assert.ok(Math.abs(run(company, 4, { side: 0 }, 6)(49).at(-1)) < 0.1);
  assert.ok(!company.moving);
  assert.ok(run(new Company(), 3, { side: -1 })(23).at(-1) < -5);
});

test('nods after a sentence, and raises its brows at a question; one who speaks does neither', () => {
  const company = new Company(() => 0.5);
  company.heardSentence(0, 'È ancora caldo.');
  const nod = run(company, 2, {})(48);
  assert.ok(Math.max(...nod) > 2 && Math.abs(nod.at(-1)) < 1e-6 && nod[0] === 0);
  company.heardSentence(2, '«Quale chiave?»');
  const asked = run(company, 3, {}, 2);
  assert.ok(Math.max(...asked(31)) > 0 && Math.max(...asked(48)) === 0);
  company.heardSentence(5, 'Ecco.');
  assert.equal(Math.max(...run(company, 2, { speaks: true }, 5)(48)), 0);
});

test('blinks while its own idle movement rests', () => {
  const lids = run(new Company(), 20, { blinks: true })(19).map((value) => value * DEGREE);
  const blinks = lids.filter((value, i) => value > 900 && !(lids[i - 1] > 900)).length;
  assert.ok(blinks >= 3 && blinks <= 10, `${blinks}`);
  assert.equal(Math.max(...run(new Company(), 20, {})(19)), 0);
});

/** A page with heads, whose speech says who speaks. */
function page(...heads) {
  const elements = new Map();
  const tree = { getElementById: (id) => elements.get(id) ?? null };
  const seats = heads.map(({ id, partner = null, persona = null, left = 0 }) => {
    const element = { id, partner, persona, getRootNode: () => tree, ownerDocument: tree, getBoundingClientRect: () => ({ left, width: 100 }) };
    elements.set(id, element);
    const speech = { busy: false, who: undefined, heard: () => (speech.busy ? { running: true, utterance: { speaker: speech.who && { id: speech.who } } } : null) };
    return Object.assign(new Seat(element, speech, () => {}), { speech });
  });
  return seats;
}
const shows = (seats) => seats.map((seat) => [Boolean(seat.heard(0).heard), seat.heard(0).listens]);

test('each shows its own persons; the first one shows the rest; both show what both say', () => {
  const seats = page({ id: 'b', partner: 'a', persona: 'ugo', left: 200 }, { id: 'a', persona: 'anna' });
  for (const seat of seats) seat.open(); // the partner first
  const [b, a] = seats;
  assert.deepEqual([a.alone, b.alone], [false, false]);
  a.speech.busy = true;
  for (const [who, expected] of [
    ['anna', [[false, true], [true, false]]],
    ['ugo', [[true, false], [false, true]]],
    ['anna+ugo', [[true, false], [true, false]]],
    ['carlo', [[false, true], [true, false]]],
    [undefined, [[false, true], [true, false]]],
  ]) {
    a.speech.who = who;
    assert.deepEqual(shows(seats), expected, who);
  }
  b.speech.busy = true; // a partner's own speech
  assert.equal(b.heard(0).heard.utterance.speaker, undefined);
  b.speech.busy = false;
  a.speech.who = 'ugo';
  const values = [a, b].map((seat) => {
    let last;
    for (let at = 0; at < 3000; at += 20) seat.add(at, (last = new Float32Array(69)), true);
    return last[49];
  });
  assert.ok(values[0] > 0 && values[1] < 0, 'they look at each other'); // a is on the left
  a.close();
  assert.ok(b.alone);
  a.open();
  assert.ok(!b.alone);
});

test('a head whose partner is itself, a partner of another, or missing is alone', () => {
  const seats = page({ id: 'a', partner: 'a' }, { id: 'b', partner: 'nobody' }, { id: 'c' }, { id: 'd', partner: 'c' }, { id: 'e', partner: 'd' });
  for (const seat of seats) seat.open();
  assert.deepEqual(seats.map((seat) => seat.alone), [true, true, false, false, true]);
});
