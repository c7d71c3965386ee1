// SPDX-License-Identifier: MIT
// The library: search, read, listen.
import { copy } from './copy.js';
import { Frame } from './frame.js';
import { ownName } from './languages.js';
import { openKeys } from './library-keys.js';
import { canKeep, forget, keep, kept, KeptSpeech, startWorker } from './library-offline.js';
import { Search } from './library-search.js';
import { setText } from './library-text.js';
import { words } from './library-words.js';
import { forGood } from './storage.js';
import { voicesOf } from './voice-choice.js';

const $ = (id) => document.getElementById(id);
const USUAL_RATE = 150; // words a minute
const MINUTES = [5, 15, 30, 60];
const LOOKS = 'faccia.reading';

const query = new URLSearchParams(location.search);
const frame = new Frame(words);
const { head, say } = frame;
const passage = $('passage');
const spoken = new KeptSpeech();
const state = {
  section: null, line: null, reading: false, paused: false, pinned: null, timer: 0, voices: [], titles: new Map(),
  turn: null, going: null,
};

const load = (address) => frame.load(address);
const lines = () => [...passage.querySelectorAll('.line, [data-passage]:not(.verse)')];
const lineOf = (node) => (node.nodeType === 1 ? node : node.parentElement).closest('.line, [data-passage]:not(.verse)');
const range = (element) => {
  const all = document.createRange();
  all.selectNodeContents(element);
  return all;
};

// Works and sections

function link(text, address, ...more) {
  const item = document.createElement('li');
  const anchor = document.createElement('a');
  anchor.href = address;
  anchor.append(text, ...more);
  item.append(anchor);
  return item;
}

async function showWorks() {
  const library = await frame.access.load('v1/library?limit=1000').catch((error) => error);
  if (library instanceof Error) {
    if (library.code === 'not-found') $('news').textContent = say('noLibrary');
    else frame.problem.show({ code: library.code ?? 'unreachable', message: library.message });
    return;
  }
  const about = ({ author, lang, date, recording }) => {
    const small = document.createElement('small');
    small.textContent = [author, date, ownName(lang, frame.lang), recording && say('recording')].filter(Boolean).join(' · ');
    return small;
  };
  for (const { id, title } of library.works) state.titles.set(id, title);
  $('works').replaceChildren(...library.works.map((work) => link(work.title, `#${work.id}:1`, about(work))));
  const chosen = $('lang').value;
  $('lang').replaceChildren(new Option(say('allLanguages'), ''), ...library.languages.map((tag) => new Option(ownName(tag, frame.lang), tag)));
  $('lang').value = chosen;
  const serious = library.problems.filter((problem) => problem.serious !== false).length;
  const news = library.state === 'indexing' ? say('indexing', library) : serious ? say('problems', { n: serious }) : '';
  $('news').textContent = news;
  showKept();
}

async function openSection(work, number) {
  const [about, section] = await Promise.all([
    load(`v1/library/works/${encodeURIComponent(work)}`),
    load(`v1/library/works/${encodeURIComponent(work)}/sections/${number}`),
  ]);
  if (!section || !about) return false;
  stop();
  state.section = section;
  state.titles.set(about.id, about.title);
  passage.lang = section.work.lang;
  passage.replaceChildren(...setText(section, say));
  $('work-title').textContent = [about.author, about.title].filter(Boolean).join(': ');
  $('contents').hidden = about.sections.length < 2;
  $('contents').querySelector('ol').replaceChildren(...about.sections.map(({ id, title, number: n }) => {
    const item = link(title || `${n}`, `#${id}`);
    if (id === section.id) item.firstChild.setAttribute('aria-current', 'page');
    return item;
  }));
  for (const [id, to] of [['previous', section.previous], ['next', section.next]]) {
    $(id).hidden = !to;
    if (to) $(id).href = `#${section.work.id}:${to}`;
  }
  document.title = `${section.title || about.title} · ${about.title} · faccia`;
  fillVoices();
  return true;
}

/** What the address names: nothing, a section, a passage or a line. */
async function go() {
  const hash = location.hash.startsWith('#?') ? '' : location.hash.slice(1); // what WordPress appends is not for us
  const id = decodeURIComponent(hash || (query.get('at') ?? ''));
  const [work, number] = id.split(':');
  if (['q', 'passage'].includes(work)) return;
  const found = Boolean(number);
  $('book').hidden = !found;
  $('works').hidden = found || search.query !== '';
  for (const name of ['results', 'count']) $(name).hidden = found;
  $('more').hidden = found || !$('results').children.length;
  document.body.classList.toggle('open', found);
  if (!found) {
    document.title = `${say('title')} · faccia`;
    return;
  }
  if (state.section?.id !== `${work}:${number}` && !(await openSection(work, number))) return;
  const place = document.getElementById(id);
  for (const old of passage.querySelectorAll('.linked')) old.classList.remove('linked');
  if (place && id !== state.section.id) {
    place.classList.add('linked');
    place.scrollIntoView({ block: 'center' });
    state.line = lineOf(place) ?? place.querySelector('.line');
  } else {
    state.line = null;
    scrollTo(0, 0);
  }
}

// Listening

function showPlay() {
  $('play').textContent = say(!state.reading ? 'read' : state.paused ? 'resume' : 'pause');
}

function stop() {
  if (state.reading) head.stop();
  spoken.stop();
  state.reading = state.paused = false;
  showPlay();
}

/** Without a network what is kept is heard. */
async function hearKept() {
  const from = state.line;
  $('news').textContent = say('noNetwork');
  const all = [...passage.querySelectorAll('[data-passage]')];
  const first = from ? all.findIndex((element) => element.contains(from)) : 0;
  state.reading = true;
  showPlay();
  await spoken.play(all.slice(Math.max(0, first)), (element) => element.scrollIntoView({ block: 'nearest' }));
  state.reading = false;
  showPlay();
}

/** @param {Element|Range|null} from where she is to begin */
async function read(from = state.line) {
  if (!state.section) return;
  if (canKeep() && (!navigator.onLine || ['waiting', 'closed'].includes($('connection').dataset.state))) {
    await hearKept();
    return;
  }
  state.reading = true;
  state.paused = false;
  showPlay();
  const turn = (state.turn = Symbol('reading'));
  const { reason } = await head.read(from instanceof Element ? range(from) : (from ?? undefined));
  if (turn !== state.turn) return;
  if (reason === 'done' && state.pinned) {
    read(state.pinned);
    return;
  }
  state.reading = false;
  showPlay();
  if (reason === 'done' && state.section.next && $('sleep').value !== 'section') {
    location.hash = `${state.section.work.id}:${state.section.next}`;
    await new Promise((resolve) => addEventListener('hashchange', resolve, { once: true }));
    await state.going;
    read(null);
  }
}

function toggle() {
  if (!state.reading) read();
  else if (spoken.playing) spoken.stop();
  else if (state.paused) head.resume();
  else head.pause();
}

function step(by) {
  const all = lines();
  const now = all.indexOf(state.line);
  const to = all[Math.min(all.length - 1, Math.max(0, now + by))];
  if (!to) return;
  state.line = to;
  if (state.pinned) state.pinned = to;
  if (state.reading) read(to);
  else to.scrollIntoView({ block: 'nearest' });
}

function setRepeat() {
  state.pinned = state.pinned ? null : (state.line ?? lines()[0] ?? null);
  $('repeat').setAttribute('aria-pressed', String(state.pinned !== null));
}

head.addEventListener('reading', ({ detail }) => {
  const line = lineOf(detail.range.startContainer);
  if (state.pinned && line !== state.pinned) {
    if (lines().indexOf(line) === lines().indexOf(state.pinned) + 1) read(state.pinned);
    else state.pinned = line; // she was sent elsewhere
  }
  state.line = state.pinned ?? line;
});
head.addEventListener('paused', () => {
  state.paused = true;
  showPlay();
});
head.addEventListener('resumed', () => {
  state.paused = false;
  showPlay();
});
passage.addEventListener('click', ({ target, clientX, clientY }) => {
  if (state.reading || target.closest('a') || !getSelection().isCollapsed) return;
  const caret = document.caretPositionFromPoint?.(clientX, clientY);
  const place = caret ? caret.offsetNode : document.caretRangeFromPoint?.(clientX, clientY)?.startContainer;
  if (!place || !passage.contains(place)) return;
  const from = document.createRange();
  from.setStart(place, caret ? caret.offset : document.caretRangeFromPoint(clientX, clientY).startOffset);
  state.line = lineOf(place);
  read(from);
});

// Choices

function fillVoices() {
  const chosen = $('voice').value;
  const tag = state.section?.work.lang ?? frame.lang;
  const sex = { male: say('male'), female: say('female') };
  const own = state.section?.recording ? [new Option(say('ownVoice'), 'recording')] : [];
  const others = voicesOf(state.voices, tag).flatMap(({ voices }) => voices);
  $('voice').replaceChildren(new Option(say('automatic'), ''), ...own,
    ...others.map(({ id, name, gender }) => new Option(sex[gender] ? `${name} (${sex[gender]})` : name, id)));
  $('voice').value = chosen;
  if ($('voice').selectedIndex < 0) $('voice').value = '';
  head.voice = $('voice').value || null;
}

function setSpeed() {
  const speed = Number($('speed').value);
  $('speed-now').textContent = `${speed.toLocaleString(frame.lang)} ×`;
  head.rate = speed === 1 ? null : Math.round(USUAL_RATE * speed);
  spoken.speed = speed;
}

function setSleep() {
  clearTimeout(state.timer);
  const minutes = Number($('sleep').value);
  if (minutes > 0) state.timer = setTimeout(() => {
    head.pause();
    spoken.stop();
    $('sleep').value = '';
    $('news').textContent = say('asleep');
  }, minutes * 60000);
}

function fillSleep() {
  const chosen = $('sleep').value;
  $('sleep').replaceChildren(new Option(say('never'), ''), ...MINUTES.map((n) => new Option(say('minutes', { n }), n)), new Option(say('sectionEnd'), 'section'));
  $('sleep').value = chosen;
}

function setMouth() {
  const on = $('mouth').getAttribute('aria-pressed') !== 'true';
  $('mouth').setAttribute('aria-pressed', String(on));
  head.view = on ? 'mouth' : null;
}

function setFace() {
  const on = $('face').getAttribute('aria-pressed') !== 'true';
  $('face').setAttribute('aria-pressed', String(on));
  document.body.classList.toggle('faceless', !on);
}

function setLooks() {
  const { style } = passage;
  style.setProperty('--size', `${$('size').value}rem`);
  passage.classList.toggle('wide', $('spacing').checked);
  document.documentElement.classList.toggle('contrast', $('contrast').checked);
  forGood.set(LOOKS, JSON.stringify({ size: $('size').value, wide: $('spacing').checked, contrast: $('contrast').checked }));
}

function restoreLooks() {
  try {
    const looks = JSON.parse(forGood.get(LOOKS)) ?? {};
    if (looks.size) $('size').value = looks.size;
    $('spacing').checked = Boolean(looks.wide);
    $('contrast').checked = Boolean(looks.contrast);
  } catch {
    // not ours
  }
  setLooks();
}

async function copyLink() {
  const address = new URL(location.href);
  address.search = '';
  address.hash = state.line?.id ?? state.section?.id ?? '';
  frame.tell((await copy(address.href, $('link-field'))) ? 'linkCopied' : 'selected');
}

// What is kept

async function keepSection() {
  const passages = [...passage.querySelectorAll('[data-passage]')].map(({ dataset }) => dataset.passage);
  try {
    await keep(passages, (n) => ($('news').textContent = say('keeping', { n, of: passages.length })));
    $('news').textContent = say('keptNow');
  } catch (error) {
    frame.problem.show({ code: 'unreachable', message: String(error.message) });
  }
  await showKept();
}

async function showKept() {
  if (!canKeep()) return;
  const works = await kept();
  $('offline').hidden = !works.length;
  $('kept').replaceChildren(...works.map(({ work, bytes }) => {
    const button = document.createElement('button');
    button.type = 'button';
    const size = (bytes / 1e6).toLocaleString(frame.lang, { style: 'unit', unit: 'megabyte', maximumFractionDigits: 1 });
    button.textContent = say('forget', { title: state.titles.get(work) ?? work, size });
    button.addEventListener('click', () => forget(work).then(showKept));
    const item = document.createElement('li');
    item.append(button);
    return item;
  }));
}

const search = new Search($('search'), $('results'), $('more'), {
  load,
  say,
  count: (text) => ($('count').textContent = text),
  shown(on) {
    if (on && (location.hash || query.get('at'))) {
      query.delete('at');
      history.pushState(null, '', location.pathname);
    }
    if (on) $('book').hidden = true;
    for (const name of ['results', 'count']) $(name).hidden = !on;
    $('works').hidden = on || !$('book').hidden;
    document.body.classList.toggle('open', !$('book').hidden);
  },
});

const tellKeys = openKeys($('keys'), $('shortcuts').querySelector('dl'), [
  { key: ' ', shown: '␣', word: 'read', act: toggle },
  { key: 'j', word: 'lineBack', act: () => step(-1) },
  { key: 'l', word: 'lineForward', act: () => step(1) },
  { key: 'r', word: 'repeat', act: setRepeat },
  { key: 'm', word: 'mouth', act: setMouth },
  { key: 'f', word: 'showFace', act: setFace },
  { key: 'c', word: 'captions', act: () => (head.captions = !head.captions) },
  { key: 'y', word: 'copyLink', act: copyLink },
  { key: '/', word: 'search', act: () => $('q').focus() },
]);

$('play').addEventListener('click', toggle);
$('back').addEventListener('click', () => step(-1));
$('forward').addEventListener('click', () => step(1));
$('repeat').addEventListener('click', setRepeat);
$('mouth').addEventListener('click', setMouth);
$('face').addEventListener('click', setFace);
$('speed').addEventListener('input', setSpeed);
$('sleep').addEventListener('change', setSleep);
$('voice').addEventListener('change', () => (head.voice = $('voice').value || null));
for (const name of ['size', 'spacing', 'contrast']) $(name).addEventListener('input', setLooks);
$('link').addEventListener('click', copyLink);
$('keep').addEventListener('click', keepSection);
document.addEventListener('keydown', (event) => event.key === 'Escape' && stop());
addEventListener('hashchange', () => (state.going = go()));

frame.onTranslate(() => {
  fillSleep();
  fillVoices();
  showPlay();
  setSpeed();
  tellKeys(say);
});
restoreLooks();
document.body.classList.toggle('embed', query.has('embed'));
frame.translate();
const texts = Promise.all([showWorks(), go()]);
// on a slow line she would be in the text's way
const opened = texts.catch(() => {}).then(() => frame.loadHead()).catch(() => {});
await texts;
$('keep').hidden = !(await startWorker());
await opened;
state.voices = (await load('v1/voices'))?.voices ?? [];
fillVoices();
