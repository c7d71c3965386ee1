// SPDX-License-Identifier: GPL-3.0-or-later
// Checks the lips of a .fap in each sound: contacts and openings at the times of the phones.
export const MNS = 21 / 1024; // mm of the modelled speaker per unit of the lip FAPs

const labials = ['p', 'b', 'm'];
const labiodentals = ['f', 'v'];
const openVowels = ['a', 'ɐ', 'ɑ', 'æ', 'ʌ', 'ɛ', 'ɔ'];

/** Constraint of a phone: 'lips' closed, lip at the 'teeth', an 'open' vowel, or nothing. */
export function kindOf({ ipa }) {
  const letter = [...ipa][0];
  return labials.includes(letter) ? 'lips' : labiodentals.includes(letter) ? 'teeth' : openVowels.includes(letter) ? 'open' : undefined;
}

/** mm between the inner contours; on film people's lips are 1.5 to 2.3 mm apart in /f v/, and round borders hide 0.9 of it. */
const GAP = [2.4, 3.2];
const apart = (f) => -(f[4] + f[5]) * MNS;

export const isClosed = (f) => f[4] + f[5] >= 0 && f[8] + f[10] >= 0 && f[9] + f[11] >= 0;

/** The frames displayed while a phone sounds; each stays until the next. */
export function shownWithin({ start, end }, fps) {
  const first = Math.floor(start * fps + 1e-6);
  return { first, end: Math.max(first + 1, Math.ceil(end * fps - 1e-6)) };
}

/** Contacts may lead the sound by 40 ms and lag by 60 (LUCIA, chapter 1); this allows half of that, s. */
const SLACK = 0.02;

/** Shorter vowels, in s, have no time to open between two contacts of 42 ms each with 10 ms transitions. */
export const SHORT = 0.035;

/** Counts contacts and openings over phones ({ipa, start, end}) and the frames displayed with them. */
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
      const met = within.some((f) => f[5] * MNS >= -1.52 && f[16] * MNS <= -1.58 && apart(f) >= GAP[0] && apart(f) <= GAP[1]);
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
