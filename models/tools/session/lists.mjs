// SPDX-License-Identifier: GPL-3.0-or-later
/** Lists of what is to be said in a recording session: those of models/sessions, or a text with an item in each line. */
import fs from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

const MOST = { items: 5000, bytes: 1 << 20, text: 400, repetitions: 50 };
const folder = fileURLToPath(new URL('../../sessions', import.meta.url));

export class ListError extends Error {}

export const listNames = () => fs.readdirSync(folder).filter((name) => name.endsWith('.json')).map((name) => name.slice(0, -5)).sort();
export const pageText = () => fs.readFileSync(path.join(folder, 'page.html'), 'utf8');

function readText(file) {
  if (fs.statSync(file).size > MOST.bytes) throw new ListError(`${file}: more than ${MOST.bytes >> 20} MB`);
  return fs.readFileSync(file, 'utf8');
}

function check(file, items) {
  const seen = new Set();
  if (!items.length) throw new ListError(`${file}: no items`);
  if (items.length > MOST.items) throw new ListError(`${file}: more than ${MOST.items} items`);
  for (const [i, { name, text }] of items.entries()) {
    if (typeof name !== 'string' || !/^[\w-]{1,60}$/.test(name)) throw new ListError(`${file}: items[${i}]: the name must be letters, digits, - and _, at most 60`);
    if (typeof text !== 'string' || !text.trim() || text.length > MOST.text) throw new ListError(`${file}: items[${i}]: a text of at most ${MOST.text} characters is wanted`);
    if (seen.has(name)) throw new ListError(`${file}: items[${i}]: the name '${name}' occurs twice`);
    seen.add(name);
  }
}

/** A list of models/sessions by its name, or a file of that form. */
export function readList(name) {
  const file = listNames().includes(name) ? path.join(folder, `${name}.json`) : name;
  let list;
  try {
    list = JSON.parse(readText(file));
  } catch (error) {
    if (error.code === 'ENOENT') throw new ListError(`there is no list '${name}'; there are ${listNames().join(', ')}, and files of that form`);
    throw error instanceof ListError ? error : new ListError(`${file}: ${error.message}`);
  }
  const { lang, title = path.basename(file, '.json'), repetitions = 1, items } = list ?? {};
  if (typeof lang !== 'string' || !/^[A-Za-z]{2,3}(-[A-Za-z0-9]{1,8})*$/.test(lang)) throw new ListError(`${file}: lang: a language tag is wanted`);
  if (typeof title !== 'string') throw new ListError(`${file}: title: a text is wanted`);
  if (!Number.isInteger(repetitions) || repetitions < 1 || repetitions > MOST.repetitions) throw new ListError(`${file}: repetitions: 1 to ${MOST.repetitions} are possible`);
  if (!Array.isArray(items)) throw new ListError(`${file}: items: a list is wanted`);
  check(file, items);
  return { lang, title, repetitions, items: items.map(({ name: item, text, ipa, note }) => ({ name: item, text, ipa, note })) };
}

/** A text with an item in each line: names are numbers. */
export function readLines(file, lang) {
  const lines = readText(file).split(/\r?\n/).map((line) => line.trim()).filter(Boolean);
  const digits = String(lines.length).length;
  const items = lines.map((text, i) => ({ name: String(i + 1).padStart(digits, '0'), text }));
  check(file, items);
  return { lang, title: path.basename(file, path.extname(file)), repetitions: 1, items };
}
