// SPDX-License-Identifier: GPL-3.0-or-later
// Bounds on hostile files and clients of the library: pages grow only linearly with their text, a process with limits parses files, other
// clients are served meanwhile, and a damaged index is recreated.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { Daemon, eventually } from '../../lib/daemon.mjs';

const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-bounds-'));
const [works, scenes, index] = ['works', 'scenes', 'index'].map((name) => path.join(folder, name));
const put = (name, text) => fs.writeFileSync(path.join(works, name), text);
const tei = (body) => `<TEI xmlns="http://www.tei-c.org/ns/1.0" xml:lang="it"><teiHeader/><text><body><div>${body}</div></body></text></TEI>`;
const SMALL = 500, FACTOR = 8; // size of a work in one dimension, and the factor of the second work
// dimensions: marks in a paragraph, nested marks, lines of a stanza, marks across lines, notes, pages
const shapes = {
  marks: (n) => `<p>${'<emph>amo</emph> '.repeat(n)}</p>`,
  crossed: (n) => `<p>${'<emph><foreign xml:lang="en">so</foreign></emph><name>Ada</name> '.repeat(n / 2)}</p>`,
  lines: (n) => `<lg>${'<l>amo</l>'.repeat(n)}</lg>`,
  over: (n) => `<lg>${'<l><emph>amo</emph> te</l>'.repeat(n / 2)}</lg>`,
  notes: (n) => `<p>${'amo<note>sì</note> '.repeat(n / 4)}</p>`,
  pages: (n) => `<p>${'amo<pb n="1"/> '.repeat(n)}</p>`,
  blocks: (n) => '<p>amo</p>'.repeat(n),
};
const hostile = '![[]()';

let daemon;
const get = (address) => fetch(`${daemon.url}${address}`);
const list = async () => (await get('/v1/library?limit=1000')).json();
const ready = (what = 'the library') => eventually(async () => { const all = await list(); return all.state === 'ready' && all; }, what, 240000); // a reader may take ten times its limit of processor time by the clock
// processor time of the daemon, in ticks of 10 ms
const ticks = () => fs.readFileSync(`/proc/${daemon.process.pid}/stat`, 'utf8').replace(/\(.*\)/, 'x').split(' ').slice(13, 15).reduce((sum, each) => sum + Number(each), 0);
// pids of the daemon's reader processes
const readers = () => fs.readdirSync('/proc').filter((pid) => {
  try {
    const [, name, parent] = /\((.*)\) \S (\d+)/.exec(fs.readFileSync(`/proc/${pid}/stat`, 'utf8'));
    return name === 'faccia-reader' && Number(parent) === daemon.process.pid;
  } catch {
    return false; // it has ended, or is not a process
  }
});
const cost = async (address, times) => {
  const before = ticks();
  for (let i = 0; i < times; i++) assert.equal((await (await get(address)).text()).startsWith('<!doctype') || address.startsWith('/v1'), true);
  return Math.max(ticks() - before, 1) / times;
};

before(async () => {
  for (const each of [works, scenes]) fs.mkdirSync(each);
  for (const [name, shape] of Object.entries(shapes)) {
    put(`${name}-small.xml`, tei(shape(SMALL)));
    put(`${name}-large.xml`, tei(shape(SMALL * FACTOR)));
  }
  put('nested.md', `uno *due **tre** quattro*\n\n# Fine\n\n{ graffa & ~ }\n`);
  put('tesi.md', '---\ntitle: Insiemi { aperti e \\chiusi\nauthor: A } B\nlang: it\n---\ntesto\n');
  put('scena.xml', tei('<sp><p>Vieni <stage>(piano)</stage> <emph>qui</emph>.</p></sp>'));
  put('poem.xml', tei('<lg><l>sol<emph>o</emph></l><l><emph>e <foreign xml:lang="en">so</foreign></emph> va</l></lg>'));
  put('zz.md', `# Titolo\n\nbuono\n\n${hostile.repeat(500000)}\n`);
  put('zzu.txt', `${'_amo '.repeat(13)}\n`.repeat(30000)); // an emphasis begins 390,000 times, and never ends
  put('zzz.txt', 'dopo il peggio\n');
  daemon = await Daemon.start(['--library', works, '--library-index', index, '--editing', '--scenes', scenes], {}, { voices: false });
  await ready();
});
after(async () => {
  await daemon?.stop();
  fs.rmSync(folder, { recursive: true });
});

test('the cost of a page grows linearly with the text', async () => {
  for (const name of Object.keys(shapes))
    for (const address of ['/library/%/1', '/v1/library/works/%/sections/1', '/v1/library/search?q=amo&work=%&limit=100']) {
      if (name === 'crossed' && address.includes('search')) continue;
      const [small, large] = [await cost(address.replace('%', `${name}-small`), 2), await cost(address.replace('%', `${name}-large`), 1)];
      assert.ok(large <= small * 25 + 20, `${address} of ${name}: ${small} -> ${large} ticks for ${FACTOR} times the text`);
    }
});

test('marks of a page nest, line by line', async () => {
  assert.match(await (await get('/library/poem/1')).text(), /sol<em>o<\/em><\/span>\n<span[^>]*><em>e <i lang="en">so<\/i><\/em> va<\/span>/);
  assert.match(await (await get('/library/nested/1')).text(), /uno <em>due <em>tre<\/em> quattro<\/em>/);
  assert.match(await (await get('/library/scena/1')).text(), /Vieni <span class="stage">\(piano\)<\/span> <em>qui<\/em>\./);
});

test('balances braces in a name in BibTeX', async () => {
  const bib = await (await get('/library/tesi.bib')).text();
  assert.match(bib, /title = \{\{Insiemi \{\\textbraceleft\} aperti e \{\\textbackslash\}chiusi\}\}/);
  let depth = 0; // BibTeX counts escaped braces, too
  for (const sign of bib.trimEnd().slice(0, -1)) {
    depth += sign === '{' ? 1 : sign === '}' ? -1 : 0;
    assert.ok(depth >= 0, bib);
  }
  assert.equal(depth, 1, bib);
});

test('reports a file that takes too long to read, and reads the following ones', async () => {
  const all = await list();
  const told = all.problems.find(({ file }) => file === 'zz.md');
  // on a busy machine the limit by the clock may come first
  assert.match(told?.message ?? 'nothing', /the process that reads it took more than \d+ s( of processor time)?, (in its first section|after section 1)/);
  assert.ok(all.works.some(({ id }) => id === 'zzz'));
});

test('reads 2 MB of underscores that end no emphasis', async () => {
  const all = await list();
  assert.equal(all.problems.find(({ file }) => file === 'zzu.txt'), undefined);
  assert.ok(all.works.some(({ id }) => id === 'zzu'));
});

test('saves abandoned by four clients delay no one, and are cleaned up', async () => {
  const leaving = new AbortController();
  const saving = [1, 2, 3, 4].map((i) => fetch(`${daemon.url}/v1/library/files/b${i}.md`, { method: 'PUT', body: hostile.repeat(500000), signal: leaving.signal }));
  const left = Promise.allSettled(saving);
  await eventually(() => readers().length, 'a check', 120000);
  for (const address of ['/v1/scenes', '/v1/library/files', '/v1/library/search?q=peggio'])
    assert.equal((await fetch(`${daemon.url}${address}`, { signal: AbortSignal.timeout(10000) })).status, 200, `${address} while they are checked`);
  leaving.abort();
  await left;
  await eventually(() => !readers().length, 'the end of all checks', 120000);
  assert.deepEqual(fs.readdirSync(works).filter((name) => name.startsWith('b')).filter((name) => name.endsWith('.md')), []);
});

test('rebuilds a damaged index while the daemon runs, and reports it once', async () => {
  for (const name of [index, `${index}-wal`]) { // the log has what is not yet in the file
    const file = fs.openSync(name, 'r+');
    const { size } = fs.fstatSync(file);
    if (size) fs.writeSync(file, Buffer.alloc(size, 0xa5), 0, size, 0);
    fs.closeSync(file);
  }
  fs.unlinkSync(path.join(works, 'zz.md'));
  await eventually(async () => { await (await get('/v1/library/search?q=peggio')).text(); return /is damaged or of another version; rebuilding it/.test(daemon.log); }, 'a line in the log', 120000);
  await ready('the new index');
  const { results } = await (await get('/v1/library/search?q=peggio')).json();
  assert.deepEqual(results.map(({ work }) => work.id), ['zzz']);
  assert.equal(daemon.log.match(/rebuilding it/g).length, 1);
});

test('obeys SIGTERM while reading a file', async () => {
  put('again.md', hostile.repeat(500000));
  await eventually(() => readers().length, 'the reading', 120000);
  const started = Date.now();
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  assert.ok(Date.now() - started < 15000, 'it hangs');
  daemon = undefined;
});
