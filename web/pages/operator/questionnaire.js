// SPDX-License-Identifier: MIT
// A questionnaire and its results (schema questionnaire.json): reading, counting, plotting.
import { writeTable } from './scene.js';

const MOST = { items: 100, scale: 8 };
const isText = (value) => typeof value === 'string' && value.trim().length > 0;
const fail = (place, what) => {
  throw Object.assign(new Error(`${place}: ${what}`), { place, what });
};

const isScale = (scale) => Array.isArray(scale) && scale.length > 1 && scale.length <= MOST.scale && scale.every(isText);

/**
 * @typedef {{id: string, text: string, scale?: string[], seconds?: number}} Item
 * @typedef {{id: string, reason: string, choice?: number, text?: string, seconds?: number}} Answer
 * @param {unknown} json @returns {{title: string, lang?: string, items: Item[], answers?: Answer[]}}
 * @throws {Error} with the place: "items.3.scale"
 */
export function readQuestionnaire(json) {
  if (!isText(json?.title)) fail('title', 'text');
  const { items, answers } = json;
  if (!Array.isArray(items) || !items.length || items.length > MOST.items) fail('items', 'items');
  const ids = new Set();
  items.forEach((item, i) => {
    if (!isText(item?.id) || ids.has(item.id)) fail(`items.${i}.id`, 'id');
    ids.add(item.id);
    if (!isText(item.text)) fail(`items.${i}.text`, 'text');
    const { scale, seconds } = item;
    if (scale !== undefined && !isScale(scale)) fail(`items.${i}.scale`, 'texts');
    if (seconds !== undefined && !(Number.isInteger(seconds) && seconds >= 1 && seconds <= 3600)) fail(`items.${i}.seconds`, 'seconds');
  });
  if (answers !== undefined && !(Array.isArray(answers) && answers.every((answer) => ids.has(answer?.id)))) fail('answers', 'answers');
  return json;
}

/**
 * @typedef {{label: string, count: number, percent: number}} Count
 * @typedef {{id: string, text: string, n: number, counts: Count[], mean: number|null, words: string[]}} Tally
 *
 * Counts the answers of several people.
 * @param {Item[]} items @param {Answer[][]} people
 * @returns {Tally[]}
 */
export function tally(items, people) {
  return items.map(({ id, text, scale = [] }) => {
    const given = people.map((answers) => answers.find((answer) => answer.id === id)).filter(Boolean);
    const chosen = given.filter(({ choice }) => Number.isInteger(choice) && choice < scale.length);
    const n = scale.length ? chosen.length : given.filter((answer) => isText(answer.text)).length;
    const counts = scale.map((label, choice) => {
      const count = chosen.filter((answer) => answer.choice === choice).length;
      return { label, count, percent: n ? (100 * count) / n : 0 };
    });
    const mean = scale.length && n ? chosen.reduce((sum, { choice }) => sum + choice + 1, 0) / n : null;
    return { id, text, n, counts, mean, words: scale.length ? [] : given.map((answer) => answer.text).filter(isText) };
  });
}

/** All answers as a table: a row for each person and item. @param {Item[]} items @param {Answer[][]} people */
export const answersCsv = (items, people) => writeTable([['person', 'id', 'question', 'reason', 'choice', 'answer', 'seconds'],
  ...people.flatMap((answers, i) => answers.map(({ id, reason, choice, text, seconds }) =>
    [i + 1, id, items.find((item) => item.id === id)?.text ?? '', reason, choice === undefined ? '' : choice + 1, text ?? '', seconds ?? ''].map(String)))]);

const SVG = 'http://www.w3.org/2000/svg';
const [WIDTH, ROW, LEFT, BAR] = [480, 26, 180, 220];

function node(name, attributes, text) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== undefined) element.textContent = text;
  return element;
}

const shortened = (text, most) => (text.length > most ? `${text.slice(0, most - 1)}…` : text);

/** The bars of an item on a scale. @param {Tally} item @param {string} lang of numbers @returns {SVGElement} */
export function plot(item, lang) {
  const percent = new Intl.NumberFormat(lang, { maximumFractionDigits: 0 });
  const svg = node('svg', { viewBox: `0 0 ${WIDTH} ${ROW * item.counts.length}`, role: 'img', class: 'plot', xmlns: SVG });
  svg.append(node('title', {}, item.text));
  item.counts.forEach(({ label, count, percent: part }, i) => {
    const y = i * ROW, middle = y + ROW / 2;
    svg.append(node('text', { x: LEFT - 8, y: middle, 'text-anchor': 'end', 'dominant-baseline': 'central', 'font-size': 14, fill: 'currentColor' }, shortened(label, 24)),
      node('rect', { x: LEFT, y: y + 4, width: Math.max(1, (BAR * part) / 100), height: ROW - 8, fill: '#2f6db5' }),
      node('text', { x: LEFT + (BAR * part) / 100 + 8, y: middle, 'dominant-baseline': 'central', 'font-size': 14, fill: 'currentColor' }, `${percent.format(part)} % (${count})`));
  });
  return svg;
}
