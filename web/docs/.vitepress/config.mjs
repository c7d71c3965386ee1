// SPDX-License-Identifier: MIT
// The documentation site: build.mjs prepares its sources in a folder of the build and runs VitePress with this configuration.
import { createHash } from 'node:crypto';
import { writeFileSync } from 'node:fs';
import path from 'node:path';
import { defineConfig } from 'vitepress';
import { bundled, sidebar, slug } from '../pages.mjs';

const { FACCIA_DOCS_SOURCE: srcDir, FACCIA_DOCS_OUT: outDir } = process.env;
const base = '/docs/';
const sha = (text) => createHash('sha256').update(text).digest('hex').slice(0, 10);

// The daemon's content security policy allows no style attributes: each colour of code becomes a class of code.css.
const colours = new Map();
const colourClasses = {
  name: 'colour-classes',
  pre: (node) => toClass(node),
  span: (node) => toClass(node),
};
function toClass(node) {
  const { style } = node.properties;
  if (!style) return;
  const name = `c${sha(style)}`;
  colours.set(name, style);
  delete node.properties.style;
  node.properties.class = [node.properties.class, name].flat().filter(Boolean).join(' ');
}

// npm packages bundled into the scripts, for the bill of materials.
const found = new Set();
const contents = {
  name: 'contents',
  generateBundle(_, bundle) {
    if (this.environment?.name === 'ssr' || Object.values(bundle).some(({ fileName }) => fileName === 'app.js')) return; // what draws the pages here
    for (const { modules } of Object.values(bundle))
      for (const [id, { renderedLength }] of Object.entries(modules ?? {})) {
        const name = renderedLength && id.match(/.*\/node_modules\/((?:@[^/]+\/)?[^/]+)\//)?.[1];
        if (name) found.add(name);
      }
  },
};

export default defineConfig({
  base, srcDir, outDir,
  cacheDir: `${srcDir}.cache`,
  title: 'faccia',
  description: 'A face that speaks: the documentation.',
  lang: 'en',
  lastUpdated: false,
  buildConcurrency: 1, // index pages in a fixed order, so that the search index is reproducible
  metaChunk: true,
  contentProps: { class: 'content' }, // without it VitePress writes a style attribute
  appearance: { disableTransition: false }, // it would write a style element
  head: [
    ['link', { rel: 'icon', href: `${base}icon.svg` }],
    ['link', { rel: 'stylesheet', href: `${base}code.css` }],
  ],
  vue: {
    template: { compilerOptions: { isCustomElement: (tag) => tag === 'talking-head' } },
    // by the path from the folder of the build it would be another in each
    features: { componentIdGenerator: (file, content) => sha(path.basename(file) + content) },
  },
  vite: { build: { assetsInlineLimit: 0, chunkSizeWarningLimit: 4000 }, logLevel: 'warn', plugins: [contents] },
  markdown: {
    codeTransformers: [colourClasses],
    // loaded first, because the set of loaded languages affects how others are coloured
    languages: ['c', 'css', 'html', 'ini', 'js', 'json', 'jsonc', 'jsx', 'php', 'python', 'sh', 'svelte', 'ts', 'vue', 'xml', 'yaml'],
    anchor: { slugify: slug },
  },
  themeConfig: {
    sidebar,
    nav: [
      { text: 'The face', link: '/../', target: '_self' },
      { text: 'Examples', link: '/../examples.html', target: '_self' },
    ],
    search: { provider: 'local' },
    outline: [2, 3],
    footer: { message: 'server and models: GPL-3.0-or-later; protocol and web: MIT' },
  },
  // Nor does it allow scripts in a page: each becomes a file. Styles that are left are set by script when the page is there.
  transformHtml(code) {
    return code.replace(/ style="[^"]*"/g, '').replace(/<script([^>]*)>([^<]+)<\/script>/g, (_, attributes, script) => {
      const name = `inline-${sha(script)}.js`;
      writeFileSync(path.join(outDir, name), script);
      return `<script${attributes} src="${base}${name}"></script>`;
    });
  },
  buildEnd() {
    const names = [...found].sort().join(' ');
    if (names !== [...bundled].sort().join(' ')) throw new Error(`the scripts hold ${names}: web/docs/pages.mjs says otherwise (bundled)`);
    const rules = [...colours].sort(([a], [b]) => (a < b ? -1 : 1)).map(([name, style]) => `.${name}{${style}}`);
    writeFileSync(path.join(outDir, 'code.css'), `${rules.join('\n')}\n`);
  },
});
