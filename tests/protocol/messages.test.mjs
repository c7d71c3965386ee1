// SPDX-License-Identifier: GPL-3.0-or-later
// The declaration of the messages of client and server (protocol/messages.json) and all that is made of it: what is kept in the repository is
// what would be made now, and a member or a message that is missing from any one of those files is found.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import Ajv from 'ajv/dist/2020.js';

const root = fileURLToPath(new URL('../..', import.meta.url));
const maker = path.join(root, 'protocol/make-messages.py');
const read = (name) => fs.readFileSync(path.join(root, name), 'utf8');
const declared = JSON.parse(read('protocol/messages.json'));
const { members } = declared.client.speak;
const KEPT = ['protocol/schema/client.json', 'protocol/schema/server.json', 'protocol/openapi.json', 'protocol/asyncapi.json', 'protocol/messages.md', 'protocol/README.md', 'web/element/talking-head.d.ts',
  'web/element/speak-attributes.mjs', 'web/docs/element/reference.md', 'web/client/python/faccia.py'];

const folders = [];
after(() => folders.forEach((folder) => fs.rmSync(folder, { recursive: true })));

/** A copy of the declaration, and of what is made of it. */
function copy() {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-messages-'));
  folders.push(folder);
  for (const name of ['protocol/messages.json', ...KEPT]) {
    fs.mkdirSync(path.dirname(path.join(folder, name)), { recursive: true });
    fs.copyFileSync(path.join(root, name), path.join(folder, name));
  }
  return folder;
}

/** Lists the files of each copy that differ from the generated ones. */
function wrong(...folders) {
  const { status, stdout, stderr } = spawnSync('python3', [maker, '--check', '--root', ...folders], { encoding: 'utf8' });
  const names = stdout.split('\n').filter(Boolean).map((line) => line.split(' ')[0]);
  assert.equal(status, names.length ? 1 : 0, stderr);
  return folders.map((folder) => names.filter((name) => name.startsWith(`${folder}/`)).map((name) => path.relative(folder, name)));
}
const write = (...folders) => execFileSync('python3', [maker, '--write', '--root', ...folders]);

const make = (what, folder = root) => execFileSync('python3', [maker, what, '--root', folder], { encoding: 'utf8' });

test('the declaration matches its schema', () => {
  const ajv = new Ajv({ strict: true, strictTypes: false, strictRequired: false });
  const validate = ajv.compile(JSON.parse(read('protocol/schema/messages.json')));
  assert.ok(validate(declared), ajv.errorsText(validate.errors));
  for (const damage of [(d) => delete d.client.speak.members.rate.min, (d) => delete d.client.speak.members.mode.words, (d) => delete d.client.stop.summary, (d) => delete d.client.stop.right,
    (d) => (d.client.speak.members.rate.type = 'double'), (d) => (d.client.stop.right = 'shout'), (d) => delete d.server.messages.begin.members.rate.summary, (d) => delete d.server.messages.begin.members.again.value,
    (d) => delete d.server.answers.stopped.of]) {
    const damaged = structuredClone(declared);
    damage(damaged);
    assert.ok(!validate(damaged), String(damage));
  }
});

test('the files in the repository are those generated from the declaration', () => assert.deepEqual(wrong(path.resolve(root)), [[]]));

const gone = (object, name) => {
  assert.ok(name in object, name);
  delete object[name];
};
const json = (change) => (text) => {
  const document = JSON.parse(text);
  change(document);
  return JSON.stringify(document, null, 2) + '\n';
};
/** Drops the last of the lines that fit. */
const lines = (pattern, count = 1) => (text) => {
  const all = text.split('\n');
  const fitting = [...all.keys()].filter((at) => pattern.test(all[at]));
  assert.equal(fitting.length, count, String(pattern));
  return all.toSpliced(fitting.at(-1), 1).join('\n');
};
const words = (before, after) => (text) => {
  assert.equal(text.split(before).length, 2, before);
  return text.replace(before, after);
};
const answerOf = (document, method, place, status) => document.paths[place][method].responses[status].content['application/json'];
const ofSpeech = (document) => document.paths['/v1/speech'].get.parameters;

// A member, or a message, taken out of one place of one file.
const DAMAGES = [
  ['protocol/schema/client.json', 'a member of speak', json((d) => gone(d.$defs.speak.properties, 'contacts'))],
  ['protocol/schema/client.json', 'a bound', json((d) => gone(d.$defs.speak.properties.rate, 'maximum'))],
  ['protocol/schema/client.json', 'a member of a notice', json((d) => gone(d.$defs.choices.properties, 'question'))],
  ['protocol/schema/client.json', 'a message', json((d) => gone(d.$defs, 'jump'))],
  ['protocol/schema/client.json', 'a type', json((d) => d.properties.type.enum.pop())],
  ['protocol/openapi.json', 'a parameter', json((d) => gone(d.components.parameters, 'contacts'))],
  ['protocol/openapi.json', 'a parameter of a path', json((d) => ofSpeech(d).splice(ofSpeech(d).findIndex(({ $ref }) => $ref?.endsWith('/contacts')), 1))],
  ['protocol/openapi.json', 'a word of a parameter', json((d) => d.components.parameters.markup.schema.enum.pop())],
  ['protocol/openapi.json', 'a member of the body of /v1/speech', json((d) => gone(d.components.schemas.speech.properties, 'contacts'))],
  ['protocol/openapi.json', 'a member of the body of /v1/say', json((d) => gone(d.components.schemas.say.properties, 'topic'))],
  ['protocol/asyncapi.json', 'a member of the address', json((d) => gone(d.channels.stream.bindings.ws.query.properties, 'contacts'))],
  ['protocol/asyncapi.json', 'a message', json((d) => gone(d.components.messages, 'client.jump'))],
  ['protocol/asyncapi.json', 'a message of the channel', json((d) => gone(d.channels.stream.messages, 'client.jump'))],
  ['protocol/asyncapi.json', 'a message that is heard', json((d) => d.operations.hear.messages.shift())],
  ['protocol/schema/server.json', 'a member', json((d) => gone(d.$defs.begin.properties, 'again'))],
  ['protocol/schema/server.json', 'a member that several share', json((d) => gone(d.$defs.word.properties, 'utf16_start'))],
  ['protocol/schema/server.json', 'a bound', json((d) => gone(d.$defs.chosen.properties.choice, 'maximum'))],
  ['protocol/schema/server.json', 'a member that is always there', json((d) => d.$defs.end.required.pop())],
  ['protocol/schema/server.json', 'a message', json((d) => gone(d.$defs, 'observers'))],
  ['protocol/schema/server.json', 'a code', json((d) => d.$defs.code.enum.pop())],
  ['protocol/openapi.json', 'a member of an answer', json((d) => gone(d.components.schemas.accepted.properties, 'held'))],
  ['protocol/openapi.json', 'a member of a warning', json((d) => gone(d.components.schemas.warning.properties, 'byte'))],
  ['protocol/openapi.json', 'an answer', json((d) => gone(answerOf(d, 'post', '/v1/stop', 200), 'schema'))],
  ['protocol/openapi.json', 'one of several answers', json((d) => answerOf(d, 'post', '/v1/rooms/{room}/commands', 200).schema.oneOf.pop())],
  ['protocol/asyncapi.json', 'a message of the server', json((d) => gone(d.components.messages, 'server.jumped'))],
  ['protocol/asyncapi.json', 'a message of the server, of the channel', json((d) => gone(d.channels.stream.messages, 'server.jumped'))],
  ['protocol/asyncapi.json', 'a message that is told', json((d) => d.operations.tell.messages.shift())],
  ['protocol/messages.md', 'a member', lines(/^\| `contacts` /)],
  ['protocol/messages.md', 'a member of the server', lines(/^\| `may_speak` /)],
  ['protocol/messages.md', 'a message of the server', lines(/^### server: jumped$/)],
  ['protocol/README.md', 'a message of the server', lines(/^\| \[`jumped`\]/)],
  ['protocol/README.md', 'a member of the server', words('`room`, `followers`, `may_speak`', '`room`, `followers`')],
  ['protocol/README.md', 'a member of hello', lines(/^\| `opus_skip` /)],
  ['protocol/messages.md', 'a message', lines(/^### jump$/)],
  ['web/element/talking-head.d.ts', 'an option of speak', lines(/^ {2}gender\?: /)],
  ['web/element/talking-head.d.ts', 'an attribute', lines(/^ {2}contacts\?: .* \| null;$/)],
  ['web/element/talking-head.d.ts', 'a property', lines(/^ {2}contacts: .* \| null;$/)],
  ['web/element/talking-head.d.ts', 'an option of listen', lines(/^ {2}\/\*\* The language spoken\. /)],
  ['web/element/talking-head.d.ts', 'a member of the server', lines(/^ {2}followers: /)],
  ['web/element/talking-head.d.ts', 'a member of the server that is not always there', lines(/^ {2}lookahead\?: 0 \| 40 \| 80 \| 120;$/, 2)],
  ['web/element/talking-head.d.ts', 'an event', lines(/^ {2}jumped: CustomEvent/)],
  ['web/element/speak-attributes.mjs', 'an attribute', lines(/^ {2}contacts: /)],
  ['web/docs/element/reference.md', 'an attribute', words('`blend`, `contacts`, `normalization`, `verse` | defaults for', '`blend`, `normalization` | defaults for')],
  ['web/docs/element/reference.md', 'an option', words('`blend`, `contacts`, `normalize`,', '`blend`, `normalize`,')],
  ['web/client/python/faccia.py', 'a message', words('resume rate jump play', 'resume rate play')],
  ['web/client/python/faccia.py', 'a message of the server', words('paused resumed jumped', 'paused resumed')],
];
assert.deepEqual([...new Set(DAMAGES.map(([name]) => name))].sort(), [...KEPT].sort());
test('detects and reverts a change in any generated file', () => {
  const damaged = DAMAGES.map(([name, , damage]) => {
    const folder = copy();
    fs.writeFileSync(path.join(folder, name), damage(read(name)));
    return folder;
  });
  const found = wrong(...damaged);
  for (const [i, [name, what]] of DAMAGES.entries()) assert.deepEqual(found[i], [name], `${what} of ${name}`);
  write(...damaged);
  const value = (name, text) => (name.endsWith('.json') ? JSON.parse(text) : text); // numbers outside the declared members may be written differently
  for (const [i, [name, what]] of DAMAGES.entries())
    assert.deepEqual(value(name, fs.readFileSync(path.join(damaged[i], name), 'utf8')), value(name, read(name)), `${what} of ${name}`);
});

test('a member declared once appears in each file, and in the build', () => {
  const folder = copy();
  const more = structuredClone(declared);
  more.client.speak.members.sparkle = { type: 'number', min: 0, max: 9, default: 3, summary: 'How much it sparkles.', attribute: true, option: { value: 'N', summary: 'how much it sparkles' } };
  more.client.glitter = { summary: 'Strews glitter.', right: 'speak', members: { grains: { type: 'integer', min: 1, max: 7, required: true, summary: 'How many.' } } };
  more.server.messages.glittered = { summary: 'Glitter has fallen.', shares: ['utterance'], event: true, members: { shine: { type: 'integer', min: 1, required: true, line: true, summary: 'How much of it.' } } };
  more.server.answers.accepted.members.shine = { type: 'integer', min: 1, summary: 'How much of it.' };
  fs.writeFileSync(path.join(folder, 'protocol/messages.json'), JSON.stringify(more));
  assert.deepEqual(wrong(folder), [KEPT]);
  write(folder);
  const server = ['protocol/schema/server.json', 'protocol/README.md'];
  for (const name of KEPT.filter((one) => !one.endsWith('.py') && !server.includes(one))) assert.match(fs.readFileSync(path.join(folder, name), 'utf8'), /\bsparkle\b/, name);
  for (const name of ['protocol/schema/client.json', 'protocol/asyncapi.json', 'protocol/messages.md', 'web/client/python/faccia.py'])
    assert.match(fs.readFileSync(path.join(folder, name), 'utf8'), /\bglitter\b/, name);
  for (const name of [...server, 'protocol/openapi.json', 'protocol/messages.md', 'web/element/talking-head.d.ts']) assert.match(fs.readFileSync(path.join(folder, name), 'utf8'), /\bshine\b/, name);
  for (const name of ['protocol/asyncapi.json', 'web/client/python/faccia.py']) assert.match(fs.readFileSync(path.join(folder, name), 'utf8'), /\bglittered\b/, name);
  assert.match(make('server-messages', folder), /\{"glittered", \{"shine", NULL\}\},/);
  assert.match(make('client-messages', folder), /\{"glitter", RIGHT_SPEAK\},/);
  assert.match(make('speak-fields', folder), /FIELD\(sparkle, NUMBER, 0, 9, NULL\)/);
  assert.match(make('speak-fields', folder), /\.sparkle = 3/);
  assert.match(make('say-options', folder), /"sparkle", 1, NULL, 1/);
  assert.match(make('say-options', folder), /--sparkle N +how much it sparkles/);
  assert.match(make('client-messages', folder), /"grains", FIELD_INTEGER, 1, 7, NULL, true/);
  assert.deepEqual(wrong(folder), [[]]);
});

test('the daemon\'s rows match the declaration', () => {
  const rows = [...make('speak-fields').matchAll(/FIELD\((\w+), /g)].map(([, name]) => name);
  assert.deepEqual(rows, Object.keys(members));
  const options = [...make('say-options').matchAll(/\{"(\w+)", /g)].map(([, name]) => name);
  assert.deepEqual(options, Object.keys(members).filter((name) => members[name].option));
});
