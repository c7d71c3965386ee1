// SPDX-License-Identifier: GPL-3.0-or-later
// faccia-mcp with the client of the Model Context Protocol's own SDK, over standard input and output and over HTTP.
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { once } from 'node:events';
import fs from 'node:fs';
import { createRequire } from 'node:module';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { Daemon } from '../../lib/daemon.mjs';
import { sign } from '../../lib/tokens.mjs';

const package_ = fileURLToPath(new URL('../../../web/mcp/package.json', import.meta.url));
const program = path.join(path.dirname(package_), 'faccia-mcp.mjs');
const require = createRequire(package_);
const { Client } = require('@modelcontextprotocol/sdk/client/index.js');
const { StdioClientTransport } = require('@modelcontextprotocol/sdk/client/stdio.js');
const { StreamableHTTPClientTransport } = require('@modelcontextprotocol/sdk/client/streamableHttp.js');

const SECRET = 'a secret of this test that is long enough';
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-mcp-'));
const poem = 'Il mare\n\nIl mare è calmo,\nla luna è piena.\n\nUna barca torna piano.\n';

let daemon, kiosk;
before(async () => {
  fs.mkdirSync(path.join(folder, 'works'));
  fs.writeFileSync(path.join(folder, 'works/mare.txt'), poem);
  // films are drawn in tests/browser: here a program writes its file at once, and fails for one that is red
  fs.writeFileSync(path.join(folder, 'filmer'), '#!/bin/sh\ncase $* in *red*) echo "faccia: film: no red" >&2; exit 1 ;; esac\necho "  50 %: picture 1 of 2" >&2\nsleep 1\nwhile [ "$1" != --output ]; do shift; done\necho film >"$2"\n', { mode: 0o755 });
  daemon = await Daemon.start(['--film-program', path.join(folder, 'filmer'), '--library', path.join(folder, 'works'), '--library-index', path.join(folder, 'index')]);
  kiosk = await daemon.stream('?lang=it&room=home');
  await kiosk.wait({ type: 'joined' });
});
after(async () => {
  await kiosk.close();
  fs.rmSync(folder, { recursive: true });
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});

async function connect(transport) {
  const client = new Client({ name: 'test', version: '1' });
  await client.connect(transport);
  return client;
}
const stdio = (url, env = {}) =>
  connect(new StdioClientTransport({ command: process.execPath, args: [program, '--url', url], env: { ...process.env, ...env }, stderr: 'pipe' }));

/** Starts faccia-mcp --http, and returns its address. */
async function serve(url, { env = {}, http = '0' } = {}) {
  const child = spawn(process.execPath, [program, '--url', url, '--http', http], { env: { ...process.env, ...env }, stdio: ['ignore', 'ignore', 'pipe'] });
  const [line] = await once(child.stderr.setEncoding('utf8'), 'data');
  return {
    address: new URL(/http\S+/.exec(line)[0].replace('0.0.0.0', '127.0.0.1')),
    stop: async () => {
      child.kill();
      return (await once(child, 'exit'))[0];
    },
  };
}
const http = (address, token) =>
  connect(new StreamableHTTPClientTransport(address, token ? { requestInit: { headers: { authorization: `Bearer ${token}` } } } : {}));

const said = (result) => result.content[0].text;
const call = (client, name, args = {}) => client.callTool({ name, arguments: args });

/** Calls each tool and reads each resource. */
async function tryAll(client) {
  kiosk.messages.length = 0;
  const { tools } = await client.listTools();
  assert.deepEqual(tools.map(({ name }) => name).sort(), ['ask', 'choices', 'express', 'film', 'library_read', 'library_search', 'rooms', 'say', 'stop']);
  for (const { description, inputSchema } of tools) assert.ok(description.length > 20 && inputSchema.type === 'object');

  assert.equal(said(await call(client, 'say', { text: 'Buongiorno.', lang: 'it' })), 'Said to 1 listener.');
  const { id } = await kiosk.wait({ type: 'begin' });
  await kiosk.wait({ type: 'end', id, reason: 'done' });
  const heard = await call(client, 'say', { text: 'La cena è pronta.', lang: 'it', wait: true });
  assert.deepEqual([said(heard), heard.structuredContent], ['Heard by 1 listener.', { listeners: 1, heard: true }]);
  assert.deepEqual(kiosk.messages.filter(({ type }) => type === 'sentence').map(({ text }) => text), ['Buongiorno.', 'La cena è pronta.']);

  const asked = call(client, 'ask', { question: 'Vuoi il tè?', choices: ['Sì', 'No'], lang: 'it' });
  const offer = await kiosk.wait({ type: 'choices' });
  assert.deepEqual([offer.question, offer.choices], ['Vuoi il tè?', ['Sì', 'No']]);
  kiosk.send({ type: 'choose', choice: 1, id: offer.id });
  const { choice, text, answered } = (await asked).structuredContent;
  assert.deepEqual([choice, text, answered], [1, 'No', true]);
  assert.match(said(await asked), / chose: No$/);
  const nobody = await call(client, 'ask', { question: 'E adesso?', choices: ['Sì', 'No'], lang: 'it', seconds: 5 });
  assert.deepEqual([said(nobody), nobody.structuredContent], ['Nobody has chosen an answer.', { answered: false }]);
  await kiosk.wait(({ type, choices }) => type === 'choices' && !choices.length);

  assert.match(said(await call(client, 'choices', { choices: ['Uno', 'Due'], question: 'Quale?' })), /on the screen/);
  await kiosk.wait(({ type, choices }) => type === 'choices' && choices[0] === 'Uno');
  assert.match(said(await call(client, 'choices', { choices: [] })), /gone/);
  assert.equal(said(await call(client, 'express', { mix: [{ name: 'joy', intensity: 0.5 }] })), 'The face shows joy.');
  assert.deepEqual((await kiosk.wait(({ type, mix }) => type === 'expressed' && mix.length > 0)).mix, [{ name: 'joy', intensity: 0.5 }]);
  assert.equal(said(await call(client, 'express', { mix: [] })), 'The face is neutral.');
  assert.equal(said(await call(client, 'stop')), 'It is silent.');
  assert.equal(said(await call(client, 'rooms')).split('\n')[0], 'home: 1 listener');

  const found = await call(client, 'library_search', { query: 'luna', lang: 'it' });
  const [{ passage, text: words }] = found.structuredContent.results;
  assert.match(words, /la luna è piena/);
  assert.match(said(await call(client, 'library_read', { passage })), /luna è piena/);
  assert.equal(said(await call(client, 'say', { passage, wait: true })), 'Heard by 1 listener.');
  assert.equal(said(await call(client, 'library_search', { query: 'balena' })), 'Nothing was found.');

  const { resources } = await client.listResources();
  assert.deepEqual(resources.map(({ uri }) => uri).sort(), ['faccia://expressions', 'faccia://heads', 'faccia://library', 'faccia://voices']);
  for (const { uri } of resources) assert.equal(typeof JSON.parse((await client.readResource({ uri })).contents[0].text), 'object');
  const { resourceTemplates: [{ uriTemplate }] } = await client.listResourceTemplates();
  const { contents: [section] } = await client.readResource({ uri: uriTemplate.replace('{work}', 'mare').replace('{section}', '1') });
  assert.match(section.text, /barca torna piano/);

  // what is wrong is an answer in words
  const wrong = async (name, args, pattern) => {
    const result = await call(client, name, args);
    assert.equal(result.isError, true, JSON.stringify(result));
    assert.match(said(result), pattern);
  };
  await wrong('say', { text: 'Ciao.', voice: 'nobody' }, /nobody/);
  await wrong('say', { text: 'Ciao.', lang: 'xx', wait: true }, /xx/);
  await wrong('say', {}, /either text or passage/);
  await wrong('express', { mix: [{ name: 'hunger', intensity: 1 }] }, /hunger/);
  await wrong('stop', { room: 'cellar' }, /room/);
  await wrong('library_read', { passage: 'mare:99' }, /mare:99|passage/);
  await wrong('library_search', { query: '"' }, /quer|quot/i);
  await wrong('choices', { choices: Array(9).fill('x') }, /choices/);
  assert.match(said(await call(client, 'say', { text: 'Ciao.', room: 'cellar', wait: true })), /Nobody listens/);
}

test('makes a film, and tells how far it is', async () => {
  const client = await stdio(daemon.url);
  const shares = [];
  const { structuredContent: made } = await client.callTool({ name: 'film', arguments: { text: 'Ciao.', lang: 'it', format: 'webm' } }, undefined, { onprogress: ({ progress }) => shares.push(progress), timeout: 120000 });
  assert.match(made.film, /^http:.*\/v1\/films\/[0-9a-f]{32}\/film\.webm$/);
  assert.deepEqual(shares, [0.5]);
  assert.equal(await (await fetch(made.film)).text(), 'film\n');
  const failed = await client.callTool({ name: 'film', arguments: { text: 'Ciao.', lang: 'it', background: 'red' } });
  assert.deepEqual([failed.isError, failed.content[0].text], [true, 'no red']);
  await client.close();
});

test('every tool and resource, over standard input and output', async () => {
  const client = await stdio(daemon.url);
  await tryAll(client);
  await client.close();
});

test('every tool and resource, over HTTP', async () => {
  const server = await serve(daemon.url);
  const client = await http(server.address);
  await tryAll(client);
  const other = await http(server.address);
  assert.match(said(await call(other, 'rooms')), /home/);
  await daemon.left(3); // the kiosk's, this one, and one that is kept for the next question
  await client.close();
  await other.close();
  assert.equal(await server.stop(), 0);
});

test('says that no daemon answers', async () => {
  const client = await stdio('http://127.0.0.1:9');
  for (const [name, args] of [['say', { text: 'Ciao.' }], ['ask', { question: 'Sì?', choices: ['Sì', 'No'] }], ['rooms', {}]]) {
    const result = await call(client, name, args);
    assert.equal(result.isError, true);
    assert.equal(said(result), 'No faccia daemon answers at http://127.0.0.1:9. Is facciad running there?');
  }
  await client.close();
});

test('tokens: that of the program, or that of the client', async () => {
  const secret = path.join(folder, 'secret');
  fs.writeFileSync(secret, SECRET, { mode: 0o600 });
  const closed = await Daemon.start(['--secret-file', secret]);
  const token = sign({ secret: SECRET });
  const bare = await stdio(closed.url);
  const refused = await call(bare, 'rooms');
  assert.equal(refused.isError, true);
  assert.match(said(refused), /token/);
  await bare.close();
  const wrong = await stdio(closed.url, { FACCIA_TOKEN: 'nonsense' });
  assert.match(said(await call(wrong, 'say', { text: 'Ciao.' })), /does not accept the token/);
  await wrong.close();
  const right = await stdio(closed.url, { FACCIA_TOKEN: token });
  assert.ok(!(await call(right, 'rooms')).isError);
  await right.close();

  const local = await serve(closed.url, { env: { FACCIA_TOKEN: token } });
  const lent = await http(local.address);
  assert.ok(!(await call(lent, 'rooms')).isError, 'lent to this machine');
  const own = await http(local.address, 'nonsense');
  assert.ok((await call(own, 'rooms')).isError, 'its own goes first');
  await local.stop();
  const open = await serve(closed.url, { env: { FACCIA_TOKEN: token }, http: '0.0.0.0:0' });
  const stranger = await http(open.address);
  assert.ok((await call(stranger, 'rooms')).isError, 'not lent to other machines');
  const known = await http(open.address, token);
  assert.ok(!(await call(known, 'rooms')).isError);
  // a session belongs to its token
  const { sessionId } = known.transport;
  const stolen = await fetch(open.address, { method: 'POST', headers: { 'content-type': 'application/json', accept: 'application/json, text/event-stream', 'mcp-session-id': sessionId }, body: '{"jsonrpc":"2.0","id":1,"method":"tools/list"}' });
  assert.equal(stolen.status, 404);
  await open.stop();
  assert.equal((await closed.stop()).code, 0);
});

test('lets no page of another site in, and refuses what is no message', async () => {
  const server = await serve(daemon.url);
  const post = (headers, body = '{}') => fetch(server.address, { method: 'POST', headers: { 'content-type': 'application/json', accept: 'application/json, text/event-stream', ...headers }, body });
  assert.equal((await post({ origin: 'https://example.org' })).status, 403);
  assert.notEqual((await post({ origin: 'http://localhost:3000' })).status, 403);
  assert.equal((await post({}, 'no JSON')).status, 400);
  assert.equal((await post({}, `"${'x'.repeat(2 << 20)}"`)).status, 400);
  assert.equal((await post({ 'mcp-session-id': 'nobody' })).status, 404);
  assert.equal((await fetch(new URL('/', server.address))).status, 404);
  await server.stop();
  for (const [args, pattern] of [[['--http', 'x'], /invalid address/], [['--url', 'nowhere'], /is no address/], [['--loud'], /loud/]]) {
    const { status, stderr } = spawnSync(process.execPath, [program, ...args], { encoding: 'utf8' });
    assert.equal(status, 2);
    assert.match(stderr, pattern);
  }
  assert.match(spawnSync(process.execPath, [program, '--help'], { encoding: 'utf8' }).stdout, /^Usage: faccia-mcp/);
});
