// SPDX-License-Identifier: GPL-3.0-or-later
// Checks the structure of the sources: include directions, names and lengths. Prints all violations at once.
import assert from 'node:assert/strict';
import path from 'node:path';
import { test } from 'node:test';
import { sources } from '../lib/sources.mjs';

// Layers, from the bottom up: a folder may include those listed for it, and itself. A subfolder may have its own entry.
const BELOW = {
  protocol: [],
  base: [],
  access: ['base'],
  cluster: ['base'],
  markup: ['base'],
  normalize: ['markup', 'base'],
  expression: ['markup', 'protocol', 'base'],
  voice: ['cluster', 'markup', 'base'],
  face: ['voice', 'expression', 'markup', 'protocol', 'base'],
  synthesis: ['face', 'voice', 'normalize', 'expression', 'markup', 'protocol', 'base'],
  stream: ['synthesis', 'face', 'voice', 'normalize', 'expression', 'markup', 'protocol', 'base'],
  codec: ['stream', 'protocol', 'base'],
  film: ['http', 'access', 'export', 'synthesis', 'voice', 'protocol', 'base'],
  export: ['codec', 'normalize', 'stream', 'synthesis', 'face', 'voice', 'markup', 'protocol', 'base'],
  http: ['access', 'base'],
  rooms: ['http', 'access', 'cluster', 'stream', 'codec', 'synthesis', 'expression', 'markup', 'protocol', 'base'],
  api: ['rooms', 'film', 'coach', 'http', 'library', 'access', 'cluster', 'stream', 'export', 'live', 'synthesis', 'codec', 'expression', 'markup', 'protocol', 'base'],
  // beside the core
  live: ['synthesis', 'face', 'voice', 'protocol', 'base'],
  coach: ['library/align', 'live', 'synthesis', 'voice', 'base'],
  library: ['normalize', 'markup', 'base'],
  'library/align': ['library', 'live', 'normalize', 'face', 'voice', 'markup', 'protocol', 'base'],
  'library/publish': ['library', 'export', 'synthesis', 'face', 'voice', 'markup', 'protocol', 'base'],
  research: ['cli', 'daemon', 'library/align', 'export', 'synthesis', 'face', 'voice', 'expression', 'protocol', 'base'],
  bridges: ['http', 'base'],
  plugins: ['library/align', 'face', 'voice', 'markup', 'base'],
};
BELOW.daemon = Object.keys(BELOW);
BELOW.cli = Object.keys(BELOW);

/** Layers that a folder must not reach even through other headers: the network code sees blocks, commands and the offer. */
const HIDDEN = { rooms: ['face', 'voice', 'normalize'], api: ['face', 'voice', 'normalize'] };

/** Long because it is a table. */
const isTable = ({ name, code }) => {
  const rows = code.split('\n').filter((line) => /^\s*(\[.*\] = )?\{.*\},?\s*$|^\s*"(?:\\.|[^"])*",?\s*$|^\s*[-\d.,x\sa-fA-F{}]+,?\s*$/.test(line) && line.trim() !== '').length;
  return /table|model/.test(path.basename(name)) && rows > code.split('\n').length / 2;
};

const stageOf = (name) => {
  if (name.startsWith('protocol/')) return 'protocol';
  if (/^server\/(coach|live|library|research)\/.*\bfaccia_\w+\.c$/.test(name)) return 'cli'; // a command lies beside what it runs
  const [, room, folder] = name.split('/');
  return `${room}/${folder}` in BELOW ? `${room}/${folder}` : room;
};
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

  for (const { name } of files)
    for (const [file, from] of reached(name, includes, known))
      if (from !== name && HIDDEN[stageOf(name)]?.includes(stageOf(file))) lines.push(`hidden: ${name} reaches ${file} through ${from}`);

  const headers = new Map();
  for (const { name } of files) headers.set(name, includes.get(name).filter((file) => known.has(file)));
  for (const circle of circles(headers)) lines.push(`circle of includes: ${circle.join(', ')}`);
  // the files of one folder may call each other: they are one engine
  for (const circle of circles(calls(files)))
    if (new Set(circle.map((name) => path.dirname(name))).size > 1) lines.push(`circle of calls: ${circle.join(', ')}`);

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
      if (length > 800 && !isTable(file)) lines.push(`length: ${file.name} has ${length} lines`);
    }
  return [...new Set(lines)];
}

/** All that a file includes, itself or through others, and the file through which. */
function reached(name, includes, known) {
  const found = new Map();
  const queue = [name];
  for (const from of queue)
    for (const file of includes.get(from))
      if (known.has(file) && !found.has(file)) {
        found.set(file, from);
        queue.push(file);
      }
  return found;
}

const KEYWORDS = new Set(['if', 'for', 'while', 'switch', 'return', 'sizeof', 'defined', 'struct', 'enum']);

/** Which .c files call functions of which others. Passing a function as a pointer does not count as a call by that file. */
function calls(files) {
  const owner = new Map();
  const bodies = files.filter(({ name }) => name.endsWith('.c')).map(({ name, code }) => ({ name, code }));
  for (const { name, code } of bodies)
    for (const [, kind, word] of code.matchAll(/^((?:[a-z]\w*[ *]+)+?\**)(\w+)\([^;{]*\)\s*\{/gm))
      if (!/\bstatic\b/.test(kind) && !KEYWORDS.has(word)) owner.set(word, owner.has(word) ? null : name);
  const graph = new Map();
  for (const { name, code } of bodies) {
    const own = new Set([...code.matchAll(/^static [^;={]*?(\w+)\(/gm)].map(([, word]) => word));
    const called = [...code.matchAll(/\b(\w+)\(/g)].map(([, word]) => word).filter((word) => !own.has(word));
    graph.set(name, [...new Set(called.map((word) => owner.get(word)).filter((file) => file && file !== name))]);
  }
  return graph;
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

test('includes point one way, file names are unique, files are short', () => {
  const files = [...sources('server'), ...sources('protocol')];
  assert.ok(files.length > 300, `${files.length}`);
  const lines = broken(files);
  assert.equal(lines.length, 0, `\n${lines.join('\n')}`);
});

test('only the settings read settings', () => {
  const asked = sources('server').flatMap(({ name, code }) =>
    [...code.matchAll(/\b(?:secure_)?(?:getenv|setenv|putenv)\(("?\w+"?)/g)].map(([, what]) => `${name}: ${what}`),
  );
  // PATH and HOME are the system's; a voice's worker tells what it loads, in its own process: libraries to be silent, a plugin that speaks
  // with a second voice whether that is confined; the command of a recogniser is told the language, a film that a daemon waits
  // for it; programs beside the daemon have their own
  const others = asked.filter((line) => !/^server\/daemon\/settings\.c:|: "(?:PATH|HOME|PULSE_SERVER|PULSE_CLIENTCONFIG)"$|^server\/bridges\/|^server\/(?:voice\/worker_main|library\/align\/reference)\.c: "FACCIA_SANDBOX"$|^server\/live\/faccia_recogniser\.c: "HEAR_LANG"$|^server\/cli\/faccia_film\.c: FILM_JOB_VARIABLE$/.test(line));
  assert.deepEqual(others, []);
});

const file = (name, text) => ({ name, text, code: text });
for (const [what, files, expected] of [
  ['a circle of includes', [file('server/base/a.h', '#include "server/base/b.h"'), file('server/base/b.h', '#include "server/base/a.h"')], /^circle of includes: server\/base\/a\.h, server\/base\/b\.h$/],
  ['a circle of calls', [file('server/base/a.c', 'int a(void) {\n    return b();\n}'), file('server/http/b.c', 'int b(void) {\n    return a();\n}')], /^circle of calls: server\/base\/a\.c, server\/http\/b\.c$/],
  ['no circle: one folder', [file('server/base/a.c', 'int a(void) {\n    return b();\n}'), file('server/base/b.c', 'int b(void) {\n    return a();\n}')], null],
  ['no circle: one unit', [file('server/base/a.h', ''), file('server/base/a.c', '#include "server/base/a.h"\n#include "a_internal.h"'), file('server/base/a_internal.h', '#include "server/base/a.h"')], null],
  ['the order', [file('server/api/a.c', '#include "server/face/b.h"'), file('server/face/b.h', '')], /^stage: server\/api\/a\.c \(api\) includes server\/face\/b\.h$/],
  ['what is hidden', [file('server/api/a.c', '#include "server/stream/b.h"'), file('server/stream/b.h', '#include "server/face/c.h"'), file('server/face/c.h', '')], /^hidden: server\/api\/a\.c reaches server\/face\/c\.h through server\/stream\/b\.h$/],
  ['a name', [file('server/api/a.c', ''), file('server/face/a.h', '')], /^name: a in server\/api, server\/face$/],
  ['a length', [file('server/api/a.c', 'int x;\n'.repeat(801))], /^length: server\/api\/a\.c has 801 lines$/],
  ['a table', [file('server/api/a_table.c', '    {"x", 1},\n'.repeat(801))], null],
])
  test(`the rules detect ${what}`, () => {
    const lines = broken(files);
    if (expected) assert.ok(lines.length === 1 && expected.test(lines[0]), lines.join('\n'));
    else assert.deepEqual(lines, []);
  });
