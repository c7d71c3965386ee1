// SPDX-License-Identifier: GPL-3.0-or-later
// A read-aloud book (EPUB 3 with media overlays) brings its own recording: faccia's own export comes back whole.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { Daemon, build, eventually, ordinary } from '../../lib/daemon.mjs';

const folder = fs.mkdtempSync(path.join(fs.realpathSync(build), 'spoken-book-')); // not in /tmp, which the aligner may always read
const works = path.join(folder, 'works');
const sources = path.join(folder, 'sources');
const program = path.join(ordinary, 'server/cli/faccia');
const TEXT = `---
title: Il porto
author: A. Rossi
lang: it
---
# Mattina

La barca torna al porto. Il pescatore conta le reti e guarda il mare.

# Sera

Domani partono tutti. La luna sale piano sopra il monte, e il gatto dorme. Nel 1827 il dott. Bo aveva 3 case.
`;

let daemon;
const ask = async (address) => (await daemon.get(`/v1/library${address}`)).json();
const recording = async (work) => (await ask(`/works/${work}`)).recordings?.[0];
const finished = (work) => eventually(async () => { const one = await recording(work); return ['aligned', 'failed'].includes(one?.state) && one; }, `${work} aligned`, 240000);

/** Cuts a file off in its middle. */
const cut = (file) => {
  const to = `${file}.cut`;
  fs.writeFileSync(to, fs.readFileSync(file).subarray(0, 3000));
  return to;
};

/** Changes a book: files by name, or null to leave one out; paths of files to add. */
function rebuilt(from, to, files, added = {}) {
  const script = `
import json, sys, zipfile
a, b = zipfile.ZipFile(sys.argv[1]), zipfile.ZipFile(sys.argv[2], 'w')
files = json.load(sys.stdin)
for i in a.infolist():
    new = files.get(i.filename, False)
    if new is None: continue
    b.writestr(i, a.read(i.filename) if new is False else new)
for name, file in json.loads(sys.argv[3]).items(): b.write(file, name)
b.close()`;
  execFileSync('python3', ['-c', script, from, to, JSON.stringify(added)], { input: JSON.stringify(files) });
}

before(async () => {
  for (const name of [works, sources]) fs.mkdirSync(name);
  fs.writeFileSync(path.join(sources, 'porto.md'), TEXT);
  execFileSync(program, ['library', 'export', '--epub', path.join(works, 'porto.epub'), '--wav', path.join(folder, 'porto.wav'), '--vtt', path.join(folder, 'porto.vtt'), sources, 'porto']);
  const book = path.join(works, 'porto.epub');
  const read = (name) => execFileSync('unzip', ['-p', book, `EPUB/${name}`], { encoding: 'utf8' });
  const smil = read('s2.smil');
  // only the second section is recorded, in hours, minutes and seconds, with a clip to the end of the file, by a path with signs
  const ends = [...smil.matchAll(/clipEnd="([^"]+)"/g)].map(([, time]) => time);
  const [firstText] = smil.match(/<text src="[^"]+"\/>/);
  rebuilt(book, path.join(works, 'aperto.epub'), { 'EPUB/s1.smil': '<smil xmlns="http://www.w3.org/ns/SMIL" version="3.0"><body/></smil>', 'EPUB/s2.smil': `<smil xmlns="http://www.w3.org/ns/SMIL" version="3.0"><body><par>${firstText}<audio src="s2.mp3" clipBegin="0"/></par></body></smil>` });
  rebuilt(book, path.join(works, 'meta.epub'), { 'EPUB/s1.smil': '<smil xmlns="http://www.w3.org/ns/SMIL" version="3.0"><body/></smil>', 'EPUB/s2.smil': smil.replaceAll('src="s2.mp3"', 'src="./x/../s%32.mp3"').replace(`clipEnd="${ends.at(-1)}"`, '') });
  rebuilt(book, path.join(works, 'senza.epub'), { 'EPUB/s1.smil': '<smil xmlns="http://www.w3.org/ns/SMIL" version="3.0"><body/></smil>', 'EPUB/s2.smil': '<smil xmlns="http://www.w3.org/ns/SMIL" version="3.0"><body/></smil>' });
  // one overlay reads both pages, as it may where a page of fixed layout is divided
  const pars = [...(read('s1.smil') + smil).matchAll(/<par\b[\s\S]*?<\/par>/g)].join('');
  rebuilt(book, path.join(works, 'insieme.epub'), {
    'EPUB/s1.smil': `<smil xmlns="http://www.w3.org/ns/SMIL" version="3.0"><body>${pars}</body></smil>`,
    'EPUB/package.opf': read('package.opf').replace(/media-overlay="([^"]+)"([\s\S]*)media-overlay="[^"]+"/, 'media-overlay="$1"$2media-overlay="$1"'),
  });
  rebuilt(book, path.join(works, 'rotto.epub'), { 'EPUB/s1.mp3': 'this is no sound' });
  rebuilt(book, path.join(works, 'perso.epub'), { 'EPUB/s1.mp3': null });
  rebuilt(book, path.join(works, 'storto.epub'), { 'EPUB/s1.smil': '<smil><body>' });
  // the same book with its sound as AAC, and texts that nobody reads; one clip for a section, whose words are bounded by it
  const mp4 = (name) => {
    const mp3 = path.join(folder, `${name}.mp3`), m4a = path.join(folder, `${name}.m4a`);
    fs.writeFileSync(mp3, execFileSync('unzip', ['-p', book, `EPUB/${name}.mp3`], { maxBuffer: 1 << 26 }));
    execFileSync('ffmpeg', ['-v', 'error', '-y', '-i', mp3, '-c:a', 'aac', '-b:a', '64k', m4a]);
    return m4a;
  };
  const all = (name, file) => {
    const times = [...read(`${name}.smil`).matchAll(/clipBegin="([^"]+)" clipEnd="([^"]+)"/g)];
    return `<smil xmlns="http://www.w3.org/ns/SMIL" version="3.0"><body><par><audio src="${file}" clipBegin="${times[0][1]}" clipEnd="${times.at(-1)[2]}"/><text src="${name}.xhtml#tutto"/></par></body></smil>`;
  };
  const more = 'Questo foglio spiega come si ascolta il libro e non viene letto da nessuno.';
  const page = (name, after = '') => read(`${name}.xhtml`).replace(/(<body[^>]*>)([\s\S]*)(<\/body>)/, (_, open, inner, close) => `${open}${name === 's1' ? `<p>${more}</p>` : ''}<div id="tutto">${inner}</div>${after}${close}`);
  rebuilt(book, path.join(works, 'aac.epub'), {
    'EPUB/s1.smil': all('s1', 's1.m4a'), 'EPUB/s2.smil': all('s2', 's2.m4a'), 'EPUB/s1.xhtml': page('s1'), 'EPUB/s2.xhtml': page('s2', '<p>Anche questa coda del libro resta muta.</p>'),
  }, { 'EPUB/s1.m4a': mp4('s1'), 'EPUB/s2.m4a': mp4('s2') });
  rebuilt(book, path.join(works, 'mozzo.epub'), { 'EPUB/s1.smil': read('s1.smil').replaceAll('s1.mp3', 's1.m4a') }, { 'EPUB/s1.m4a': cut(mp4('s1')) });
  fs.copyFileSync(path.join(sources, 'porto.md'), path.join(works, 'solo.md'));
  execFileSync('ffmpeg', ['-v', 'error', '-y', '-i', path.join(folder, 'porto.wav'), '-c:a', 'aac', '-b:a', '64k', path.join(works, 'solo.m4a')]);
  daemon = await Daemon.start(['--library', works, '--library-index', path.join(folder, 'index'), '--library-align', '100']);
  await eventually(async () => (await ask('')).state === 'ready', 'the library');
});
after(async () => {
  assert.equal((await daemon.stop()).code, 0, daemon.log);
  fs.rmSync(folder, { recursive: true });
});

test('the recording of an exported book is the one that was exported, and its words are found in it', async () => {
  const one = await finished('porto');
  assert.deepEqual([one.state, one.file, one.missing, one.unread, one.unwritten], ['aligned', 'porto.epub', 0, [], []], JSON.stringify(one));
  const times = [...fs.readFileSync(path.join(folder, 'porto.vtt'), 'utf8').matchAll(/<(\d\d):(\d\d):(\d\d\.\d{3})>(\p{L}+)/gu)].map(([, h, m, s, word]) => [word, h * 3600 + m * 60 + Number(s)]);
  const said = await (await daemon.get('/v1/speech?passage=porto:1&voice=recording&format=json')).json();
  assert.equal(said.voice, 'recording:porto');
  assert.deepEqual(said.words.map(({ text }) => text).slice(0, 4), ['Mattina', 'La', 'barca', 'torna']);
  const first = said.words.map(({ text, start }) => [text, start, times.find(([word]) => word === text)?.[1]]).filter(([, , time]) => time);
  assert.ok(first.length > 8);
  for (const [word, start, time] of first) assert.ok(Math.abs(start - time) < 0.15, `${word}: ${start} instead of ${time}`);
  const sound = Buffer.from(await (await daemon.get('/v1/speech?passage=porto:2:p1&voice=recording&format=wav')).arrayBuffer());
  const loud = (buffer) => Math.sqrt(new Int16Array(buffer.buffer, buffer.byteOffset + 44, (buffer.length - 44) >> 1).reduce((sum, x) => sum + x * x, 0) / (buffer.length / 2));
  const whole = fs.readFileSync(path.join(folder, 'porto.wav'));
  assert.ok(loud(sound) > loud(whole) / 2, 'it is heard');
  assert.ok(sound.length < whole.length);
});

test('numbers and abbreviations are found in the recording as they are written', async () => {
  await finished('porto');
  const { words } = await (await daemon.get('/v1/speech?passage=porto:2:p1&voice=recording&format=json')).json();
  assert.deepEqual(words.map(({ text }) => text).slice(-7), ['1827', 'il', 'dott', 'Bo', 'aveva', '3', 'case']);
});

test('an overlay that several pages name is heard once', async () => {
  const one = await finished('insieme');
  assert.deepEqual([one.state, one.missing, one.unread, one.unwritten], ['aligned', 0, [], []], JSON.stringify(one));
  for (const passage of ['2:p1', '1:p1']) {
    const [words, whole] = await Promise.all(['insieme', 'porto'].map(async (work) => (await (await daemon.get(`/v1/speech?passage=${work}:${passage}&voice=recording&format=json`)).json()).words.map(({ text, start }) => [text, start.toFixed(1)])));
    assert.deepEqual(words, whole);
  }
});

test('only a part of a book may be recorded; clips may go to the end of a file', async () => {
  const one = await finished('meta');
  assert.equal(one.state, 'aligned', JSON.stringify(one));
  assert.ok(one.unread.length && one.unread.every(({ passage }) => passage.startsWith('meta:1:')), JSON.stringify(one.unread));
  const said = await (await daemon.get('/v1/speech?passage=meta:2:p1&voice=recording&format=json')).json();
  assert.deepEqual(said.words.map(({ text }) => text).slice(0, 3), ['Domani', 'partono', 'tutti']);
});

test('a clip without an end reads the text that follows its own, too, if there is sound for it', async () => {
  const one = await finished('aperto');
  assert.equal(one.state, 'aligned', JSON.stringify(one));
  assert.ok(one.unread.length && one.unread.every(({ passage }) => passage.startsWith('aperto:1:')), JSON.stringify(one.unread));
  assert.deepEqual(one.unwritten, []);
  const { words } = await (await daemon.get('/v1/speech?passage=aperto:2:p1&voice=recording&format=json')).json();
  assert.deepEqual(words.map(({ text }) => text).slice(0, 3), ['Domani', 'partono', 'tutti']);
});

test('sound in AAC is read, in books and beside works; words lie in the clip of their text, and text without a clip is not read', async () => {
  const times = [...fs.readFileSync(path.join(folder, 'porto.vtt'), 'utf8').matchAll(/<(\d\d):(\d\d):(\d\d\.\d{3})>(\p{L}+)/gu)].map(([, h, m, s, word]) => [word, h * 3600 + m * 60 + Number(s)]);
  const one = await finished('aac');
  assert.deepEqual([one.state, one.missing, one.unwritten], ['aligned', 2, []], JSON.stringify(one));
  assert.deepEqual(one.unread.map(({ passage }) => passage.replace(/:p\d+$/, '')), ['aac:1', 'aac:3'], JSON.stringify(one.unread));
  const whole = await finished('solo');
  assert.deepEqual([whole.state, whole.file, whole.missing], ['aligned', 'solo.m4a', 0], JSON.stringify(whole));
  for (const [passage, first] of [['aac:2:p1', 'La'], ['solo:1', 'Mattina']]) {
    const { words } = await (await daemon.get(`/v1/speech?passage=${passage}&voice=recording&format=json`)).json();
    assert.equal(words[0].text, first, passage);
    const from = passage === 'solo:1' ? 0 : words[1].start - times.find(([word]) => word === 'barca')[1];
    for (const word of ['barca', 'porto', 'pescatore', 'reti', 'guarda'])
      assert.ok(Math.abs(words.find(({ text }) => text.startsWith(word)).start - from - times.find(([text]) => text === word)[1]) < 0.15, `${passage}: ${word} ${JSON.stringify(words)}`);
  }
});

test('a book whose sound cannot be read says why, and is read all the same', async () => {
  for (const [work, why] of [['senza', /no recording/], ['rotto', /s1\.mp3/], ['mozzo', /s1\.m4a': the MP4 file has no index/], ['perso', /has no 'EPUB\/s1\.mp3'/], ['storto', /s1\.smil', line 1/]]) {
    const one = await finished(work);
    assert.equal(one.state, 'failed', work);
    assert.match(one.why, why, work);
    assert.equal((await ask(`/works/${work}`)).passages, 4);
  }
  assert.equal(spawnSync(program, ['library', works]).status, 0);
});
