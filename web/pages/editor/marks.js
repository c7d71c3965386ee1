// SPDX-License-Identifier: MIT
// The marks of a text: what holds over which stretch of it, or at which place. Values do not change: each act gives a new list.

/** Outer ones first: so they lie in each other when the text is written. */
export const KINDS = ['voice', 'affect', 'gaze', 'emphasis'];
/** Kinds of marks that stand at a position rather than over words. */
export const POINTS = ['pause', 'gesture'];

const isWord = (c) => c !== undefined && /[\p{L}\p{M}\p{N}'’]/u.test(c);

/** A stretch widened to whole words; one of nothing takes the word that it stands in. @returns {[number, number]} */
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

/** Takes a kind away from a stretch. @returns {object[]} */
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
 * Puts one: what there was of its kind gives way to it. A point stands behind the stretch when it is a pause, before it
 * otherwise.
 */
export function withMark(marks, { kind, value, from, to }) {
  if (!POINTS.includes(kind) && from >= to) return marks;
  if (!POINTS.includes(kind)) return inOrder([...without(marks, kind, from, to), { kind, value, from, to }]);
  const at = kind === 'pause' ? to : from;
  return inOrder([...marks.filter((mark) => mark.kind !== kind || mark.from !== at), { kind, value, from: at, to: at }]);
}

/** The marks after the text was edited: they go along with their words. */
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

/** Cuts the marks to a stretch, with positions relative to its start. */
export function within(marks, from, to) {
  return marks
    .filter((mark) => (mark.from === mark.to ? mark.from >= from && mark.to <= to : mark.to > from && mark.from < to))
    .map((mark) => ({ ...mark, from: Math.max(mark.from, from) - from, to: Math.min(mark.to, to) - from }));
}

/** The sentence round a stretch. @returns {[number, number]} */
export function sentenceAt(text, from, to) {
  const ends = [...text.matchAll(/[.?!…]+["'»”’)]*\s|\n\s*\n/g)].map((match) => match.index + match[0].length);
  return [ends.filter((end) => end <= from).at(-1) ?? 0, ends.find((end) => end >= Math.max(to, from + 1)) ?? text.length];
}
