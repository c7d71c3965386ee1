// SPDX-License-Identifier: MIT
import { copy } from './copy.js';
import { layOut, markupOf, mixAt, spread } from './emotion-disc.js';
import { words } from './emotion-words.js';
import { Frame } from './frame.js';
import { FIRST, fill, primary, spokenLanguage } from './languages.js';

const R = 100; // of the disc, in units of the picture
const DOTS_APART = 0.13;
const EASE = 0.25; // s, while the point is dragged
const FAPS_EVERY_MS = 150;
const STRONG = 400; // FAP units that fill half a bar
const STEP = 0.1;
const SMALL_STEP = 0.02;

const $ = (id) => document.getElementById(id);
const [text, lang, disc, thumb] = ['text', 'lang', 'disc', 'thumb'].map($);
const [choice, slider, markup] = ['affect', 'intensity', 'markup'].map($);
const svg = (name, attributes = {}) => {
  const element = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  return element;
};

const frame = new Frame(words);
const { head } = frame;
const say = (name, values) => frame.say(name, values);
let ready = false; // the head, to be told
let offered = FIRST;
let placed = []; // the affects on the disc
let faps = []; // what they are
const now = { x: 0, y: 0, affect: null }; // the point; affect: that one alone, not what the direction says

const called = (name) => words[frame.lang].affects[name] ?? name;
const strength = () => Math.min(1, Math.hypot(now.x, now.y));
const percent = (value) => `${Math.round(100 * value)} %`;

function mix() {
  if (!now.affect) return mixAt(now, placed);
  const intensity = Math.round(100 * strength()) / 100;
  return intensity ? [{ name: now.affect, intensity }] : [];
}

// The disc

function draw() {
  const basics = placed.filter((a) => a.basic);
  $('spokes').replaceChildren(...basics.flatMap(({ name, angle }) => {
    const at = (radius) => ({ x: radius * R * Math.cos(angle), y: -radius * R * Math.sin(angle) });
    const label = svg('text', at(1.24));
    label.textContent = called(name);
    const { x, y } = at(1);
    return [svg('line', { class: 'spoke', x2: x, y2: y }), label];
  }));
  $('affects').replaceChildren(...placed.map(({ name, basic, x, y }) => {
    const group = svg('g', { class: basic ? 'basic' : '', 'data-name': name });
    const title = svg('title');
    title.textContent = called(name);
    group.append(svg('circle', { cx: x * R, cy: -y * R, r: basic ? 5 : 3.5 }), title);
    if (!basic) {
      const label = svg('text', { x: x * R, y: -y * R - 5 });
      label.textContent = called(name);
      group.append(label);
    }
    return group;
  }));
  const chosen = choice.value;
  const options = placed.map(({ name }) => new Option(called(name), name));
  options.sort((a, b) => a.text.localeCompare(b.text, frame.lang));
  choice.replaceChildren(new Option(say('mixed'), ''), ...options);
  choice.value = chosen;
}

/** Shows where the point is and what that means, and tells the head. */
function update({ ease = EASE, tell = true } = {}) {
  const parts = mix();
  const spoken = parts.map(({ name, intensity }) => `${called(name)} ${percent(intensity)}`).join(', ') || say('neutral');
  thumb.setAttribute('transform', `translate(${now.x * R} ${-now.y * R})`);
  thumb.setAttribute('aria-valuenow', Math.round(100 * strength()));
  thumb.setAttribute('aria-valuetext', spoken);
  thumb.setAttribute('aria-roledescription', say('slider'));
  $('mix').textContent = spoken;
  choice.value = now.affect ?? '';
  slider.value = Math.round(100 * strength());
  $('intensity-value').value = percent(strength());
  for (const { classList, dataset } of $('affects').children) classList.toggle('chosen', parts.some((p) => p.name === dataset.name));
  write();
  if (tell && ready) head.express(parts, { ease });
}

function write() {
  const kind = document.querySelector('input[name="kind"]:checked').value;
  markup.value = markupOf(kind, mix(), text.value, lang.value);
}

function move(x, y, affect = null) {
  const far = Math.max(1, Math.hypot(x, y));
  Object.assign(now, { x: x / far, y: y / far, affect });
  update();
}

/** Moves the point along its direction, or that of the affect. */
function strengthen(intensity, affect = now.affect) {
  const own = placed.find(({ name }) => name === affect);
  const angle = own ? own.angle : strength() ? Math.atan2(now.y, now.x) : Math.PI / 2;
  const radius = Math.min(1, Math.max(0, intensity));
  move(radius * Math.cos(angle), radius * Math.sin(angle), affect);
}

function pointAt(event) {
  const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(disc.getScreenCTM().inverse());
  move(at.x / R, -at.y / R);
}

disc.addEventListener('pointerdown', (event) => {
  const dot = event.target.closest('[data-name]');
  event.preventDefault();
  thumb.focus({ preventScroll: true });
  if (dot) {
    strengthen(strength() || 0.7, dot.dataset.name);
    return;
  }
  disc.setPointerCapture(event.pointerId);
  pointAt(event);
});
disc.addEventListener('pointermove', (event) => {
  if (disc.hasPointerCapture(event.pointerId)) pointAt(event);
});
thumb.addEventListener('keydown', (event) => {
  const step = event.shiftKey ? SMALL_STEP : STEP;
  const ways = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, step], ArrowDown: [0, -step] };
  const way = ways[event.key];
  if (way) move(now.x + way[0], now.y + way[1]);
  else if (event.key === 'Home') move(0, 0);
  else if (event.key === 'End') strengthen(1);
  else if (event.key === 'PageUp') strengthen(strength() + STEP);
  else if (event.key === 'PageDown') strengthen(strength() - STEP);
  else return;
  event.preventDefault();
});
choice.addEventListener('change', () => {
  if (choice.value) strengthen(strength() || 0.7, choice.value);
  else move(now.x, now.y);
});
slider.addEventListener('input', () => strengthen(slider.value / 100));
$('neutral').addEventListener('click', () => move(0, 0));

// The markup and the values

for (const radio of document.querySelectorAll('input[name="kind"]')) radio.addEventListener('change', write);
text.addEventListener('input', write);
$('copy').addEventListener('click', async () => frame.tell((await copy(markup.value, markup)) ? 'copied' : 'selected'));

function showFaps() {
  if (!ready || !$('faps-box').open) return;
  const values = head.faps;
  const rows = faps.filter(({ number }) => Math.round(values[number] ?? 0));
  $('faps').tBodies[0].replaceChildren(...rows.map(({ number, name }) => {
    const row = document.createElement('tr');
    const value = Math.round(values[number]);
    for (const cell of [number, name, value]) row.insertCell().textContent = cell;
    const bar = document.createElement('div');
    const fill = document.createElement('i');
    const width = Math.min(50, (50 * Math.abs(value)) / (Math.abs(value) + STRONG));
    bar.className = 'bar';
    bar.setAttribute('aria-hidden', 'true');
    fill.style.insetInlineStart = `${value < 0 ? 50 - width : 50}%`;
    fill.style.inlineSize = `${width}%`;
    bar.append(fill);
    row.insertCell().append(bar);
    return row;
  }));
}

// The page

/** Has the text follow the language that is spoken. */
function showLanguage() {
  text.lang = lang.value;
  const samples = Object.values(words).map(({ sample }) => sample);
  if (samples.includes(text.value) || !text.value.trim()) text.value = (words[primary(lang.value)] ?? words.en).sample;
  write();
}

function offer(tags, chosen) {
  offered = tags;
  fill(lang, tags, { page: frame.lang, others: say('otherLanguages'), chosen });
  showLanguage();
}

function speak() {
  if (!ready) return;
  frame.problem.clear();
  head.stop();
  head.speak(text.value, { lang: lang.value, markup: 'plain' });
}

head.addEventListener('hello', ({ detail }) => {
  const tags = detail.languages.map(({ tag }) => tag);
  offer(tags, lang.dataset.chosen ? lang.value : spokenLanguage(navigator.languages, tags, detail.lang));
});
lang.addEventListener('change', () => {
  lang.dataset.chosen = 'yes';
  showLanguage();
});
$('form').addEventListener('submit', (event) => {
  event.preventDefault();
  speak();
});
$('stop').addEventListener('click', () => ready && head.stop());
document.addEventListener('keydown', (event) => {
  if (event.key === 'Escape' && ready) head.stop();
  if (event.key === 'Enter' && (event.ctrlKey || event.metaKey)) speak();
});
frame.onTranslate(() => {
  offer(offered, lang.value);
  draw();
  update({ tell: false });
});

// Who asks for less motion sees the emotions, which are what this page is for, without the signs of life.
if (matchMedia('(prefers-reduced-motion: reduce)').matches) {
  head.setAttribute('still', 'off');
  head.setAttribute('life', '0');
}
offer(FIRST, spokenLanguage(navigator.languages, FIRST));
await frame.open();
ready = true;
setInterval(showFaps, FAPS_EVERY_MS);
const [expressions, known] = await Promise.all([frame.load('v1/expressions'), frame.load('faps.json')]);
if (expressions && known) {
  ({ faps } = known);
  placed = spread(layOut(expressions.expressions.filter(({ kind }) => kind === 'affect')), DOTS_APART);
  draw();
  update();
}
