// SPDX-License-Identifier: GPL-3.0-or-later
// Exports of a work: an EPUB with media overlays (validated by epubcheck), captions, TextGrid and face; feeds, sitemap and citations,
// parsed with common libraries.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { Daemon, build, eventually, root } from '../../lib/daemon.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-export-'));
const works = path.join(folder, 'works');
const made = path.join(folder, 'made');
const file = (name) => path.join(made, name);
const program = path.join(build, 'server/cli/faccia');
const put = (name, text) => fs.writeFileSync(path.join(works, name), text);
const faccia = (...args) => spawnSync(program, args, { encoding: 'utf8', env: { ...process.env, XDG_CACHE_HOME: folder } });
const exported = (from, work, ...options) => {
  const done = faccia('library', 'export', ...options, from, work);
  assert.deepEqual([done.status, done.stderr], [0, ''], done.stderr);
};
const written = (...rest) => exported(works, ...rest);
const python = (script, ...args) => JSON.parse(execFileSync('/usr/bin/python3', ['-c', script, ...args], { encoding: 'utf8', maxBuffer: 1 << 24 }));

/** Reads a book as a reading system does: for each section its text, ids with their contents, clips, and lines of verse. */
const BOOK = `
import json, sys, zipfile
import xml.etree.ElementTree as T
X, S, O = ('{http://www.w3.org/1999/xhtml}', '{http://www.w3.org/ns/SMIL}', '{http://www.idpf.org/2007/opf}')
z = zipfile.ZipFile(sys.argv[1])
opf = T.fromstring(z.read('EPUB/package.opf'))
ms = lambda t: round(sum(float(n) * 60 ** i for i, n in enumerate(reversed(t.split(':')))) * 1000)
items = {i.get('id'): i for i in opf.iter(O + 'item')}
metas = [(m.get('property'), m.get('refines'), m.text) for m in opf.iter(O + 'meta')]
sections = []
for ref in opf.iter(O + 'itemref'):
    item = items[ref.get('idref')]
    page = T.fromstring(z.read('EPUB/' + item.get('href')))
    clips = []
    if item.get('media-overlay'):
        smil = T.fromstring(z.read('EPUB/' + items[item.get('media-overlay')].get('href')))
        clips = [[p.find(S + 'text').get('src').split('#')[1], ms(p.find(S + 'audio').get('clipBegin')), ms(p.find(S + 'audio').get('clipEnd')), p.find(S + 'audio').get('src')] for p in smil.iter(S + 'par')]
    marked = {e.get('id'): ''.join(e.itertext()) for e in page.iter(X + 'span') if (e.get('id') or '').startswith('w')}
    sections.append({'text': ''.join(page.find(X + 'body').itertext()), 'marked': marked, 'clips': clips, 'lines': [[d.get('data-n'), ''.join(d.itertext())] for d in page.iter(X + 'span') if (d.get('class') or '').startswith('line')]})
print(json.dumps({'names': z.namelist(), 'stored': z.infolist()[0].compress_type, 'metas': metas, 'sections': sections, 'title': opf.find('.//{http://purl.org/dc/elements/1.1/}title').text}))
`;
const book = (name) => python(BOOK, file(name));
const valid = (...names) => {
  for (const name of names) {
    const said = spawnSync('java', ['-jar', '/usr/share/java/epubcheck.jar', '--failonwarnings', file(name)], { encoding: 'utf8' });
    assert.equal(said.status, 0, said.stdout + said.stderr);
  }
};

before(() => {
  fs.cpSync(path.join(root, 'models/library'), works, { recursive: true });
  fs.rmSync(path.join(works, 'meson.build'));
  fs.mkdirSync(made);
  put('segni.xml', `<?xml version="1.0"?><TEI xml:lang="it"><teiHeader><fileDesc><titleStmt><title>Segni &amp; "prove" {100%} &lt;b&gt;</title><author>Ada_Rossi</author></titleStmt>
<publicationStmt><publisher>Casa &amp; figli</publisher><date>1998</date></publicationStmt></fileDesc></teiHeader><text><body>
<div><head>Uno</head><p>Prima <emph>parte che <foreign xml:lang="en">goes on</foreign>. E poi</emph> finisce<note>Una nota &lt;breve&gt;.</note> nel 1998.</p>
<p xml:lang="en">The clock is slow.</p><pb n="7"/><lg><l n="41">Il mare è calmo,</l><l>la luna è piena.</l></lg></div>
<div><p>...</p></div></body></text></TEI>`);
  put('detto.md', '---\ntitle: Detto\nlang: it\n---\nLa luna sale sul monte. Il gatto dorme vicino al fuoco.\n');
  execFileSync(program, ['say', '--lang', 'it', '--wav', path.join(works, 'detto.wav'), 'La luna sale sul monte. Il gatto dorme vicino al fuoco.']);
});
let daemon;
after(async () => {
  await daemon?.stop();
  fs.rmSync(folder, { recursive: true });
});

test('a book: timed words with ids and no gap; verse as verse; epubcheck reports nothing', () => {
  written('segni', '--epub', file('segni.epub'));
  written('mare', '--epub', file('mare.epub'), '--sentences');
  written('o-farol', '--epub', file('farol.epub'), '--silent');
  written('the-clock', '--epub', file('clock.epub'));
  valid('segni.epub', 'mare.epub', 'farol.epub');

  const { sections: [uno, due], names, stored, title, metas } = book('segni.epub');
  assert.deepEqual([names[0], stored, title], ['mimetype', 0, 'Segni & "prove" {100%} <b>']);
  assert.deepEqual(uno.clips.map(([id]) => uno.marked[id]), ['Uno', 'Prima', 'parte', 'che', 'goes', 'on', 'E', 'poi', 'finisce', 'nel', '1998', 'The', 'clock', 'is', 'slow', 'Il', 'mare', 'è', 'calmo', 'la', 'luna', 'è', 'piena']);
  assert.equal(uno.clips[0][1], 0);
  for (const [i, clip] of uno.clips.entries()) {
    assert.ok(clip[2] > clip[1], clip.join());
    if (i) assert.equal(clip[1], uno.clips[i - 1][2]);
  }
  assert.match(uno.text, /goes on\. E poi finisce\* nel 1998\.\s+Una nota <breve>\./);
  assert.deepEqual(uno.lines, [['41', 'Il mare è calmo,'], [null, 'la luna è piena.']]);
  assert.deepEqual([due.clips.length, due.text.trim()], [0, '...']);
  const [whole] = metas.filter(([property, refines]) => property === 'media:duration' && !refines);
  assert.equal(whole[2].split(':').reduce((sum, part) => sum * 60 + Number(part), 0).toFixed(3), (uno.clips.at(-1)[2] / 1000).toFixed(3));

  const [canto, dialogo] = book('mare.epub').sections;
  assert.equal(canto.clips.map(([id]) => canto.marked[id])[1], 'Il mare è calmo e la luna è piena');
  assert.equal(canto.lines.length, 8);
  assert.match(dialogo.text, /Anna[^]*slow and steady/);
  assert.ok(book('farol.epub').sections.every(({ clips }) => !clips.length));
  const [clock] = book('clock.epub').sections;
  assert.equal(clock.marked[clock.clips[0][0]], 'The');
  assert.ok(!/[<>]/.test(clock.text));
});

test('an exported book comes back as it was: sections, passages, speakers and stage directions', () => {
  const again = path.join(folder, 'again');
  fs.mkdirSync(again);
  written('la-chiave', '--epub', file('la-chiave.epub'), '--silent');
  valid('la-chiave.epub');
  const measured = (from, ending) => Object.fromEntries([...faccia('library', from).stdout.matchAll(new RegExp(`^(\\S+) +\\S+ +${ending} +(\\d+) sections +(\\d+) passages`, 'gm'))].map(([, id, ...counts]) => [id, counts]));
  const before = measured(works, 'tei');
  for (const name of ['mare', 'la-chiave']) fs.copyFileSync(file(`${name}.epub`), path.join(again, `${name}.epub`));
  const told = faccia('library', 'check', '--words', again);
  assert.deepEqual([told.status, told.stderr], [0, ''], told.stdout);
  const after = measured(again, 'epub');
  for (const name of ['mare', 'la-chiave']) assert.deepEqual(after[name], before[name], name);
  const cast = (at) => JSON.parse(faccia('library', 'cast', '--json', at).stdout).cast.map(({ id, name, passages, characters }) => [id, name, passages, characters]);
  assert.deepEqual(cast(path.join(again, 'la-chiave.epub')), cast(path.join(works, 'la-chiave.xml')));
});

test('book and captions give words the same times', () => {
  written('detto', '--epub', file('detto.epub'), '--vtt', file('detto.vtt'));
  const [{ clips, marked }] = book('detto.epub').sections;
  const spoken = [...fs.readFileSync(file('detto.vtt'), 'utf8').matchAll(/<(\d\d):(\d\d):(\d\d\.\d{3})>(?:")?(\p{L}+)/gu)].map(([, h, m, s, word]) => [word, Math.round((h * 3600 + m * 60 + Number(s)) * 1000)]);
  for (const [word, ms] of spoken) assert.ok(clips.some(([id, from]) => marked[id] === word && Math.abs(from - ms) <= 1), `${word} ${ms}`);
  assert.ok(spoken.length > 6);
});

test('uses the recording next to the work', () => {
  written('detto', '--voice', 'recording', '--epub', file('recorded.epub'), '--wav', file('recorded.wav'));
  const [{ clips, marked }] = book('recorded.epub').sections;
  assert.deepEqual(clips.map(([id]) => marked[id]), ['La', 'luna', 'sale', 'sul', 'monte', 'Il', 'gatto', 'dorme', 'vicino', 'al', 'fuoco']);
  assert.ok(book('recorded.epub').metas.some(([name, , value]) => name === 'media:narrator' && value === 'recording:detto'));
  const none = faccia('library', 'export', '--voice', 'recording', '--epub', file('none.epub'), works, 'mare');
  assert.equal(none.status, 1);
  assert.match(none.stderr, /there is no recording beside it/);
  assert.ok(!fs.existsSync(file('none.epub')));
});

test('audiobooks have a chapter for each section, in MP4 and MP3', () => {
  fs.mkdirSync(path.join(folder, 'more'));
  fs.writeFileSync(path.join(folder, 'more/capitoli.md'), '---\ntitle: Capitoli; "=" e #\nauthor: A. Rossi\nlang: it\ndate: 1999\n---\nSenza titolo.\n\n# Uno; con = segni #1\n\nLa luna sale.\n\n# Vuoto\n\n# Due\n\nIl gatto dorme.\n');
  exported(path.join(folder, 'more'), 'capitoli', '--m4b', file('capitoli.m4b'), '--mp3', file('capitoli.mp3'), '--wav', file('capitoli.wav'));
  const seconds = (fs.statSync(file('capitoli.wav')).size - 44) / 2 / 22050;
  for (const [name, codec] of [['capitoli.m4b', 'aac'], ['capitoli.mp3', 'mp3']]) {
    const { chapters, format, streams } = JSON.parse(execFileSync('ffprobe', ['-v', 'error', '-of', 'json', '-show_chapters', '-show_format', '-show_streams', file(name)], { encoding: 'utf8' }));
    assert.equal(streams[0].codec_name, codec);
    assert.deepEqual([format.tags.title, format.tags.artist, format.tags.date], ['Capitoli; "=" e #', 'A. Rossi', '1999']);
    assert.deepEqual(chapters.map(({ tags }) => tags.title), ['Capitoli; "=" e #', 'Uno; con = segni #1', 'Vuoto', 'Due']);
    for (const [i, chapter] of chapters.entries()) assert.ok(Math.abs(chapter.start_time - (i ? chapters[i - 1].end_time : 0)) < 0.002);
    assert.ok(Math.abs(chapters.at(-1).end_time - seconds) < 0.01 && Math.abs(format.duration - seconds) < 0.2, `${format.duration} ${seconds}`);
  }
  const bare = path.join(folder, 'bare');
  fs.mkdirSync(bare);
  const none = spawnSync(program, ['library', 'export', '--m4b', file('none.m4b'), path.join(folder, 'more'), 'capitoli'], { encoding: 'utf8', env: { ...process.env, PATH: bare, XDG_CACHE_HOME: folder } });
  assert.equal(none.status, 1);
  assert.match(none.stderr, /no ffmpeg in PATH/);
  assert.ok(!fs.existsSync(file('none.m4b')));
});

test('a play: captions say who speaks, and stage directions give moods', () => {
  written('la-chiave', '--srt', file('chiave.srt'), '--vtt', file('chiave.vtt'));
  const srt = fs.readFileSync(file('chiave.srt'), 'utf8');
  const cues = [...srt.matchAll(/(\d+)\n(\d\d:\d\d:\d\d,\d{3}) --> (\d\d:\d\d:\d\d,\d{3})\n([^]*?)\n\n/g)];
  assert.equal(cues.map(([all]) => all).join(''), srt);
  assert.deepEqual(cues.map(([, n]) => Number(n)), cues.map((_, i) => i + 1));
  const vtt = [...fs.readFileSync(file('chiave.vtt'), 'utf8').matchAll(/(\S+) --> (\S+)\n([^]*?)\n\n/g)];
  const plain = (text) => text.replace(/^<v ([^>]*)>/, '$1: ').replace(/<[^>]*>/g, '');
  assert.deepEqual(cues.map(([, , from, to, text]) => [from.replace(',', '.'), to.replace(',', '.'), text]), vtt.map(([, from, to, text]) => [from, to, plain(text)]));
  assert.ok(cues.some(([, , , , text]) => /^Lisetta e Tullio: Alla barca!$/.test(text)), srt);

  const scene = (direction) => `<TEI xml:lang="it"><text><body><div><sp><speaker>Ada</speaker><stage>(${direction})</stage><p>Il pane è caldo.</p></sp></div></body></text></TEI>`;
  const faces = ['bevendo', 'piangendo', 'leggendo'].map((direction) => {
    fs.writeFileSync(path.join(folder, `more/${direction}.xml`), scene(direction));
    exported(path.join(folder, 'more'), direction, '--fap', file(`${direction}.fap`));
    return fs.readFileSync(file(`${direction}.fap`), 'utf8');
  });
  assert.equal(faces[0], faces[2]);
  assert.notEqual(faces[0], faces[1]);
});

test('prose with --dialogue: book, captions and TextGrid mark who speaks, with or without sound, by words or sentences', () => {
  const prose = path.join(folder, 'prose');
  fs.mkdirSync(prose);
  fs.writeFileSync(path.join(prose, 'molo.md'), '---\ntitle: Il molo\nlang: it\n---\n# Sera\n\nLa sera scese sul porto.\n\n«Chi va *là*?» disse Renzo.\n\n«Sono io», rispose Lucia, «e ho *molta* fretta».\n\n«E che vuoi?»\n');
  const marks = (name) => [...execFileSync('unzip', ['-p', file(name), 'EPUB/s1.xhtml'], { encoding: 'utf8' }).replace(/<\/?em>|<span id="[^"]*">/g, '').matchAll(/<span class="speech" data-who="([^"]*)">([^]*?»)/g)].map(([, who, text]) => `${who} ${text.replace(/<[^>]*>/g, '')}`);
  const told = ['renzo «Chi va là?»', 'lucia «Sono io»', 'lucia «e ho molta fretta»', 'renzo «E che vuoi?»'];
  exported(prose, 'molo', '--dialogue', '--epub', file('molo.epub'), '--vtt', file('molo.vtt'), '--textgrid', file('molo.TextGrid'));
  exported(prose, 'molo', '--dialogue', '--epub', file('frasi.epub'), '--sentences', '--voice', 'espeak:it');
  exported(prose, 'molo', '--dialogue', '--epub', file('muto.epub'), '--silent');
  exported(prose, 'molo', '--epub', file('uno.epub'), '--silent');
  valid('molo.epub', 'frasi.epub', 'muto.epub');
  assert.deepEqual(['molo.epub', 'frasi.epub', 'muto.epub', 'uno.epub'].map(marks), [told, told, told, []]);
  const [{ clips, marked, text }] = book('molo.epub').sections;
  assert.deepEqual(clips.map(([id]) => marked[id]).slice(6), ['Chi', 'va', 'là', 'disse', 'Renzo', 'Sono', 'io', 'rispose', 'Lucia', 'e', 'ho', 'molta', 'fretta', 'E', 'che', 'vuoi']);
  assert.match(text, /«Sono io», rispose Lucia, «e ho molta fretta»\.\s/);
  const cues = [...fs.readFileSync(file('molo.vtt'), 'utf8').matchAll(/-->.*\n([^]*?)\n\n/g)].map(([, cue]) => cue.replace(/<\d[^>]*>/g, ''));
  assert.deepEqual(cues.slice(2), ['<v Renzo>«Chi va là?»', 'disse Renzo.', '<v Lucia>«Sono io»', 'rispose Lucia,', '<v Lucia>«e ho molta fretta»', '<v Renzo>«E che vuoi?»']);
  const [, speakers] = fs.readFileSync(file('molo.TextGrid'), 'utf8').split('name = "speakers"');
  assert.deepEqual([...speakers.matchAll(/text = "([^"]+)"/g)].map(([, name]) => name), ['Renzo', 'Lucia', 'Lucia', 'Renzo']);
});

test('exports captions, TextGrid and face of a whole work together', () => {
  written('mare', '--vtt', file('mare.vtt'), '--textgrid', file('mare.TextGrid'), '--fap', file('mare.fap'), '--wav', file('mare.wav'));
  const seconds = (fs.statSync(file('mare.wav')).size - 44) / 2 / 22050;
  const vtt = fs.readFileSync(file('mare.vtt'), 'utf8');
  const cues = [...vtt.matchAll(/^(\d\d):(\d\d):(\d\d\.\d{3}) --> (\d\d):(\d\d):(\d\d\.\d{3})\n([^]*?)\n\n/gm)].map(([, h, m, s, H, M, S, text]) => [h * 3600 + m * 60 + Number(s), H * 3600 + M * 60 + Number(S), text]);
  assert.match(vtt, /^WEBVTT\n\n/);
  assert.ok(cues.length > 8);
  for (const [i, [from, to, text]] of cues.entries()) {
    assert.ok(to > from && to <= seconds + 0.001 && (!i || from >= cues[i - 1][1] - 0.001), text);
    assert.ok(!/&(?!amp;|lt;|gt;)/.test(text), text);
  }
  assert.match(cues.map(([, , text]) => text.replace(/<[^>]*>/g, '').replaceAll('\n', ' ')).join(' '), /la barca dorme legata alla riva;.*slow and steady.*da sola\./);
  const grid = fs.readFileSync(file('mare.TextGrid'), 'utf8');
  assert.deepEqual([...grid.matchAll(/name = "(\w+)"/g)].map(([, name]) => name), ['sentences', 'words', 'phones', 'speakers']);
  for (const tier of grid.split(/item \[\d\]:/).slice(1)) {
    const intervals = [...tier.matchAll(/intervals \[(\d+)\]:\s+xmin = (\S+)\s+xmax = (\S+)\s+text = "((?:[^"]|"")*)"/g)];
    assert.equal(intervals.length, Number(tier.match(/size = (\d+)/)[1]));
    assert.equal(intervals[0][2], '0');
    for (const [i, [, n, from, to]] of intervals.entries()) assert.ok(Number(n) === i + 1 && Number(to) > Number(from) && (!i || from === intervals[i - 1][3]));
    assert.ok(Math.abs(Number(intervals.at(-1)[3]) - seconds) < 1e-3);
  }
  assert.ok(grid.includes('text = "pescatore"') && grid.includes('text = "ʎ"'));
  const fap = fs.readFileSync(file('mare.fap'), 'utf8');
  assert.equal(Number(fap.match(/^2\.1 faccia 25 (\d+)\n/)[1]), Math.ceil(seconds * 25 - 1e-9));
});

test('reports a failed export', () => {
  for (const [status, said, ...args] of [
    [2, /a folder and a work/, works],
    [2, /name an output/, works, 'mare'],
    [2, /name an output/, '--silent', '--vtt', file('x.vtt'), works, 'mare'],
    [1, /unknown work 'nothing'/, '--epub', file('x.epub'), works, 'nothing'],
    [1, /no voice "nobody"/, '--voice', 'nobody', '--epub', file('x.epub'), works, 'mare'],
    [1, /x\.epub/, '--silent', '--epub', path.join(folder, 'no/where/x.epub'), works, 'mare'],
  ]) {
    const done = faccia('library', 'export', ...args);
    assert.equal(done.status, status, args.join(' ') + done.stderr);
    assert.match(done.stderr, said);
  }
  assert.deepEqual(fs.readdirSync(made).filter((name) => name.startsWith('x')), []);
});

test('serves feed, sitemap, citations and descriptions in their standard forms', async () => {
  daemon = await Daemon.start(['--library', works, '--library-index', path.join(folder, 'index')]);
  const get = async (address, type) => {
    const response = await daemon.get(address);
    const text = await response.text();
    assert.deepEqual([response.status, response.headers.get('content-type')?.split(';')[0]], [200, type], address);
    const again = await daemon.get(address, { headers: { 'if-none-match': response.headers.get('etag') } });
    assert.equal(again.status, 304, address);
    return text;
  };
  const kept = async (address, type, name) => fs.writeFileSync(file(name), await get(address, type));
  await eventually(async () => (await (await daemon.get('/v1/library')).json()).state === 'ready', 'the library');
  const later = new Date(Date.UTC(2031, 0, 2, 3, 4, 5));
  fs.appendFileSync(path.join(works, 'kuslar.tr.txt'), '\nBir satır daha.\n');
  fs.utimesSync(path.join(works, 'kuslar.tr.txt'), later, later);
  await eventually(async () => (await (await daemon.get('/library/feed.xml')).text()).includes('2031-01-02T03:04:05Z'), 'the change');

  await kept('/library/feed.xml', 'application/atom+xml', 'feed.xml');
  const feed = python('import feedparser,json,sys\nf=feedparser.parse(sys.argv[1])\nprint(json.dumps([f.bozo, f.version, [[e.title, e.link, e.updated] for e in f.entries]]))', file('feed.xml'));
  assert.deepEqual([!!feed[0], feed[1], feed[2].length], [false, 'atom10', 8]);
  assert.deepEqual(feed[2][0].slice(1), [`${daemon.url}/library/kuslar-tr`, '2031-01-02T03:04:05Z']);
  assert.equal((await daemon.get(new URL(feed[2][0][1]).pathname)).status, 200);

  await kept('/library/sitemap.xml', 'application/xml', 'sitemap.xml');
  const places = python('import json,sys\nimport xml.etree.ElementTree as T\nprint(json.dumps([e.text for e in T.parse(sys.argv[1]).iter("{http://www.sitemaps.org/schemas/sitemap/0.9}loc")]))', file('sitemap.xml'));
  assert.deepEqual(places.sort(), ['detto', 'kuslar-tr', 'la-chiave', 'la-lanterna', 'mare', 'o-farol', 'segni', 'the-clock'].map((id) => `${daemon.url}/library/${id}`));

  await kept('/library/segni.bib', 'application/x-bibtex', 'segni.bib');
  const [entry] = python('import bibtexparser,json,sys\nfrom bibtexparser.customization import convert_to_unicode\nprint(json.dumps([convert_to_unicode(e) for e in bibtexparser.load(open(sys.argv[1])).entries]))', file('segni.bib'));
  assert.deepEqual([entry.ID, entry.ENTRYTYPE, entry.year, entry.language, entry.url], ['segni', 'book', '1998', 'it', `${daemon.url}/library/segni`]);
  assert.match(entry.title, /Segni .*& "prove" .*100.*%.*<b>/);
  assert.match(entry.publisher, /Casa .*& figli/);

  await kept('/library/segni.xml', 'application/xml', 'segni.dc.xml');
  const core = python('import json,sys\nimport xml.etree.ElementTree as T\nprint(json.dumps({e.tag.split("}")[1]: e.text for e in T.parse(sys.argv[1]).getroot()}))', file('segni.dc.xml'));
  assert.deepEqual(core, { title: 'Segni & "prove" {100%} <b>', creator: 'Ada_Rossi', publisher: 'Casa & figli', date: '1998', language: 'it', type: 'Text', identifier: `${daemon.url}/library/segni` });

  const described = async (address) => JSON.parse((await get(address, 'text/html')).match(/<script type="application\/ld\+json">([^<]*)<\/script>/)[1]);
  const work = await described('/library/segni');
  assert.deepEqual([work['@context'], work['@type'], work.name, work.author.name, work.datePublished], ['https://schema.org', 'Book', 'Segni & "prove" {100%} <b>', 'Ada_Rossi', '1998']);
  const chapter = await described('/library/detto/1');
  assert.deepEqual([chapter['@type'], chapter.isPartOf['@type'], chapter.audio.map((audio) => audio['@type'])], ['Chapter', 'Book', ['AudioObject', 'AudioObject']]);
  const { pathname, search } = new URL(chapter.audio[1].contentUrl);
  const sound = await daemon.get(pathname + search);
  assert.deepEqual([sound.status, sound.headers.get('content-type'), Buffer.from(await sound.arrayBuffer()).toString('latin1', 0, 4)], [200, chapter.audio[1].encodingFormat, 'OggS']);
  assert.match(await get('/library', 'text/html'), /<link rel="alternate" type="application\/atom\+xml" href="\/library\/feed\.xml">/);
  for (const address of ['/library/nothing.bib', '/library/nothing.xml', '/library/mare.pdf']) assert.equal((await daemon.get(address)).status, 404, address);
  const grid = await daemon.get('/v1/speech?passage=mare:1:l1&format=textgrid');
  assert.match(await grid.text(), /^File type = "ooTextFile"/);
  assert.match(await (await daemon.get('/v1/speech?passage=mare:1:l1&format=vtt')).text(), /^WEBVTT\n\n00:00:00\.\d{3} --> /);
  const { code } = await daemon.stop();
  assert.equal(code, 0, daemon.log);
  daemon = null;
});
