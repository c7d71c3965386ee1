// SPDX-License-Identifier: MIT
// Converts a range of the Face Player to a named gesture, a file for the daemon (models/gestures/README.md).

import { DocumentStore } from '../shared/document-store.js';

const SECONDS = 10;
const FEWEST = 3;
const MOST = 600; // frames
const USUAL = [3, 4, 5, 7]; // groups: eyes, brows, cheeks, head; the mouth is for speech

/**
 * @param {{fps: number, frames: number[][]}} take @param {{number: number, name: string, group: number}[]} table of FAPs
 * @param {{name: string, from: number, to: number, groups: number[]}} wish frames, both included
 * @returns {object|null} null: it is too short or too long, or nothing moves in it
 */
export function makeGesture({ fps, frames }, table, { name, from, to, groups }) {
  const stretch = frames.slice(from, to + 1);
  if (stretch.length < FEWEST || stretch.length > MOST || (stretch.length - 1) / fps > SECONDS) return null;
  const curves = table
    .filter(({ number, group }) => number > 2 && groups.includes(group) && stretch.some((values) => values[number]))
    .map((fap) => [fap.name, stretch.map((values) => values[fap.number] ?? 0)]);
  if (!curves.length) return null;
  return { format: 'faccia-gesture', version: 1, name, fps, blend: { in: 0.2, out: 0.3 }, curves: Object.fromEntries(curves) };
}

/** Writes the file with a line for each curve. */
export function gestureText(gesture) {
  const lines = Object.entries(gesture.curves).map(([name, curve]) => `  ${JSON.stringify(name)}: ${JSON.stringify(curve)}`);
  const head = JSON.stringify({ ...gesture, curves: {} }, null, 1).replace(/\{\}\n\}$/, '');
  return `${head}{\n${lines.join(',\n')}\n }\n}\n`;
}

const $ = (id) => document.getElementById(id);

/** The form. @param {() => {take: object|null, now: number}} state @param {object[]} table @param {object} frame of the page */
export function openGestureForm(state, table, frame) {
  const stretch = { from: 0, to: 0 };
  const groups = [...new Set(table.map(({ group }) => group))].filter((group) => group > 1);
  const boxes = groups.map((group) => Object.assign(document.createElement('input'), { type: 'checkbox', value: group, checked: USUAL.includes(group) }));
  const names = boxes.map(() => document.createElement('span'));
  $('gesture-groups').append(
    ...boxes.map((box, i) => {
      const label = Object.assign(document.createElement('label'), { className: 'choice' });
      label.append(box, names[i]);
      return label;
    }),
  );
  const show = () => {
    const fps = state().take?.fps ?? 25;
    $('stretch').textContent = frame.say('stretchIs', { from: stretch.from, to: stretch.to, seconds: (Math.max(0, stretch.to - stretch.from) / fps).toFixed(2) });
    groups.forEach((group, i) => (names[i].textContent = frame.words[frame.lang].groups[group]));
  };
  $('stretch-from').addEventListener('click', () => {
    stretch.from = state().now;
    stretch.to = Math.max(stretch.to, stretch.from);
    show();
  });
  $('stretch-to').addEventListener('click', () => {
    stretch.to = state().now;
    stretch.from = Math.min(stretch.to, stretch.from);
    show();
  });
  const server = new DocumentStore('v1/gestures', frame.access);
  $('gesture').addEventListener('submit', async (event) => {
    event.preventDefault();
    frame.problem.clear();
    const { take } = state();
    const name = $('gesture-name').value;
    const made = take && makeGesture(take, table, { name, ...stretch, groups: groups.filter((_, i) => boxes[i].checked) });
    frame.tell(made ? '' : 'noGesture');
    if (!made) return;
    if (event.submitter?.id === 'gesture-keep') {
      await server.save(name, gestureText(made)).then(() => frame.tell('gestureKept'), (error) => frame.problem.show(error));
      return;
    }
    frame.tell('gestureMade');
    const url = URL.createObjectURL(new Blob([gestureText(made)], { type: 'application/json' }));
    Object.assign(document.createElement('a'), { href: url, download: `${name}.json` }).click();
    setTimeout(() => URL.revokeObjectURL(url), 10000);
  });
  frame.onTranslate(show);
}
