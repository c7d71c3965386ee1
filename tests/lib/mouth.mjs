// SPDX-License-Identifier: GPL-3.0-or-later
// What the lips of a .fap do in each sound: contacts and openings, by the phones' own times.
export const MNS = 21 / 1024; // mm of the modelled speaker for a unit of the lips' FAPs

const labials = ['p', 'b', 'm'];
const labiodentals = ['f', 'v'];
const openVowels = ['a', 'ɐ', 'ɑ', 'æ', 'ʌ', 'ɛ', 'ɔ'];

/** Contacts may lead the sound by 40 ms and lag by 60 (LUCIA, chapter 1); frames are looked at in half of that. */
const SLACK = 0.02;

/** Shorter vowels have no time between two contacts, which last 42 ms each and are felt for 10 ms on either side. */
export const SHORT = 0.035;

/** Counts over phones ({ipa, start, end}) and the frames that show them. */
export function readMouth(phones, { fps, frames }) {
  const out = { lips: 0, closed: 0, teeth: 0, met: 0, open: 0, gaps: [], misses: [] };
  phones.forEach((phone) => {
    const letter = [...phone.ipa][0];
    const within = frames.slice(Math.max(0, Math.ceil((phone.start - SLACK) * fps)), Math.floor((phone.end + SLACK) * fps) + 1);
    if (labials.includes(letter)) {
      const closed = within.some((f) => f[4] + f[5] >= 0 && f[8] + f[10] >= 0 && f[9] + f[11] >= 0);
      out.lips++;
      out.closed += closed;
      if (!closed) out.misses.push(phone);
    } else if (labiodentals.includes(letter)) {
      const met = within.some((f) => f[5] * MNS >= -1.72 && f[16] * MNS <= -1.58);
      out.teeth++;
      out.met += met;
      if (!met) out.misses.push(phone);
    } else if (openVowels.includes(letter) && phone.end > phone.start) {
      const inside = frames.slice(Math.max(0, Math.round(phone.start * fps)), Math.round(phone.end * fps) + 1);
      out.open++;
      out.gaps.push({ phone, seconds: phone.end - phone.start, mm: Math.max(...inside.map((f) => -(f[4] + f[5]) * MNS)) });
    }
  });
  return out;
}

export function addMouth(sum, part) {
  for (const key of ['lips', 'closed', 'teeth', 'met', 'open']) sum[key] = (sum[key] ?? 0) + part[key];
  sum.gaps = (sum.gaps ?? []).concat(part.gaps);
  return sum;
}
