// SPDX-License-Identifier: MIT
// Builds the documentation site, without a network: node build.mjs FOLDER HELP MANIFEST [DEPFILE]. HELP is what help.mjs wrote,
// MANIFEST the element's custom-elements.json. The site is made for the address /docs/ of the daemon.
import fs from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';
import { build } from 'vitepress';
import { asyncapi, commandLine, elementApi, openapi, settings } from './reference.mjs';
import { generated, included, slug } from './pages.mjs';

const here = path.dirname(fileURLToPath(import.meta.url)), root = path.join(here, '../..');
const [out, helpFile, manifestFile, depfile] = process.argv.slice(2);
if (!manifestFile) {
  console.error('usage: node build.mjs FOLDER HELP MANIFEST [DEPFILE]');
  process.exit(2);
}
const outDir = path.resolve(out), source = `${outDir}.source`;
const inputs = new Set(['build.mjs', 'pages.mjs', 'reference.mjs', '.vitepress/config.mjs', '.vitepress/theme/index.mjs', '.vitepress/theme/LiveFace.vue', '.vitepress/theme/style.css']
  .map((file) => path.join(here, file)));
const read = (file) => {
  inputs.add(path.join(root, file));
  return fs.readFileSync(path.join(root, file), 'utf8');
};

/** Cuts a text at its headings: [{ level, title, lines }]; what stands before the first has the title null. */
function cut(text) {
  const sections = [{ level: 1, title: null, lines: [] }];
  let fenced = false;
  for (const line of text.split('\n')) {
    if (/^\s*```/.test(line)) fenced = !fenced;
    const heading = !fenced && line.match(/^(#{2,3}) (.*)$/);
    if (heading) sections.push({ level: heading[1].length, title: heading[2], lines: [] });
    else sections.at(-1).lines.push(line);
  }
  return sections;
}

/** The text of a page of a divided text: its sections under one title, their headings as high as they can be. */
function compose({ from, sections, title }) {
  const all = cut(read(from));
  const wanted = sections.map((name) => {
    const section = all.find((one) => one.title === name);
    if (!section) throw new Error(`${from} has no section "${name}"`);
    return section;
  });
  const lift = Math.min(...wanted.filter(({ title: name }) => name && name !== title).map(({ level }) => level), 3) - 2;
  const body = wanted.map(({ level, title: name, lines }) => {
    const text = lines.filter((line) => !/^# /.test(line)).join('\n').replace(/^#### /gm, `${'#'.repeat(4 - lift)} `);
    return name === null || name === title ? text : `${'#'.repeat(level - lift)} ${name}\n${text}`;
  });
  return `# ${title}\n\n${body.join('\n')}`;
}

/** Maps texts and headings to their place on the site: "FILE" and "FILE#ANCHOR" to "/page" and "/page#anchor". */
const places = new Map();
for (const [page, { from, sections }] of Object.entries(included)) {
  if (!sections) {
    places.set(from, `/${page}`);
    continue;
  }
  for (const { title, lines } of cut(read(from)).filter((one) => sections.includes(one.title))) {
    places.set(title ? `${from}#${slug(title)}` : from, title && title !== included[page].title ? `/${page}#${slug(title)}` : `/${page}`);
    for (const [, name] of lines.join('\n').matchAll(/^#{4} (.*)$/gm)) places.set(`${from}#${slug(name)}`, `/${page}#${slug(name)}`);
  }
}
for (const from of new Set(Object.values(included).filter(({ sections }) => sections).map((one) => one.from))) {
  const shown = Object.values(included).filter((one) => one.from === from).flatMap(({ sections }) => sections);
  const lost = cut(read(from)).map(({ title }) => title).filter((title) => !shown.includes(title));
  if (lost.length) throw new Error(`${from}: on no page: ${lost.join(', ')} (web/docs/pages.mjs)`);
}
const written = fs.readdirSync(here, { recursive: true, encoding: 'utf8' }).filter((file) => file.endsWith('.md') && !file.startsWith('.')).sort();
for (const file of written) places.set(`web/docs/${file}`, `/${file.slice(0, -3)}`);
const pictures = new Set();
/** Code blocks tagged for tests, and the language that highlights them. */
const shownAs = { csp: 'txt', http: 'txt', text: 'txt', stream: 'json' };

/** Turns a text of the repository into one of the site: its links and pictures lead to where these are there. */
function moved(file, text) {
  const own = file.startsWith('web/docs/');
  const link = (whole, bang, words, target) => {
    if (/^(https?|mailto):|^\//.test(target)) return whole;
    const [name, anchor = ''] = target.split('#');
    const place = name ? path.posix.normalize(path.posix.join(path.posix.dirname(file), name)) : file;
    if (!fs.existsSync(path.join(root, place))) throw new Error(`${file}: ${target} leads nowhere`);
    if (bang) {
      pictures.add(place);
      return `![${words}](/pictures/${path.posix.basename(place)})`;
    }
    const page = places.get(place);
    const at = places.get(anchor ? `${place}#${anchor}` : place) ?? (page && `${page}${anchor && `#${anchor}`}`);
    if (at) return `[${words}](${at.replace(/(^|\/)index(?=#|$)/, '$1')})`;
    if (/^web\/pages\/.*\.html$/.test(place)) return `<a href="/${path.posix.basename(place).replace(/^index\.html$/, '')}${anchor && `#${anchor}`}" target="_self">${words.replace(/`([^`]*)`/g, '<code>$1</code>')}</a>`;
    return words.includes('`') ? words : `${words} (\`${place}\`)`;
  };
  let fenced = false;
  return text
    .replace(/^(<!--[^]*?-->\s*)+/, '')
    .replace(/(!?)\[((?:[^\]`]|`[^`]*`)*)\]\(([^()\s]+)\)/g, (whole, bang, words, target, at, all) =>
      isCode(all, at) ? whole : link(whole, bang, words, target))
    .replace(/^(\s*```)(\w+).*$/gm, (_, fence, name) => `${fence}${shownAs[name] ?? name}`)
    .split('\n')
    .map((line) => {
      if (/^\s*```/.test(line)) fenced = !fenced;
      if (own || fenced || /^ {4}/.test(line)) return line;
      // a text of the repository contains no HTML: show what looks like it
      return line
        .split(/(`[^`]*`|<a href="[^"]*" target="_self">.*?<\/a>)/)
        .map((part, i) => (i % 2 ? part : part.replaceAll('<', '&lt;').replaceAll('{{', '&#123;&#123;')))
        .join('');
    })
    .join('\n');
}

/** Whether a place in a text is in a block of code. */
function isCode(text, at) {
  const before = text.slice(0, at);
  return before.split(/^\s*```/m).length % 2 === 0 || /^ {4}/.test(before.slice(before.lastIndexOf('\n') + 1));
}

fs.rmSync(source, { recursive: true, force: true });
fs.rmSync(outDir, { recursive: true, force: true });
fs.mkdirSync(source, { recursive: true });
fs.symlinkSync(path.join(root, 'web/node_modules'), path.join(source, 'node_modules')); // the pages become scripts that import Vue
const put = (page, text) => {
  const file = path.join(source, `${page}.md`);
  if (fs.existsSync(file)) throw new Error(`${page}: two pages of that name`);
  fs.mkdirSync(path.dirname(file), { recursive: true });
  fs.writeFileSync(file, text);
};
for (const file of written) put(file.slice(0, -3), moved(`web/docs/${file}`, read(`web/docs/${file}`)));
for (const [page, one] of Object.entries(included)) put(page, moved(one.from, one.sections ? compose(one) : read(one.from)));
const help = JSON.parse(fs.readFileSync(helpFile, 'utf8'));
const schema = (name) => JSON.parse(read(`protocol/schema/${name}.json`));
const references = {
  'element/api': () => elementApi(JSON.parse(fs.readFileSync(manifestFile, 'utf8'))),
  'protocol/openapi': () => openapi(JSON.parse(read('protocol/openapi.json')), schema),
  'protocol/asyncapi': () => asyncapi(JSON.parse(read('protocol/asyncapi.json')), schema),
  'protocol/cli': () => commandLine(help),
  'operating/settings': () => settings(help),
};
for (const page of generated) put(page, references[page]());
fs.mkdirSync(path.join(source, 'public/pictures'), { recursive: true });
for (const picture of pictures) {
  inputs.add(path.join(root, picture));
  fs.copyFileSync(path.join(root, picture), path.join(source, 'public/pictures', path.basename(picture)));
}
fs.copyFileSync(path.join(root, 'web/pages/shared/icon.svg'), path.join(source, 'public/icon.svg'));

Object.assign(process.env, { FACCIA_DOCS_SOURCE: source, FACCIA_DOCS_OUT: outDir, NODE_ENV: 'production' });
await build(here);
fs.rmSync(source, { recursive: true, force: true });
fs.rmSync(`${source}.cache`, { recursive: true, force: true });
for (const file of ['404.html', 'hashmap.json']) fs.rmSync(path.join(outDir, file), { force: true }); // the daemon asks for neither
// The daemon takes FILE.gz as it lies there: it starts sooner than if it had to compress.
for (const file of fs.readdirSync(outDir, { recursive: true, encoding: 'utf8' }).filter((name) => /\.(html|js|css|json|svg)$/.test(name)))
  fs.writeFileSync(path.join(outDir, `${file}.gz`), gzipSync(fs.readFileSync(path.join(outDir, file)), { level: 9 }));
if (depfile) {
  const escape = (file) => file.replaceAll(' ', '\\ ');
  fs.writeFileSync(depfile, `${escape(out)}: ${[...inputs].sort().map(escape).join(' ')}\n`);
}
