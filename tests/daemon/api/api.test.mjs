// SPDX-License-Identifier: GPL-3.0-or-later
// openapi.json and asyncapi.json against the running daemon: everything described exists, and everything that exists is described.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import Ajv from 'ajv/dist/2020.js';
import { Daemon, eventually, root } from '../../lib/daemon.mjs';

const read = (name) => fs.readFileSync(path.join(root, name), 'utf8');
const load = (name) => JSON.parse(read(`protocol/${name}`));
const [openapi, asyncapi] = [load('openapi.json'), load('asyncapi.json')];
const ajv = new Ajv({ strict: false });
for (const name of ['client', 'server', 'head-model', 'timed', 'pictures', 'library', 'scene']) ajv.addSchema(load(`schema/${name}.json`), `schema/${name}.json`);
ajv.addSchema(openapi, 'openapi.json');

let daemon;
let folder;
before(async () => {
  folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-api-'));
  fs.mkdirSync(path.join(folder, 'texts'));
  fs.writeFileSync(path.join(folder, 'texts/mare.md'), '# Il mare\n\nIl mare è calmo.\n');
  fs.mkdirSync(path.join(folder, 'scenes'));
  fs.writeFileSync(path.join(folder, 'scenes/lunch.json'), '{"lines":[]}');
  fs.writeFileSync(path.join(folder, 'texts/altro.md'), 'Un altro testo.\n');
  fs.mkdirSync(path.join(folder, 'gestures'));
  fs.mkdirSync(path.join(folder, 'reports'));
  fs.writeFileSync(path.join(folder, 'reports/0123456789abcdef.json'), '{"word":"mare","lang":"it"}');
  // films are drawn in tests/browser: here a program writes its file at once
  fs.writeFileSync(path.join(folder, 'filmer'), '#!/bin/sh\nwhile [ "$1" != --output ]; do shift; done\necho film >"$2"\n', { mode: 0o755 });
  fs.copyFileSync(path.join(root, 'models/gestures/wink.json'), path.join(folder, 'gestures/wink.json'));
  daemon = await Daemon.start(['--editing', '--gestures', path.join(folder, 'gestures'), '--scenes', path.join(folder, 'scenes'), '--library', path.join(folder, 'texts'), '--library-index', path.join(folder, 'index'), '--reports', path.join(folder, 'reports'), '--film-program', path.join(folder, 'filmer'), '--max-films', '1000', '--max-films-per-client', '1000']);
  await eventually(async () => (await (await daemon.get('/v1/library')).json()).state === 'ready', 'the library to be read');
  BODIES['/v1/coach'] = await (await daemon.get('/v1/speech?text=Ciao&lang=it&format=wav')).arrayBuffer();
});
after(async () => {
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  fs.rmSync(folder, { recursive: true });
});

const PLACES = { '{room}': 'api', '{work}': 'mare', '{section}': '1', '{passage}': 'mare:1', '{scene}': 'lunch', '{gesture}': 'wink', '{file}': 'altro.md', '{report}': '0123456789abcdef', '{suffix}': 'mp4' };

/** Resolves a reference within the document. */
const at = (document, { $ref }) => $ref.slice(2).split('/').reduce((value, key) => value[key.replaceAll('~1', '/')], document);

/** Checks a response against its description in the document. */
async function check(response, operation) {
  let described = operation.responses[response.status];
  assert.ok(described, `${response.url} answered ${response.status}`);
  if (described.$ref) described = at(openapi, described);
  const type = response.headers.get('content-type');
  const media = described.content?.[type];
  assert.ok(media || !described.content, `${response.url} answered with ${type}`);
  if (type !== 'application/json') return;
  const schema = JSON.parse(JSON.stringify(media.schema).replaceAll('"$ref":"#/', '"$ref":"openapi.json#/'));
  const value = await response.json();
  assert.ok(ajv.validate(schema, value), `${response.url}: ${ajv.errorsText()}`);
}

const parameters = (operation) => (operation.parameters ?? []).map((p) => (p.$ref ? at(openapi, p) : p));
const methodsOf = (address) => ['get', 'post', 'put', 'delete'].filter((method) => method in openapi.paths[address]);
const operations = Object.keys(openapi.paths).flatMap((address) =>
  methodsOf(address).map((method) => ({ address, method: method.toUpperCase(), operation: openapi.paths[address][method] })));
// documents served unchanged
const documents = Object.keys(openapi.paths).filter((address) => /^\/v1\/\w+\.json$/.test(address));

test('the routes of the daemon are the paths of the OpenAPI document', async () => {
  const routes = [...read('server/api/routes.c').matchAll(/^ {4}\{\.path = "(\/[^"]+)"/gm)].map(([, address]) => address);
  routes.push('/v1/rooms'); // in the table of routes only by name, for the commands below it
  assert.ok(routes.length > 10);
  const below = [...read('server/api/routes.c').matchAll(/^ {4}\{\.path = "(\/[^"]+)"[^}]*\.below = true/gm)].map(([, address]) => `${address}/`);
  const own = (address) => routes.includes(address) || (!address.includes('{') && !below.some((folder) => address.startsWith(folder)));
  assert.deepEqual(Object.keys(openapi.paths).filter(own).sort(), [...routes, ...documents].sort());
  for (const address of routes) {
    const response = await daemon.get(address, { method: 'OPTIONS' });
    assert.equal(response.status, 204);
    const allowed = response.headers.get('allow');
    for (const method of methodsOf(address)) assert.ok(allowed.includes(method.toUpperCase()), `${address} ${allowed}`);
    assert.equal('post' in openapi.paths[address], allowed.includes('POST'));
  }
});

test('serves the documents unchanged, with everything they refer to', async () => {
  for (const name of ['openapi.json', 'asyncapi.json', 'schema/client.json', 'schema/server.json', 'schema/head-model.json', 'schema/timed.json', 'schema/pictures.json', 'schema/scene.json',
    'schema/library.json', 'schema/avatar-map.json']) {
    const response = await daemon.get(`/v1/${name}`);
    assert.equal(response.status, 200, name);
    assert.equal(response.headers.get('content-type'), 'application/json');
    assert.equal(await response.text(), read(`protocol/${name}`));
  }
  const references = [...`${read('protocol/openapi.json')}${read('protocol/asyncapi.json')}`.matchAll(/"\$ref": "([^#"][^"#]*)/g)].map(([, file]) => file);
  for (const file of new Set(references)) assert.equal((await daemon.get(`/v1/${file}`)).status, 200, file);
});

const BODIES = { '/v1/audio/speech': { input: 'Sì.' }, '/v1/library/reports': { word: 'calmo', lang: 'it' }, '/v1/gestures/{gesture}': JSON.parse(read('models/gestures/wink.json')), '/v1/library/files/{file}': { text: 'Sì.' }, '/v1/scenes/{scene}': { lines: [{ id: '1', text: 'Sì.' }] }, '/v1/revoke': { jti: 'x', exp: 4e9 }, '/v1/rooms/{room}/commands': { type: 'state', state: 'idle' } };
const bodyOf = (address) => (BODIES[address] instanceof ArrayBuffer ? BODIES[address] : JSON.stringify(BODIES[address]));
for (const { address, method, operation } of operations) {
  test(`answers ${method} ${address} as documented`, async () => {
    const room = await daemon.stream('?room=api');
    await room.wait({ type: 'joined' });
    const { models } = await room.wait({ type: 'hello' });
    const name = address.includes('schema') ? 'server.json' : models[0].name;
    if (address.includes('{film}')) {
      const { id } = await (await daemon.get('/v1/films?lang=it&text=x', { method: 'POST', body: 'Sì.' })).json();
      PLACES['{film}'] = id;
      await eventually(async () => (await (await daemon.get(`/v1/films/${id}`)).json()).state === 'done', 'a film');
    }
    const url = address.replace('{name}', name).replace(/\{\w+\}/g, (place) => PLACES[place]);
    const wants = (name) => parameters(operation).some((p) => p.name === name && p.in === 'query');
    const wantsRoom = wants('room');
    const query = wantsRoom ? '?room=api' : wants('text') ? '?text=Ciao&lang=it' : wants('q') ? '?q=mare' : wants('url') ? '?url=/library/mare/1' : '';
    const options = { method, headers: method === 'PUT' || method === 'DELETE' ? { 'if-match': '*' } : {} };
    if (operation.requestBody?.content['text/plain']) Object.assign(options, { body: 'Sì.', headers: { 'content-type': 'text/plain' } });
    if (BODIES[address] && method !== 'GET') options.body = bodyOf(address);
    if (operation.requestBody?.content['multipart/form-data']) {
      options.body = new FormData();
      options.body.append('fap', new Blob(['2.1 x 25 0\n']), 'x.fap');
    }
    if (address !== '/v1/events') {
      const response = await daemon.get(url + query, options);
      assert.ok(response.status < 300, `${response.status}`);
      await check(response, operation);
    }
    // without required parameters, and with a room that does not exist
    if (wantsRoom) await check(await daemon.get(url, options), operation);
    if (wantsRoom && method === 'POST') await check(await daemon.get(`${url}?room=nobody`, options), operation);
    if (address.includes('{')) await check(await daemon.get(address.replace(/\{\w+\}/g, 'nobody'), method === 'POST' ? options : {}), operation);
    await room.close();
  });
  for (const { name, schema } of parameters(operation).filter((p) => p.in === 'query' && method === 'POST' && p.name !== 'room'))
    if (schema.enum || schema.minimum !== undefined || schema.type === 'boolean')
      test(`${method} ${address} accepts ${name}`, async () => {
        const room = await daemon.stream('?room=api');
        await room.wait({ type: 'joined' });
        const options = { method, body: 'Sì.', headers: { 'content-type': 'text/plain' } };
        const form = new FormData();
        form.append('fap', new Blob(['2.1 x 25 0\n']), 'x.fap');
        if (address === '/v1/play') Object.assign(options, { body: form, headers: {} });
        const coach = address === '/v1/coach';
        if (coach) Object.assign(options, { body: bodyOf(address), headers: {} });
        const query = coach ? 'text=Ciao&lang=it' : 'room=api';
        const response = await daemon.get(`${address}?${query}&${name}=nonsense`, options);
        assert.equal(response.status, name === 'markup' && address === '/v1/say' ? 202 : 400);
        await check(response, operation);
        for (const value of schema.enum ?? []) {
          const good = await daemon.get(`${address}?${query}&${name}=${value}`, options);
          assert.ok(good.status < 300 || (name === 'markup' && good.status === 400) || (value === 'quiet' && good.status === 409), `${value} ${good.status}`);
          await good.arrayBuffer();
        }
        await room.close();
      });
}

// except client.sound, which is a binary message
const types = (side) =>
  Object.entries(asyncapi.components.messages).filter(([key]) => key.startsWith(side) && key !== 'client.sound').map(([key, message]) => {
    assert.equal(key, `${side}.${message.name}`);
    return message.name;
  });

test('the AsyncAPI document lists the messages of the schemas and of the daemon', () => {
  const known = [...read('server/api/commands.c').match(/commands\[\] = \{([^;]+)\};/)[1].matchAll(/\{"(\w+)"/g)].map(([, type]) => type);
  assert.deepEqual(types('client').sort(), known.sort());
  for (const side of ['client', 'server']) {
    const schema = load(`schema/${side}.json`);
    assert.deepEqual(types(side).filter((type) => type !== 'media' || side === 'client').sort(), schema.properties.type.enum.sort());
  }
  for (const { payload } of Object.values(asyncapi.components.messages)) if (payload) assert.ok(ajv.getSchema(payload.schema.$ref), payload.schema.$ref);
  for (const operation of Object.values(asyncapi.operations))
    for (const message of operation.messages) assert.ok(at(asyncapi, at(asyncapi, message)));
});

test('the daemon accepts each client message and sends each server message', async () => {
  const stream = await daemon.stream('?lang=it');
  const texts = { text: '<speak>Uno <mark name="m"/>due. Tre.</speak>', markup: 'ssml', phones: true, speaker: 'Anna' };
  const members = { speak: texts, rate: { rate: 150 }, jump: { mark: 'm' }, join: { room: 'api' }, play: { name: 'x' },
    choices: { choices: ['Sì'] }, choose: { choice: 0 }, state: { state: 'idle' }, consent: { consent: 'asked', text: 'Sì?' }, calibrate: { featurePointsCoord: { '8.3': [26, -62, 18] } }, lexicon: { lexicon: '' }, backdrop: { source: 'x.png' }, head: { head: '' }, said: { id: 'said', text: 'Sì' }, text: { id: 'w', text: 'Uno.' }, flush: { id: 'w' }, close: { id: 'w' }, cancel: { id: 'w' }, voice: { id: 'v', rate: 16000 }, ask: { text: 'Sì?', id: 'q', choices: ['Sì'] }, hear: { id: 'h', rate: 16000 }, drive: { frames: [{ time: 0, faps: { 3: 300 } }] } };
  const order = ['ping', 'model', 'media', 'idle', 'authorize', 'join', 'express', 'choices', 'choose', 'state', 'consent', 'calibrate', 'lexicon', 'backdrop', 'head', 'manner', 'drive', 'said', 'overhear', 'speak', 'text', 'flush', 'close', 'cancel', 'pause', 'rate', 'jump', 'resume', 'play', 'voice', 'hear', 'leave', 'stop', 'ask'];
  assert.deepEqual([...order].sort(), types('client').sort());
  const desk = await daemon.stream(); // observers are notified of each other (observers)
  desk.send({ type: 'join', room: 'api', watch: true });
  await desk.wait({ type: 'observers' });
  const mix = [{ name: 'joy' }];
  for (const type of order) {
    if (type === 'leave') await stream.wait({ type: 'end', reason: 'done' });
    stream.send({ type, mix, token: 'x', ...members[type] });
  }
  await stream.wait({ type: 'asked' });
  stream.send({ type: 'choices', choices: ['No'] }); // in place of the question's
  await stream.wait({ type: 'answered', reason: 'withdrawn' });
  stream.send({ type: 'speak', markup: 'ssml', text: '<speak>Ciao.<bark/></speak>' });
  await stream.wait({ type: 'warning' });
  stream.send({ type: 'ping', id: 'last' });
  await stream.wait({ type: 'pong', id: 'last' });
  const messages = [...stream.messages, ...desk.messages];
  assert.ok(!messages.some((m) => m.code === 'unknown-type' || m.code === 'bad-message'));
  // authorized is sent only when tokens are required, overheard only with a recogniser
  const heard = new Set([...messages.map((m) => m.type), stream.chunks.length && 'media', 'authorized', 'overheard']);
  assert.deepEqual(types('server').filter((type) => !heard.has(type)), []);
  for (const { arrived, ...message } of messages)
    assert.ok(ajv.validate({ $ref: 'schema/server.json' }, message), `${arrived} ${JSON.stringify(message).slice(0, 200)}: ${ajv.errorsText()}`);
  for (const opened of [stream, desk]) await opened.close();
});
