// SPDX-License-Identifier: MIT
// The page of examples: one story at a time, with its fields, its source and its events. The address names the story.
import { tokenOfTab } from '../shared/access.js';
import { copy } from '../shared/copy.js';
import { fillTexts, openMenu, showConnection, showPage } from '../shared/header.js';
import { shared } from '../texts/en.js';
import { controls, setValue, valueOf } from './controls.js';
import { EventLog } from './log.js';
import { KINDS, source } from './source.js';
import { stories } from './stories.js';
import './talking-head.js';

const $ = (id) => document.getElementById(id);
const manifest = await (await fetch('custom-elements.json')).json();
const [about] = manifest.modules[0].declarations;
const settable = [...about.attributes, ...about.cssProperties];
const server = new URL('.', location.href).href.replace(/\/$/, '');
const token = tokenOfTab();
const sheet = new CSSStyleSheet(); // the page's policy forbids inline styles
const log = new EventLog($('log'));
const say = (name) => shared[name];
fillTexts(document.querySelector('header'), say);
openMenu();
const ALWAYS = ['error', 'warning'];
let story, head, fields, watcher;

/** Returns the current attributes of the element in the order of the manifest, without the page's own token. */
function given() {
  const told = [['src', `${server.replace(/^http/, 'ws')}/v1/stream`]];
  for (const { name } of about.attributes)
    if (valueOf(head, name) !== null && !(name === 'token' && head.token === token)) told.push([name, valueOf(head, name)]);
  const style = about.cssProperties.map(({ name }) => [name, valueOf(head, name)]).filter(([, value]) => value !== null);
  if (style.length) told.push(['style', style.map(([name, value]) => `${name}: ${value}`).join('; ')]);
  return Object.fromEntries(told);
}

const kind = () => document.querySelector('#kinds input:checked').value;

function write() {
  $('source').firstChild.textContent = source(story, given(), kind(), server);
  $('source-field').hidden = true;
  $('news').textContent = '';
}

const made = (tag, attributes, text = '') => {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.textContent = text;
  return element;
};

const suggestions = { poster: ['off'] };

/** Reads the server's offer from its `hello`. */
function learn({ detail: { languages = [], models = [], expressions = [] } }) {
  suggestions.lang = languages.map(({ tag }) => tag);
  suggestions.model = models.map(({ name }) => name);
  suggestions.expression = expressions.map((name) => `${name} 0.6`);
  if (!$('fields').contains(document.activeElement)) makeFields();
}

function makeFields() {
  const wanted = (story.controls ?? []).map((name) => settable.find((one) => one.name === name));
  fields = controls(head, wanted, suggestions);
  $('fields').replaceChildren(...fields.nodes);
  $('controls').hidden = !wanted.length;
}

async function act(run) {
  try {
    await run(head);
  } catch (error) {
    log.add('failed', { message: error.message });
  }
}

function open() {
  const asked = location.hash.slice(1);
  const next = stories.find(({ id }) => id === asked) ?? (story && asked === 'story-title' ? story : stories[0]);
  if (next !== story) begin(next);
}

function begin(next) {
  story = next;
  watcher?.disconnect();
  log.clear();
  document.title = `${story.title} · Examples · faccia`;
  $('story-title').textContent = story.title;
  $('about').textContent = story.about;
  for (const link of $('stories').querySelectorAll('a')) link.toggleAttribute('aria-current', link.hash === `#${story.id}`);
  sheet.replaceSync(story.css ?? '');
  head = made('talking-head', { id: 'head', ...(token ? { token } : {}), ...story.attributes }, story.content);
  const told = story.shows.filter((name) => name.startsWith('@')).map((name) => name.slice(1));
  const mine = head;
  for (const { name } of about.events)
    head.addEventListener(name, ({ detail }) => {
      if (mine === head && ($('all').checked || told.includes(name) || ALWAYS.includes(name))) log.add(name, detail);
    });
  head.addEventListener('connection', ({ detail }) => showConnection(detail.state, say));
  head.addEventListener('hello', learn, { once: true });
  const beside = (story.beside ?? []).map(([tag, attributes, text]) => made(tag, { ...attributes, ...(token && tag === 'talking-head' ? { token } : {}) }, text));
  $('stage').replaceChildren(head, ...beside);
  $('actions').replaceChildren(...Object.entries(story.actions ?? {}).map(([name, [label, run]]) => {
    const button = made('button', { type: 'button', 'data-act': name }, label);
    button.addEventListener('click', () => act(run));
    return button;
  }));
  $('actions').hidden = !$('actions').childElementCount;
  makeFields();
  // a field, a button of the example, or one of the element's own buttons may change it
  watcher = new MutationObserver(() => {
    fields.refresh();
    write();
  });
  watcher.observe(head, { attributes: true });
  write();
}

for (const group of new Set(stories.map((one) => one.group))) {
  const list = made('ul', { 'aria-label': group });
  for (const { id, title, group: of } of stories) if (of === group) list.appendChild(made('li', {})).append(made('a', { href: `#${id}` }, title));
  $('stories').append(made('h2', {}, group), list);
}
for (const [value, name] of Object.entries(KINDS)) {
  const choice = made('label', { class: 'choice' });
  choice.append(made('input', { type: 'radio', name: 'kind', value, ...(value === 'html' ? { checked: '' } : {}) }), name);
  choice.addEventListener('change', write);
  $('kinds').append(choice);
}
document.adoptedStyleSheets.push(sheet);
$('skip').addEventListener('click', (event) => {
  event.preventDefault(); // the address is the story's
  $('story-title').focus();
});
$('copy').addEventListener('click', async () => {
  const copied = await copy($('source').textContent, $('source-field'));
  $('news').textContent = copied ? 'Copied' : 'Copy it from the field below';
});
$('reset').addEventListener('click', () => {
  for (const { name } of settable) if (name !== 'token' || !token) setValue(head, name, story.attributes?.[name] ?? null);
});
$('controls').addEventListener('submit', (event) => event.preventDefault());
$('clear').addEventListener('click', () => log.clear());
addEventListener('hashchange', () => {
  open();
  if (location.hash === `#${story.id}`) $('story-title').focus();
});
open();
showPage();
