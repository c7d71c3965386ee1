// SPDX-License-Identifier: MIT
// The built documentation: every link inside leads somewhere, nothing in a page is inline, every text that belongs to it is there, and sizes that texts state are true.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { gzipSync } from 'node:zlib';
import { generated, included, sidebar } from '../../web/docs/pages.mjs';

const root = path.resolve(import.meta.dirname, '../..');
const built = path.join(process.env.FACCIA_WEB ?? path.join(root, 'build/web'), 'docs');
const web = path.dirname(built);
const skip = !fs.existsSync(built) && 'the documentation is not built: sh server/run.sh --build-only';
const pages = skip ? [] : fs.readdirSync(built, { recursive: true, encoding: 'utf8' }).filter((file) => file.endsWith('.html')).sort();
const text = Object.fromEntries(pages.map((page) => [page, fs.readFileSync(path.join(built, page), 'utf8')]));
const ids = Object.fromEntries(pages.map((page) => [page, new Set([...text[page].matchAll(/\sid="([^"]+)"/g)].map(([, id]) => id))]));
const decode = (words) => decodeURIComponent(words.replaceAll('&amp;', '&').replaceAll('&#39;', "'"));

test('each text has a page, and the sidebar lists it', { skip }, () => {
  const written = fs.readdirSync(path.join(root, 'web/docs'), { recursive: true, encoding: 'utf8' }).filter((file) => file.endsWith('.md')).map((file) => file.slice(0, -3));
  const all = [...written, ...Object.keys(included), ...generated].sort();
  assert.deepEqual(pages.map((page) => page.slice(0, -5)).sort(), all);
  const named = sidebar.flatMap(({ items, link }) => items ?? [{ link }]).map(({ link }) => link.slice(1).replace(/(^|\/)$/, '$1index'));
  assert.deepEqual([...named, 'index'].sort(), all);
});

test('every internal link leads to an existing page and heading', { skip }, () => {
  const broken = [];
  let links = 0;
  for (const page of pages)
    for (const [, raw] of text[page].matchAll(/<(?:a|img|link|script)\s[^>]*?(?:href|src)="([^"]+)"/g)) {
      if (/^(https?|mailto|data):/.test(raw)) continue;
      const { pathname, hash } = new URL(decode(raw), `http://docs/docs/${page}`);
      const place = decodeURIComponent(pathname);
      links++;
      if (!place.startsWith('/docs/')) {
        // the daemon's own pages and documents
        const known = place === '/' || fs.existsSync(path.join(web, place)) || (place.startsWith('/v1/') && fs.existsSync(path.join(root, 'protocol', place.slice(4))));
        if (!known) broken.push(`${page}: ${raw}`);
        continue;
      }
      const target = place.slice('/docs/'.length).replace(/(^|\/)$/, '$1index.html');
      if (!fs.existsSync(path.join(built, target))) broken.push(`${page}: ${raw}`);
      else if (hash && ids[target] && !ids[target].has(decodeURIComponent(hash.slice(1)))) broken.push(`${page}: ${raw} (no such heading)`);
    }
  assert.ok(links > 1000, `${links} links`);
  assert.deepEqual(broken, []);
});

test('pages contain no inline scripts or styles', { skip }, () => {
  for (const page of pages) assert.doesNotMatch(text[page], /<style|\sstyle="|<script(?![^>]*\ssrc=)|\son\w+="/, page);
});

test('links in the texts of the tree lead to existing files and headings', () => {
  const slug = (words) => words.replace(/`/g, '').toLowerCase().replace(/[^\p{L}\p{N}\s_-]/gu, '').trim().replace(/\s/g, '-');
  const prose = (file) => fs.readFileSync(file, 'utf8').replace(/^\s*```[^]*?^\s*```/gm, '').replace(/^ {4}.*$/gm, '');
  const files = ['README.md', 'CONTRIBUTING.md', 'SECURITY.md', 'CHANGELOG.md', ...Object.values(included).map(({ from }) => from),
    ...fs.readdirSync(path.join(root, 'web/docs'), { recursive: true, encoding: 'utf8' }).filter((file) => file.endsWith('.md')).map((file) => `web/docs/${file}`)];
  const broken = [];
  for (const file of new Set(files))
    for (const [, target] of prose(path.join(root, file)).replace(/`[^`]*`/g, '').matchAll(/\]\(([^()\s]+)\)/g)) {
      if (/^(https?:|mailto:|\/)/.test(target)) continue;
      const [name, anchor] = target.split('#');
      const place = name ? path.join(root, path.dirname(file), name) : path.join(root, file);
      if (!fs.existsSync(place)) broken.push(`${file}: ${target}`);
      else if (anchor && place.endsWith('.md') && ![...prose(place).matchAll(/^#+ (.*)$/gm)].some(([, words]) => slug(words) === anchor)) broken.push(`${file}: ${target} (no such heading)`);
    }
  assert.deepEqual(broken, []);
});

test('the README is short', () => assert.ok(fs.statSync(path.join(root, 'README.md')).size <= 6000));

// Places where a text states the size of a built file: the words before the figure, and the files of that size.
const models = process.env.FACCIA_MODELS ?? path.join(root, 'build/models');
const plain = (file) => fs.statSync(file).size;
const packed = (file) => (fs.existsSync(`${file}.gz`) ? plain(`${file}.gz`) : gzipSync(fs.readFileSync(file), { level: 9 }).length);
const heads = (ending) => fs.readdirSync(path.join(models, 'heads')).filter((file) => file.endsWith(ending)).map((file) => path.join(models, 'heads', file));
const least = (of, ending) => Math.min(...heads(ending).map(of));
const most = (of, ending) => Math.max(...heads(ending).map(of));
const STATED = [
  ['web/docs/start/pages.md', /`portrait\.js` \(([\d.]+ kB)/, () => packed(path.join(web, 'portrait.js'))],
  ['web/docs/start/pages.md', /its WebAssembly \(([\d.]+ kB)/, () => packed(path.join(web, 'tfjs-backend-wasm-simd.wasm'))],
  ['web/docs/start/pages.md', /three networks \(([\d.]+ MB)/, () => ['blazeface', 'facemesh', 'iris'].reduce((sum, net) => sum + plain(path.join(web, `${net}.bin`)), 0)],
  ['web/docs/start/pages.md', /`face-points\.json` \(([\d.]+ kB)/, () => plain(path.join(web, 'face-points.json'))],
  ['web/docs/start/pages.md', /`portrait-poses\.js`, ([\d.]+ kB)/, () => plain(path.join(web, 'portrait-poses.js'))],
  ['web/docs/start/pages.md', /`portrait-poses\.js`, [\d.]+ kB, ([\d.]+ kB)/, () => packed(path.join(web, 'portrait-poses.js'))],
  ['web/docs/element/avatars.md', /`talking-head-draco\.js` \(([\d.]+ kB)/, () => packed(path.join(web, 'talking-head-draco.js'))],
  ['web/docs/element/avatars.md', /`talking-head-basis\.js` \(([\d.]+ kB)/, () => packed(path.join(web, 'talking-head-basis.js'))],
  ['web/docs/element/avatars.md', /`talking-head-avatar\.js`, ([\d.]+ kB)/, () => packed(path.join(web, 'talking-head-avatar.js'))],
  ['web/docs/element/pictures.md', /instead of the head's file: ([\d.]+ kB)/, () => packed(path.join(models, 'pictures/mara.json'))],
  ['web/docs/element/pictures.md', /\(her head: ([\d.]+ MB)/, () => packed(path.join(models, 'heads/mara.json'))],
  ['web/docs/research/index.md', /head model with textures \| ([\d.]+) to/, () => least(packed, '.json'), 'MB'],
  ['web/docs/research/index.md', /head model with textures \| [\d.]+ to ([\d.]+ MB)/, () => most(packed, '.json')],
  ['models/README.md', /on two processors \| ([\d.]+) to/, () => least(packed, '.json'), 'MB'],
  ['models/README.md', /on two processors \| [\d.]+ to ([\d.]+ MB)/, () => most(packed, '.json')],
  ['models/README.md', /faccia's exports: ([\d.]+) to/, () => least(plain, '.glb'), 'MB'],
  ['models/README.md', /faccia's exports: [\d.]+ to ([\d.]+ MB)/, () => most(plain, '.glb')],
  ['models/README.md', /MB\) and ([\d.]+ kB) of script/, () => packed(path.join(web, 'talking-head-avatar.js'))],
  ['models/README.md', /\| ([\d.]+ kB) \(Mara\)/, () => packed(path.join(models, 'pictures/mara.json'))],
  ['protocol/avatars.md', /NAME\.glb`, ([\d.]+) to/, () => least(plain, '.glb'), 'MB'],
  ['protocol/avatars.md', /NAME\.glb`, [\d.]+ to ([\d.]+ MB)/, () => most(plain, '.glb')],
];

test('sizes stated in the texts match the build', { skip: skip || (!fs.existsSync(path.join(models, 'heads')) && 'no heads are built') }, () => {
  const wrong = [];
  for (const [file, words, size, unit] of STATED) {
    const [, said] = words.exec(fs.readFileSync(path.join(root, file), 'utf8').replace(/\s+/g, ' ')) ?? assert.fail(`${file}: ${words}`);
    const is = size() / (unit === 'MB' || said.endsWith('MB') ? 1e6 : 1e3);
    if (Math.abs(parseFloat(said) / is - 1) > 0.03) wrong.push(`${file}: ${said}, but is ${is.toFixed(2)}`);
  }
  assert.deepEqual(wrong, []);
});
