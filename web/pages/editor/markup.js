// SPDX-License-Identifier: MIT
// Converts a text with marks to APML, JSML and SSML, as far as each can express them, and back. See protocol/markup.md.
import { KINDS } from './marks.js';

const SSML = 'http://www.w3.org/2001/10/synthesis';
const EMOTIONML = 'http://www.w3.org/2009/10/emotionml';
const GESTURES = 'https://faccia.invalid/gesture';
const JSML_EMOTIONS = { anger: 'ANGER', fear: 'AFRAID', sadness: 'SAD', joy: 'HAPPY', surprise: 'SURPRISED', disgust: 'DISGUSTED' };
const LEVELS = { strong: 'strong', moderate: 'medium', reduced: 'weak' }; // as APML calls them

const escaped = (text) => text.replace(/[&<>"]/g, (c) => ({ '&': '&amp;', '<': '&lt;', '>': '&gt;', '"': '&quot;' })[c]);

/** The form of a mark in each markup: [before, after], or the text at a position; null: it has none. */
const dialects = {
  apml: {
    open: (lang) => `<apml xml:lang="${escaped(lang)}"><performative type="inform">`,
    close: '</performative></apml>',
    voice: () => null,
    affect: (value) => [`<rheme affect="${value}">`, '</rheme>'],
    gaze: (value) => [`<emphasis level="weak" deictic="${value}">`, '</emphasis>'],
    emphasis: (value) => [`<emphasis level="${LEVELS[value]}">`, '</emphasis>'],
    pause: (value) => `<pause sec="${value / 1000}"/>`,
    gesture: (value) => `<gesture name="${value}"/>`,
  },
  jsml: {
    open: (lang) => `<jsml xml:lang="${escaped(lang)}">`,
    close: '</jsml>',
    voice: (value) => [`<voice voice="${escaped(value)}">`, '</voice>'],
    affect: (value) => (JSML_EMOTIONS[value] ? [`<${JSML_EMOTIONS[value]}>`, `</${JSML_EMOTIONS[value]}>`] : null),
    gaze: (value) => [`<gesture name="look-${value}">`, '</gesture>'],
    emphasis: (value) => [`<EMP LEVEL="${value}">`, '</EMP>'],
    pause: (value) => `<BREAK MSECS="${value}"/>`,
    gesture: (value) => `<gesture name="${value}"/>`,
  },
  ssml: {
    open: (lang) => `<speak version="1.1" xmlns="${SSML}" xmlns:faccia="${GESTURES}" xml:lang="${escaped(lang)}">`,
    close: '</speak>',
    voice: (value) => [`<voice name="${escaped(value)}">`, '</voice>'],
    affect: (value) => [`<emotion xmlns="${EMOTIONML}"><category name="${value}"/>`, '</emotion>'],
    gaze: (value) => [`<faccia:gesture name="look-${value}">`, '</faccia:gesture>'],
    emphasis: (value) => [`<emphasis level="${value}">`, '</emphasis>'],
    pause: (value) => `<break time="${value}ms"/>`,
    gesture: (value) => `<faccia:gesture name="${value}"/>`,
  },
};

export const MARKUPS = Object.keys(dialects);

/**
 * @param {'apml'|'jsml'|'ssml'} markup @param {string} text
 * @param {{kind: string, value: *, from: number, to: number}[]} marks @param {string} lang
 * @returns {{code: string, unsaid: object[]}} and the marks that this markup cannot say
 */
export function write(markup, text, marks, lang) {
  const dialect = dialects[markup];
  const unsaid = marks.filter(({ kind, value }) => dialect[kind](value) === null);
  const said = marks.filter((mark) => !unsaid.includes(mark));
  const points = said.filter(({ kind }) => !KINDS.includes(kind));
  const given = new Set();
  const at = (place) => {
    const here = points.filter((point) => point.from === place && !given.has(point));
    for (const point of here) given.add(point);
    return here.map(({ kind, value }) => dialect[kind](value)).join('');
  };
  const plain = (from, to) => {
    let out = at(from);
    for (let k = from; k < to; k++) out += escaped(text[k]) + (k + 1 < to ? at(k + 1) : '');
    return out;
  };
  const run = (level, from, to) => {
    if (level === KINDS.length) return plain(from, to);
    let [out, done] = ['', from];
    for (const mark of said.filter(({ kind, from: a, to: b }) => kind === KINDS[level] && a < to && b > from)) {
      const [a, b] = [Math.max(mark.from, from), Math.min(mark.to, to)];
      if (a > done) out += run(level + 1, done, a);
      const [before, after] = dialect[mark.kind](mark.value);
      out += before + run(level + 1, a, b) + after;
      done = b;
    }
    return done < to ? out + run(level + 1, done, to) : out;
  };
  return { code: `${dialect.open(lang)}${run(0, 0, text.length)}${at(text.length)}${dialect.close}\n`, unsaid };
}

const entities = { lt: '<', gt: '>', amp: '&', quot: '"', apos: "'" };
const character = (name) => {
  const number = name.startsWith('#x') ? parseInt(name.slice(2), 16) : parseInt(name.slice(1), 10);
  return name.startsWith('#') ? String.fromCodePoint(number >= 0 && number <= 0x10ffff ? number : 0xfffd) : (entities[name] ?? '');
};
const unescaped = (text) => text.replace(/&(#?\w+);/g, (_, name) => character(name));

// a declaration or comment; a tag: slash, name, attributes, slash; text
const ATTRIBUTES = /(?:\s+[\w:.-]+\s*=\s*(?:"[^"]*"|'[^']*'))*/.source;
const TOKEN = new RegExp(String.raw`(<\?[^]*?\?>|<!--[^]*?-->|<![^>]*>)|<(\/?)([\w:.-]+)(${ATTRIBUTES})\s*(\/?)>|([^<]+|<)`, 'g');
const ATTRIBUTE = /([\w:.-]+)\s*=\s*(?:"([^"]*)"|'([^']*)')/g;

/** Reads an element of any of the three markups as a mark; null: unknown to the editor. */
function asked(name, attributes) {
  const { level = 'moderate' } = attributes;
  const gesture = attributes.name ?? '';
  const jsml = Object.entries(JSML_EMOTIONS).find(([, element]) => element.toLowerCase() === name)?.[0];
  const milliseconds = (time) => Math.round(parseFloat(time) * (/ms$/.test(time) ? 1 : 1000));
  if (jsml) return { kind: 'affect', value: jsml };
  if (name === 'rheme' || name === 'theme') return attributes.affect ? { kind: 'affect', value: attributes.affect } : null;
  if (name === 'emphasis' && attributes.deictic) return { kind: 'gaze', value: attributes.deictic };
  if (name === 'emphasis' || name === 'emp') {
    const known = Object.keys(LEVELS).find((each) => each === level || LEVELS[each] === level);
    return { kind: 'emphasis', value: known ?? 'moderate' };
  }
  if (name === 'voice') {
    const voice = attributes.name ?? attributes.voice;
    return voice ? { kind: 'voice', value: voice } : null;
  }
  if (name === 'pause') return { kind: 'pause', value: milliseconds(attributes.sec ?? '0.4') };
  if (name === 'break') return { kind: 'pause', value: milliseconds(attributes.msecs ? `${attributes.msecs}ms` : (attributes.time ?? '400ms')) };
  if (name === 'gesture' && /^look-(left|right|up|down)$/.test(gesture)) return { kind: 'gaze', value: gesture.slice(5) };
  if (name === 'gesture') return { kind: 'gesture', value: gesture };
  return null;
}

const KNOWN = ['apml', 'performative', 'rheme', 'theme', 'jsml', 'speak', 'emotion', 'category'];

/**
 * Reads what `write` wrote, and of other documents what it understands; text alone is text.
 * @param {string} source
 * @returns {{text: string, marks: object[], lang: string|null, lost: string[]}} lost: the elements that are not kept
 */
export function read(source) {
  if (!/^\s*</.test(source)) return { text: source, marks: [], lang: null, lost: [] };
  const marks = [];
  const open = [];
  const lost = new Set();
  let [text, lang] = ['', null];
  for (const [, other, closing, prefixed, inside, empty, plain] of source.matchAll(TOKEN)) {
    if (other) continue;
    if (plain !== undefined) {
      text += unescaped(plain);
      continue;
    }
    const name = prefixed.replace(/^.*:/, '').toLowerCase();
    if (closing) {
      const mark = open.pop();
      if (mark?.kind) marks.push({ ...mark, to: ['pause', 'gesture'].includes(mark.kind) ? mark.from : text.length });
      continue;
    }
    const pairs = [...inside.matchAll(ATTRIBUTE)].map(([, key, a, b]) => [key.toLowerCase(), unescaped(a ?? b)]);
    const attributes = Object.fromEntries(pairs);
    lang ??= attributes['xml:lang'] ?? null;
    const mark = asked(name, attributes);
    if (!mark && !KNOWN.includes(name)) lost.add(prefixed);
    if (name === 'category' && open.length) Object.assign(open.at(-1), { kind: 'affect', value: attributes.name });
    if (!empty) open.push({ ...mark, from: text.length });
    else if (mark) marks.push({ ...mark, from: text.length, to: text.length });
  }
  const lead = text.length - text.trimStart().length;
  const whole = text.trim();
  const place = (at) => Math.min(whole.length, Math.max(0, at - lead));
  const placed = marks.map((mark) => ({ ...mark, from: place(mark.from), to: place(mark.to) }));
  const kept = placed.filter(({ kind, from, to, value }) => value && (from < to || !KINDS.includes(kind)));
  return { text: whole, marks: kept.sort((a, b) => a.from - b.from || b.to - a.to), lang, lost: [...lost] };
}
