// SPDX-License-Identifier: GPL-3.0-or-later
// What the lips of a .fap do in each sound: contacts and openings, by the phones' own times.
export const MNS = 21 / 1024; // mm of the modelled speaker for a unit of the lips' FAPs

const labials = ['p', 'b', 'm'];
const labiodentals = ['f', 'v'];
const openVowels = ['a', 'ɐ', 'ɑ', 'æ', 'ʌ', 'ɛ', 'ɔ'];

/** What a phone asks of the lips: 'lips' that close, the lip at the 'teeth', an 'open' vowel, or nothing that is looked at. */
export function kindOf({ ipa }) {
  const letter = [...ipa][0];
  return labials.includes(letter) ? 'lips' : labiodentals.includes(letter) ? 'teeth' : openVowels.includes(letter) ? 'open' : undefined;
}

export const isClosed = (f) => f[4] + f[5] >= 0 && f[8] + f[10] >= 0 && f[9] + f[11] >= 0;

/** The frames that are on the screen while a phone sounds: each until the next one comes. */
export function shownWithin({ start, end }, fps) {
  const first = Math.floor(start * fps + 1e-6);
  return { first, end: Math.max(first + 1, Math.ceil(end * fps - 1e-6)) };
}

/** Contacts may lead the sound by 40 ms and lag by 60 (LUCIA, chapter 1); frames are looked at in half of that. */
const SLACK = 0.02;

/** Shorter vowels have no time between two contacts, which last 42 ms each and are felt for 10 ms on either side. */
export const SHORT = 0.035;

/** Counts over phones ({ipa, start, end}) and the frames that show them. */
export function readMouth(phones, { fps, frames }) {
  const out = { lips: 0, closed: 0, teeth: 0, met: 0, open: 0, gaps: [], misses: [] };
  phones.forEach((phone) => {
    const kind = kindOf(phone);
    const within = frames.slice(Math.max(0, Math.ceil((phone.start - SLACK) * fps)), Math.floor((phone.end + SLACK) * fps) + 1);
    if (kind === 'lips') {
      const closed = within.some(isClosed);
      out.lips++;
      out.closed += closed;
      if (!closed) out.misses.push(phone);
    } else if (kind === 'teeth') {
      const met = within.some((f) => f[5] * MNS >= -1.72 && f[16] * MNS <= -1.58);
      out.teeth++;
      out.met += met;
      if (!met) out.misses.push(phone);
    } else if (kind === 'open' && phone.end > phone.start) {
      const inside = frames.slice(Math.max(0, Math.round(phone.start * fps)), Math.round(phone.end * fps) + 1);
      out.open++;
      out.gaps.push({ phone, seconds: phone.end - phone.start, mm: Math.max(...inside.map((f) => -(f[4] + f[5]) * MNS)) });
    }
  });
  return out;
}

export function addMouth(sum, part) {
  for (const key of ['lips', 'closed', 'teeth', 'met', 'open']) sum[key] = (sum[key] ?? 0) + part[key];
  for (const key of ['gaps', 'misses']) sum[key] = (sum[key] ?? []).concat(part[key]);
  return sum;
}
