// SPDX-License-Identifier: GPL-3.0-or-later
// The smallest application of each framework, as its own starter writes it, around the code of web/docs/frameworks. packages: from npm, beside the element's;
// files: by name; commands: what its developer runs; out: the folder that they fill, or serve: the command of its server.
import fs from 'node:fs';
import path from 'node:path';
import { root } from '../../lib/daemon.mjs';

/** The code of a language in a page of web/docs/frameworks. */
function printed(page, language) {
  const text = fs.readFileSync(path.join(root, 'web/docs/frameworks', `${page}.md`), 'utf8');
  return text.match(new RegExp('^```' + language + '\\n([^]*?)^```', 'm'))[1];
}

const HEAD = '<meta charset="utf-8"><title>App</title><link rel="icon" href="data:,">';
const page = (body, head = '') => `<!doctype html>\n<html lang="en"><head>${HEAD}${head}</head><body>${body}</body></html>\n`;
const entry = (script) => page(`<div id="app"></div><script type="module" src="/${script}"></script>`);
const vite = (plugin, name) => `import { ${name} as plugin } from '${plugin}';\nimport { defineConfig } from 'vite';\nexport default defineConfig({ plugins: [plugin()] });\n`;
const types = (more = {}) => JSON.stringify({
  compilerOptions: { target: 'ES2022', module: 'ESNext', moduleResolution: 'Bundler', lib: ['ES2022', 'DOM', 'DOM.Iterable'], strict: true, noEmit: true, skipLibCheck: true, ...more }, include: ['src'],
});

// Angular wants a newer Node than Debian's: it comes from npm, too
const NODE = `node-${process.platform}-${process.arch}`;

export const apps = {
  'Vite and React': {
    packages: ['vite@8', '@vitejs/plugin-react@6', 'react@19', 'react-dom@19', 'typescript@5', '@types/react@19', '@types/react-dom@19'],
    files: {
      'index.html': entry('src/main.tsx'),
      'vite.config.js': vite('@vitejs/plugin-react', 'default'),
      'tsconfig.json': types({ jsx: 'react-jsx' }),
      'src/head.tsx': printed('react', 'tsx'),
      'src/main.tsx': "import { StrictMode } from 'react';\nimport { createRoot } from 'react-dom/client';\nimport Head from './head';\ncreateRoot(document.getElementById('app')!).render(<StrictMode><Head /></StrictMode>);\n",
    },
    commands: ['tsc', 'vite build'], out: 'dist',
  },
  Next: {
    packages: ['next@15', 'react@19', 'react-dom@19', 'typescript@5', '@types/react@19', '@types/node@20'],
    files: {
      'package.json': '{"private":true}', // and no tsconfig: Next writes its own
      'app/layout.tsx': "export const metadata = { title: 'App', icons: 'data:,' };\nexport default function Layout({ children }: { children: React.ReactNode }) {\n  return <html lang=\"it\"><body>{children}</body></html>;\n}\n",
      'app/page.tsx': "import Head from './head';\nexport default function Page() {\n  return <Head />;\n}\n",
      'app/head.tsx': `'use client';\n${printed('react', 'tsx')}`,
    },
    commands: ['next build'], serve: 'next start -p 0',
  },
  'Vite and Vue': {
    packages: ['vite@8', '@vitejs/plugin-vue@6', 'vue@3', 'vue-tsc@3', 'typescript@5'],
    files: {
      'index.html': entry('src/main.ts'),
      'vite.config.js': printed('vue', 'js'),
      'tsconfig.json': types(),
      'src/main.ts': "import { createApp } from 'vue';\nimport App from './App.vue';\ncreateApp(App).mount('#app');\n",
      'src/App.vue': printed('vue', 'vue'),
    },
    commands: ['vue-tsc', 'vite build'], out: 'dist',
  },
  'Vite and Svelte': {
    packages: ['vite@8', '@sveltejs/vite-plugin-svelte@7', 'svelte@5', 'svelte-check@4', 'typescript@5'],
    files: {
      'index.html': entry('src/main.ts'),
      'vite.config.js': vite('@sveltejs/vite-plugin-svelte', 'svelte'),
      'svelte.config.js': "import { vitePreprocess } from '@sveltejs/vite-plugin-svelte';\nexport default { preprocess: vitePreprocess() };\n",
      'tsconfig.json': types({ types: ['svelte'], verbatimModuleSyntax: true }),
      'src/main.ts': "import { mount } from 'svelte';\nimport App from './App.svelte';\nmount(App, { target: document.getElementById('app')! });\n",
      'src/App.svelte': printed('svelte', 'svelte'),
    },
    commands: ['svelte-check --fail-on-warnings', 'vite build'], out: 'dist',
  },
  Astro: {
    packages: ['astro@5', '@astrojs/check@0.9', 'typescript@5'],
    files: {
      'tsconfig.json': '{"extends":"astro/tsconfigs/strict","include":[".astro/types.d.ts","src"]}',
      'src/pages/index.astro': page(printed('astro', 'astro')),
    },
    commands: ['astro check', 'astro build'], out: 'dist',
  },
  Angular: {
    packages: [...['core', 'common', 'compiler', 'platform-browser', 'build', 'compiler-cli', 'cli'].map((name) => `@angular/${name}@22`), 'rxjs@7', 'tslib@2', 'typescript@6', `${NODE}@24`],
    files: {
      'angular.json': `{ "version": 1, "cli": { "analytics": false }, "projects": { "app": { "projectType": "application", "root": "", "sourceRoot": "src", "architect": { "build": {
  "builder": "@angular/build:application",
  "options": { "browser": "src/main.ts", "index": "src/index.html", "tsConfig": "tsconfig.json", "outputPath": "dist", ${printed('angular', 'json')} }
} } } } }`,
      'tsconfig.json': JSON.stringify({ compilerOptions: { target: 'ES2022', module: 'preserve', moduleResolution: 'bundler', strict: true, skipLibCheck: true, types: [] }, angularCompilerOptions: { strictTemplates: true }, files: ['src/main.ts'] }),
      'src/index.html': page('<app-root></app-root>', '<base href="/">'),
      'src/main.ts': "import { bootstrapApplication } from '@angular/platform-browser';\nimport { App } from './app';\nbootstrapApplication(App);\n",
      'src/app.ts': printed('angular', 'ts'),
    },
    node: `${NODE}/bin/node`, commands: ['ng build'], out: 'dist/browser',
  },
  'Plain script': {
    packages: [],
    files: { 'site/index.html': page(printed('index', 'html').replace(/<script.*<\/script>/, '<script src="talking-head/talking-head.classic.js"></script>')) },
    copy: ['node_modules/@faccia/talking-head/dist', 'site/talking-head'], commands: [], out: 'site',
  },
};
