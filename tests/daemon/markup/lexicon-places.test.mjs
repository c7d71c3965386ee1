// SPDX-License-Identifier: GPL-3.0-or-later
// Scopes of lexicons: a request, a work and its library, a room, the daemon; their precedence; and readers' reports.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { faccia } from '../../lib/command.mjs';
import { Daemon, eventually } from '../../lib/daemon.mjs';
import { sign } from '../../lib/tokens.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-lexicon-places-'));
const [works, reports] = ['works', 'reports'].map((name) => path.join(folder, name));
const pls = (entries, lang = 'it') => `<?xml version="1.0" encoding="UTF-8"?>
<lexicon version="1.0" xmlns="http://www.w3.org/2005/01/pronunciation-lexicon" alphabet="ipa" xml:lang="${lang}">
${Object.entries(entries).map(([word, said]) => `<lexeme><grapheme>${word}</grapheme><alias>${said}</alias></lexeme>`).join('\n')}
</lexicon>
`;
const secret = 'a secret that is long enough for the daemon';
const token = (rights) => ({ authorization: `Bearer ${sign({ secret, claims: { rights } })}` });
const [editor, reader] = ['listen speak operate', 'listen'].map(token);

let daemon;
before(async () => {
  for (const each of [works, reports]) fs.mkdirSync(each);
  fs.writeFileSync(path.join(folder, 'secrets'), secret, { mode: 0o600 });
  fs.writeFileSync(path.join(folder, 'daemon.pls'), pls({ uno: 'daemon', due: 'daemon', tre: 'daemon', quattro: 'daemon', cinque: 'daemon' }));
  fs.writeFileSync(path.join(works, 'lexicon.pls'), pls({ uno: 'libreria', due: 'libreria', tre: 'libreria' }));
  fs.writeFileSync(path.join(works, 'mare.txt'), 'Uno, due, tre, quattro, cinque.\n');
  fs.writeFileSync(path.join(works, 'mare.pls'), pls({ uno: 'opera', due: 'opera' }));
  fs.writeFileSync(path.join(works, 'luna.txt'), 'Uno, due, tre.\n');
  daemon = await Daemon.start(['--lexicon', path.join(folder, 'daemon.pls'), '--library', works, '--library-index', path.join(folder, 'index'), '--editing', '--reports', reports,
    '--secret-file', path.join(folder, 'secrets')]);
});
after(async () => {
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  fs.rmSync(folder, { recursive: true });
});

const speech = async (body, headers = editor) => {
  const response = await daemon.get('/v1/speech?format=json', { method: 'POST', body: JSON.stringify({ lang: 'it', ...body }), headers: { 'content-type': 'application/json', ...headers } });
  return response.json();
};
const ipa = (answer) => (answer.phones ?? []).map((phone) => phone.ipa).join('');
/** Checks that both sound the same. */
const heardAs = async (asked, words) => assert.equal(ipa(await speech(asked)), ipa(await speech({ text: words })), JSON.stringify(asked).slice(0, 200));

test('applies lexicons in order: request, work, library, daemon', async () => {
  await eventually(async () => ipa(await speech({ passage: 'mare:1' })) === ipa(await speech({ text: 'Opera, opera, libreria, daemon, daemon.' })), 'the lexicons of the library');
  await heardAs({ passage: 'luna:1' }, 'Libreria, libreria, libreria.');
  await heardAs({ text: 'Uno, due, tre.' }, 'Daemon, daemon, daemon.');
  await heardAs({ passage: 'mare:1', lexicon: pls({ uno: 'richiesta', quattro: 'richiesta' }) }, 'Richiesta, opera, libreria, richiesta, daemon.');
  await heardAs({ text: 'Uno, due, tre, quattro.', work: 'mare:1:p1' }, 'Opera, opera, libreria, daemon.');
  await heardAs({ text: 'Uno, due.', work: 'nessuno' }, 'Libreria, libreria.');
  const own = { text: '<speak xml:lang="it"><sub alias="pane">uno</sub>, <say-as interpret-as="characters">zie</say-as>, <phoneme ph="pane">sei</phoneme>.</speak>', markup: 'ssml' };
  assert.equal(ipa(await speech({ ...own, lexicon: pls({ uno: 'barca', zie: 'barca', sei: 'barca', pane: 'barca' }) })), ipa(await speech(own)));
});

test('accepts a lexicon in the query and over the stream, within a limit', async () => {
  const lexicon = pls({ gatto: 'micio' });
  const byQuery = await (await daemon.get(`/v1/speech?${new URLSearchParams({ format: 'json', lang: 'it', text: 'Ecco il gatto.', lexicon })}`, { headers: editor })).json();
  assert.equal(ipa(byQuery), ipa(await speech({ text: 'Ecco il micio.' })));
  assert.deepEqual(byQuery.words.map(({ text }) => text), ['Ecco', 'il', 'gatto']);
  const long = await speech({ text: 'Gatto.', lexicon: `<lexicon xml:lang="it">${' '.repeat(66000)}</lexicon>` });
  assert.deepEqual([long.code, long.field], ['bad-field', 'lexicon']);
});

test('reports an error in a request\'s lexicon with line and column', async () => {
  const broken = await speech({ text: 'Gatto.', lexicon: '<lexicon xml:lang="it">\n  <lexeme>' });
  assert.deepEqual([broken.type, broken.code, broken.line], ['error', 'bad-lexicon', 2]);
  assert.ok(broken.column >= 1);
  assert.match(broken.message, /^the lexicon: /);
  const other = await speech({ text: 'Gatto.', lexicon: '\n<speak/>' });
  assert.deepEqual([other.code, other.line, other.column], ['bad-lexicon', 2, 1]);
  const faulty = await speech({ text: 'Ecco il gatto.', lexicon: pls({ gatto: 'micio' }).replace('</lexicon>', '<lexeme><grapheme>x</grapheme></lexeme></lexicon>') });
  assert.equal(ipa(faulty), ipa(await speech({ text: 'Ecco il micio.' })));
  assert.equal(faulty.warnings.length, 1);
  assert.match(faulty.warnings[0].message, /4:\d+: .*ignored/);
});

test('finds a spelling of several words with a mark before each, and keeps the marks in order', async () => {
  const text = '<speak xml:lang="it"><mark name="a"/>Vedo <mark name="b"/>New <mark name="c"/>York <mark name="d"/>ora.</speak>';
  const answer = await speech({ text, markup: 'ssml', lexicon: pls({ 'New York': 'Nuova Torre' }) });
  assert.equal(ipa(answer), ipa(await speech({ text: 'Vedo Nuova Torre ora.' })));
  assert.deepEqual(answer.marks.map(({ name }) => name), ['a', 'b', 'c', 'd']);
  const times = answer.marks.map(({ time }) => time);
  assert.deepEqual(times, times.toSorted((a, b) => a - b));
  assert.ok(Math.abs(times[3] - answer.words.find(({ text: word }) => word === 'ora').start) < 0.05, JSON.stringify([times, answer.words]));
});

test('speaks an emoji that a lexicon contains, and omits the others', async () => {
  const lexicon = pls({ '😀': 'sorriso' });
  await heardAs({ text: 'Ciao 😀 mamma 🎉.', lexicon }, 'Ciao sorriso mamma.');
  const file = path.join(folder, 'emoji.pls');
  fs.writeFileSync(file, lexicon);
  assert.equal(faccia(['read', '--lang', 'it', '--lexicon', file, '--words', 'Ciao 😀 mamma 🎉.']).stdout.trim(), 'Ciao sorriso mamma');
});

const command = async (room, message, headers = editor) => {
  const response = await daemon.get(`/v1/rooms/${room}/commands`, { method: 'POST', body: JSON.stringify(message), headers: { 'content-type': 'application/json', ...headers } });
  return { status: response.status, ...(await response.json()) };
};

test('a lexicon set in a room applies to all later speech there, and is sent to late joiners', async () => {
  const query = `?room=sala&lang=it&token=${editor.authorization.slice(7)}`;
  const listener = await daemon.stream(query);
  await listener.wait({ type: 'joined' });
  const said = async (id, text) => {
    listener.send({ type: 'speak', id, text, phones: true, mode: 'replace' });
    await listener.wait({ type: 'end', id });
    const begin = listener.messages.find((message) => message.type === 'begin' && message.id === id);
    return listener.messages.filter((message) => message.type === 'phone' && message.utterance === begin.utterance).map((message) => message.ipa).join('');
  };
  const words = 'Stanza daemon.';
  const plain = await said('plain', words);
  assert.equal((await command('sala', { type: 'lexicon', lexicon: pls({ uno: 'stanza' }) }, reader)).code, 'forbidden');
  const bad = await command('sala', { type: 'lexicon', lexicon: '<lexicon>\n' });
  assert.deepEqual([bad.status, bad.code], [400, 'bad-lexicon']);
  assert.equal((await command('sala', { type: 'lexicon' })).code, 'missing-field');
  const lexicon = pls({ uno: 'stanza' });
  assert.equal((await command('sala', { type: 'lexicon', lexicon })).type, 'accepted');
  await listener.wait({ type: 'lexicon', lexicon });
  assert.equal(await said('set', 'Uno due.'), plain);
  const late = await daemon.stream(query);
  await late.wait({ type: 'lexicon', stream: 'sala', lexicon });
  await late.close();
  listener.send({ type: 'lexicon', lexicon: '' });
  await listener.wait({ type: 'lexicon', lexicon: '' });
  assert.notEqual(await said('cleared', 'Uno due.'), plain);
  const later = await daemon.stream(query);
  await later.wait({ type: 'joined' });
  later.send({ type: 'ping' });
  await later.wait({ type: 'pong' });
  assert.equal(later.messages.some(({ type }) => type === 'lexicon'), false);
  await later.close();
  await listener.close();
});

const file = (method, name, body, headers = {}) => daemon.get(`/v1/library/files/${name}`, { method, body, headers: { ...editor, ...headers } });

test('an editor saves the lexicon of a work, which applies at once; a faulty one is rejected with its position', async () => {
  const saved = await file('PUT', 'luna.pls', pls({ uno: 'corretto' }));
  assert.equal(saved.status, 201);
  await eventually(async () => ipa(await speech({ passage: 'luna:1' })) === ipa(await speech({ text: 'Corretto, libreria, libreria.' })), 'the corrected word', 120000);
  const refused = await (await file('PUT', 'luna.pls', pls({ uno: 'x' }).replace('<alias>x</alias>', ''), { 'if-match': saved.headers.get('etag') })).json();
  assert.deepEqual([refused.code, refused.line], ['bad-lexicon', 3]);
  assert.equal((await file('DELETE', 'luna.pls', undefined, { 'if-match': '*' })).status, 200);
  await eventually(async () => ipa(await speech({ passage: 'luna:1' })) === ipa(await speech({ text: 'Libreria, libreria, libreria.' })), 'the lexicon to be gone', 120000);
});

test('exports a work as it is read aloud', () => {
  const out = path.join(folder, 'mare.TextGrid');
  const phones = (from) => {
    const { status, stderr } = faccia(['library', 'export', from, 'mare', '--textgrid', out]);
    assert.equal(status, 0, stderr);
    return [.../name = "phones"[^]*/.exec(fs.readFileSync(out, 'utf8'))[0].matchAll(/text = "(.*)"/g)].map(([, text]) => text).join('');
  };
  const plain = path.join(folder, 'plain');
  fs.mkdirSync(plain);
  fs.writeFileSync(path.join(plain, 'mare.txt'), 'Opera, opera, libreria, quattro, cinque.\n');
  assert.equal(phones(works), phones(plain));
  fs.writeFileSync(path.join(works, 'rotto.txt'), 'Uno.\n');
  fs.writeFileSync(path.join(works, 'rotto.pls'), '<lexicon>');
  const broken = faccia(['library', 'export', works, 'rotto', '--textgrid', out]);
  assert.equal(broken.status, 1);
  assert.match(broken.stderr, /rotto\.pls.*bad-(lexicon|xml)/);
  for (const name of ['rotto.txt', 'rotto.pls']) fs.rmSync(path.join(works, name));
});

const report = async (body, headers = reader) => {
  const response = await daemon.get('/v1/library/reports', { method: 'POST', body: typeof body === 'string' ? body : JSON.stringify(body), headers: { 'content-type': 'application/json', ...headers } });
  return { status: response.status, ...(await response.json()) };
};
const reported = async (headers = editor) => (await daemon.get('/v1/library/reports', { headers })).json();

test('readers report misread words, which an editor sees and dismisses', async () => {
  const bowie = { word: 'Bowie', lang: 'it', work: 'mare', passage: 'mare:1:p1', context: 'canta Bowie adesso', note: 'bo-ui' };
  const first = await report(bowie);
  assert.deepEqual([first.status, first.type], [201, 'reported']);
  const again = await report({ ...bowie, note: 'other' });
  assert.deepEqual([again.status, again.name], [200, first.name], 'the same word of the same work is kept once');
  const { reports: list } = await reported();
  assert.deepEqual(list.map(({ bytes, saved, ...rest }) => rest), [{ name: first.name, ...bowie }]);
  assert.equal((await reported(reader)).code, 'forbidden');
  assert.equal((await report(bowie, {})).code, 'token-needed');
  const remove = (headers) => daemon.get(`/v1/library/reports/${first.name}`, { method: 'DELETE', headers });
  assert.equal((await remove(reader)).status, 403);
  assert.equal((await remove(editor)).status, 200);
  assert.deepEqual((await reported()).reports, []);
  assert.equal((await daemon.get(`/v1/library/reports/${first.name}`, { method: 'PUT', body: '{}', headers: editor })).status, 405);
});

test('validates reports, and limits a reader\'s reports per minute', async () => {
  for (const [body, code, field] of [
    ['{', 'bad-json'], [{ lang: 'it' }, 'missing-field', 'word'], [{ word: 'x' }, 'missing-field', 'lang'], [{ word: 'x'.repeat(201), lang: 'it' }, 'bad-field', 'word'],
    [{ word: 'x', lang: '!!' }, 'bad-field', 'lang'], [{ word: 'x', lang: 'it', note: 3 }, 'bad-field', 'note'], [{ word: 'a\0b', lang: 'it' }, 'bad-json'],
  ]) {
    const answer = await report(body, token('listen speak'));
    assert.deepEqual([answer.status, answer.code, answer.field], [400, code, field]);
  }
  const answers = [];
  for (let i = 0; i < 25; i++) answers.push((await report({ word: `parola${i}`, lang: 'it' }, token('listen speak operate'))).status);
  assert.ok(answers.includes(429), answers.join());
  assert.ok(answers.filter((status) => status === 201).length <= 20, answers.join());
});

test('where the operator allows it, a report needs no token, but a wrong token is still refused', async () => {
  const open = await Daemon.start(['--library', works, '--library-index', path.join(folder, 'index2'), '--reports', reports, '--open-reports', '--secret-file', path.join(folder, 'secrets')], {}, { voices: false });
  const send = (headers) => open.get('/v1/library/reports', { method: 'POST', body: '{"word":"aperto","lang":"it"}', headers });
  assert.equal((await send({})).status, 201);
  assert.equal((await send({ authorization: 'Bearer wrong' })).status, 401);
  assert.equal((await open.get('/v1/library/reports')).status, 401);
  assert.equal((await open.stop()).code, 0);
  const none = await Daemon.start([], {}, { voices: false });
  assert.equal((await (await none.get('/v1/library/reports', { method: 'POST', body: '{"word":"x","lang":"it"}' })).json()).code, 'nothing-kept');
  assert.equal((await none.stop()).code, 0);
});
