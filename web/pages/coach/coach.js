// SPDX-License-Identifier: MIT
// The pronunciation coach: a sentence is heard, said by the learner, and compared by the server sound by sound.
import { bearer } from '../shared/bearer.js';
import { Frame } from '../shared/frame.js';
import { fill, FIRST, spokenLanguage } from '../shared/languages.js';
import { coach as words } from '../texts/index.js';
import { Marks } from './marks.js';
import { drawMelody } from './melody.js';
import { Recorder } from './recorder.js';
import { sentencesOf } from './sentences.js';
import { audio, Model, Player } from './take.js';

const SLOW = 90; // words a minute
const MIDDLE = 0.6; // of the camera's picture, each way: where the mouth is
const LONGER = 1.8, SHORTER = 0.5; // lengths of a sound that are told
/** Sounds that the server hears as one, by its classes (protocol, Coach). */
const ALIKE = {
  closed: 'p, b, m', teeth: 'f, v', rounded: 'ʃ, ʒ, tʃ, dʒ', dental: 'θ, ð', hiss: 's, z', tip: 't, d, n', liquid: 'l, r, ʎ', back: 'k, g, h, ɲ',
  open: 'a, ɑ, æ, ʌ', middle: 'e, ɛ, ə', 'middle-round': 'o, ɔ, ø', close: 'i, j, ɯ', 'close-round': 'u, y, w',
};
const $ = (id) => document.getElementById(id);

const frame = new Frame(words, { captions: { on: false } });
const { head, say } = frame;
const state = { agreed: { sound: false, camera: false }, models: new Map(), model: null, own: null, heard: null, pictures: [] };
const player = new Player((seconds) => showMouth(seconds));
const marks = new Marks($('words'), say, (phone) => showSound(phone));
const recorder = new Recorder($('preview'), {
  level: (share) => ($('level').value = share),
  seconds: (n) => ($('recording').querySelector('.text').textContent = say('recording', { n })),
});

// The sentence

const text = () => $('text').value.trim();
const lang = () => $('lang').value;

function fillSentences() {
  $('choose').replaceChildren(new Option(say('ownSentence'), ''), ...sentencesOf(lang()).map((sentence) => new Option(sentence, sentence)));
  $('choose').value = text();
  if ($('choose').selectedIndex < 0) $('choose').value = '';
  $('text').lang = lang();
}

/** Another sentence: what was heard is of the one before. */
function change(sentence) {
  player.stop();
  if (sentence !== undefined) $('text').value = sentence;
  Object.assign(state, { heard: null, own: null, model: null });
  $('result').hidden = true;
  fillSentences();
}

/** @param {boolean} [slow] @returns {Promise<Model>} of the sentence; loaded once */
async function modelOf(slow = false) {
  const wish = { text: text(), lang: lang(), ...(slow ? { rate: SLOW } : {}) };
  const key = JSON.stringify(wish);
  if (!state.models.has(key)) state.models.set(key, await Model.load(wish, frame.access.token));
  return state.models.get(key);
}

const attempt = (act) => async (...args) => {
  frame.tell(null);
  frame.problem.clear();
  try {
    await act(...args);
  } catch (error) {
    if (frame.access.concerns(error.code)) frame.access.ask(error.code);
    else frame.problem.show({ ...error, code: error.code ?? 'unreachable', message: error.message });
  }
};

const hear = attempt(async (slow) => {
  const model = await modelOf(slow);
  state.model = model;
  await player.play(model.buffer, { model: true });
});

// The mouths

/** @param {number|null} seconds of the model; null: at rest, or at the chosen sound */
function showMouth(seconds) {
  const phone = marks.chosen;
  const at = seconds ?? (state.heard && phone ? (phone.model_start + phone.model_end) / 2 : null);
  head.pose?.(at === null || !state.model ? null : state.model.pose(at));
}

function showPicture(seconds) {
  const { pictures } = state;
  $('frame').hidden = !pictures.length;
  $('preview').parentElement.hidden = pictures.length > 0;
  if (!pictures.length) return;
  const away = ({ at }) => Math.abs(at - seconds);
  const nearest = pictures.reduce((best, picture) => (away(picture) < away(best) ? picture : best));
  const { width, height } = $('frame');
  const { bitmap } = nearest, edge = (1 - MIDDLE) / 2;
  const part = [bitmap.width * edge, bitmap.height * edge, bitmap.width * MIDDLE, bitmap.height * MIDDLE];
  $('frame').getContext('2d').drawImage(bitmap, ...part, 0, 0, width, height);
}

// What was heard

function showSound(phone) {
  const { ipa, state: judged, class: expected, heard, length } = phone;
  $('sound').hidden = false;
  $('sound-title').textContent = `/${ipa}/: ${say(judged)}`;
  const other = heard && heard !== expected;
  const like = { sounds: other ? ALIKE[heard] : '' };
  $('sound-heard').textContent = judged === 'different' && other ? say('heardInstead', like) : judged === 'unsure' ? say('unsureWhy') : say('heardGood');
  $('sound-lips').textContent = expected ? words[frame.lang].lips[expected] : '';
  const odd = judged === 'good' && (length >= LONGER || length <= SHORTER);
  $('sound-length').hidden = !odd;
  $('sound-length').textContent = odd ? say(length >= LONGER ? 'longer' : 'shorter') : '';
  $('sound-alike').textContent = expected ? say('notTold', { sounds: ALIKE[expected] }) : '';
  showMouth(null);
  showPicture((phone.start + phone.end) / 2);
}

function showResult() {
  const { heard } = state;
  $('result').hidden = false;
  marks.show(heard);
  const count = (wanted) => heard.phones.filter(({ state: judged }) => judged === wanted).length;
  $('summary').textContent = heard.other ? say('otherWords') : say('summary', { good: count('good'), different: count('different'), unsure: count('unsure') });
  marks.choose(heard.phones.find(({ state: judged }) => judged === 'different') ?? heard.phones[0]);
  drawIfOpen();
}

function drawIfOpen() {
  if ($('melody-box').open && state.heard) drawMelody($('melody'), state.model.buffer, state.own, state.heard);
}

const wordNow = () => state.heard.words[marks.chosen?.word ?? 0];
const playOwn = () => player.play(state.own, { from: wordNow().start, to: wordNow().end });
const playModel = () => player.play(state.model.buffer, { from: wordNow().model_start, to: wordNow().model_end, model: true });

// The recording

async function compare(wav) {
  const query = new URLSearchParams({ text: text(), lang: lang() });
  const answer = await fetch(`v1/coach?${query}`, {
    method: 'POST', body: wav, headers: { 'content-type': 'audio/wav', ...bearer(frame.access.token) },
  });
  if (!answer.ok) throw await answer.json();
  return answer.json();
}

function showRecording(on) {
  $('recording').hidden = !on;
  $('record').textContent = say(on ? 'stop' : 'record');
  $('record').setAttribute('aria-pressed', String(on));
  for (const id of ['hear', 'slowly', 'text', 'choose', 'lang', 'camera']) $(id).disabled = on;
}

const record = attempt(async () => {
  const camera = $('camera').checked;
  player.stop();
  const made = modelOf(); // while the learner speaks
  made.catch(() => {});
  $('recording').querySelector('.text').textContent = say('recording', { n: 0 });
  $('own').hidden = !camera;
  $('preview').parentElement.hidden = !camera;
  $('frame').hidden = true;
  showRecording(true);
  let taken;
  try {
    taken = await recorder.record(camera);
  } catch (error) {
    $('own').hidden = true;
    frame.tell(error.name === 'NotSupportedError' ? 'insecure' : 'noMicrophone');
    return;
  } finally {
    showRecording(false);
  }
  frame.tell('comparing');
  state.model = await made;
  for (const { bitmap } of state.pictures) bitmap.close();
  state.pictures = taken.pictures;
  state.heard = await compare(taken.wav);
  state.own = await audio().decodeAudioData(taken.wav);
  frame.tell(null);
  showResult();
  $('result').focus();
});

/** Asks before the microphone, or the camera, is opened for the first time. */
function toggle() {
  if (recorder.on) {
    recorder.stop();
    return;
  }
  if (!text()) {
    frame.problem.show({ code: 'empty-text' });
    return;
  }
  const camera = $('camera').checked;
  if (state.agreed.sound && (state.agreed.camera || !camera)) {
    record();
    return;
  }
  $('consent-camera').hidden = !camera;
  $('consent').hidden = false;
  $('consent').focus();
}

function agree(yes) {
  $('consent').hidden = true;
  if (yes) {
    state.agreed.sound = true;
    state.agreed.camera ||= $('camera').checked;
    record();
  }
  $('record').focus();
}

// The page

$('hear').addEventListener('click', () => hear(false));
$('slowly').addEventListener('click', () => hear(true));
$('record').addEventListener('click', toggle);
$('consent-yes').addEventListener('click', () => agree(true));
$('consent-no').addEventListener('click', () => agree(false));
$('sentence').addEventListener('submit', (event) => event.preventDefault());
$('lang').addEventListener('change', () => change(sentencesOf(lang())[0] ?? ''));
$('choose').addEventListener('change', () => $('choose').value && change($('choose').value));
$('text').addEventListener('input', () => change());
$('camera').addEventListener('change', () => ($('own-hint').hidden = !$('camera').checked));
$('sound-back').addEventListener('click', () => marks.step(-1));
$('sound-on').addEventListener('click', () => marks.step(1));
$('own-word').addEventListener('click', playOwn);
$('model-word').addEventListener('click', playModel);
$('both-words').addEventListener('click', async () => (await playModel()) && playOwn());
$('melody-box').addEventListener('toggle', drawIfOpen);
document.addEventListener('keydown', (event) => event.key === 'Escape' && (recorder.stop(), player.stop()));

const query = new URLSearchParams(location.search);
const asked = { text: query.get('text')?.slice(0, $('text').maxLength), lang: query.get('lang') };
frame.onTranslate(() => {
  const tags = asked.lang && !FIRST.includes(asked.lang) ? [...FIRST, asked.lang] : FIRST;
  fill($('lang'), tags, { page: frame.lang, others: say('otherLanguages'), chosen: lang() || asked.lang || spokenLanguage(navigator.languages, FIRST) });
  if (!text()) $('text').value = asked.text ?? sentencesOf(lang())[0];
  fillSentences();
  $('record').textContent = say(recorder.on ? 'stop' : 'record');
  if (state.heard) showResult();
});
await frame.open();
