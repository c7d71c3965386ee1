// SPDX-License-Identifier: GPL-3.0-or-later
// The library: works in all formats, valid, broken and hostile; search; passages spoken by a voice and by a recording; changed files, and
// killed processes.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import http from 'node:http';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import Ajv from 'ajv/dist/2020.js';
import { Daemon, build, eventually, root } from '../../lib/daemon.mjs';
import { further } from '../../lib/long.mjs';
import { epub, sentencesOf, writeZip } from '../../lib/works.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-library-'));
const works = path.join(folder, 'works');
const index = path.join(folder, 'works.index');
const put = (name, text) => fs.writeFileSync(path.join(works, name), text);
const tei = (body, doctype = '') => `<?xml version="1.0"?>\n${doctype}<TEI xml:lang="it"><text><body>${body}</body></text></TEI>`;
const program = path.join(build, 'server/cli/faccia');
const ajv = new Ajv({ strict: false });
const schema = JSON.parse(fs.readFileSync(path.join(root, 'protocol/schema/library.json')));
ajv.addSchema(schema, 'library');

let daemon;
const ask = async (address, status = 200, options = {}) => {
  const response = await fetch(`${daemon.url}${address}`, options);
  const text = await response.text();
  assert.equal(response.status, status, text);
  return text ? JSON.parse(text) : response;
};
const valid = (name, value) => {
  const check = ajv.getSchema(`library#/$defs/${name}`);
  assert.ok(check(value), `${ajv.errorsText(check.errors)}\n${JSON.stringify(value).slice(0, 500)}`);
  return value;
};
const search = async (query) => valid('found', await ask(`/v1/library/search?${new URLSearchParams(query)}`)).results;
const ids = (results) => results.map(({ passage }) => passage);
const list = () => ask('/v1/library?limit=1000');
const ready = () => eventually(async () => { const all = await list(); return all.state === 'ready' && all; }, 'the library');
const section = async (work, number) => valid('section', await ask(`/v1/library/works/${work}/sections/${number}`));

before(async () => {
  fs.cpSync(path.join(root, 'models/library'), works, { recursive: true });
  for (const name of ['meson.build', 'la-chiave.xml']) fs.rmSync(path.join(works, name));
  writeZip(path.join(works, 'libro.epub'), epub({
    'uno.xhtml': '<h1>Capitolo primo</h1><p>La strada era <em>lunga</em>, e nessuno parlava.</p><p>Rosa,<br/>rosa rossa,<br/>dove vai?</p><aside epub:type="footnote" xmlns:epub="http://www.idpf.org/2007/ops"><p>Una nota.</p></aside>',
    'due.xhtml': '<h1>Capitolo secondo</h1><p>Poi parlarono <span lang="en">all together</span>.</p>',
  }));
  // hostile, or broken
  put('broken.xml', '<TEI><text><body>\n<p>Una riga buona.</p>\n<p>Poi <hi>no</p></body></text></TEI>');
  put('laughs.xml', tei('<p>&d;</p>', `<!DOCTYPE TEI [<!ENTITY a "${'x'.repeat(1000)}">${['b', 'c', 'd'].map((name, i) => `<!ENTITY ${name} "${`&${'abc'[i]};`.repeat(100)}">`).join('')}]>\n`));
  put('outside.xml', tei('<p>Prima &secret; dopo.</p>', '<!DOCTYPE TEI [<!ENTITY secret SYSTEM "file:///etc/passwd">]>\n'));
  put('deep.xml', tei('<q>'.repeat(2000) + 'x' + '</q>'.repeat(2000)));
  put('unknown.xml', tei('<p>Una <marvel>meraviglia</marvel>.</p>'));
  put('latin.txt', Buffer.from('Una riga.\nPerch\xe9 no?\n', 'latin1'));
  put('empty.txt', '');
  put('acentos.pt-BR.txt', 'A nação espera, as nações esperam.\n\nUma nacao sem acentos.\n');
  put('haus.de.txt', 'Das schöne Haus.\n');
  writeZip(path.join(works, 'bomb.epub'), epub({ 'uno.xhtml': 80 }));
  writeZip(path.join(works, 'escape.epub'), epub({ '../../../etc/passwd': '<p>x</p>' }));
  writeZip(path.join(works, 'escape2.epub'), epub({ 'uno.xhtml': '<p>x</p>' }, { opf: '/etc/book.opf' }));
  put('not.epub', 'this is no archive');
  execFileSync(program, ['say', '--lang', 'it', '--wav', path.join(works, 'detto.wav'), 'La luna sale sul monte. Il gatto dorme vicino al fuoco.']);
  put('detto.md', '---\ntitle: Detto\nlang: it\n---\nLa luna sale sul monte. Il gatto dorme vicino al fuoco.\n');
  daemon = await Daemon.start(['--library', works, '--library-index', index]);
  await ready();
});
after(async () => {
  assert.equal((await daemon.stop()).code, 0, daemon.log);
  fs.rmSync(folder, { recursive: true });
});

test('lists works with their metadata, page by page', async () => {
  const all = valid('library', await list());
  const by = Object.fromEntries(all.works.map((work) => [work.id, work]));
  assert.equal(by.mare.title, 'Il mare d\'inverno');
  assert.equal(by['o-farol'].lang, 'pt-BR');
  assert.equal(by['kuslar-tr'].lang, 'tr');
  assert.equal(by.libro.author, 'A. Rossi');
  assert.equal(by.detto.recording, true);
  assert.ok(all.languages.includes('tr') && all.authors.includes('A. Rossi'));
  const seen = [];
  for (let next = ''; next !== undefined; ) {
    const page = await ask(`/v1/library?limit=2&after=${next}`);
    seen.push(...page.works.map(({ id }) => id));
    next = page.next;
  }
  assert.deepEqual(seen, Object.keys(by).sort());
});

test('reports errors in a file with their position, and they affect only that file', async () => {
  const { problems } = await list();
  const of = (file) => problems.filter((problem) => problem.file === file);
  assert.deepEqual(of('broken.xml').map(({ line, column, serious }) => [line, column, serious]), [[3, 16, true]]);
  assert.match(of('laughs.xml')[0].message, /amplification/);
  assert.equal(of('outside.xml').length, 0);
  assert.match(of('deep.xml')[0].message, /more than 256 deep/);
  assert.deepEqual(of('unknown.xml').map(({ code, line, serious }) => [code, line, serious]), [['unknown-element', 2, false]]);
  assert.deepEqual(of('latin.txt').map(({ line, column }) => [line, column]), [[2, 6]]);
  assert.match(of('empty.txt')[0].message, /no text/);
  assert.match(of('bomb.epub')[0].message, /bytes, more than the limit/);
  assert.match(of('escape.epub')[0].message, /outside the archive/);
  assert.match(of('escape2.epub')[0].message, /outside the archive/);
  assert.ok(of('not.epub')[0].serious);
  assert.deepEqual((await section('broken', 1)).blocks.map(({ text }) => text).slice(0, 1), ['Una riga buona.']);
  const { blocks } = await section('outside', 1);
  assert.equal(blocks[0].text, 'Prima dopo.');
});

test('TEI: reads verses, speakers, notes, pages, foreign words', async () => {
  const verse = (await section('mare', 1)).blocks[1];
  assert.equal(verse.id, 'mare:1:g1');
  assert.deepEqual(verse.lines.map(({ id, n, start, end }) => [id, n, verse.text.slice(start, end)])[3], ['mare:1:l4', '4', "l'amor del sale, la notte serena."]);
  const { blocks } = await section('mare', 2);
  assert.deepEqual(blocks.slice(0, 6).map(({ kind }) => kind), ['head', 'page', 'stage', 'speaker', 'paragraph', 'note']);
  const [foreign, note] = blocks[4].marks;
  assert.equal(blocks[4].speaker, 'Anna');
  assert.deepEqual([foreign.lang, blocks[4].text.slice(foreign.start, foreign.end)], ['en', 'slow and steady']);
  assert.deepEqual([note.note, note.start, blocks[5].id], ['mare:2:n1', blocks[4].text.length, 'mare:2:n1']);
});

test('reads EPUB, Markdown, text and our own markup', async () => {
  const { blocks } = await section('libro', 1);
  assert.deepEqual(blocks.map(({ kind }) => kind), ['head', 'paragraph', 'verse', 'note']);
  assert.equal(blocks[2].text, 'Rosa,\nrosa rossa,\ndove vai?');
  assert.equal((await section('libro', 2)).title, 'Capitolo secondo');
  assert.deepEqual((await section('o-farol', 2)).blocks.map(({ kind }) => kind), ['head', 'verse', 'paragraph']);
  assert.deepEqual((await section('kuslar-tr', 1)).blocks.map(({ kind }) => kind), ['verse', 'paragraph']);
  const [ssml] = (await section('the-clock', 1)).blocks;
  const source = fs.readFileSync(path.join(works, 'the-clock.ssml'), 'utf8');
  assert.deepEqual([ssml.markup, ssml.text.length, ssml.text.indexOf('never')], ['ssml', source.length, source.indexOf('never')]);
});

test('finds words in any form, without accents, dots and articles', async () => {
  for (const [q, passage, word] of [
    ['amore', 'mare:1:l4', 'amor'],
    ["l'amor", 'mare:1:l4', 'amor'],
    ['pescatori', 'mare:1:l3', 'pescatore'],
    ['ISIK', 'kuslar-tr:1:l4', 'ışık'],
    ['pencere', 'kuslar-tr:1:l3', 'pencereyi'],
    ['história', 'o-farol:2:h1', 'história'],
    ['historia', 'o-farol:2:h1', 'história'],
    ['clocks', 'the-clock:1:p1', 'clock'],
    ['nações', 'acentos-pt-br:1:p1', 'nações'],
    ['schone', 'haus-de:1:p1', 'schöne'],
  ]) {
    const [found] = await search({ q });
    assert.ok(found, q);
    const { text, marks } = found.snippet;
    assert.deepEqual([found.passage, text.slice(...marks[0])], [passage, word], q);
  }
  assert.equal((await search({ q: 'nacao' })).length, 2, 'an accent that is left out takes no form away');
  assert.deepEqual(ids(await search({ q: '"la luna"' })).sort(), ['detto:1:p1', 'mare:1:l1']);
  assert.deepEqual(ids(await search({ q: 'pesc*' })), ['mare:1:l3']);
  assert.deepEqual(ids(await search({ q: 'NEAR(luna piena, 2)' })), ['mare:1:l1']);
  assert.deepEqual(ids(await search({ q: 'luna NOT gatto' })), ['mare:1:l1']);
  assert.deepEqual(ids(await search({ q: '(gatto OR farol) AND luna' })), ['detto:1:p1']);
  assert.deepEqual(await search({ q: 'luna gatto pescatore' }), []);
  assert.deepEqual(ids(await search({ q: 'luna', work: 'detto' })), ['detto:1:p1']);
  assert.ok((await search({ q: 'barca OR barco', lang: 'pt' })).every(({ lang }) => lang === 'pt-BR'));
  assert.deepEqual(await search({ q: 'luna', author: 'nobody' }), []);
});

test('pages the results', async () => {
  const all = ids(await search({ q: 'la OR il', limit: 100 }));
  const seen = [];
  for (let after = '0'; after !== undefined; ) {
    const page = await ask(`/v1/library/search?q=la+OR+il&limit=2&after=${after}`);
    seen.push(...ids(page.results));
    after = page.next;
  }
  assert.ok(all.length > 4);
  assert.deepEqual(seen, all);
});

test('ranks some of many hits from all of the library, and continues paging behind them', async () => {
  const paragraphs = Array.from({ length: 2200 }, (_, i) => (i === 2100 ? 'Zafferano, zafferano, e ancora zafferano.' : `Zafferano con parola${i % 3 === 2 || i === 2199 ? ' pepe' : ''}, riga ${i + 1}.`));
  put('molti.md', `---\ntitle: Molti\nlang: it\nauthor: A. Molti\n---\n${paragraphs.join('\n\n')}\n`);
  const page = async (query) => valid('found', await ask(`/v1/library/search?${new URLSearchParams({ q: 'zafferano', ...query })}`));
  await eventually(async () => (await page({})).results.length, 'the new work');
  const first = await page({ limit: 5 });
  assert.deepEqual([first.ranked, first.results[0].passage], [false, 'molti:1:p2101']);
  assert.ok(first.results.every(({ score }, i, all) => !i || score <= all[i - 1].score));
  const seen = new Set();
  let next = '0', pages = 0;
  for (; next !== undefined; pages++) {
    const one = await page({ limit: 100, after: next });
    for (const id of ids(one.results)) seen.add(id);
    next = one.next;
  }
  assert.deepEqual([seen.size, pages, first.total, first.counted], [2200, 22, 2200, true]);
  const both = await page({ q: 'zafferano pepe 2200', author: 'A. Molti' });
  assert.deepEqual([both.ranked, ids(both.results)], [true, ['molti:1:p2200']], 'all words must be there, common ones, too');
  assert.equal((await page({ author: 'A. Rossi' })).results.length, 0);
  assert.equal((await page({ work: 'mare,molti', lang: 'it', limit: 3 })).results.length, 3);
  assert.equal((await page({ lang: 'en' })).results.length, 0);
  fs.rmSync(path.join(works, 'molti.md'));
});

test('counts by author, language, form and century, and searches titles, speakers and stage directions', async () => {
  put('recita.xml', `<?xml version="1.0"?><TEI xmlns="http://www.tei-c.org/ns/1.0" xml:lang="it"><teiHeader><fileDesc><titleStmt><title>Lo zibibbo</title><author>P. Vino</author></titleStmt>
    <sourceDesc><bibl><date>1743</date></bibl></sourceDesc></fileDesc></teiHeader><text><body><div><head>Atto unico</head><sp who="#b"><speaker>Brighella</speaker><p>Il zibibbo è dolce.</p></sp>
    <stage>Esce zoppicando.</stage><sp who="#c"><speaker>Corallina</speaker><p>Troppo, e lo zibibbo macchia.</p></sp></div></body></text></TEI>`);
  put('vigna.md', '---\ntitle: La vigna\nlang: it\nauthor: P. Vino\ndate: 1899\n---\nQuattro acini di zibibbo.\n');
  const page = async (query) => valid('found', await ask(`/v1/library/search?${new URLSearchParams(query)}`));
  const all = await eventually(async () => { const found = await page({ q: 'zibibbo', facets: true }); return found.total === 3 && found; }, 'both works');
  const counts = (facet) => Object.fromEntries(all.facets[facet].map(({ value, count }) => [value.id ?? value, count]));
  assert.deepEqual(counts('author'), { 'P. Vino': 3 });
  assert.deepEqual(counts('form'), { drama: 2, prose: 1 });
  assert.deepEqual(counts('century'), { 18: 2, 19: 1 });
  assert.deepEqual(counts('work'), { recita: 2, vigna: 1 });
  assert.deepEqual(all.titles.map(({ id }) => id), ['recita']);
  assert.equal((await page({ q: 'zibibbo', form: 'prose' })).total, 1);
  assert.equal((await page({ q: 'zibibbo', century: '17,18' })).total, 2);
  assert.equal((await page({ q: 'zibibbo', kind: 'head,verse' })).total, 0);
  assert.deepEqual((await page({ q: 'corallina', kind: 'speaker' })).results.map(({ passage, kind, snippet }) => [passage, kind, snippet.text]), [['recita:1:p2', 'speaker', 'Corallina']]);
  assert.deepEqual((await page({ q: 'zoppicare', kind: 'stage' })).results.map(({ passage }) => passage), ['recita:1:p2']);
  assert.equal((await page({ q: 'corallina' })).total, 0, 'names of speakers are searched only on request');
  for (const facets of [1, 'true']) assert.ok((await page({ q: 'zibibbo', facets })).facets);
  for (const facets of [0, 'false']) assert.ok(!(await page({ q: 'zibibbo', facets })).facets);
  assert.equal((await ask('/v1/library/passages/recita:1?names=maybe', 400)).field, 'names');
  assert.equal((await ask('/v1/library/passages/recita:1?names=1')).text, (await ask('/v1/library/passages/recita:1?names=true')).text);
  for (const [name, value] of [['facets', 'maybe'], ['form', 'opera'], ['kind', 'stage,head'], ['century', '19,x'], ['century', '0'], ['prefer', 'it,?']])
    assert.equal((await ask(`/v1/library/search?${new URLSearchParams({ q: 'zibibbo', [name]: value })}`, 400)).field, name, `${name}=${value}`);
  put('vinho.pt-BR.txt', 'Bebe zibibbo, zibibbo e zibibbo.\n');
  await eventually(async () => (await page({ q: 'zibibbo' })).total === 4, 'the Portuguese one');
  assert.equal((await page({ q: 'zibibbo', prefer: 'pt' })).results[0].work.id, 'vinho-pt-br');
  assert.notEqual((await page({ q: 'zibibbo', prefer: 'it' })).results[0].work.id, 'vinho-pt-br');
  for (const name of ['recita.xml', 'vigna.md', 'vinho.pt-BR.txt']) fs.rmSync(path.join(works, name));
});

test('gives every occurrence with its context, page by page, and as CSV', async () => {
  put('eco.md', '---\ntitle: L\'eco, "due" volte\nlang: it\n---\nEco, disse: èco... e l\'eco rispose.\n\nNiente.\n\nAncora echi.\n');
  const page = async (query) => valid('concordance', await ask(`/v1/library/concordance?${new URLSearchParams({ q: 'eco OR echi', work: 'eco', ...query })}`));
  const whole = await eventually(async () => { const found = await page({}); return found.lines.length && found; }, 'the echo');
  assert.deepEqual(whole.lines.map(({ left, match, right, passage }) => [left, match, right, passage]), [
    ['', 'Eco', ", disse: èco... e l'eco rispose.", 'eco:1:p1'], ['Eco, disse: ', 'èco', "... e l'eco rispose.", 'eco:1:p1'], ["Eco, disse: èco... e l'", 'eco', ' rispose.', 'eco:1:p1'], ['Ancora ', 'echi', '.', 'eco:1:p3'],
  ]);
  const seen = [];
  for (let after = null; after !== undefined;) {
    const one = await page({ limit: 1, ...(after && { after }) });
    seen.push(...one.lines);
    after = one.next;
  }
  assert.deepEqual(seen, whole.lines);
  assert.deepEqual((await page({ width: 4 })).lines.map(({ left, right }) => [left, right])[1], ['se: ', '... ']);
  const csv = await (await fetch(`${daemon.url}/v1/library/concordance?q=echi&work=eco&format=csv`)).text();
  assert.deepEqual(csv.split('\r\n').slice(-2), [`"Ancora ","echi",".","eco:1:p3","paragraph","it","eco","L'eco, ""due"" volte","","${daemon.url}/library.html?at=eco:1:p3"`, '']);
  for (const [name, value] of [['after', 'x'], ['after', '1'], ['width', '0'], ['limit', '1001']])
    assert.equal((await ask(`/v1/library/concordance?${new URLSearchParams({ q: 'eco', [name]: value })}`, 400)).field, name);
  fs.rmSync(path.join(works, 'eco.md'));
});

test('finds old spellings by the spelling of today, and the other way round', async () => {
  put('antico.md', '---\ntitle: Antico\nlang: it\n---\nFu huomo di gran virtute, et hebbe la gratia della cittade.\n');
  put('botica.pt-BR.txt', 'A pharmacia fica na rua do theatro; elle tem um chapéo.\n');
  put('ship.en.txt', 'He put his hand vpon the mast, with great swiftnesse and much beautie.\n');
  await eventually(async () => (await list()).works.filter(({ id }) => /^(antico|botica|ship)/.test(id)).length === 3, 'the works');
  for (const [q, work, word] of [['uomo', 'antico', 'huomo'], ['virtù', 'antico', 'virtute'], ['grazia', 'antico', 'gratia'], ['città', 'antico', 'cittade'], ['ebbe', 'antico', 'hebbe'], ['farmácia', 'botica', 'pharmacia'],
    ['teatro', 'botica', 'theatro'], ['chapéu', 'botica', 'chapéo'], ['upon', 'ship', 'vpon'], ['beauty', 'ship', 'beautie'], ['swiftness', 'ship', 'swiftnesse']]) {
    const found = (await search({ q })).find(({ work: { id } }) => id.startsWith(work));
    assert.ok(found, q);
    assert.deepEqual(found.snippet.marks.map(([from, to]) => found.snippet.text.slice(from, to)), [word], q);
  }
  put('moderno.md', '---\ntitle: Moderno\nlang: it\n---\nUn uomo solo.\n');
  await eventually(async () => ids(await search({ q: 'huomo' })).includes('moderno:1:p1'), 'the work of today');
  assert.equal((await search({ q: 'huomo' }))[0].work.id, 'antico', 'as written comes first');
  assert.equal((await search({ q: '"uomo di gran"' })).length, 0, 'a phrase is found as written only');
  for (const name of ['antico.md', 'botica.pt-BR.txt', 'ship.en.txt', 'moderno.md']) fs.rmSync(path.join(works, name));
});

test('serves searches as a page and a catalogue without scripts', async () => {
  const html = await (await fetch(`${daemon.url}/library?q=${encodeURIComponent('luna "piena"')}`)).text();
  assert.match(html, /<a href="\/library\/mare\/1#mare:1:l1"><cite>Il mare d'inverno<\/cite>/);
  assert.match(html, /<mark>luna<\/mark>/);
  assert.match(html, /value="luna &quot;piena&quot;"/);
  const catalogue = async (query = '') => ask(`/library/opds.json${query}`);
  const all = await catalogue();
  assert.ok(all.publications.length > 5 && all.publications.every(({ metadata, links, images }) => metadata.title && links[0].href && images.length));
  assert.deepEqual((await catalogue('?query=luna')).publications.map(({ metadata }) => metadata.title).sort(), ['Detto', "Il mare d'inverno"]);
  assert.equal(all.links.find(({ rel }) => rel === 'search').href, `${daemon.url}/library/opds.json{?query}`);
});

test('a renamed file keeps its address; the same name twice is reported', async () => {
  put('prima.md', '---\ntitle: Il nome\nlang: it\n---\nUn nome che cambia.\n');
  await eventually(async () => (await list()).works.some(({ id }) => id === 'prima'), 'the file');
  fs.renameSync(path.join(works, 'prima.md'), path.join(works, 'seconda.md'));
  await eventually(async () => (await list()).works.some(({ id }) => id === 'seconda'), 'the renamed file');
  assert.equal((await ask('/v1/library/works/prima')).id, 'seconda');
  assert.equal((await section('prima', 1)).id, 'seconda:1');
  assert.equal((await ask('/v1/library/passages/prima:1:p1')).id, 'seconda:1:p1');
  assert.match(await (await fetch(`${daemon.url}/library/prima/1`)).text(), /Un nome che cambia/);
  assert.equal((await fetch(`${daemon.url}/v1/speech?passage=prima:1:p1`)).status, 200);
  assert.equal((await ask('/v1/library/works/terza', 404)).code, 'unknown-work');
  put('seconda.txt', 'Un altro testo.\n');
  const { problems } = await eventually(async () => { const all = await list(); return all.problems.some(({ file }) => file === 'seconda.txt') && all; }, 'the problem');
  assert.deepEqual(problems.filter(({ file }) => file === 'seconda.txt').map(({ serious, message }) => [serious, /seconda-txt/.test(message)]), [[false, true]]);
  for (const name of ['seconda.md', 'seconda.txt']) fs.rmSync(path.join(works, name));
});

test('reports invalid searches with their position', async () => {
  for (const [q, byte] of [['"luna', 0], ['luna (mare', 5], ['luna)', 4], ['NEAR(luna)', 0], ['a*', 0], ['luna OR', 7], ['NOT luna', 8], ['...', 0], [`${'('.repeat(30)}a`, 16], ['luna '.repeat(40), null], ['x'.repeat(2000), 1000]]) {
    const error = await ask(`/v1/library/search?${new URLSearchParams({ q })}`, 400);
    assert.equal(error.code, 'bad-query', q);
    if (byte !== null) assert.equal(error.byte, byte, q);
  }
  assert.equal((await ask('/v1/library/search', 400)).code, 'missing-field');
  assert.equal((await ask('/v1/library/search?q=luna&limit=0', 400)).field, 'limit');
  assert.equal((await ask('/v1/library/works/nowhere', 404)).code, 'unknown-work');
  assert.equal((await ask('/v1/library/works/mare/sections/9', 404)).code, 'unknown-section');
  for (const id of ['mare:1:l99', 'mare:1:x', 'mare', 'mare:0', "mare:1:l1'--"]) assert.equal((await ask(`/v1/library/passages/${encodeURIComponent(id)}`, 404)).code.replace('section', 'passage'), 'unknown-passage', id);
  assert.equal((await ask('/v1/library/nothing', 404)).code, 'not-found');
});

/** Searches from that local address. Returns status, Retry-After and answer. */
const searchFrom = (localAddress, q) => new Promise((resolve, reject) => {
  const request = http.get({ host: '127.0.0.1', port: daemon.port, localAddress, agent: false, path: `/v1/library/search?q=${encodeURIComponent(q)}` }, async (response) => {
    let text = '';
    for await (const part of response) text += part;
    resolve({ status: response.statusCode, after: response.headers['retry-after'], answer: JSON.parse(text) });
  });
  request.on('error', reject);
});

test('asks a client with too many searches to retry later, and answers others meanwhile', async () => {
  const greedy = Array.from({ length: 500 }, (_, i) => searchFrom('127.0.0.1', `luna OR w${i}`));
  const others = Array.from({ length: 5 }, (_, i) => searchFrom(`127.0.0.${i + 2}`, 'luna'));
  for (const { status, answer } of await Promise.all(others)) assert.deepEqual([status, answer.results.length], [200, 2]);
  const all = await Promise.all(greedy);
  const refused = all.filter(({ status }) => status !== 200);
  assert.ok(refused.length < all.length);
  for (const { status, after, answer } of refused) assert.deepEqual([status, answer.code, Number(after) > 0], [503, 'too-many-searches', true]);
  assert.equal((await search({ q: 'luna' })).length, 2);
});

test('does not send a cached answer again', async () => {
  const first = await fetch(`${daemon.url}/v1/library/works/mare`);
  await first.text();
  const again = await fetch(`${daemon.url}/v1/library/works/mare`, { headers: { 'if-none-match': first.headers.get('etag') } });
  assert.deepEqual([again.status, await again.text()], [304, '']);
});

test('speaks a passage in its language, from a position, over HTTP and on a stream', async () => {
  const passage = valid('passage', await ask('/v1/library/passages/mare:1:g1'));
  const words = async (query) => (await ask(`/v1/speech?format=json&${query}`)).words;
  const all = await words('passage=mare:1:g1');
  for (const { text, utf16_start: start, utf16_end: end } of all) assert.equal(passage.text.slice(start, end), text);
  const from = passage.text.indexOf('un pescatore');
  assert.deepEqual((await words(`passage=mare:1:g1&from=${from}`)).map((word) => word.utf16_start), all.map((word) => word.utf16_start).filter((at) => at >= from));
  assert.equal((await ask('/v1/speech?passage=kuslar-tr:1:l1&format=json')).lang, 'tr');
  const marked = await ask('/v1/speech', 200, { method: 'POST', headers: { 'content-type': 'application/json' }, body: '{"passage":"the-clock:1:p1","format":"json"}' });
  assert.deepEqual([marked.lang, marked.words[0].text], ['en', 'The']);
  assert.equal((await ask('/v1/speech?passage=mare:1:l99', 404)).field, 'passage');
  assert.equal((await ask('/v1/speech?passage=mare:1:l1&from=999', 400)).field, 'from');
  assert.equal((await ask('/v1/speech?text=a&from=1', 400)).field, 'from');
  assert.equal((await ask('/v1/speech?text=a&passage=mare:1:l1', 400)).field, 'passage');
  assert.equal((await ask('/v1/speech?passage=mare:1:l1&voice=recording', 400)).code, 'unknown-voice');

  const client = await daemon.stream();
  client.send({ type: 'speak', id: 'a', passage: 'mare:1:l2' });
  await client.wait({ type: 'begin', id: 'a', lang: 'it' });
  await client.wait({ type: 'word', id: 'a', text: 'la', utf16_start: 0 });
  client.send({ type: 'speak', id: 'b', passage: 'mare:7' });
  await client.wait({ type: 'error', id: 'b', code: 'unknown-passage', field: 'passage' });
  await client.wait({ type: 'end', id: 'b', reason: 'failed' });
  await client.close();
});

test('speaks a work by its recording', async () => {
  const spoken = await ask('/v1/speech?passage=detto:1:p1&voice=recording&format=json');
  assert.equal(spoken.voice, 'recording:detto');
  assert.deepEqual(spoken.words.map(({ text }) => text).slice(0, 3), ['La', 'luna', 'sale']);
});

test('detects changes in the folder', async () => {
  put('nuovo.txt', 'Un testo appena nato parla di zenzero.');
  await eventually(async () => (await search({ q: 'zenzero' })).length, 'the new work');
  put('nuovo.txt', 'Un testo cambiato parla di cannella.');
  await eventually(async () => (await search({ q: 'cannella' })).length, 'the changed work');
  assert.deepEqual(await search({ q: 'zenzero' }), []);
  fs.rmSync(path.join(works, 'nuovo.txt'));
  await eventually(async () => !(await search({ q: 'cannella' })).length, 'the end of it');
  assert.equal(execFileSync('sqlite3', [index, "INSERT INTO found(found) VALUES ('integrity-check'); PRAGMA integrity_check"], { encoding: 'utf8' }).trim(), 'ok');
});

test('killed while indexing, it resumes where it stopped', further, async () => {
  const many = path.join(folder, 'many');
  const file = path.join(folder, 'many.index');
  fs.mkdirSync(many);
  for (let i = 0; i < 30; i++) {
    const sentences = sentencesOf(i + 1);
    fs.writeFileSync(path.join(many, `w${i}.txt`), Array.from({ length: 800 }, () => sentences.next().value).join('\n\n'));
  }
  const options = ['--library', many, '--library-index', file];
  let killed = 0;
  for (let round = 0; round < 2; round++) {
    const first = await Daemon.start(options, {}, { voices: false });
    await eventually(async () => (await (await first.get('/v1/library')).json()).done > 3 * round + 2);
    first.process.kill('SIGKILL');
    killed += (await first.exited).signal === 'SIGKILL';
  }
  assert.equal(killed, 2);
  const last = await Daemon.start(options, {}, { voices: false });
  const all = await eventually(async () => { const now = await (await last.get('/v1/library?limit=100')).json(); return now.state === 'ready' && now; }, 'the rest of the works', 180000);
  assert.equal(all.works.length, 30);
  assert.ok(all.works.every(({ passages }) => passages === 800));
  assert.equal((await last.stop()).code, 0);
  const said = execFileSync('sqlite3', [file, "INSERT INTO found(found) VALUES ('integrity-check'); PRAGMA integrity_check; SELECT count(*) FROM passage"], { encoding: 'utf8' });
  assert.deepEqual(said.trim().split('\n'), ['ok', String(30 * 800)]);
});

test('faccia library gives the same result without a daemon', () => {
  const bad = spawnSync(program, ['library', works], { encoding: 'utf8' });
  assert.equal(bad.status, 1);
  assert.match(bad.stdout, /^broken\.xml:3:16: .*\(bad-work\)$/m);
  assert.match(bad.stdout, /^mare +it +tei .* 2 sections/m);
  const good = spawnSync(program, ['library', path.join(root, 'models/library')], { encoding: 'utf8' });
  assert.deepEqual([good.status, good.stderr], [0, '']);
  assert.match(good.stdout, /6 works, .* 0 problems, 0 hints\n$/);
  assert.equal(spawnSync(program, ['library', path.join(folder, 'nowhere')]).status, 1);
  assert.equal(spawnSync(program, ['library']).status, 2);
});

test('reads TEI of 50 MB up to the position where it is broken', further, () => {
  const large = path.join(folder, 'large');
  const line = '<p>Una riga di testo che parla del mare e della luna piena, e di altro.</p>\n';
  const lines = Math.floor((50 << 20) / line.length);
  fs.mkdirSync(large);
  fs.writeFileSync(path.join(large, 'large.xml'), `<TEI xml:lang="it"><text><body>\n${line.repeat(lines)}<p>Poi <hi>no</p></body></text></TEI>`);
  const read = spawnSync(program, ['library', large], { encoding: 'utf8' });
  assert.equal(read.status, 1, read.stderr);
  assert.match(read.stdout, new RegExp(`^large\\.xml:${lines + 2}:16: .*\\(bad-work\\)$`, 'm'));
  assert.match(read.stdout, new RegExp(` ${lines + 1} passages, .* 1 problems, 0 hints\n$`));
  fs.rmSync(large, { recursive: true });
});
