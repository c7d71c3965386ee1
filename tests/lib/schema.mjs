// SPDX-License-Identifier: GPL-3.0-or-later
import fs from 'node:fs';
import Ajv from 'ajv/dist/2020.js';

const ajv = new Ajv({ strict: false });
const load = (name) => ajv.compile(JSON.parse(fs.readFileSync(new URL(`../../protocol/schema/${name}.json`, import.meta.url))));
const schemas = { client: load('client'), server: load('server'), 'head-model': load('head-model'), pictures: load('pictures'), 'avatar-map': load('avatar-map') };

/** Validates a value by the schema of that name. Returns the errors as text, or null. */
export function violations(name, value) {
  return schemas[name](value) ? null : ajv.errorsText(schemas[name].errors.slice(0, 5));
}
