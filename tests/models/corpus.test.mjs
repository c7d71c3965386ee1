// SPDX-License-Identifier: GPL-3.0-or-later
// Every schema and its reader see the same broken files (tests/corpus), and refuse the same; and agree on each document that is damaged
// in one place.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { damages, edited } from '../lib/damage.mjs';
import { build, root } from '../lib/daemon.mjs';
import { agrees, corpus, json, schema } from '../lib/verdicts.mjs';
import { readModel } from '../../web/element/head/model/model.mjs';

const facciad = (...args) => spawnSync(path.join(build, 'server/daemon/facciad'), args, { encoding: 'utf8' }).stdout;

/** only: the places that the reader looks at; it passes over the others. */
const kinds = {
  pack: { schema: 'models/speech/schema/pack.json', files: ['models/speech/it.json', 'models/speech/tr.json', 'models/speech/und.json'] },
  visemes: { schema: 'models/speech/schema/visemes.json', files: ['models/speech/visemes/pt.json'] },
  letters: { schema: 'models/speech/schema/letters.json', files: ['models/speech/letters/tr.json'] },
  alphabets: { schema: 'models/speech/schema/alphabets.json', files: ['models/speech/alphabets/ipa.json'] },
  expressions: { schema: 'models/expressions.schema.json', files: ['models/expressions.json'] },
  gesture: { schema: 'models/gestures.schema.json', files: ['models/gestures/wink.json', 'models/gestures/shrug.json'] },
  normalization: { schema: 'models/normalization.schema.json', files: ['models/normalization/it.json', 'models/normalization/tr.json'] },
  boundaries: { schema: 'models/boundaries.schema.json', files: ['models/boundaries.json'] },
  settings: { schema: JSON.parse(facciad('--print-schema')), files: ['tests/corpus/documents/settings.json'] },
  voices: { schema: 'server/plugins/command/voices.schema.json', files: ['tests/corpus/documents/voices.json'], only: /^(?!.*\/times\/unheard-of)/ },
  timed: { schema: 'protocol/schema/timed.json', files: ['tests/corpus/documents/timed.json'], only: /^\/(phones|words)(\/\d+(\/(ipa|name|start|end|stress|text))?)?$/ },
};

/** Errors that only the reader can detect, not the schema, and why. */
const readerOnly = [
  [/^(there is no|unknown) (group|phone|shape|affect|context|sound) /, 'names of things that stand elsewhere in the file'],
  [/^"[^"]*": /, 'another file'],
  [/^unknown name/, 'names that the file itself defines'],
  [/has no target in the context/, 'the contexts stand elsewhere in the file'],
  [/none of them shows the pack's phone/, "the pack's phones stand in another file"],
  [/must have \d+ items, one for each class/, 'the classes stand elsewhere in the file'],
  [/must be made of the letters/, 'the letters stand elsewhere in the file'],
  [/^the name '.*' occurs twice/, 'names must differ in all of a kind'],
  [/must be at least [\d.]+ after the previous one/, 'an order of numbers'],
  [/^'.*' is not a folder$/, 'what lies on the disk'],
  [/^another voice has it$/, 'the other voice stands elsewhere in the file'],
  [/^begins before the last one's end, or ends before it begins$/, 'an order of numbers'],
  [/^must be a number from -\d+ to \d+$/, 'the ranges of FAPs stand in protocol/fap-table.json'],
  [/^unknown FAP$/, 'the names of FAPs stand in protocol/fap-table.json', 'gesture'],
  [/^must have \d+ values, like the previous curve/, 'the curves must be of one length', 'gesture'],
  [/^makes the gesture longer than/, 'its length follows from frames and their rate', 'gesture'],
  [/^is (missing|not a known key)$/, "a grid's rows are the file's own groups", 'visemes', /^grid\./],
];

/** Returns at most this many damaged versions of a file, evenly distributed. */
const MOST = 200;

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-corpus-'));
after(() => fs.rmSync(folder, { recursive: true }));

/** Results of the readers for documents: {ok} or {code, place, message} for each. */
function judged(kind, documents) {
  const paths = documents.map((document, i) => {
    const own = path.join(folder, `${kind}-${i}`);
    fs.rmSync(own, { recursive: true, force: true });
    fs.mkdirSync(own);
    for (const beside of ['und.json', 'it.json', 'alphabets', 'visemes', 'letters']) fs.symlinkSync(path.join(root, 'models/speech', beside), path.join(own, beside));
    fs.writeFileSync(path.join(own, 'file.json'), JSON.stringify(document));
    return path.join(own, 'file.json');
  });
  const { status, stdout, stderr } = spawnSync(path.join(build, 'tests/corpus/judge'), { input: paths.map((file) => `${kind} ${file}\n`).join(''), encoding: 'utf8', maxBuffer: 1 << 28 });
  assert.equal(status, 0, stderr);
  const lines = stdout.split('\n').slice(0, -1);
  assert.equal(lines.length, documents.length);
  return lines.map((line) => {
    const [code, at, message] = line.split('\t');
    return line === 'ok' ? { ok: true } : { ok: false, code, place: at, message };
  });
}

for (const [kind, { schema: file, files, only = /^/ }] of Object.entries(kinds)) {
  const refused = schema(file);

  test(`${kind}: schema and reader reject broken files of the corpus at the same position`, () => {
    const entries = corpus(kind), documents = entries.map((entry) => edited(json(entry.of), entry)), verdicts = judged(kind, documents);
    assert.ok(entries.length >= 3);
    entries.forEach((entry, i) => {
      const places = refused(documents[i]), verdict = verdicts[i], what = `${kind}/${entry.name}: ${JSON.stringify(verdict)}; the schema: ${places}`;
      assert.equal(verdict.ok, false, what);
      assert.ok(verdict.code && verdict.message, what);
      assert.equal(verdict.place, entry.place, what);
      assert.equal(entry.readerOnly, 'why' in entry, `${what}: a reason, and the name .reader.json`);
      if (entry.readerOnly) assert.deepEqual(places, [], what);
      else assert.ok(agrees(places, verdict.place), what);
    });
  });

  for (const of of files)
    test(`${of}: schema and reader agree on every damage`, () => {
      const document = json(of), all = [...damages(document)].filter(({ set, remove }) => only.test(Object.keys(set ?? {})[0] ?? remove[0])), edits = all.filter((_, i) => i % Math.ceil(all.length / MOST) === 0);
      const documents = [document, ...edits.map((edit) => edited(document, edit))], verdicts = judged(kind, documents);
      assert.deepEqual([refused(document), verdicts[0]], [[], { ok: true }]);
      assert.ok(edits.length > 60, `${edits.length}`);
      const wrong = [];
      edits.forEach((edit, i) => {
        const places = refused(documents[i + 1]), verdict = verdicts[i + 1], what = `${JSON.stringify(edit)}: reader ${JSON.stringify(verdict)}, schema ${JSON.stringify(places)}`;
        if (verdict.ok !== !places.length) {
          const known = !verdict.ok && readerOnly.some(([message, , only, at]) => message.test(verdict.message) && (!only || only === kind) && (!at || at.test(verdict.place)));
          if (!known) wrong.push(what);
        } else if (!verdict.ok && !agrees(places, verdict.place) && !readerOnly.some(([message]) => message.test(verdict.message))) wrong.push(`another place: ${what}`);
      });
      assert.deepEqual(wrong, []);
    });
}

// Heads have two readers: the client, which needs all of one, and the daemon, which hands on what it does not read.

const headSchema = schema('protocol/schema/head-model.json');
const headPath = 'tests/corpus/documents/head.json';
const readHead = (document) => {
  try {
    readModel(document);
    return null;
  } catch (error) {
    return error;
  }
};

test('head: schema and client reject broken files of the corpus at the same position; the daemon reads the outline', () => {
  const entries = corpus('head'), documents = entries.map((entry) => edited(json(entry.of), entry)), verdicts = judged('head', [json(headPath), ...documents]);
  assert.deepEqual([headSchema(json(headPath)), readHead(json(headPath)), verdicts.shift()], [[], null, { ok: true }]);
  assert.ok(entries.length > 20);
  entries.forEach((entry, i) => {
    const places = headSchema(documents[i]), error = readHead(documents[i]), what = `head/${entry.name}: ${error}; the schema: ${places}`;
    assert.equal(error?.place, entry.place, what);
    assert.equal(entry.readerOnly, 'why' in entry, `${what}: a reason, and the name .reader.json`);
    if (entry.readerOnly) assert.deepEqual(places, [], what);
    else assert.ok(agrees(places, error.place), what);
  });
  const outline = entries.filter((_, i) => !verdicts[i].ok).map(({ name }) => name);
  assert.deepEqual(outline, ['another-format', 'no-name', 'not-an-object', 'parts-that-are-an-object', 'textures-that-are-a-list']);
  assert.ok(verdicts.every(({ ok, code }) => ok || code === 'bad-model'));
});

test('head: the client accepts whatever the schema accepts, unless the arrays do not fit', () => {
  const document = json(headPath), wrong = [];
  let taken = 0;
  for (const edit of damages(document)) {
    const damaged = edited(document, edit);
    if (headSchema(damaged).length) continue;
    const error = readHead(damaged);
    if (!error) taken++;
    else if (!/do not fit|must have \d+ vertices|triangles of the vertices|a vertex for each|no such turn/.test(error.message) && !(error instanceof RangeError)) wrong.push(`${JSON.stringify(edit)}: ${error}`);
  }
  assert.deepEqual(wrong, []);
  assert.ok(taken > 50, `${taken}`);
});
