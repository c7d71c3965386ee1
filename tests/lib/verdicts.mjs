// SPDX-License-Identifier: GPL-3.0-or-later
// What a schema and the reader of the same files say of broken ones.
import fs from 'node:fs';
import path from 'node:path';
import Ajv from 'ajv/dist/2020.js';
import { root } from './daemon.mjs';

export const json = (file) => JSON.parse(fs.readFileSync(path.join(root, file), 'utf8'));

/** [["groups", "a"], ...]: as the readers write it, and cut as they cut it. */
const place = (steps) => steps.map((step, i) => (/^\d+$/.test(step) ? `[${step}]` : i ? `.${step}` : step)).join('');
const steps = (error) => {
  const { missingProperty, additionalProperty, propertyName } = error.params;
  const inner = missingProperty ?? additionalProperty ?? propertyName;
  return [...error.instancePath.split('/').slice(1).map((step) => step.replaceAll('~1', '/').replaceAll('~0', '~')), ...(inner === undefined ? [] : [inner])];
};

/** A function that gives the places of a document that the schema (or its file) refuses; none when it takes the document. */
export function schema(from) {
  const check = new Ajv({ strict: false, allErrors: true }).compile(typeof from === 'string' ? json(from) : from);
  return (document) => (check(document) ? [] : [...new Set(check.errors.map((error) => place(steps(error))))]);
}

/** Do they mean the same? One may say it of what the other's place lies in; the readers cut places off after 63 bytes. */
export function agrees(places, at) {
  const reader = at.replace(/\.(\d+)(?=[.[]|$)/g, '[$1]'); // messages have mix.0.name
  const within = (inner, outer) => (outer === '' && places.length === 1) || inner === outer || (inner.startsWith(outer) && /[.[]/.test(inner[outer.length]));
  const cut = (text) => Buffer.from(text).subarray(0, 63).toString();
  return places.some((one) => within(reader, one) || within(one, reader) || cut(one).startsWith(reader));
}

/** The broken documents of a kind: tests/corpus/README.md. */
export function corpus(kind) {
  const folder = path.join('tests/corpus', kind);
  return fs.readdirSync(path.join(root, folder)).filter((name) => name.endsWith('.json')).map((name) => ({ name: name.replace(/\.json$/, ''), readerOnly: name.endsWith('.reader.json'), ...json(path.join(folder, name)) }));
}
