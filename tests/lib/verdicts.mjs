// SPDX-License-Identifier: GPL-3.0-or-later
// Compares errors of a schema with those of the reader of the same files.
import fs from 'node:fs';
import path from 'node:path';
import Ajv from 'ajv/dist/2020.js';
import { root } from './daemon.mjs';

export const json = (file) => JSON.parse(fs.readFileSync(path.join(root, file), 'utf8'));

/** Formats a path such as ["groups", "a"] like the readers. */
const place = (steps) => steps.map((step, i) => (/^\d+$/.test(step) ? `[${step}]` : i ? `.${step}` : step)).join('');
const steps = (error) => {
  const { missingProperty, additionalProperty, propertyName } = error.params;
  const inner = missingProperty ?? additionalProperty ?? propertyName;
  return [...error.instancePath.split('/').slice(1).map((step) => step.replaceAll('~1', '/').replaceAll('~0', '~')), ...(inner === undefined ? [] : [inner])];
};

/** Returns a function that lists the invalid places of a document by the schema (or its file). */
export function schema(from) {
  const check = new Ajv({ strict: false, allErrors: true }).compile(typeof from === 'string' ? json(from) : from);
  return (document) => (check(document) ? [] : [...new Set(check.errors.map((error) => place(steps(error))))]);
}

/** Tells whether both report the same place. One may name a parent of the other's; readers truncate places to 63 bytes. */
export function agrees(places, at) {
  const reader = at.replace(/\.(\d+)(?=[.[]|$)/g, '[$1]'); // messages have mix.0.name
  const within = (inner, outer) => (outer === '' && places.length === 1) || inner === outer || (inner.startsWith(outer) && /[.[]/.test(inner[outer.length]));
  const cut = (text) => Buffer.from(text).subarray(0, 63).toString();
  return places.some((one) => within(reader, one) || within(one, reader) || cut(one).startsWith(reader));
}

/** The invalid documents of a kind (tests/corpus/README.md). */
export function corpus(kind) {
  const folder = path.join('tests/corpus', kind);
  return fs.readdirSync(path.join(root, folder)).filter((name) => name.endsWith('.json')).map((name) => ({ name: name.replace(/\.json$/, ''), readerOnly: name.endsWith('.reader.json'), ...json(path.join(folder, name)) }));
}
