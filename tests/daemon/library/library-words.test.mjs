// SPDX-License-Identifier: GPL-3.0-or-later
// Every reader delivers every word of a work once, in order and with its language; limits of a work; no file outside the library's folder.
import assert from 'node:assert/strict';
import { execFile } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { Daemon, build, eventually } from '../../lib/daemon.mjs';
import { epub, writeZip } from '../../lib/works.mjs';

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
  signs: ['<p>Il <ref target="#rus">дом</ref> nostro<ref target="#rus">²</ref>, <ref target="#rus">a</ref>.</p><note xml:id="rus">Casa.</note>', 'Il дом nostro,.\nCasa.'],
  closesigns: ['<p>Il <emph>vento</emph><ref target="#n">[9]</ref>come <ref target="#n">*</ref>allora.<ref target="#n">(a)</ref>Tace<ref target="#n">1</ref>!</p><!-->in prosa?--><note xml:id="n">Sale.</note>', 'Il vento come allora. Tace!\nSale.'],
  tags: ['<p>La corona di<app>\n<lem><tagStart gi="name"/></lem>\n<rdg wit="O"></rdg>\n</app>Francia<app>\n<lem><tagEnd gi="name"/></lem>\n<rdg wit="O"></rdg>\n</app>.</p><p><app>\n<lem><tagEnd gi="sp"/><tagStart gi="sp"/><tagStart gi="speaker"/>Dido<tagEnd gi="speaker"/></lem>\n</app>Noi due.</p>', 'La corona di Francia.\nDido Noi due.'],
  pretty: ['<p>be<choice>\n  <sic>l</sic>\n  <corr>ll</corr>\n</choice>a <app>\n <lem>rosa</lem>\n <rdg>cosa</rdg></app>!</p>', 'bella rosa!'],
  parts: ['<castList><castItem><role>Ugo</role><roleDesc>un oste</roleDesc></castItem></castList><table><row><cell>uno</cell><cell>due</cell></row></table><p><bibl><author>Neri</author><date>1788</date></bibl></p>', 'Ugo un oste\nuno; due\nNeri1788'],
  spoken: ['<u who="#a">Buongiorno<pause/> a tutti</u><vocal><desc>ride</desc></vocal><u who="#b">E a lei</u>', 'Buongiorno a tutti\nride\nE a lei'],
  tongues: ['<p>Disse <hi xml:lang="fr">bonjour</hi> e <q xml:lang="en">good night <hi>dear</hi></q>.</p><lg><l xml:lang="la">Ave rosa</l><l>ave stella</l></lg><quote xml:lang="en"><p>All in English.</p></quote>',
    'Disse bonjour e «good night dear». {fr:bonjour} {en:«good night dear»}\nAve rosa\nave stella {la:Ave rosa}\n[en] All in English.'],
  entities: ['<p>perch&eacute; la citt&agrave; &mdash; gi&ugrave;</p>', 'perché la città — giù'],
  quotes: ['<p><q>Vieni,</q> disse, <q>\n<hi>qui</hi>.</q> <said>Io <q>no</q> e <q>«forse»</q></said> “<q>chi</q>”, <q xml:lang="en">yes</q>.</p><p>— <q>Sì</q></p><q><p>Tutto.</p></q><p><q>Uno<l>verso</l></q></p>', '«Vieni,» disse, «qui.» «Io “no” e «forse»» “chi”, «yes». {en:«yes»}\n— Sì\nTutto.\n«Uno\nverso'],
  insets: ['<p>Una <note>Detta piano.</note>parola<note n="1">lunga </note>.</p>', 'Una parola.\nDetta piano.\nlunga'],
  tables: ['<table><head>Prezzi</head><row><cell>pane</cell><cell>due.</cell><cell><p>lire</p></cell></row><row><cell/><cell>solo</cell></row></table><list><item>ultimo</item></list>', 'Prezzi\npane; due. lire\nsolo\nultimo'],
  imprint: ['<byline>di <docAuthor>Ada Neri</docAuthor>.</byline><docImprint>Lucca, <docDate>1788</docDate></docImprint><docDate>1789</docDate>', 'di Ada Neri.\nLucca, 1788\n1789'],
  entries: ['<entryFree><form><orth>abate</orth></form><gramGrp><pos>s.</pos></gramGrp><sense><def>capo</def></sense></entryFree><entry><orth>ape</orth>insetto</entry>', 'abate s. capo\nape insetto'],
  letters: ['<p>m&ebreve;no &Emacr;va</p>', 'mĕno Ēva'],
  codes: ['<p>Disse <foreign xml:lang="eng">good night</foreign> e <foreign xml:lang="fre">merci</foreign> e <foreign xml:lang="grc">χαῖρε</foreign> e <foreign xml:lang="LA">ave</foreign>, <hi xml:lang="IT">sì</hi>.</p>', 'Disse good night e merci e χαῖρε e ave, sì. {en:good night} {fr:merci} {grc:χαῖρε} {la:ave}'],
  rest: ['<epigraph><quote>Detto antico.</quote></epigraph><lg><head>Canto</head><lg><l>uno</l></lg><lg><l>du<caesura/>e</l></lg></lg><sp><ab>Voce sola.</ab></sp><p>Prima <gap reason="illegible"/> dopo <supplied>ripreso</supplied>, 1<hi rend="sup">o</hi>.</p><trailer>Fine</trailer>', 'Detto antico.\nCanto\nuno\ndu e\nVoce sola.\nPrima […] dopo ripreso, 1o.\nFine'],
  soft: ['<p>meravi\u00adglioso la\u200bvoro</p>', 'meraviglioso lavoro'],
};
const NS = 'xmlns:epub="http://www.idpf.org/2007/ops"';
const EPUB = {
  signs: [`<p>Una frase<a ${NS} epub:type="noteref" href="#n1">1</a> e<sup><a href="#n2">2</a></sup> poi<a role="doc-noteref" href="#n3">*</a> altro<a href="#n4">[4]</a>, al m<sup>2</sup>.</p><p>Il vento<a href="#n5">[5]</a>cala.</p>`, 'Una frase e poi altro, al m2.\nIl vento cala.'],
  endnotes: [`<p>Testo.</p><section ${NS} epub:type="endnotes"><ol><li id="n1" epub:type="endnote"><p>Prima nota. <a epub:type="backlink" href="#a">Indietro</a></p></li><li id="n2"><p>Seconda nota.</p><p>Il suo seguito.</p></li></ol></section><p>Dopo.</p>`, 'Testo.\nnote: Prima nota.\nnote: Seconda nota. Il suo seguito.\nDopo.'],
  hidden: ['<p hidden="">Uno.</p><p style="color: red; display : none">Due.</p><p aria-hidden="true">Tre.</p><template><p>Quattro.</p></template><p style="x-display:none">Si <span style="visibility:hidden">non</span> vede.</p>', 'Si vede.'],
  words: ['<p>tra&shy;monto, <ruby>base<rp>(</rp><rt>sopra</rt><rp>)</rp></ruby>, <img src="a.png" alt="una barca"/>, <math xmlns="http://www.w3.org/1998/Math/MathML" alttext="x pi\u00f9 y"><mi>x</mi></math>.</p><svg xmlns="http://www.w3.org/2000/svg"><title>No</title><text>Insegna</text></svg>', 'tramonto, base, una barca, x più y.\nInsegna'],
  lines: ['<div class="poem"><div class="line">Primo verso</div><div class="line">secondo</div></div><p><span class="line">uno</span><br/><span class="line" lang="la">duo</span></p>', 'Primo verso secondo\nuno duo {la:duo}'],
  drama: [`<table ${NS}><tr><td epub:type="z3998:persona">Anna</td><td><p>Vieni <i epub:type="z3998:stage-direction">(piano)</i> qui.</p></td></tr></table><p>Dopo.</p>`, 'Anna\nVieni (piano) qui.\nDopo.'],
  entities: ['<p>Due&nbsp;parole &mdash; caff&egrave; &thetasym;.</p><p>Dopo.</p>', 'Due parole — caffè ϑ.\nDopo.'],
  groups: ['<article>Nudo</article>testo<ul><li><p>Uno</p>coda</li><li>Due</li></ul><main><p>Fine</p></main>', 'Nudo\ntesto\nUno\ncoda\nDue\nFine'],
  forms: ['<form><fieldset><legend>Domande</legend>Prima <input value="no"/> riga <button>No</button></fieldset>Seconda</form><p>Ecco <object data="a.svg" type="image/svg+xml">una mappa</object>.</p>', 'Domande\nPrima riga\nSeconda\nEcco una mappa.'],
  quotes: ['<p><q>Vieni</q>, disse, “<q>qui</q>”.</p>', '«Vieni», disse, “qui”.'],
  tables: ['<table><tr><th>Nome</th><th>Anni</th></tr><tr><td>Ada</td><td><p>cinque</p></td></tr><tr><td><p>Uno.</p><p>Due.</p></td><td>Tre.</td></tr></table><pre>una  riga</pre><dl><dt>Mare</dt><dd>acqua</dd></dl>', 'Nome; Anni\nAda; cinque\nUno.\nDue.\nTre.\nuna riga\nMare\nacqua'],
  address: ['<p>Spett. Ditta<br/>Via Roma 1<br/>Lucca</p>', 'Spett. Ditta Via Roma 1 Lucca'],
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
const check = (directory, ...options) =>
  new Promise((done) => {
    execFile(program, ['library', ...options, directory], { timeout: 120000, maxBuffer: 1 << 26 }, (error, stdout) => done({ stdout, status: error ? error.code : 0 }));
  });
const problemsOf = (file) => all.problems.filter((problem) => problem.file === file);

before(async () => {
  fs.mkdirSync(path.join(works, 'below'), { recursive: true });
  for (const [name, [body]] of Object.entries(TEI)) fs.writeFileSync(path.join(works, `tei-${name}.xml`), tei(body));
  for (const [name, [body]] of Object.entries(EPUB)) writeZip(path.join(works, `epub-${name}.epub`), epub({ 'uno.xhtml': body }));
  const title = '<titleStmt><title>Prova</title><author><persName><forename>Ada</forename><surname>Neri</surname></persName><idno type="wikidata">Q42</idno></author><author>Ugo Bo</author></titleStmt>';
  fs.writeFileSync(path.join(works, 'head.xml'), tei('<p>Testo.</p>', { head: header(`${title}<publicationStmt><date when="2021"/></publicationStmt><sourceDesc><bibl><date when="1788"/>Lucca, 1788</bibl></sourceDesc>`) }));
  const full = '<titleStmt><title>Copia</title><author>Neri, Ada</author></titleStmt><sourceDesc><biblFull><titleStmt><title>Stampa</title><author>Neri, Ada, 1700-1780</author></titleStmt></biblFull></sourceDesc>';
  fs.writeFileSync(path.join(works, 'copy.xml'), tei('<p>Testo.</p>', { head: header(full) }));
  fs.writeFileSync(path.join(works, 'only.xml'), tei('<p>Testo.</p>', { head: header('<titleStmt><title>Copia</title><author>Ugo Bo<affiliation>Un istituto</affiliation><email>u@example.org</email></author></titleStmt>') }));
  fs.writeFileSync(path.join(works, 'dates.xml'), tei('<p>Testo.</p>', {
    head: `${header('<titleStmt><title>Il molo: un racconto : ELTeC edition: an electronic edition</title><author>Neri, Ada (1832-1898).</author><author>Bo, Ugo, ca. 1790-</author><author>Po, Eva (18??-19??)</author><author>Lia [pseud.] (detta la Mora)</author></titleStmt><publicationStmt><date>2021</date></publicationStmt><sourceDesc><bibl type="digital"><date>1991</date></bibl><bibl type="firstEdition">Lucca, <date>1866</date></bibl></sourceDesc>').replace('</teiHeader>', '<profileDesc><creation><date>800</date><date notBefore="1863">circa</date></creation></profileDesc></teiHeader>')}<standOff><listEvent><event type="battle" when="1492"/><event type="print" when="1870"/></listEvent></standOff>`,
  }));
  fs.writeFileSync(path.join(works, 'ancient.xml'), tei('<p>Testo.</p>', { head: `${header('<titleStmt><title>Nave: elettronica</title><author>Bo, U.</author></titleStmt><sourceDesc><bibl><date>1896</date></bibl></sourceDesc>')}<standOff><listEvent><event type="premiere" when="-0200"/><event type="written"/></listEvent></standOff>` }));
  fs.writeFileSync(path.join(works, 'latin.xml'), Buffer.from('<?xml version="1.0" encoding="ISO-8859-1"?><TEI xmlns="http://www.tei-c.org/ns/1.0"><teiHeader/><text xml:lang="it"><body><p>perch\xe9</p></body></text></TEI>', 'latin1'));
  fs.writeFileSync(path.join(works, 'old.xml'), '<TEI.2><teiHeader/><text lang="it"><body><div7><p>Vecchia forma.</p></div7></body></text></TEI.2>');
  const persons = '<profileDesc><particDesc><listPerson><person xml:id="ugo"><persName><forename>Ugo</forename>\n<surname>Bo</surname></persName></person></listPerson></particDesc></profileDesc>';
  const shared = '<sp who="#ada"><speaker>ADA</speaker><l>Che notte chiara.</l><l part="I">Chi va?</l></sp><sp who="#ugo"><l part="M">Nessuno.</l></sp><sp who="#ugo #coro"><l part="F">Andiamo!</l></sp><sp who="#ugo"><l part="N">Poi si farà giorno.</l><l>E sia.</l></sp>';
  fs.writeFileSync(path.join(works, 'shared.xml'), tei(shared, { head: `<teiHeader><fileDesc/>${persons}</teiHeader>` }));
  const prose = 'Quando la barca di mio padre tornava dal largo io correvo alla riva, e contavo le ceste ad una ad una prima che altri le vedesse, perché da quel numero dipendeva la cena di tutti e anche il sonno della casa intera fino al mattino.';
  const wrap = (text, width) => text.replace(new RegExp(`(.{1,${width}})(?: |$)`, 'g'), '$1\n');
  fs.writeFileSync(path.join(works, 'marks.md'), '# Uno *due*\n\nUna voce[^1] e poi un ~~gatto~~ cane <b>rosso</b>, <span lang="fr">bonjour</span>[^1].\n\nprimo verso  \nsecondo verso[^coda]\n\n[^1]: Detta piano.\n\n    E poi forte.\n\n    | lato | capo |\n    |---|---|\n\n[^coda]: In coda[^terza].\n\n[^terza]: Nota di nota.\n\n| Nome | Anni |\n|------|-----:|\n| Ada | 5 |\n\n- [ ] fare il pane\n- [x] lavare\n\n<div class="a">Dentro <i>un</i> riquadro<!-- e non\nfuori --> &egrave; chiaro</div>\n');
  const verse = 'Che fai tu, vento, che torni alla riva\nse non c\'è vela che voglia partire?\n  Qui non si parte, qui solo si arriva.\n';
  fs.writeFileSync(path.join(works, 'plain.it.txt'), `PARTE PRIMA\n\nCapitolo I\nIl ritorno\n\n${wrap(prose, 58)}\n${verse}\nCAPITOLO II.\n\nLA SERA\n\nParte della gente\n\nCapitolo di mare e di sale, niente di più, disse.\n– Chi è? – domandò lei dalla porta, che stava sempre chiusa.\n– Io, – e non disse altro.\n\nEPILOGO\n\nFine di ogni cosa.\n`);
  fs.writeFileSync(path.join(works, 'guten.txt'), 'Title: Il mare, la sera\nAuthor: Ada Neri\nLanguage: Italian\n\n*** START OF THE PROJECT GUTENBERG EBOOK ***\n\nVide _una barca_, la _stella_ e un nome_di_file, poi _ e _questo.\n');
  fs.writeFileSync(path.join(works, 'narrow.it.txt'), `${wrap(prose.slice(0, 130), 50)}\n${verse}`);
  const beside = epub({ '../Testo/uno.xhtml': '' });
  writeZip(path.join(works, 'beside.epub'), { ...beside, 'Testo/uno.xhtml': '<html xmlns="http://www.w3.org/1999/xhtml"><body><p>Accanto.</p></body></html>' });
  const roles = epub({ 'perch\u00e9.xhtml': '<p>Perché no.</p>' });
  roles['OEBPS/perche\u0301.xhtml'] = roles['OEBPS/perch\u00e9.xhtml'];
  delete roles['OEBPS/perch\u00e9.xhtml'];
  roles['OEBPS/book.opf'] = roles['OEBPS/book.opf'].replace('<dc:language>', '<dc:creator id="b">Ada Neri</dc:creator><meta refines="#b" property="role">aut</meta><dc:creator id="c">Ugo Bo</dc:creator><meta refines="#c" property="role">trl</meta><dc:date opf:event="modification">2020</dc:date><dc:date opf:event="publication">1881</dc:date><dc:language>')
    .replace('<package ', '<package xmlns:opf="http://www.idpf.org/2007/opf" ');
  writeZip(path.join(works, 'roles.epub'), roles);
  writeZip(path.join(works, 'locked.epub'), { ...epub({ 'uno.xhtml': '<p>Chiuso.</p>', 'due.xhtml': '<p>Libero.</p>' }),
    'META-INF/encryption.xml': '<encryption xmlns="urn:oasis:names:tc:opendocument:xmlns:container" xmlns:enc="http://www.w3.org/2001/04/xmlenc#"><enc:EncryptedData><enc:CipherData><enc:CipherReference URI="OEBPS/uno.xhtml"/></enc:CipherData></enc:EncryptedData></encryption>' });
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
  await eventually(async () => { all = await (await fetch(`${daemon.url}/v1/library?limit=1000`)).json(); return all.state === 'ready'; }, 'the library', 240000);
});
after(async () => {
  assert.equal((await daemon.stop()).code, 0, daemon.log);
  fs.rmSync(folder, { recursive: true });
});

for (const [format, cases] of Object.entries({ tei: TEI, epub: EPUB }))
  for (const [name, [, expected]] of Object.entries(cases))
    test(`${format}, ${name}: reads every word once, in its order and language`, async () => assert.equal(await read(`${format}-${name}`), expected));

test('the header: omits authority numbers of authors, reads the date of the source; TEI P4', async () => {
  const named = (work) => all.works.find(({ id }) => id === work);
  assert.deepEqual([named('copy').title, named('copy').author], ['Copia', 'Neri, Ada']);
  assert.equal(named('only').author, 'Ugo Bo');
  assert.equal(await read('latin'), 'perché');
  const head = all.works.find(({ id }) => id === 'head');
  assert.deepEqual([head.author, head.date], ['Ada Neri; Ugo Bo', '1788']);
  assert.equal(await read('old'), 'Vecchia forma.');
  // the years of authors' lives and the form of the edition belong to neither name nor title; the earliest date of the source is the work's
  const told = (work) => (({ title, author, date }) => [title, author, date])(named(work));
  assert.deepEqual(told('dates'), ['Il molo: un racconto', 'Neri, Ada; Bo, Ugo; Po, Eva; Lia [pseud.] (detta la Mora)', '1863']);
  assert.deepEqual(told('ancient'), ['Nave: elettronica', 'Bo, U.', '-0200']);
});

test('a verse shared by speakers has one number and is indented; who speaks is named by the list of persons where the text does not', async () => {
  const { blocks } = await (await fetch(`${daemon.url}/v1/library/works/shared/sections/1`)).json();
  assert.deepEqual(blocks.filter(({ kind }) => kind === 'speaker').map(({ text }) => text), ['ADA']);
  const lines = blocks.flatMap(({ text, speaker, lines = [] }) => lines.map(({ id, n, start, end, indent = false }) => [id, n, speaker, text.slice(start, end), indent]));
  assert.deepEqual(lines, [
    ['shared:1:l1', '1', 'ADA', 'Che notte chiara.', false],
    ['shared:1:l2', '2', 'ADA', 'Chi va?', false],
    ['shared:1:l3', '2', 'Ugo Bo', 'Nessuno.', true],
    ['shared:1:l4', '2', 'Ugo Bo, coro', 'Andiamo!', true],
    ['shared:1:l5', '3', 'Ugo Bo', 'Poi si farà giorno.', false],
    ['shared:1:l6', '4', 'Ugo Bo', 'E sia.', false],
  ]);
});

test('Markdown: tables, footnotes, struck text, tasks and HTML are read as what they are, without hints', async () => {
  const { title } = all.works.find(({ id }) => id === 'marks');
  const { blocks } = await (await fetch(`${daemon.url}/v1/library/works/marks/sections/1`)).json();
  assert.equal(title, 'Uno due');
  assert.deepEqual(blocks.map(({ kind, text, n, item = false }) => [kind, text, ...(n ? [n] : []), ...(item ? ['item'] : [])]), [
    ['head', 'Uno due'],
    ['paragraph', 'Una voce e poi un gatto cane rosso, bonjour.'],
    ['note', 'Detta piano.\nE poi forte.\nlato; capo', '1'],
    ['verse', 'primo verso\nsecondo verso'],
    ['note', 'Nota di nota.', '3'],
    ['note', 'In coda.', '2'],
    ['paragraph', 'Nome; Anni'],
    ['paragraph', 'Ada; 5'],
    ['paragraph', 'fare il pane', 'item'],
    ['paragraph', 'lavare', 'item'],
    ['paragraph', 'Dentro un riquadro è chiaro'],
  ]);
  assert.deepEqual(blocks[1].marks.filter(({ kind }) => kind === 'foreign').map(({ lang, start, end }) => [lang, blocks[1].text.slice(start, end)]), [['fr', 'bonjour']]);
  assert.deepEqual(problemsOf('marks.it.md').concat(problemsOf('marks.md')), []);
});

test('plain text: headings begin sections; wrapped prose is prose at any width, verse stays verse; a dash begins a speech', async () => {
  const { sections } = await (await fetch(`${daemon.url}/v1/library/works/plain-it`)).json();
  assert.deepEqual(sections.map(({ title }) => title), ['PARTE PRIMA', 'Capitolo I', 'CAPITOLO II.', 'EPILOGO']);
  const blocks = [];
  for (const { number } of sections) blocks.push(...(await (await fetch(`${daemon.url}/v1/library/works/plain-it/sections/${number}`)).json()).blocks);
  const kinds = blocks.map(({ kind, text }) => `${kind} ${text.split(/\s/).length}`);
  assert.deepEqual(kinds, ['head 2', 'head 2', 'head 2', 'paragraph 45', 'verse 23', 'head 2', 'head 2', 'paragraph 3', 'paragraph 10', 'paragraph 12', 'paragraph 7', 'head 1', 'paragraph 4']);
  assert.deepEqual((await (await fetch(`${daemon.url}/v1/library/works/narrow-it/sections/1`)).json()).blocks.map(({ kind }) => kind), ['paragraph', 'verse']);
});

test('plain text: the header of Project Gutenberg, and words between underscores', async () => {
  const { title, author, lang } = all.works.find(({ id }) => id === 'guten');
  assert.deepEqual([title, author, lang], ['Il mare, la sera', 'Ada Neri', 'it']);
  const { blocks } = await (await fetch(`${daemon.url}/v1/library/works/guten/sections/1`)).json();
  const { text, marks } = blocks.at(-1);
  assert.equal(text, 'Vide una barca, la stella e un nome_di_file, poi _ e _questo.');
  assert.deepEqual(marks.map(({ kind, start, end }) => [kind, text.slice(start, end)]), [['emphasis', 'una barca'], ['emphasis', 'stella']]);
});

test('keeps the text after an undeclared entity in a document that declares standalone="yes"', async () => {
  assert.equal(await read('alone'), 'Due parole — caffè.\nDopo.');
  assert.deepEqual(problemsOf('alone.xml'), []);
});

test('the words read are those of the source, as a second reader counts them; what is lost is named with its line', async () => {
  const whole = path.join(folder, 'whole');
  fs.mkdirSync(whole);
  for (const file of fs.readdirSync(works).filter((name) => /^(tei|epub)-.*\.(xml|epub)$/.test(name))) fs.copyFileSync(path.join(works, file), path.join(whole, file));
  fs.writeFileSync(path.join(whole, 'verso.md'), '---\ntitle: Prova\n---\n# Uno *due*\n\n1. voce [legata](http://e.org/a "b")  \n   `co<d>ice` &egrave;\n\n<!-- un\n\ncommento -->\n\n[x]: http://e.org\n');
  // marks in a comment inside a paragraph, a value with a sign, a backslash before a letter, a number that begins a line
  fs.writeFileSync(path.join(whole, 'segni.md'), 'La voce [legata][x]<!--\nnon detto --> torna in via\\casa e conta fino a\n38. Poi tace.\n\n<Quadro n="1" titolo="Una `lista<t>` nel titolo">\n\nFine.\n\n[x]: http://e.org\n');
  const well = await check(whole, 'check', '--words');
  const [, source, read] = /^all: (\d+) words in the source, (\d+) read, \d+ left out on purpose: 0 lost, 0 doubled, 0 glued, 0 divided$/m.exec(well.stdout) ?? assert.fail(well.stdout);
  assert.ok(source > 150 && read > 150, well.stdout);
  assert.equal(well.status, 0);
  const broken = path.join(folder, 'broken');
  fs.mkdirSync(broken);
  writeZip(path.join(broken, 'rotto.epub'), epub({ 'uno.xhtml': '<p>Prima.</p>\n<p>Tagliato <b>qui</p>\n<p>tutto perso</p>' }));
  const { stdout, status } = await check(broken, 'check', '--words');
  assert.match(stdout, /^rotto\.epub:3: lost: "perso" before ""$/m);
  assert.match(stdout, /^rotto\.epub: 5 words in the source, 3 read, 0 left out on purpose: 2 lost, 0 doubled/m);
  assert.equal(status, 1);
});

test('reports alternatives without a lemma once, and known elements not at all', () => {
  assert.match(problemsOf('tei-readings.xml')[0].message, /first reading/);
  assert.equal(problemsOf('tei-readings.xml').length, 1);
  for (const name of Object.keys(TEI).filter((name) => name !== 'readings')) assert.deepEqual(problemsOf(`tei-${name}.xml`), [], name);
});

test('EPUB: rejects paths outside the package; reads and reports repeated documents once', async () => {
  assert.equal(await read('beside'), 'Accanto.');
  assert.equal(await read('again'), 'Una volta sola.');
  const [told, ...more] = problemsOf('again.epub');
  assert.match(told.message, /OEBPS\/uno\.xhtml' is in the spine again/);
  assert.ok(told.line > 1 && !more.length);
});

test('an EPUB: verse in div, who speaks, authors by their roles, decomposed file names; encrypted documents are told', async () => {
  const blocks = async (work) => (await (await fetch(`${daemon.url}/v1/library/works/${work}/sections/1`)).json()).blocks;
  assert.deepEqual((await blocks('epub-lines')).map(({ kind, lines }) => [kind, lines?.length]), [['verse', 2], ['verse', 2]]);
  const [speaker, said, after] = await blocks('epub-drama');
  assert.deepEqual([speaker.kind, said.speaker, after.speaker], ['speaker', 'Anna', undefined]);
  assert.deepEqual(said.marks.map(({ kind, start, end }) => [kind, said.text.slice(start, end)]), [['stage', '(piano)']]);
  assert.equal(await read('roles'), 'Perché no.');
  assert.deepEqual([all.works.find(({ id }) => id === 'roles').author, all.works.find(({ id }) => id === 'roles').date], ['A. Rossi; Ada Neri', '1881']);
  assert.match(problemsOf('locked.epub')[0].message, /'OEBPS\/uno\.xhtml' is encrypted \(DRM\)/);
  assert.equal(await read('locked'), 'Libero.');
});

test('limits the size of a work, and reports it with its position', async () => {
  const { stdout, status } = await check(bounds);
  const [, line] = /entities\.xml:(\d+):\d+: the limit for a work is 64 MiB of the index/.exec(stdout) ?? assert.fail(stdout);
  assert.ok(Number(line) > 100, line);
  assert.match(stdout, /^entities .* sections/m);
  assert.equal(status, 1);
});

test('shortens names and numbers that each block repeats', async () => {
  const { blocks } = await (await fetch(`${daemon.url}/v1/library/works/repeats/sections/1`)).json();
  assert.ok(Math.max(...blocks.map(({ speaker = '' }) => speaker.length)) <= 200);
  assert.ok(Math.max(...blocks.flatMap(({ lines = [] }) => lines.map(({ n }) => n.length))) <= 200);
});

test('reads nothing outside the library: links to files and folders, recordings; link loops end', async () => {
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

test('stops reading a file that becomes a link out of the library', async () => {
  const file = path.join(works, 'below', 'real.txt');
  fs.rmSync(file);
  fs.symlinkSync(secret, file);
  await eventually(async () => { all = await (await fetch(`${daemon.url}/v1/library?limit=1000`)).json(); return problemsOf('below/real.txt').length; }, 'the link', 120000);
  assert.ok(!all.works.some(({ id }) => id === 'below-real'));
});

test('reads foreign words with a voice of their language, omits stage directions, and keeps text positions', async () => {
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
