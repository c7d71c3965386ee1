// SPDX-License-Identifier: MIT
// The marks of a text, each over a range or at a point. Lists are immutable: every change returns a new one.

/** Outer marks first, so that they nest in the written markup. */
export const KINDS = ['voice', 'affect', 'gaze', 'emphasis'];
/** Kinds of marks that stand at a position rather than over words. */
export const POINTS = ['pause', 'gesture'];

const isWord = (c) => c !== undefined && /[\p{L}\p{M}\p{N}'’]/u.test(c);

/** Extends a range to whole words; an empty range takes the word around it. @returns {[number, number]} */
export function wholeWords(text, from, to) {
  while (isWord(text[from - 1]) && isWord(text[from])) from--;
  while (isWord(text[to - 1]) && isWord(text[to])) to++;
  if (from < to) {
    while (from < to && !isWord(text[from])) from++;
    while (to > from && !isWord(text[to - 1])) to--;
  }
  return [from, to];
}

const inOrder = (marks) => marks.toSorted((a, b) => a.from - b.from || b.to - a.to);

/** Removes a kind of mark from a range. @returns {object[]} */
export function without(marks, kind, from, to) {
  return inOrder(
    marks.flatMap((mark) => {
      if (mark.kind !== kind || mark.to <= from || mark.from >= to) return [mark];
      const left = [{ ...mark, to: Math.min(mark.to, from) }, { ...mark, from: Math.max(mark.from, to) }];
      return left.filter((piece) => piece.from < piece.to);
    }),
  );
}

/**
 * Adds a mark, which replaces others of its kind there. Pauses are placed after the range, other points before it.
 */
export function withMark(marks, { kind, value, from, to }) {
  if (!POINTS.includes(kind) && from >= to) return marks;
  if (!POINTS.includes(kind)) return inOrder([...without(marks, kind, from, to), { kind, value, from, to }]);
  const at = kind === 'pause' ? to : from;
  return inOrder([...marks.filter((mark) => mark.kind !== kind || mark.from !== at), { kind, value, from: at, to: at }]);
}

/** Moves the marks along with their words after an edit. */
export function moved(marks, before, after) {
  let head = 0;
  while (head < before.length && head < after.length && before[head] === after[head]) head++;
  let tail = 0;
  while (tail < before.length - head && tail < after.length - head && before.at(-1 - tail) === after.at(-1 - tail)) tail++;
  const [end, grown] = [before.length - tail, after.length - before.length];
  const place = (at, first) => (at <= head ? at : at >= end ? at + grown : first ? head : after.length - tail);
  return marks
    .map((mark) => ({ ...mark, from: place(mark.from, true), to: place(mark.to, false) }))
    .map((mark) => (POINTS.includes(mark.kind) ? { ...mark, to: mark.from } : mark))
    .filter(({ kind, from, to }) => POINTS.includes(kind) || from < to);
}

/** Cuts the marks to a range, with positions relative to its start. */
export function within(marks, from, to) {
  return marks
    .filter((mark) => (mark.from === mark.to ? mark.from >= from && mark.to <= to : mark.to > from && mark.from < to))
    .map((mark) => ({ ...mark, from: Math.max(mark.from, from) - from, to: Math.min(mark.to, to) - from }));
}

/** Returns the sentence around a range. @returns {[number, number]} */
export function sentenceAt(text, from, to) {
  const ends = [...text.matchAll(/[.?!…]+["'»”’)]*\s|\n\s*\n/g)].map((match) => match.index + match[0].length);
  return [ends.filter((end) => end <= from).at(-1) ?? 0, ends.find((end) => end >= Math.max(to, from + 1)) ?? text.length];
}
