// SPDX-License-Identifier: GPL-3.0-or-later
// Every reader delivers every word of a work once, in order and with its language; limits of a work; no file outside the library's folder.
import assert from 'node:assert/strict';
import { execFile } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { Daemon, build, eventually } from '../lib/daemon.mjs';
import { epub, writeZip } from '../lib/works.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-words-'));
const works = path.join(folder, 'works');
const bounds = path.join(folder, 'bounds'); // not in the daemon's folder: `faccia library` alone is quick
const secret = path.join(folder, 'secret.txt');
const program = path.join(build, 'server/cli/faccia');
const header = (inner) => `<teiHeader><fileDesc>${inner}</fileDesc></teiHeader>`;
const tei = (body, { attributes = '', head = '', doctype = '' } = {}) =>
  `<?xml version="1.0"?>${doctype}<TEI xmlns="http://www.tei-c.org/ns/1.0">${head}<text xml:lang="it" ${attributes}><body><div>${body}</div></body></text></TEI>`;

// name: [body of the text, expected result (a line per block; "LANG|words" for a stretch in another language)]
const TEI = {
  alone: ['<p>Vostra <abbr>Ecc.</abbr> vide <sic>la le</sic> <orig>virtude</orig>.</p>', 'Vostra Ecc. vide la le virtude.'],
  pairs: ['<p>Era <choice><sic>bela</sic><corr>bella</corr></choice>, <choice><corr>alta</corr><sic>atla</sic></choice>, <choice><expan>signora</expan><abbr>sig.ra</abbr></choice>, <choice><orig>huomo</orig><reg>uomo</reg></choice>.</p>', 'Era bella, alta, signora, uomo.'],
  others: ['<p>Con <choice><unclear cert="low">fame</unclear><unclear cert="high">fiamme</unclear></choice> e <choice><seg>mare</seg><seg>monte</seg></choice> su<choice><am>ꝑ</am><ex>per</ex></choice>bo.</p>', 'Con fiamme e mare superbo.'],
  nested: ['<p>Un <choice><orig>ho<choice><am>ñ</am><ex>nore</ex></choice></orig><reg>o<ex>no</ex>re</reg></choice> grande.</p>', 'Un onore grande.'],
  readings: ['<p>Dice <app><lem>pace</lem><rdg>guerra</rdg></app> e <app><rdg wit="#a">fede</rdg><rdg wit="#b">fame</rdg></app>.</p><app><rdg><l>Un verso intero</l></rdg><rdg><l>Un altro verso</l></rdg></app>', 'Dice pace e fede.\nUn verso intero'],
  breaks: ['<p>primo<lb/>secondo<lb break="yes"/>terzo, mera\n  <lb break="no"/>\n viglia, con-<lb/>tento, Santa-<lb/>Maria, sospi<pb n="3" break="no"/>rare, in<cb/>torno, notte<milestone unit="x"/>giorno, mat-<lb break="no"/>tina</p>', 'primo secondo terzo, meraviglia, contento, Santa-Maria, sospirare, intorno, notte giorno, mattina'],
  directions: ['<sp><speaker>Rosa <stage>(piano)</stage></speaker><p>Vieni <stage>(lo chiama)</stage> qui.</p><l>Primo verso,</l><stage>Si siede.</stage><l>secondo verso</l></sp>', 'Rosa (piano)\nVieni (lo chiama) qui.\nPrimo verso,\nSi siede.\nsecondo verso'],
  tokens: ['<p><w>sole</w><w>luna</w><pc>,</pc><w>stella</w> <w>dell</w><pc>\'</pc><w>alba</w><pc>.</pc> <w part="I">ama</w><w part="F">re</w></p>', "sole luna, stella dell'alba. amare"],
  edits: ['<p>Un <subst><del>vecchio</del><add>nuovo</add></subst> <surplus>il il</surplus> <damage>campo</damage><metamark>^</metamark>, <restore><del>poi <hi>ripreso</hi></del></restore> e <del>tolto</del>. <fw>Titolo corrente</fw></p>', 'Un nuovo il il campo, poi ripreso e .'],
  figures: ['<p>Ecco <figure><head>Tavola prima</head><figDesc>Disegno di una barca</figDesc></figure> e basta.</p><figure><head>Tavola seconda</head></figure><p>Fine.</p>', 'Ecco Tavola prima e basta.\nTavola seconda\nFine.'],
  persons: ['<castList><head>Personaggi</head><castItem><role>Zeno</role> <roleDesc>oste</roleDesc></castItem></castList><floatingText><body><div><p>Cara Ada,</p></div></body></floatingText><p>scrisse.</p>', 'Personaggi\nZeno oste\nCara Ada,\nscrisse.'],
  notes: ['<p>Una parola<ref target="#nota">12</ref> e <ref target="#altro">un rinvio</ref>.</p><note xml:id="nota" n="12">Detta piano.</note>', 'Una parola e un rinvio.\nDetta piano.'],
  tongues: ['<p>Disse <hi xml:lang="fr">bonjour</hi> e <q xml:lang="en">good night <hi>dear</hi></q>.</p><lg><l xml:lang="la">Ave rosa</l><l>ave stella</l></lg><quote xml:lang="en"><p>All in English.</p></quote>',
    'Disse bonjour e good night dear. {fr:bonjour} {en:good night dear}\nAve rosa\nave stella {la:Ave rosa}\n[en] All in English.'],
  entities: ['<p>perch&eacute; la citt&agrave; &mdash; gi&ugrave;</p>', 'perché la città — giù'],
  soft: ['<p>meravi\u00adglioso la\u200bvoro</p>', 'meraviglioso lavoro'],
};
const NS = 'xmlns:epub="http://www.idpf.org/2007/ops"';
const EPUB = {
  signs: [`<p>Una frase<a ${NS} epub:type="noteref" href="#n1">1</a> e<sup><a href="#n2">2</a></sup> poi<a role="doc-noteref" href="#n3">*</a> altro<a href="#n4">[4]</a>, al m<sup>2</sup>.</p>`, 'Una frase e poi altro, al m2.'],
  endnotes: [`<p>Testo.</p><section ${NS} epub:type="endnotes"><ol><li id="n1" epub:type="endnote"><p>Prima nota. <a epub:type="backlink" href="#a">Indietro</a></p></li><li id="n2"><p>Seconda nota.</p><p>Il suo seguito.</p></li></ol></section><p>Dopo.</p>`, 'Testo.\nnote: Prima nota.\nnote: Seconda nota. Il suo seguito.\nDopo.'],
  hidden: ['<p hidden="">Uno.</p><p style="color: red; display : none">Due.</p><p aria-hidden="true">Tre.</p><template><p>Quattro.</p></template><p style="x-display:none">Si <span style="visibility:hidden">non</span> vede.</p>', 'Si vede.'],
  words: ['<p>tra&shy;monto, <ruby>base<rp>(</rp><rt>sopra</rt><rp>)</rp></ruby>, <img src="a.png" alt="una barca"/>, <math xmlns="http://www.w3.org/1998/Math/MathML" alttext="x pi\u00f9 y"><mi>x</mi></math>.</p><svg xmlns="http://www.w3.org/2000/svg"><title>No</title><text>Insegna</text></svg>', 'tramonto, base, una barca, x più y.\nInsegna'],
  entities: ['<p>Due&nbsp;parole &mdash; caff&egrave; &thetasym;.</p><p>Dopo.</p>', 'Due parole — caffè ϑ.\nDopo.'],
  groups: ['<article>Nudo</article>testo<ul><li><p>Uno</p>coda</li><li>Due</li></ul><main><p>Fine</p></main>', 'Nudo\ntesto\nUno\ncoda\nDue\nFine'],
  forms: ['<form><fieldset><legend>Domande</legend>Prima <input value="no"/> riga <button>No</button></fieldset>Seconda</form><p>Ecco <object data="a.svg" type="image/svg+xml">una mappa</object>.</p>', 'Domande\nPrima riga\nSeconda\nEcco una mappa.'],
  tongues: ['<p>Disse <em lang="en">good night</em> e <i xml:lang="fr">merci</i>.</p><h2 lang="en">A chapter</h2>', 'Disse good night e merci. {en:good night} {fr:merci}\n[en] A chapter'],
};

/** Returns the blocks of all sections, one per line, with stretches in other languages marked. */
const read = async (work) => {
  const { sections } = await (await fetch(`${daemon.url}/v1/library/works/${work}`)).json();
  const out = [];
  for (const { number } of sections) {
    const { blocks } = await (await fetch(`${daemon.url}/v1/library/works/${work}/sections/${number}`)).json();
    for (const { kind, text, lang, marks = [] } of blocks) {
      if (kind === 'page') continue;
      const tongues = marks.filter((mark) => mark.kind === 'foreign').map((mark) => ` {${mark.lang}:${text.slice(mark.start, mark.end)}}`);
      out.push(`${work.startsWith('epub-') && kind === 'note' ? 'note: ' : ''}${lang && lang !== 'it' ? `[${lang}] ` : ''}${work.startsWith('epub-') ? text.replaceAll('\n', ' ') : text}${tongues.join('')}`);
    }
  }
  return out.join('\n');
};

let daemon, all;
/** Runs `faccia library DIR`; asynchronously, because the daemon may close idle connections meanwhile. */
const check = (directory) =>
  new Promise((done) => {
    execFile(program, ['library', directory], { timeout: 120000, maxBuffer: 1 << 26 }, (error, stdout) => done({ stdout, status: error ? error.code : 0 }));
  });
const problemsOf = (file) => all.problems.filter((problem) => problem.file === file);

before(async () => {
  fs.mkdirSync(path.join(works, 'below'), { recursive: true });
  for (const [name, [body]] of Object.entries(TEI)) fs.writeFileSync(path.join(works, `tei-${name}.xml`), tei(body));
  for (const [name, [body]] of Object.entries(EPUB)) writeZip(path.join(works, `epub-${name}.epub`), epub({ 'uno.xhtml': body }));
  const title = '<titleStmt><title>Prova</title><author><persName><forename>Ada</forename><surname>Neri</surname></persName><idno type="wikidata">Q42</idno></author><author>Ugo Bo</author></titleStmt>';
  fs.writeFileSync(path.join(works, 'head.xml'), tei('<p>Testo.</p>', { head: header(`${title}<publicationStmt><date when="2021"/></publicationStmt><sourceDesc><bibl><date when="1788"/>Lucca, 1788</bibl></sourceDesc>`) }));
  fs.writeFileSync(path.join(works, 'old.xml'), '<TEI.2><teiHeader/><text lang="it"><body><div7><p>Vecchia forma.</p></div7></body></text></TEI.2>');
  const beside = epub({ '../Testo/uno.xhtml': '' });
  writeZip(path.join(works, 'beside.epub'), { ...beside, 'Testo/uno.xhtml': '<html xmlns="http://www.w3.org/1999/xhtml"><body><p>Accanto.</p></body></html>' });
  // a thousand references to one document; another path of the same document
  const again = epub({ 'uno.xhtml': '<p>Una volta sola.</p>' });
  again['OEBPS/book.opf'] = again['OEBPS/book.opf'].replace('</manifest>', '<item id="e" href="./x/../uno.xhtml" media-type="application/xhtml+xml"/></manifest>')
    .replace('<spine>', `<spine>${'<itemref idref="d0"/>\n'.repeat(1000)}<itemref idref="e"/>`);
  writeZip(path.join(works, 'again.epub'), again);
  // values repeated on each block, by attribute defaults of the document
  fs.writeFileSync(path.join(works, 'repeats.xml'), tei(`<sp><speaker>${'Nome '.repeat(20000)}</speaker>${'<p>a</p>'.repeat(3000)}</sp><lg>${'<l>b</l>'.repeat(3000)}</lg>`, { doctype: `<!DOCTYPE TEI [<!ATTLIST l n CDATA "${'9'.repeat(50000)}">]>` }));
  fs.writeFileSync(path.join(works, 'alone.xml'), tei('<p>Due&nbsp;parole &mdash; caff&egrave;.</p><p>Dopo.</p>').replace('version="1.0"', 'version="1.0" encoding="UTF-8" standalone = \'yes\' '));
  // entities that expand to 200 blocks each, every block with a speaker's name
  fs.mkdirSync(bounds);
  fs.writeFileSync(path.join(bounds, 'entities.xml'), tei(`<p>Prima.</p><sp><speaker>${'Nome '.repeat(40)}</speaker>${'&much;\n'.repeat(1500)}</sp>`, { doctype: `<!DOCTYPE TEI [<!ENTITY much "${'<p>a</p>'.repeat(200)}">]>` }));
  // files outside the folder
  fs.writeFileSync(secret, 'Questo non si legge.\n');
  fs.writeFileSync(path.join(folder, 'secret.wav'), 'RIFF');
  fs.mkdirSync(path.join(folder, 'other'));
  fs.writeFileSync(path.join(folder, 'other', 'there.txt'), 'Neanche questo.\n');
  fs.writeFileSync(path.join(works, 'below', 'real.txt'), 'Questo si legge.\n');
  const link = (to, name) => fs.symlinkSync(to, path.join(works, name));
  link(secret, 'absolute.txt');
  link('../secret.txt', 'relative.txt');
  link('../below/../../secret.txt', 'below/winding.txt');
  link('../other', 'folder');
  link('../secret.wav', 'below/real.wav');
  link('below/real.txt', 'inside.txt');
  for (const name of ['x', 'y', 'z']) link('.', name);
  link('..', 'below/up');
  daemon = await Daemon.start(['--library', works, '--library-index', path.join(folder, 'index')]);
  await eventually(async () => { all = await (await fetch(`${daemon.url}/v1/library?limit=1000`)).json(); return all.state === 'ready'; }, 'the library', 60000);
});
after(async () => {
  assert.equal((await daemon.stop()).code, 0, daemon.log);
  fs.rmSync(folder, { recursive: true });
});

for (const [format, cases] of Object.entries({ tei: TEI, epub: EPUB }))
  for (const [name, [, expected]] of Object.entries(cases))
    test(`${format}, ${name}: every word once, in its order and language`, async () => assert.equal(await read(`${format}-${name}`), expected));

test('the header: authors without numbers of authority files, the date of the source; TEI P4', async () => {
  const head = all.works.find(({ id }) => id === 'head');
  assert.deepEqual([head.author, head.date], ['Ada Neri; Ugo Bo', '1788']);
  assert.equal(await read('old'), 'Vecchia forma.');
});

test('a document that says that it needs no DTD keeps what follows an entity that nobody declares', async () => {
  assert.equal(await read('alone'), 'Due parole — caffè.\nDopo.');
  assert.deepEqual(problemsOf('alone.xml'), []);
});

test('alternatives without a lemma are told once, elements that are known not at all', () => {
  assert.match(problemsOf('tei-readings.xml')[0].message, /first reading/);
  assert.equal(problemsOf('tei-readings.xml').length, 1);
  for (const name of Object.keys(TEI).filter((name) => name !== 'readings')) assert.deepEqual(problemsOf(`tei-${name}.xml`), [], name);
});

test('an EPUB: paths that lead beside the package; each document once, told with its place', async () => {
  assert.equal(await read('beside'), 'Accanto.');
  assert.equal(await read('again'), 'Una volta sola.');
  const [told, ...more] = problemsOf('again.epub');
  assert.match(told.message, /OEBPS\/uno\.xhtml' is in the spine again/);
  assert.ok(told.line > 1 && !more.length);
});

test('what a work takes is bounded, and told with its place', async () => {
  const { stdout, status } = await check(bounds);
  const [, line] = /entities\.xml:(\d+):\d+: a work may take 64 MiB of the index/.exec(stdout) ?? assert.fail(stdout);
  assert.ok(Number(line) > 100, line);
  assert.match(stdout, /^entities .* sections/m);
  assert.equal(status, 1);
});

test('names and numbers that each block repeats are short ones', async () => {
  const { blocks } = await (await fetch(`${daemon.url}/v1/library/works/repeats/sections/1`)).json();
  assert.ok(Math.max(...blocks.map(({ speaker = '' }) => speaker.length)) <= 200);
  assert.ok(Math.max(...blocks.flatMap(({ lines = [] }) => lines.map(({ n }) => n.length))) <= 200);
});

test('nothing outside the library is read: links to files and folders, recordings; loops of links end', async () => {
  const paths = all.works.map(({ id }) => id);
  for (const name of ['absolute', 'relative', 'winding', 'there']) assert.ok(!paths.some((id) => id.includes(name)), name);
  for (const file of ['absolute.txt', 'relative.txt', 'below/winding.txt', 'folder']) assert.match(problemsOf(file)[0]?.message ?? '', /leads out of the library's folder/, file);
  assert.equal(await read('below-real'), 'Questo si legge.');
  assert.equal(await read('inside'), 'Questo si legge.');
  assert.equal(all.works.filter(({ id }) => /real/.test(id)).length, 1);
  assert.equal(all.works.find(({ id }) => id === 'below-real').recording, false);
  const { results } = await (await fetch(`${daemon.url}/v1/library/search?q=neanche`)).json();
  assert.deepEqual(results, []);
  const listed = await check(works);
  assert.match(listed.stdout, /below\/winding\.txt: a link that leads out/);
  assert.doesNotMatch(listed.stdout, /there /);
});

test('a file that becomes a link to another place is not read any more', async () => {
  const file = path.join(works, 'below', 'real.txt');
  fs.rmSync(file);
  fs.symlinkSync(secret, file);
  await eventually(async () => { all = await (await fetch(`${daemon.url}/v1/library?limit=1000`)).json(); return problemsOf('below/real.txt').length; }, 'the link', 30000);
  assert.ok(!all.works.some(({ id }) => id === 'below-real'));
});

test('foreign words have a voice of their language, stage directions none; places stay those of the text', async () => {
  const speech = async (passage) => (await fetch(`${daemon.url}/v1/speech?passage=${passage}&format=json&phones=1`)).json();
  const { text } = await (await fetch(`${daemon.url}/v1/library/passages/tei-tongues:1:p1`)).json();
  const mixed = await speech('tei-tongues:1:p1');
  for (const word of mixed.words) assert.equal(text.slice(word.utf16_start, word.utf16_end), word.text);
  const said = (answer, word) => answer.words.find(({ text: one }) => one === word);
  const phones = (answer, word) => {
    const { start, end } = said(answer, word);
    return answer.phones.filter((phone) => phone.start >= start - 1e-3 && phone.end <= end + 1e-3).map(({ ipa }) => ipa).join(' ');
  };
  const sole = async (words, lang) => (await fetch(`${daemon.url}/v1/speech?${new URLSearchParams({ text: words, lang, format: 'json', phones: '1' })}`)).json();
  const [english, italian] = [await sole('good night dear', 'en'), await sole('good night dear', 'it')];
  assert.notEqual(phones(english, 'night'), phones(italian, 'night'));
  assert.equal(phones(mixed, 'night'), phones(english, 'night'));
  const line = await speech('tei-tongues:1:l1');
  assert.deepEqual(line.words.map((word) => word.text), ['Ave', 'rosa']);
  const play = await speech('tei-directions:1:p1');
  assert.deepEqual(play.words.map((word) => word.text), ['Vieni', 'qui']);
  const whole = (await (await fetch(`${daemon.url}/v1/library/passages/tei-directions:1:p1`)).json()).text;
  for (const word of play.words) assert.equal(whole.slice(word.utf16_start, word.utf16_end), word.text);
  const bad = await fetch(`${daemon.url}/v1/speech?text=ciao&languages=3-1:en`);
  assert.deepEqual([bad.status, (await bad.json()).field], [400, 'languages']);
});
