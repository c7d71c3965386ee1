// SPDX-License-Identifier: MIT
// The library: search, read, listen.
import { copy } from '../shared/copy.js';
import { keepsStill, makeFilm, makesFilms } from '../shared/film.js';
import { FilmButton } from '../shared/film-button.js';
import { Frame } from '../shared/frame.js';
import { ownName } from '../shared/languages.js';
import { addressesOf, named, take } from './library-early.js';
import { Choices } from './choices.js';
import { openKeys } from './keys.js';
import { lineOf, Listening } from './listening.js';
import { canKeep, forget, keep, kept, KeptSpeech, startWorker } from './offline.js';
import { Recording } from './recording.js';
import { Roles } from './roles.js';
import { Search } from './search.js';
import { showText } from './text.js';
import { library as words } from '../texts/index.js';
import { Sayings } from '../shared/sayings.js';

const $ = (id) => document.getElementById(id);

const query = new URLSearchParams(location.search);
const frame = new Frame(words);
const { head, say } = frame;
const passage = $('passage');
const spoken = new KeptSpeech();
const state = { section: null, titles: new Map(), going: null };
const choices = new Choices(frame, passage, spoken);
const roles = new Roles(frame, passage, (address) => frame.access.load(address), {
  file: () => state.file,
  quiet: () => listening.stop(),
});
const listening = new Listening(frame, passage, {
  spoken,
  async next() {
    const { work, next } = state.section;
    if (!next) return false;
    location.hash = `${work.id}:${next}`;
    await new Promise((resolve) => addEventListener('hashchange', resolve, { once: true }));
    await state.going;
    return true;
  },
  stopped: () => recording.settle(),
});
const recording = new Recording(passage, {
  say,
  load: (address) => frame.access.load(address),
  busy: () => listening.reading,
  recorded: () => head.voice === 'recording',
  hear(text, lang) {
    listening.stop();
    return head.speak(text, { lang, voice: undefined, mode: 'replace' });
  },
});

const load = async (address) => (await take(address)) ?? frame.load(address);

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

function namePages() {
  for (const mark of passage.querySelectorAll('.page')) mark.title = say('editionPage', { n: mark.textContent });
}

/** The sections as items, each with those of a deeper level in a list of its own. */
function contentsOf(sections, shown) {
  const top = [];
  const open = []; // {level, item}, outermost first
  for (const { id, title, number, level } of sections) {
    const item = link(title || `${number}`, `#${id}`);
    if (id === shown) item.firstChild.setAttribute('aria-current', 'page');
    while (open.length && open.at(-1).level >= level) open.pop();
    const above = open.at(-1)?.item;
    if (!above) top.push(item);
    else {
      if (above.lastChild.localName !== 'ol') above.append(document.createElement('ol'));
      above.lastChild.append(item);
    }
    open.push({ level, item });
  }
  return top;
}

async function openSection(work, number) {
  const addresses = addressesOf(work, number);
  const [about, section] = await Promise.all(addresses.map(load));
  if (!section || !about) return false;
  listening.stop();
  state.section = section;
  state.file = about.file;
  state.titles.set(about.id, about.title);
  showText(passage, section);
  namePages();
  $('work-title').textContent = [about.author, about.title].filter(Boolean).join(': ');
  $('contents').hidden = about.sections.length < 2;
  $('contents').querySelector('ol').replaceChildren(...contentsOf(about.sections, section.id));
  for (const [id, to] of [['previous', section.previous], ['next', section.next]]) {
    $(id).hidden = !to;
    if (to) $(id).href = `#${section.work.id}:${to}`;
  }
  document.title = `${section.title || about.title} · ${about.title} · faccia`;
  recording.show(section, addresses[1]);
  choices.section = section;
  roles.show(section);
  return true;
}

/** Returns the target of the address: nothing, a section, a passage or a line. */
async function go() {
  const id = named();
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
    listening.line = lineOf(place) ?? place.querySelector('.line');
  } else {
    listening.line = null;
    scrollTo(0, 0);
  }
}

async function copyLink() {
  const address = new URL(location.href);
  const id = listening.line?.id ?? state.section?.id;
  address.search = id ? `?at=${id}` : ''; // the server then sends the text together with the page
  address.hash = '';
  frame.tell((await copy(address.href, $('link-field'))) ? 'linkCopied' : 'selected');
}

/** The page that has one say a line. @param {Element|null} line */
function practiceOf(line) {
  const lang = line?.closest('[lang]')?.lang ?? state.section?.work.lang;
  return line ? `coach.html?${new URLSearchParams({ text: line.textContent.trim().replace(/\s+/g, ' '), lang })}` : 'coach.html';
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

const search = new Search($('search'), { list: $('results'), more: $('more'), titles: $('titles'), facets: $('facets'), table: $('table') }, {
  load,
  say,
  lang: () => frame.lang,
  count: (text) => ($('count').textContent = text),
  shown(on) {
    if (on && (location.hash || query.get('at'))) {
      query.delete('at');
      history.pushState(null, '', location.pathname);
    }
    if (on) $('book').hidden = true;
    for (const name of ['results', 'count']) $(name).hidden = !on;
    if (!on) $('titles').hidden = $('facets').hidden = true;
    $('works').hidden = on || !$('book').hidden;
    document.body.classList.toggle('open', !$('book').hidden);
  },
});

new Sayings(frame, $('sayings'), {
  selected() {
    const selection = getSelection();
    const node = selection.isCollapsed ? null : selection.getRangeAt(0).startContainer;
    if (!node || !passage.contains(node)) return null;
    const element = node.nodeType === 1 ? node : node.parentElement;
    const { passage: id } = element.closest('[data-passage]')?.dataset ?? {};
    return { word: selection.toString(), lang: element.closest('[lang]')?.lang, context: lineOf(node)?.textContent.trim(), work: state.section?.work.id, passage: id };
  },
  lang: () => state.section?.work.lang ?? frame.lang,
  file: () => state.file,
  quiet: () => listening.stop(),
});

const tellKeys = openKeys($('keys'), $('shortcuts').querySelector('dl'), [
  { key: ' ', shown: '␣', word: 'read', act: () => listening.toggle() },
  { key: 'j', word: 'lineBack', act: () => listening.step(-1) },
  { key: 'l', word: 'lineForward', act: () => listening.step(1) },
  { key: 'r', word: 'repeat', act: () => listening.repeat() },
  { key: 'm', word: 'mouth', act: () => choices.mouth() },
  { key: 'f', word: 'showFace', act: () => choices.face() },
  { key: 'c', word: 'captions', act: () => (head.captions = !head.captions) },
  { key: 'y', word: 'copyLink', act: copyLink },
  { key: '/', word: 'search', act: () => $('q').focus() },
]);

$('play').addEventListener('click', () => listening.toggle());
$('back').addEventListener('click', () => listening.step(-1));
$('forward').addEventListener('click', () => listening.step(1));
$('repeat').addEventListener('click', () => listening.repeat());
$('link').addEventListener('click', copyLink);
$('practise').addEventListener('click', ({ currentTarget }) => (currentTarget.href = practiceOf(listening.line ?? passage.querySelector('.line, [data-passage]:not(.verse)'))));
$('keep').addEventListener('click', keepSection);
new FilmButton(frame, $('film'), $('film-progress'), async (told, signal) => {
  const { id } = state.section;
  const { model, voice, rate } = head;
  const still = keepsStill(head) || undefined;
  const chosen = { model: model || undefined, voice: voice || undefined, rate: rate || undefined };
  const order = { passage: id, ...chosen, still, ...roles.film };
  const film = await makeFilm(order, frame.access.token, told, signal);
  return film && { film, name: `${id.replace(':', '-')}.mp4` };
});
document.addEventListener('keydown', (event) => event.key === 'Escape' && listening.stop());
addEventListener('hashchange', () => (state.going = go()));

frame.onTranslate(() => {
  namePages();
  listening.showPlay();
  recording.translate();
  tellKeys(say);
});
frame.translate();
// in sequence: on a slow connection the list would delay the text, and the head both
const texts = go().then(showWorks);
const opened = texts.catch(() => {}).then(() => frame.loadHead()).catch(() => {});
await texts;
$('keep').hidden = !(await startWorker());
await opened;
$('film').hidden = !(await makesFilms(frame.access.token));
choices.voices = roles.voices = (await load('v1/voices'))?.voices ?? [];
