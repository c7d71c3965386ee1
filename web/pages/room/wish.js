// SPDX-License-Identifier: MIT
// Reads the options in the address of a room's page.

/** @param {string} text "22-7", "22:30-6:45" @returns {[number, number]|null} minutes of the day, from and until */
export function readHours(text) {
  const found = /^(\d{1,2})(?::(\d\d))?-(\d{1,2})(?::(\d\d))?$/.exec(text ?? '');
  if (!found) return null;
  const minutes = [0, 2].map((i) => Number(found[i + 1]) * 60 + Number(found[i + 2] ?? 0));
  return minutes.every((each) => each <= 1440) ? minutes : null;
}

/** Whether the minute of the day lies in the hours, which may go over midnight. */
export const isWithin = ([from, until], minute) =>
  (from <= until ? minute >= from && minute < until : minute >= from || minute < until);

/** @param {string} address of the page */
export function readWish(address) {
  const query = new URL(address).searchParams;
  return {
    room: query.get('room'),
    lang: query.get('lang'),
    head: query.get('model'),
    view: query.get('view') ?? 'face',
    clock: query.has('clock') && query.get('clock') !== '0',
    sleep: readHours(query.get('sleep')),
    distance: Number(query.get('distance')) || null,
    recogniser: query.get('recogniser'),
  };
}
