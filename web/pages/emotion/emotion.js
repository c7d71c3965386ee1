// SPDX-License-Identifier: MIT
import { copy } from '../shared/copy.js';
import { markupOf, MoodDisc } from '../shared/mood-disc.js';
import { emotion as words } from '../texts/index.js';
import { Frame } from '../shared/frame.js';
import { FIRST, fill, primary, spokenLanguage } from '../shared/languages.js';

const EASE = 0.25; // s, while the point is dragged
const FAPS_EVERY_MS = 150;
const STRONG = 400; // FAP units that fill half a bar

const $ = (id) => document.getElementById(id);
const [text, lang] = ['text', 'lang'].map($);
const [choice, slider, markup] = ['affect', 'intensity', 'markup'].map($);

const frame = new Frame(words);
const { head } = frame;
const say = (name, values) => frame.say(name, values);
let ready = false; // whether the head accepts messages
let offered = FIRST;
let faps = []; // what they are

const called = (name) => words[frame.lang].affects[name] ?? name;
const percent = (value) => `${Math.round(100 * value)} %`;
const described = (mix) => mix.map(({ name, intensity }) => `${called(name)} ${percent(intensity)}`).join(', ') || say('neutral');
const disc = new MoodDisc($('disc'), { called, described, moved: () => update() });

// The disc

function draw() {
  disc.draw();
  $('thumb').setAttribute('aria-roledescription', say('slider'));
  const chosen = choice.value;
  const options = disc.names.map((name) => new Option(called(name), name));
  options.sort((a, b) => a.text.localeCompare(b.text, frame.lang));
  choice.replaceChildren(new Option(say('mixed'), ''), ...options);
  choice.value = chosen;
}

/** Shows the mood at the point, and applies it to the head. */
function update({ ease = EASE, tell = true } = {}) {
  disc.update();
  $('mix').textContent = described(disc.mix);
  choice.value = disc.affect ?? '';
  slider.value = Math.round(100 * disc.strength);
  $('intensity-value').value = percent(disc.strength);
  write();
  if (tell && ready) head.express(disc.mix, { ease });
}

function write() {
  const kind = document.querySelector('input[name="kind"]:checked').value;
  markup.value = markupOf(kind, disc.mix, text.value, lang.value);
}

choice.addEventListener('change', () => disc.choose(choice.value || null));
slider.addEventListener('input', () => disc.strengthen(slider.value / 100));
$('neutral').addEventListener('click', () => disc.move(0, 0));

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

/** Replaces the sample text when the language changes. */
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

// With reduced motion the emotions, which are the subject of this page, are shown without idle motion.
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
  disc.affects = expressions.expressions.filter(({ kind }) => kind === 'affect');
  draw();
  update();
}
