// SPDX-License-Identifier: GPL-3.0-or-later
// How the sources hang together: what includes what, in which order of stages; names; lengths. All that is against a rule is printed
// at once. There is no list of exceptions.
import assert from 'node:assert/strict';
import path from 'node:path';
import { test } from 'node:test';
import { sources } from '../lib/sources.mjs';

// From below to above: a stage includes those below it, and itself.
const BELOW = {
  protocol: [],
  base: [],
  access: ['base'],
  codec: ['protocol', 'base'],
  markup: ['base'],
  normalize: ['markup', 'base'],
  expression: ['markup', 'protocol', 'base'],
  voice: ['markup', 'base'],
  face: ['voice', 'expression', 'markup', 'protocol', 'base'],
  synthesis: ['codec', 'face', 'voice', 'normalize', 'expression', 'markup', 'protocol', 'base'],
  export: ['synthesis', 'codec', 'face', 'voice', 'markup', 'protocol', 'base'],
  stream: ['export', 'synthesis', 'codec', 'face', 'voice', 'expression', 'markup', 'protocol', 'base'],
  net: ['access', 'stream', 'export', 'synthesis', 'codec', 'expression', 'markup', 'protocol', 'base'],
  align: ['face', 'voice', 'markup', 'base'],
  eval: ['face', 'voice', 'expression', 'protocol', 'base'],
  fit: ['face', 'voice', 'protocol', 'base'],
  plugins: ['align', 'face', 'voice', 'markup', 'base'],
};
BELOW.app = Object.keys(BELOW);

/** Long because it is a table. */
const isTable = ({ name, code }) => {
  const rows = code.split('\n').filter((line) => /^\s*(\[.*\] = )?\{.*\},?\s*$|^\s*"(?:\\.|[^"])*",?\s*$|^\s*[-\d.,x\sa-fA-F{}]+,?\s*$/.test(line) && line.trim() !== '').length;
  return /table|model/.test(path.basename(name)) && rows > code.split('\n').length / 2;
};

const stageOf = (name) => (name.startsWith('protocol/') ? 'protocol' : name.split('/')[1]);
/** x.c, x.h and x_internal.h are one. */
const unitOf = (name) => name.replace(/(_internal)?\.[ch]$/, '');

/** The rules that these files break, each as a line. */
export function broken(files) {
  const known = new Map(files.map((file) => [file.name, file]));
  const includes = new Map(files.map(({ name, text }) => [name, [...text.matchAll(/^#include "([^"]+)"/gm)].map(([, file]) => file)]));
  const lines = [];

  for (const { name } of files)
    for (const file of includes.get(name)) {
      const place = /^(server|protocol)\//.test(file) ? file : path.posix.join(path.dirname(name), file);
      if (!known.has(place)) continue; // made while building
      const [from, to] = [stageOf(name), stageOf(place)];
      if (!(from in BELOW)) lines.push(`stage: ${name} is in a room that has no place in the order`);
      else if (from !== to && !BELOW[from].includes(to)) lines.push(`stage: ${name} (${from}) includes ${file}`);
    }

  const units = new Map();
  for (const { name } of files) {
    const unit = units.get(unitOf(name)) ?? new Set();
    for (const file of includes.get(name)) if (known.has(file) && unitOf(file) !== unitOf(name)) unit.add(unitOf(file));
    units.set(unitOf(name), unit);
  }
  for (const circle of circles(units)) lines.push(`circle: ${circle.join(', ')}`);

  const bases = new Map();
  for (const { name } of files)
    if (name.startsWith('server/')) {
      const key = path.basename(name);
      bases.set(key, [...(bases.get(key) ?? []), name]);
    }
  for (const [, names] of bases) if (names.length > 1) lines.push(`name: ${names.join(', ')}`);
  const folders = new Map();
  for (const { name } of files)
    if (name.startsWith('server/')) {
      const key = path.basename(unitOf(name));
      folders.set(key, (folders.get(key) ?? new Set()).add(path.dirname(name)));
    }
  for (const [name, where] of folders) if (where.size > 1) lines.push(`name: ${name} in ${[...where].join(', ')}`);

  for (const file of files)
    if (file.name.endsWith('.c')) {
      const length = file.text.split('\n').length - 1;
      if (length > 300 && !isTable(file)) lines.push(`length: ${file.name} has ${length} lines`);
    }
  return [...new Set(lines)];
}

/** The strongly connected parts of more than one unit (Tarjan 1972). */
function circles(graph) {
  const [index, low, onStack, stack, found] = [new Map(), new Map(), new Set(), [], []];
  const visit = (node) => {
    index.set(node, index.size);
    low.set(node, index.get(node));
    stack.push(node);
    onStack.add(node);
    for (const next of graph.get(node) ?? []) {
      if (!index.has(next)) visit(next);
      if (onStack.has(next)) low.set(node, Math.min(low.get(node), low.get(next)));
    }
    if (low.get(node) !== index.get(node)) return;
    const part = [];
    let last;
    do {
      last = stack.pop();
      onStack.delete(last);
      part.push(last);
    } while (last !== node);
    if (part.length > 1) found.push(part.sort());
  };
  for (const node of graph.keys()) if (!index.has(node)) visit(node);
  return found;
}

test('includes point one way, names occur once, files are short', () => {
  const files = [...sources('server'), ...sources('protocol')];
  assert.ok(files.length > 300, `${files.length}`);
  const lines = broken(files);
  assert.equal(lines.length, 0, `\n${lines.join('\n')}`);
});

test('no setting is read but by the settings', () => {
  const asked = sources('server').flatMap(({ name, code }) =>
    [...code.matchAll(/\b(?:secure_)?(?:getenv|setenv|putenv)\(("?\w+"?)/g)].map(([, what]) => `${name}: ${what}`),
  );
  // PATH and HOME are the system's; a voice's worker tells the libraries that it loads to be silent
  const others = asked.filter((line) => !/^server\/app\/settings\.c:|: "(?:PATH|HOME|PULSE_SERVER|PULSE_CLIENTCONFIG)"$/.test(line));
  assert.deepEqual(others, []);
});

const file = (name, text) => ({ name, text, code: text });
for (const [what, files, expected] of [
  ['a circle', [file('server/base/a.h', '#include "server/base/b.h"'), file('server/base/b.c', '#include "server/base/c.h"'), file('server/base/c.h', '#include "server/base/a.h"'), file('server/base/b.h', '')], /^circle: server\/base\/a, server\/base\/b, server\/base\/c$/],
  ['no circle: one unit', [file('server/base/a.h', ''), file('server/base/a.c', '#include "server/base/a.h"\n#include "a_internal.h"'), file('server/base/a_internal.h', '#include "server/base/a.h"')], null],
  ['the order', [file('server/net/a.c', '#include "server/face/b.h"'), file('server/face/b.h', '')], /^stage: server\/net\/a\.c \(net\) includes server\/face\/b\.h$/],
  ['a name', [file('server/net/a.c', ''), file('server/face/a.h', '')], /^name: a in server\/net, server\/face$/],
  ['a length', [file('server/net/a.c', 'int x;\n'.repeat(301))], /^length: server\/net\/a\.c has 301 lines$/],
  ['a table', [file('server/net/a_table.c', '    {"x", 1},\n'.repeat(301))], null],
])
  test(`the rules see ${what}`, () => {
    const lines = broken(files);
    if (expected) assert.ok(lines.length === 1 && expected.test(lines[0]), lines.join('\n'));
    else assert.deepEqual(lines, []);
  });
