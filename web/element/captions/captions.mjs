// SPDX-License-Identifier: MIT
import { PlainText } from './plain-text.mjs';

export const CAPTION_LEAST_EM = 3.6; // height of the box, two lines
export const CAPTION_CHARACTERS = 84; // two lines of 42, what subtitles use

/**
 * Cuts a stretch of text into pieces that fit a caption, at spaces, after punctuation where there is any late enough.
 * @returns {{start: number, end: number}[]} places in the text, UTF-16
 */
export function cutCaption(text, start, end, size = CAPTION_CHARACTERS) {
  const pieces = [];
  while (start < end) {
    while (start < end && /\s/.test(text[start])) start++;
    let cut = end;
    if (end - start > size) {
      const window = text.slice(start, start + size + 1);
      const clause = /^[^]*[,;:.!?…»”)](?=\s)/.exec(window)?.[0].length ?? 0;
      const space = window.search(/\s\S*$/);
      cut = start + (clause > size / 2 ? clause : space > 0 ? space : size);
      if (/[\uDC00-\uDFFF]/.test(text[cut] ?? '')) cut--; // not between the halves of a character
    }
    let stop = cut;
    while (stop > start && /\s/.test(text[stop - 1])) stop--;
    if (stop > start) pieces.push({ start, end: stop });
    start = cut;
  }
  return pieces;
}

/**
 * Captions of one utterance: takes words as they are heard and returns the line to show.
 */
export class CaptionTrack {
  /** @param {string} source as it was given to be spoken @param {string} [markup] what it is */
  constructor(source, markup) {
    this.plain = new PlainText(source, markup);
    this.text = this.plain.text;
    this.heardOf = { start: 0, end: 0 }; // the sentence
    this.cut = { size: 0, pieces: [] };
    this.word = null;
  }

  /** @param {{utf16_start: number, utf16_end: number}} place */
  sentence(place) {
    this.heardOf = { start: this.plain.at(place.utf16_start), end: this.plain.at(place.utf16_end) };
    this.cut = { size: 0, pieces: [] };
    this.word = null;
  }

  /** @param {{utf16_start: number, utf16_end: number}} place */
  heard(place) {
    this.word = { start: this.plain.at(place.utf16_start), end: this.plain.at(place.utf16_end) };
  }

  /**
   * Returns the line to show: its words before, at and after the current one, or null when there is none.
   * @param {number} [size] characters that fit
   */
  lineOf(size = CAPTION_CHARACTERS) {
    if (this.cut.size !== size) this.cut = { size, pieces: cutCaption(this.text, this.heardOf.start, this.heardOf.end, size) };
    const { pieces } = this.cut;
    if (!pieces.length) return null;
    const { start: from, end: to } = this.word ?? pieces[0];
    const piece = pieces.find((p) => from < p.end && to > p.start) ?? pieces[pieces.length - 1];
    const clip = (place) => Math.min(piece.end, Math.max(piece.start, place));
    const [begin, end] = this.word ? [clip(from), clip(to)] : [piece.start, piece.start];
    return {
      said: this.text.slice(piece.start, begin),
      word: this.text.slice(begin, end),
      rest: this.text.slice(end, piece.end),
    };
  }
}

/** Captions that the caller supplies, for a voice without a text: shows the last characters that fit. */
export class GivenCaptions {
  #text = null;

  /** @param {() => string} [known] what is shown as long as nothing is given */
  constructor(known = () => '') {
    this.known = known;
  }

  /** @param {string|null} text in place of the one before */
  give(text) {
    this.#text = text;
  }

  lineOf(size) {
    const text = this.#text ?? this.known(), piece = cutCaption(text, 0, text.length, size).at(-1);
    return piece ? { said: '', word: '', rest: text.slice(piece.start, piece.end) } : null;
  }
}

/** The same of an utterance whose text is not known before its sentences are heard. */
export class HeardCaptions {
  constructor(markup) {
    this.markup = markup;
    this.track = null;
    this.base = 0;
  }

  /** @param {{text: string, utf16_start: number, utf16_end: number}} message */
  sentence(message) {
    this.track = new CaptionTrack(message.text, this.markup);
    this.base = message.utf16_start;
    this.track.sentence(this.#shifted(message));
  }

  /** @param {{utf16_start: number, utf16_end: number}} place */
  heard(place) {
    this.track?.heard(this.#shifted(place));
  }

  lineOf(size) {
    return this.track?.lineOf(size) ?? null;
  }

  #shifted({ utf16_start, utf16_end }) {
    return { utf16_start: utf16_start - this.base, utf16_end: utf16_end - this.base };
  }
}
