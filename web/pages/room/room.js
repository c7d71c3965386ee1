// SPDX-License-Identifier: MIT
// The face of a room: speaks, shows its state, offers answers, sleeps at night.
import { Access } from '../shared/access.js';
import { pageLanguage } from '../shared/languages.js';
import { errors, room as words, shared } from '../texts/index.js';
import { Consent } from './consent.js';
import { Ears } from './ears.js';
import { Manner } from './manner.js';
import { Reply } from './reply.js';
import { isWithin, readWish } from './wish.js';

const WORKER = 'room-worker.js';

/**
 * Registers the service worker, which lets the page start without a network. Browsers allow one over HTTPS and on localhost
 * only.
 */
async function keepShell() {
  if (globalThis.origin === 'null' || !('serviceWorker' in navigator)) return;
  try {
    const trusted = globalThis.trustedTypes?.createPolicy('faccia-room-worker', { createScriptURL: () => WORKER });
    await navigator.serviceWorker.register(trusted?.createScriptURL('') ?? WORKER, { scope: 'room.html' }); // the library's worker serves the rest
  } catch (error) {
    console.info('faccia: the page is not kept for when there is no network:', error.message);
  }
}

const AWAKE_MS = 60000; // time awake at night after the last event
const ANSWERED_MS = 6000; // duration of the shown answer
const INSECURE_MS = 20000; // duration of the note on HTTPS
const TROUBLE_MS = 20000; // duration of an error; a lost connection is shown until it is restored
const SHIFT_MS = 60000; // shifts the picture slightly against burn-in
const SHIFTS = [[0, 0], [6, 2], [4, -5], [-3, -6], [-6, 3]];
const $ = (id) => document.getElementById(id);
const wish = readWish(location.href);
const lang = pageLanguage(wish.lang ? [wish.lang, ...navigator.languages] : navigator.languages, Object.keys(words));
const say = (name, values = {}) => (words[lang][name] ?? shared[lang][name]).replace(/\{(\w+)\}/g, (_, key) => values[key] ?? '');
const head = $('head');
const now = { connection: 'connecting', told: 'idle', heard: '', utterances: 0, sound: 'on', offered: null };
const consent = new Consent(head, say, {
  news: tell,
  changed() {
    wake();
    showQuestion();
  },
});
const ears = new Ears(head, say, lang, { news: tell, speaking: () => now.utterances > 0, wake }, wish.recogniser);
const reply = new Reply(head, lang, wake);
let awakeUntil = 0;
let trouble = ''; // message during a lost connection
let lock = null;

function showState() {
  const state = now.connection !== 'open' ? 'offline' : now.utterances ? 'speaking' : now.told;
  document.body.dataset.state = state;
  const more = state === 'speaking' && now.sound === 'blocked' ? say('blocked') : state === 'speaking' ? say('stopHint') : now.heard;
  $('sign').querySelector('.text').textContent = say(state);
  $('sign').querySelector('.more').textContent = more;
}

let telling = 0; // timer

/** For a while. */
function tell(text, milliseconds) {
  $('news').textContent = text;
  clearTimeout(telling);
  telling = setTimeout(() => $('news').textContent === text && ($('news').textContent = ''), milliseconds);
}

function answer(choice) {
  if (consent.answer(choice)) return;
  if (now.offered) head.choose(choice, now.offered.id);
}

function showQuestion() {
  const { question = '', choices = [] } = now.offered ?? {};
  const hidden = !choices.length || consent.asked; // one question at a time
  $('question').hidden = hidden;
  document.body.toggleAttribute('data-offered', !hidden);
  $('question').querySelector('.what').textContent = question;
  $('question').querySelector('.answers').replaceChildren(...choices.map((text, choice) => {
    const button = document.createElement('button');
    button.type = 'button';
    button.textContent = text;
    button.addEventListener('click', () => answer(choice));
    return button;
  }));
}

/** Keeps the screen on while the face is awake, if the browser allows it. */
async function keepOn(on) {
  if (!on || document.hidden) {
    lock?.release().catch(() => {});
    lock = null;
  } else lock ??= await navigator.wakeLock?.request('screen').catch(() => null);
}

function look() {
  const time = new Date();
  $('clock').textContent = time.toLocaleTimeString(lang, { hour: '2-digit', minute: '2-digit' });
  const night = wish.sleep && isWithin(wish.sleep, time.getHours() * 60 + time.getMinutes());
  const asleep = (Boolean(night) || now.told === 'asleep') && Date.now() > awakeUntil && !now.utterances && !now.offered && !consent.asked;
  $('asleep').hidden = !asleep;
  $('place').inert = asleep;
  head.hidden = asleep; // and draws nothing
  keepOn(!asleep);
}

function wake() {
  awakeUntil = Date.now() + AWAKE_MS;
  look();
}

let shift = 0;
setInterval(() => {
  const [x, y] = SHIFTS[++shift % SHIFTS.length];
  $('place').style.transform = `translate(${x}px, ${y}px)`;
}, SHIFT_MS);
setInterval(look, 5000);
if (!globalThis.isSecureContext) tell(say('insecure'), INSECURE_MS);

head.addEventListener('connection', ({ detail }) => {
  now.connection = detail.state;
  if (detail.state === 'open') return; // it exists once the element is in the room
  now.offered = null;
  now.told = 'idle';
  now.heard = '';
  consent.lost();
  ears.lost();
  reply.close();
  showQuestion();
  showState();
});
head.addEventListener('joined', () => {
  if ($('news').textContent === trouble) $('news').textContent = ''; // the link is back
  showState();
});
head.addEventListener('begin', ({ detail }) => {
  now.utterances++;
  document.body.toggleAttribute('data-bell', detail.bell === true);
  wake();
  showState();
});
head.addEventListener('word', () => document.body.removeAttribute('data-bell'));
head.addEventListener('end', () => {
  document.body.removeAttribute('data-bell');
  now.utterances = Math.max(0, now.utterances - 1);
  showState();
});
head.addEventListener('sound', ({ detail }) => {
  now.sound = detail.sound;
  showState();
});
head.addEventListener('state', ({ detail }) => {
  const before = now.told;
  now.told = detail.state;
  now.heard = detail.text ?? '';
  if (detail.state === 'asleep') awakeUntil = 0;
  else if (detail.state !== 'idle' || before === 'asleep') awakeUntil = Date.now() + AWAKE_MS;
  look();
  showState();
});
head.addEventListener('head', ({ detail }) => {
  const name = detail.head || wish.head;
  if (name) head.setAttribute('model', name);
  else head.removeAttribute('model');
});
head.addEventListener('choices', ({ detail }) => {
  now.offered = detail.choices.length ? detail : null;
  $('news').textContent = '';
  wake();
  showQuestion();
});
head.addEventListener('chosen', ({ detail }) => {
  now.offered = null;
  showQuestion();
  tell(say('chosen', { text: detail.text }), ANSWERED_MS);
});
head.addEventListener('error', ({ detail }) => {
  if (access.concerns(detail.code)) return;
  const text = errors[lang][detail.code] ?? detail.message;
  clearTimeout(telling);
  if (now.connection === 'open') tell(text, TROUBLE_MS);
  else $('news').textContent = trouble = text;
});

document.addEventListener('click', (event) => {
  const [target] = event.composedPath(); // also for buttons of the head
  if (now.utterances && !target.closest?.('button, form')) head.stop();
  wake();
});
document.addEventListener('keydown', ({ key, target }) => {
  if (target.closest('form')) return;
  if (key === 'Escape') head.stop();
  if (/^[1-8]$/.test(key)) answer(Number(key) - 1);
  wake();
});
document.addEventListener('visibilitychange', () => look());
$('full').hidden = !document.fullscreenEnabled;
$('full').addEventListener('click', () => document.documentElement.requestFullscreen());
document.addEventListener('fullscreenchange', () => ($('full').hidden = Boolean(document.fullscreenElement)));

document.documentElement.lang = head.lang = lang;
document.title = `${wish.room ?? say('title')} · faccia`;
for (const element of document.querySelectorAll('[data-text]')) element.textContent = say(element.dataset.text);
for (const element of document.querySelectorAll('[data-label]')) element.setAttribute('aria-label', say(element.dataset.label));
new Manner(head, say, lang, wish.distance);
$('clock').hidden = !wish.clock;
head.setAttribute('view', wish.view);
if (wish.head) head.setAttribute('model', wish.head);
const access = new Access($('access'), head, (code) => errors[lang][code], () => showState());
if (wish.room) head.setAttribute('room', wish.room);
else $('news').textContent = say('noRoom');
showState();
look();
keepShell();
await import('./talking-head.js');
