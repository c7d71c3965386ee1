// SPDX-License-Identifier: MIT
// The built documentation: every link inside leads somewhere, nothing in a page is inline, and every text that belongs to it is there.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { generated, included, sidebar } from '../../web/docs/pages.mjs';

const root = path.resolve(import.meta.dirname, '../..');
const built = path.join(process.env.FACCIA_WEB ?? path.join(root, 'build/web'), 'docs');
const skip = !fs.existsSync(built) && 'the documentation is not built: sh server/run.sh --build-only';
const pages = skip ? [] : fs.readdirSync(built, { recursive: true, encoding: 'utf8' }).filter((file) => file.endsWith('.html')).sort();
const text = Object.fromEntries(pages.map((page) => [page, fs.readFileSync(path.join(built, page), 'utf8')]));
const ids = Object.fromEntries(pages.map((page) => [page, new Set([...text[page].matchAll(/\sid="([^"]+)"/g)].map(([, id]) => id))]));
const decode = (words) => decodeURIComponent(words.replaceAll('&amp;', '&').replaceAll('&#39;', "'"));

test('there is a page for each text, and the sidebar names each', { skip }, () => {
  const written = fs.readdirSync(path.join(root, 'web/docs'), { recursive: true, encoding: 'utf8' }).filter((file) => file.endsWith('.md')).map((file) => file.slice(0, -3));
  const all = [...written, ...Object.keys(included), ...generated].sort();
  assert.deepEqual(pages.map((page) => page.slice(0, -5)).sort(), all);
  const named = sidebar.flatMap(({ items, link }) => items ?? [{ link }]).map(({ link }) => link.slice(1).replace(/(^|\/)$/, '$1index'));
  assert.deepEqual([...named, 'index'].sort(), all);
});

test('every link inside leads to a page and a heading that are there', { skip }, () => {
  const broken = [];
  let links = 0;
  const web = path.dirname(built);
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

test('nothing in a page is inline', { skip }, () => {
  for (const page of pages) assert.doesNotMatch(text[page], /<style|\sstyle="|<script(?![^>]*\ssrc=)|\son\w+="/, page);
});

test('links of the texts in the tree lead to files and headings that are there', () => {
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
