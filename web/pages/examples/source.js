// SPDX-License-Identifier: MIT
// Writes an example as HTML, React, Vue and Svelte source. It needs no page: tests compile all of them.

export const KINDS = { html: 'HTML', react: 'React', vue: 'Vue', svelte: 'Svelte' };

const escape = (text) => text.replaceAll('&', '&amp;').replaceAll('<', '&lt;').replaceAll('"', '&quot;');
const inBraces = (text) => text.replaceAll('{', '&#123;').replaceAll('}', '&#125;');

function attributes(given, kind) {
  return Object.entries(given).map(([name, value]) => {
    if (name === 'style' && kind === 'react')
      return ` style={{ ${[...value.matchAll(/(--[\w-]+): ([^;]+)/g)].map(([, key, set]) => `'${key}': '${set}'`).join(', ')} }}`;
    return value === '' ? ` ${name}` : ` ${name}="${kind === 'svelte' ? inBraces(escape(value)) : escape(value)}"`;
  }).join('');
}

const element = ([name, given, text], kind) => `<${name}${attributes(given, kind)}>${escape(text)}</${name}>`;

/** Indents the source of a button's function. */
const indented = (line, i) => (i ? line.replace(/^ {6}/, '  ') : line);
const code = (act) => act.toString().split('\n').map(indented).join('\n');

const HEARD = {
  html: (name) => `  head.addEventListener('${name}', ({ detail }) => console.log(detail));`,
  react: (name) => ` on${name}={({ detail }) => console.log(detail)}`,
  vue: (name) => ` @${name}="told($event)"`,
  svelte: (name) => ` on${name}={({ detail }) => console.log(detail)}`,
};

/**
 * @param {import('./stories.js').Story} story
 * @param {Record<string, string>} given attributes that the element has now
 * @param {keyof KINDS} kind @param {string} server the address of its scripts @returns {string}
 */
export function source(story, given, kind, server) {
  const { beside = [], actions = {}, css, content = '' } = story;
  const events = story.shows.filter((name) => name.startsWith('@')).map((name) => name.slice(1));
  const acts = Object.entries(actions).map(([name, [label, act]]) => ({ name, label, act }));
  const others = beside.map((one) => element(one, kind));
  const heard = events.map(HEARD[kind]);
  const functions = acts.map(({ name, act }) => `  const ${name} = ${code(act)};`);
  const styles = css ? [`<style>\n${css}\n</style>`] : [];
  const script = `${server}/talking-head.js`;
  const tag = (extra) => `<talking-head${extra}${attributes(given, kind)}${kind === 'html' ? '' : heard.join('')}>${escape(content)}</talking-head>`;
  if (kind === 'html') {
    const pressed = acts.map(({ name }) => `  document.querySelector('#${name}').addEventListener('click', () => ${name}(head));`);
    const lines = [...functions, ...pressed, ...heard];
    return [`<script type="module" src="${script}"></script>`, ...styles, tag(''), ...others,
      ...acts.map(({ name, label }) => `<button id="${name}">${escape(label)}</button>`),
      ...(lines.length ? ['<script type="module">', "  const head = document.querySelector('talking-head');", ...lines, '</script>'] : [])].join('\n');
  }
  if (kind === 'react') {
    const inside = [tag(' ref={face}'), ...others, ...acts.map(({ name, label }) => `<button onClick={() => ${name}(face.current)}>${label}</button>`)];
    return ["import { useRef } from 'react';", `import '${script}'; // or '@faccia/talking-head'`, ...(css ? ['', css.replace(/^/gm, '// CSS: ')] : []), '',
      'export function Example() {', '  const face = useRef(null);', ...functions,
      '  return <>', ...inside.map((line) => `    ${line}`), '  </>;', '}'].join('\n');
  }
  if (kind === 'vue') {
    const told = events.length ? ['  const told = ({ detail }) => console.log(detail);'] : [];
    const inside = [tag(' ref="face"'), ...others, ...acts.map(({ name, label }) => `<button @click="${name}(face)">${label}</button>`)];
    return ['<script setup>', "  import { ref } from 'vue';", `  import '${script}'; // or '@faccia/talking-head'`, '  const face = ref(null);', ...told, ...functions, '</script>',
      '<template>', ...inside.map((line) => `  ${line}`), '</template>', ...styles].join('\n');
  }
  const inside = [tag(' bind:this={face}'), ...others, ...acts.map(({ name, label }) => `<button onclick={() => ${name}(face)}>${label}</button>`)];
  return ['<script>', `  import '${script}'; // or '@faccia/talking-head'`, '  let face = $state(null);', ...functions, '</script>', ...inside,
    ...styles.map((style) => style.replace(/^talking-head(.*?) \{/gm, ':global(talking-head$1) {'))].join('\n');
}
