// SPDX-License-Identifier: MIT
// A scene: the lines that an operator has prepared, with variants, moods, answers and where they lead (schema scene.json).

const MOST = { lines: 500, variants: 20, choices: 8, backdrop: 2000 };
const COLUMNS = ['id', 'text', 'variants', 'mood', 'choices', 'next'];

const isText = (value) => typeof value === 'string' && value.trim().length > 0;
const fail = (place, what) => {
  throw Object.assign(new Error(`${place}: ${what}`), { place, what });
};

function readChoice(choice, place) {
  if (!isText(choice?.text)) fail(`${place}.text`, 'text');
  if (choice.next !== undefined && !isText(choice.next)) fail(`${place}.next`, 'id');
  return { text: choice.text.trim(), ...(choice.next === undefined ? {} : { next: choice.next }) };
}

function readLine(line, place) {
  if (!isText(line?.id)) fail(`${place}.id`, 'id');
  if (!isText(line.text)) fail(`${place}.text`, 'text');
  const { variants = [], mood = '', choices = [], next } = line;
  if (!Array.isArray(variants) || variants.length > MOST.variants || !variants.every(isText)) fail(`${place}.variants`, 'texts');
  if (typeof mood !== 'string') fail(`${place}.mood`, 'text');
  if (!Array.isArray(choices) || choices.length > MOST.choices) fail(`${place}.choices`, 'choices');
  if (next !== undefined && !isText(next)) fail(`${place}.next`, 'id');
  return {
    id: line.id, text: line.text.trim(), variants: variants.map((text) => text.trim()), mood,
    choices: choices.map((choice, i) => readChoice(choice, `${place}.choices.${i}`)), ...(next === undefined ? {} : { next }),
  };
}

/**
 * @typedef {{id: string, text: string, variants: string[], mood: string, choices: Choice[], next?: string}} Line
 * @typedef {{text: string, next?: string}} Choice
 *
 * @param {unknown} json @returns {{title: string, backdrop?: string, lines: Line[]}}
 * @throws {Error} with the place: "lines.3.next"
 */
export function readScene(json) {
  if (!json || typeof json !== 'object' || !Array.isArray(json.lines) || json.lines.length > MOST.lines) fail('lines', 'lines');
  if (json.title !== undefined && typeof json.title !== 'string') fail('title', 'text');
  const lines = json.lines.map((line, i) => readLine(line, `lines.${i}`));
  const ids = new Set();
  lines.forEach(({ id }, i) => (ids.has(id) ? fail(`lines.${i}.id`, 'twice') : ids.add(id)));
  lines.forEach(({ next, choices }, i) => {
    if (next !== undefined && !ids.has(next)) fail(`lines.${i}.next`, 'nowhere');
    choices.forEach((choice, k) => choice.next !== undefined && !ids.has(choice.next) && fail(`lines.${i}.choices.${k}.next`, 'nowhere'));
  });
  const { title = '', backdrop } = json;
  if (backdrop !== undefined && (typeof backdrop !== 'string' || backdrop.length > MOST.backdrop)) fail('backdrop', 'text');
  return { title, ...(backdrop ? { backdrop } : {}), lines };
}

/** Fields of a table (RFC 4180). @param {string} text @returns {string[][]} */
export function readTable(text) {
  const rows = [[]];
  let field = '', quoted = false, at = 0;
  const source = text.replace(/^\uFEFF/, '');
  const close = () => {
    rows.at(-1).push(asWritten(field));
    field = '';
  };
  for (; at < source.length; at++) {
    const c = source[at];
    if (quoted && c === '"' && source[at + 1] === '"') field += source[++at];
    else if (c === '"' && (quoted || !field)) quoted = !quoted;
    else if (!quoted && c === ',') close();
    else if (!quoted && (c === '\n' || c === '\r')) {
      if (c === '\r' && source[at + 1] === '\n') at++;
      close();
      rows.push([]);
    } else field += c;
  }
  close();
  return rows.filter((row) => row.some((each) => each !== ''));
}

// Spreadsheets evaluate cells that begin like this as formulas, quoted or not; a leading apostrophe makes them text.
// readTable removes it.
const harmless = (field) => (/^'*[=+\-@\t\r]/.test(field) ? `'${field}` : field);
const asWritten = (field) => (/^'+[=+\-@\t\r]/.test(field) ? field.slice(1) : field);

/** @param {string[][]} rows */
export const writeTable = (rows) =>
  rows.map((row) => row.map(harmless).map((field) => (/[",\r\n]/.test(field) ? `"${field.replaceAll('"', '""')}"` : field)).join(',')).join('\r\n') + '\r\n';

const parts = (text) => (text ?? '').split('|').map((each) => each.trim()).filter(Boolean);

/** A scene as a table: variants between `|`, choices as `text > id` between `|`. */
export const writeCsv = ({ lines }) => writeTable([COLUMNS, ...lines.map((line) => [
  line.id, line.text, line.variants.join(' | '), line.mood,
  line.choices.map(({ text, next }) => (next === undefined ? text : `${text} > ${next}`)).join(' | '), line.next ?? '',
])]);

/** @param {string} text of a table whose first row names its columns; `text` is required */
export function readCsv(text) {
  const [head = [], ...rows] = readTable(text);
  const column = Object.fromEntries(head.map((name, i) => [name.trim().toLowerCase(), i]));
  if (column.text === undefined) fail('1', 'column');
  return readScene({
    lines: rows.map((row, i) => {
      const of = (name) => row[column[name]]?.trim() ?? '';
      return {
        id: of('id') || String(i + 1), text: of('text'), variants: parts(of('variants')), mood: of('mood'),
        choices: parts(of('choices')).map((each) => {
          const [what, next] = each.split('>').map((side) => side.trim());
          return next ? { text: what, next } : { text: what };
        }),
        ...(of('next') ? { next: of('next') } : {}),
      };
    }),
  });
}
