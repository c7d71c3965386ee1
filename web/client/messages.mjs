// SPDX-License-Identifier: MIT
// The types of all messages, from their schemas: what the daemon is tested against.
import { compile } from 'json-schema-to-typescript';
import { readFileSync } from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

const schemas = path.join(path.dirname(fileURLToPath(import.meta.url)), '../../protocol/schema');
const capital = (text) => text[0].toUpperCase() + text.slice(1);

/** A message's schema says by its type what else is in it; one of these for each type is what a type of TypeScript can say. */
function alternatives(side) {
  const { properties, $defs } = JSON.parse(readFileSync(path.join(schemas, `${side}.json`)));
  const types = properties.type.enum;
  // Repeats shared members: a TypeScript type cannot be extended here.
  const whole = ({ allOf = [], properties: members = {}, required = [] }) => {
    const parts = allOf.filter(({ $ref }) => $ref).map(({ $ref }) => whole($defs[$ref.split('/').at(-1)]));
    return {
      members: Object.assign({}, ...parts.map((part) => part.members), members),
      required: [...parts.flatMap((part) => part.required), ...required],
    };
  };
  const message = (type) => {
    const { members, required } = whole($defs[type] ?? {});
    const all = { ...members, type: { const: type } };
    return [type, { title: capital(side) + capital(type), type: 'object', properties: all, required: [...new Set(['type', ...required])] }];
  };
  return {
    title: `${capital(side)}Message`,
    oneOf: types.map((type) => ({ $ref: `#/$defs/${type}` })),
    $defs: { ...$defs, ...Object.fromEntries(types.map(message)) },
  };
}

/**
 * @param {'client'|'server'} side
 * @returns {Promise<string>} a module whose type ClientMessage, or ServerMessage, is any of its messages
 */
export async function messageTypes(side) {
  const options = { bannerComment: '', cwd: schemas, additionalProperties: false, ignoreMinAndMaxItems: true };
  const types = await compile(alternatives(side), side, options);
  return `// SPDX-License-Identifier: MIT\n${types}`;
}
