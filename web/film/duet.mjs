// SPDX-License-Identifier: MIT
// Two heads that talk with each other on a film: each shows what its persons say and listens to the other, as two elements of a
// page do.
import { FAP_VALUES } from '../element/face/face-track.mjs';
import { Company } from '../element/face/company.mjs';
import { FaceMixer } from '../element/face/face-mixer.mjs';

const EARLY_S = 0.25; // before its first word, the face of a speaker prepares
const SENTENCE_END = /[.!?…]["'»”’)\s]*$/u;

const seconds = (time) => time.split(':').reduce((sum, part) => 60 * sum + Number(part), 0);
const plain = (text) => text.replace(/<[^>]*>/g, '').replace(/&lt;/g, '<').replace(/&gt;/g, '>').replace(/&amp;/g, '&');

/**
 * Reads captions (WebVTT).
 * @param {string} text @returns {{start: number, end: number, who: string, text: string}[]} who: '' for nobody in particular
 */
export function readWords(text) {
  return text.replace(/\r\n?/g, '\n').split(/\n\n+/).flatMap((block) => {
    const [, start, end, said] = /(?:^|\n)([\d:.]+) --> ([\d:.]+)[^\n]*\n([^]*)/.exec(block) ?? [];
    if (!start) return [];
    const [, who = ''] = /<v(?:\.[^\s>]*)?\s+([^>]*)>/.exec(said) ?? [];
    return [{ start: seconds(start), end: seconds(end), who: plain(who), text: plain(said) }];
  });
}

/**
 * Seats those who speak: who has no place takes that of the one who has been silent longer. What nobody in particular says is
 * the first head's.
 * @param {{who: string}[]} cues @returns {number[]} for each the place, 0 or 1
 */
export function seated(cues) {
  const places = [{ who: null, turn: 0 }, { who: null, turn: 0 }];
  return cues.map(({ who }, i) => {
    if (!who) return 0;
    let place = places.findIndex((one) => one.who === who);
    if (place < 0) place = places[0].turn <= places[1].turn ? 0 : 1;
    places[place] = { who, turn: i + 1 };
    return place;
  });
}

/** Numbers from 0 to 1, the same each time (Park and Miller 1988). */
function numbers(seed) {
  let state = seed;
  return () => (state = (state * 48271) % 2147483647) / 2147483647;
}

/** The faces of both heads, picture after picture. */
export class Duet {
  #heads;
  #cue = -1; // that is or was heard

  /**
   * @param {import('../element/face/face-track.mjs').FaceTrack} track of all that is said
   * @param {ReturnType<typeof readWords>} cues @param {boolean} still
   */
  constructor(track, cues, still) {
    const places = seated(cues);
    this.track = track;
    this.still = still;
    const from = (i) => Math.max(cues[i - 1]?.end ?? 0, cues[i].start - EARLY_S);
    this.cues = cues.map((cue, i) => ({ ...cue, place: places[i], from: from(i) }));
    this.#heads = [1, -1].map((side, i) => ({
      side, mixer: new FaceMixer(), company: new Company(numbers(i + 1)), values: new Float32Array(FAP_VALUES),
    }));
  }

  /**
   * The faces at a moment, which must not be before that of the last call.
   * @param {number} time seconds @returns {Float32Array[]} of the left head and the right one
   */
  at(time) {
    while (this.cues[this.#cue + 1]?.from <= time) this.#next(time);
    return this.#heads.map(({ side, mixer, company, values }, i) => {
      const speaks = i === this.speaker;
      mixer.update(1000 * time, speaks ? { track: this.track, seconds: time, running: true } : null);
      values.set(mixer.values);
      if (!this.still) company.add(time, values, { side, speaks, blinks: !speaks });
      return values;
    });
  }

  /** The place of the head that speaks at the moment of the last call, or has spoken. */
  get speaker() {
    return this.cues[Math.max(0, this.#cue)]?.place ?? 0;
  }

  /** Goes on to the next cue: who has heard the one before reacts to it. */
  #next(time) {
    const heard = this.cues[this.#cue++];
    if (heard && SENTENCE_END.test(heard.text)) this.#heads[1 - heard.place].company.heardSentence(time, heard.text);
  }
}
