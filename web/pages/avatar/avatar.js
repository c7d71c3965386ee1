// SPDX-License-Identifier: MIT
// Makes a head from pictures of the user's face. The pictures are processed in this page and never sent.
import { Frame } from '../shared/frame.js';
import { fill, primary, spokenLanguage } from '../shared/languages.js';
import { avatar as words } from '../texts/index.js';
import { PictureBox } from './picture.js';
import { Poses } from './poses.js';
import { ProfileBox } from './profile.js';
import { Wear } from './wear.js';

const LOOKS_MAX = 120; // after this time the user is assumed to have given up

/**
 * Takes the sharpest pictures from the front and from either side while the user turns before the camera. They stay in the
 * page.
 * @param {HTMLVideoElement} video @param {{readPicture: Function, find: Function, TurnPicker: Function, table: object}} tools
 * @param {{signal: AbortSignal, wants: (side: string|null) => void}} page wants: which side to turn to; null: any that was seen
 * @returns {Promise<{picture: ImageData, landmarks: number[][]}[]>} the front first
 */
async function takeTurn(video, { readPicture, find, TurnPicker, table }, { signal, wants }) {
  const picker = new TurnPicker(Object.values(table)[0]);
  for (let look = 0; look < LOOKS_MAX && !picker.done && !signal.aborted; look++) {
    wants(picker.missing[0] ?? null);
    await new Promise((resolve) => setTimeout(resolve)); // lets the page draw and play sound
    if (signal.aborted) break;
    const picture = await readPicture(video);
    const landmarks = await find(picture).catch(() => null); // no face just now
    if (landmarks) picker.take({ picture, landmarks });
  }
  return picker.views;
}

const $ = (id) => document.getElementById(id);
const [form, text, lang, state, making] = ['form', 'text', 'lang', 'state', 'making'].map($);
const frame = new Frame(words);
const { head, say } = frame;
let tags = [];
let models = [];
let boxes = [];
let made = null; // the head, when it is
let stream = null; // of the camera
let turning = null; // AbortController of a running capture of a turn or of poses
let said = null; // the displayed state: its name and values

const wearFields = Object.fromEntries(['seen', 'style', 'hair', 'beard', 'glasses', 'age'].map((id) => [id, $(id)]));
const wear = new Wear(wearFields, say, () => made && doing(make));
const poses = new Poses($('poses'), { say, tell, focus: () => $('pose-files').focus() });

function tell(name, values) {
  said = name && [name, values];
  state.textContent = name ? say(name, values) : '';
}

/** Runs an action of the user and shows its error. */
async function doing(act) {
  try {
    await act();
  } catch (error) {
    tell(error.code && words.en[error.code] ? error.code : 'failed', { message: error.message });
  }
}

let tools = null; // the face detector and the points of the server's heads, loaded with the first picture
async function load() {
  if (tools) return tools;
  tell('loading');
  const module = await import('./portrait.js');
  const [table, styles] = await Promise.all(['face-points.json', 'face-wear.json'].map((file) => frame.load(file)));
  if (!table) throw new Error('face-points.json');
  tools = { ...module, table, styles: styles ?? {}, all: { ...table, ...styles }, find: await module.openEye(new URL('./', import.meta.url).href) };
  return tools;
}

async function add(source) {
  const all = await load();
  tell('looking');
  await new Promise((resolve) => setTimeout(resolve)); // so that it can be read
  const picture = await all.readPicture(source);
  try {
    put({ picture, landmarks: await all.find(picture) });
    tell('found');
  } catch (error) {
    if (error.code !== 'no_face') throw error;
    put(all.asProfile(picture, all.table)); // throws for anything but a profile
    tell('profile');
  }
}

/** Adds a picture in which a face was found. */
function put(view) {
  const box = new (view.landmarks ? PictureBox : ProfileBox)(view, tools, { say, remove: () => remove(box) });
  boxes.push(box);
  show();
}

/** Shows that a capture from the camera runs, or has ended. */
async function before(button, act) {
  if (turning) {
    turning.abort();
    return;
  }
  turning = new AbortController();
  button.ariaPressed = 'true';
  try {
    await act(turning.signal);
  } finally {
    turning = null;
    button.ariaPressed = 'false';
  }
}

const turn = () => before($('turn'), async (signal) => {
  const all = await load();
  const wants = (side) => tell(side ? `turn_${side}` : 'turn_on');
  const views = await takeTurn($('video'), all, { signal, wants });
  views.forEach(put);
  tell(views.length === 3 ? 'found' : 'turn_few');
});

/** Returns the reference for poses: the chosen base head, and the picture from the front. */
async function rest() {
  const { json, base } = await headOf($('like').value || $('like').dataset.nearest);
  const [view] = tools.inOrder(boxes.map((box) => box.view).filter(({ landmarks }) => landmarks), base);
  return { json, base, view };
}

async function takePoses() {
  if (!stream) await cameraOn();
  if (stream) await before($('pose-camera'), async (signal) => poses.take($('video'), await load(), await rest(), signal));
}

function remove(box) {
  boxes = boxes.filter((one) => one !== box);
  show();
  tell(null);
  $('files').focus();
}

const BEST = 3; // heads that are offered first

const group = (label, options) => {
  const out = Object.assign(document.createElement('optgroup'), { label });
  out.append(...options);
  return out;
};

const option = (value, label) => Object.assign(document.createElement('option'), { value, textContent: label });

function show() {
  $('pictures').replaceChildren(...boxes.map(({ item }) => item));
  boxes.forEach((box, i) => box.translate(i + 1));
  const front = boxes.find(({ view }) => view.landmarks);
  making.hidden = $('posing').hidden = !front;
  poses.show(tools);
  if (!front || !tools) return;
  const known = models.filter(({ name }) => tools.table[name]);
  const order = tools.nearest(front.view, tools.table).map(({ name }) => name)
    .filter((name) => known.some((model) => model.name === name));
  const [nearest] = order;
  const titleOf = (name) => known.find((model) => model.name === name)?.title ?? '';
  for (const id of ['like', 'eyes']) {
    const chosen = $(id).value;
    const first = id === 'like' ? option('', say('nearest', { title: titleOf(nearest) })) : option('', say('hairPhoto'));
    const all = known.map(({ name, title }) => option(name, title));
    const isBest = ({ value }) => order.slice(0, BEST).includes(value);
    const [best, others] = [true, false].map((wanted) => all.filter((one) => isBest(one) === wanted));
    const groups = () => [group(say('mostSimilar'), best), group(say('others'), others)];
    $(id).replaceChildren(first, ...(id === 'like' ? groups() : all));
    $(id).value = chosen;
  }
  wear.show(front.view, tools, known);
  $('like').dataset.nearest = nearest;
}

async function headOf(name) {
  const json = await frame.access.load(`v1/models/${encodeURIComponent(name)}`);
  return { json, base: tools.table[name] };
}

async function make() {
  if (!$('like').value) {
    tell('likeFirst');
    $('like').focus();
    return;
  }
  if (!wear.isComplete) {
    tell('styleFirst');
    return;
  }
  tell('working');
  $('make').disabled = $('save').disabled = true;
  hideLook();
  try {
    await new Promise((resolve) => setTimeout(resolve));
    const start = performance.now();
    const name = $('like').value;
    const base = await headOf(name);
    const eyes = await headOf($('eyes').value || wear.eyes);
    const worn = await wear.options(name, tools, async (other) => (Object.hasOwn(tools.styles, other) ? frame.load(`wear-${other}.json`) : (await headOf(other)).json));
    const old = worn.age ? await headOf(tools.OLDEST[base.json.voice?.gender] ?? tools.OLDEST.female) : null;
    const result = await tools.makeHead(base.json, base.base, boxes.map(({ view }) => view), tools.textures, {
      title: say('title'), eyes: eyes.json, old: old?.json, light: Number($('light').value), ...worn,
    });
    made = result.head;
    await head.showHead(made);
    const seconds = new Intl.NumberFormat(frame.lang, { maximumFractionDigits: 1 });
    const took = () => seconds.format((performance.now() - start) / 1000);
    tell('made', { seconds: took() });
    if (result.parted) state.append(` ${say('parted')}`);
    if (result.bearded) state.append(` ${say('bearded')}`);
    if (poses.named.length) await learnPoses(took);
    showLook();
  } finally {
    $('make').disabled = false;
  }
}

const SHOWN = { width: 480, height: 600, faces: 2.5 }; // the photograph beside the head: pixels, and its height in faces

/** The photograph beside the head, as large as it: it is done when its user says so. */
function showLook() {
  const { picture, landmarks } = boxes.find(({ view }) => view.landmarks).view;
  const whole = Object.assign(document.createElement('canvas'), { width: picture.width, height: picture.height });
  whole.getContext('2d').putImageData(picture, 0, 0);
  const [top, chin] = [landmarks[10], landmarks[152]];
  const tall = SHOWN.faces * Math.hypot(top[0] - chin[0], top[1] - chin[1]);
  const wide = (tall * SHOWN.width) / SHOWN.height;
  const photo = Object.assign($('look-photo'), { width: SHOWN.width, height: SHOWN.height });
  const above = Math.max(0, (top[1] + chin[1]) / 2 - 0.54 * tall);
  photo.getContext('2d').drawImage(whole, (top[0] + chin[0] - wide) / 2, above, wide, tall, 0, 0, SHOWN.width, SHOWN.height);
  $('look').hidden = photo.hidden = false;
  photo.parentElement.classList.add('compared');
  photo.parentElement.scrollIntoView({ block: 'nearest' });
}

function hideLook() {
  $('look').hidden = $('look-photo').hidden = true;
  $('look-photo').parentElement.classList.remove('compared');
}

function accept() {
  hideLook();
  $('save').disabled = false;
  tell('done');
  $('save').focus();
}

async function learnPoses(took) {
  try {
    const learnt = await poses.learn(made, await rest());
    if (learnt.actions) await head.showHead((made = learnt.head));
    tell(learnt.taken ? 'pose_done' : 'pose_zero', { seconds: took(), poses: learnt.taken, actions: learnt.actions });
  } catch (error) {
    if (error.code !== 'parted') throw error;
    tell('poses_parted');
  }
}

function save() {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([JSON.stringify(made)], { type: 'application/json' }));
  link.download = `${made.name}.json`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}

async function cameraOn() {
  try {
    stream = await navigator.mediaDevices.getUserMedia({ video: { facingMode: 'user', width: { ideal: 1280 } } });
  } catch {
    tell('no_camera');
    return;
  }
  $('video').srcObject = stream;
  $('camera-box').hidden = false;
  await $('video').play();
  $('take').focus();
}

function cameraOff() {
  turning?.abort();
  stream?.getTracks().forEach((track) => track.stop());
  stream = null;
  $('video').srcObject = null;
  $('camera-box').hidden = true;
  $('camera').focus();
}

const addAll = (files) =>
  doing(async () => {
    for (const file of files) await add(file);
  });
$('files').addEventListener('change', ({ target }) => {
  addAll([...target.files]);
  target.value = '';
});
// Pictures can be dropped anywhere on the card.
const card = $('files').closest('.card');
const drag = (on) => (event) => {
  if (!event.dataTransfer.types.includes('Files')) return;
  event.preventDefault();
  card.classList.toggle('dragged', on);
};
card.addEventListener('dragover', drag(true));
card.addEventListener('dragleave', drag(false));
card.addEventListener('drop', (event) => {
  const files = [...event.dataTransfer.files];
  drag(false)(event);
  if (files.length) addAll(files);
});
$('pose-files').addEventListener('change', ({ target }) =>
  doing(async () => {
    const files = [...target.files];
    target.value = '';
    await poses.addFiles(files, await load(), await rest());
  }),
);
$('pose-camera').addEventListener('click', () => doing(takePoses));
$('camera').addEventListener('click', () => doing(cameraOn));
$('take').addEventListener('click', () => doing(() => add($('video'))));
$('turn').addEventListener('click', () => doing(turn));
$('camera-off').addEventListener('click', cameraOff);
$('make').addEventListener('click', () => doing(make));
$('light').addEventListener('change', () => made && doing(make));
$('accept').addEventListener('click', accept);
$('save').addEventListener('click', save);
form.addEventListener('submit', (event) => {
  event.preventDefault();
  head.stop();
  frame.problem.clear();
  head.speak(text.value, { lang: lang.value });
});
$('stop').addEventListener('click', () => head.stop());
document.addEventListener('keydown', (event) => event.key === 'Escape' && head.stop());
lang.addEventListener('change', () => (text.lang = lang.value));
frame.onTranslate(() => {
  fill(lang, tags, { page: frame.lang, others: say('otherLanguages'), chosen: lang.value });
  if (Object.values(words).some(({ sample }) => sample === text.value) || !text.value) text.value = say('sample');
  show();
  if (said) tell(...said);
});

await frame.open();
models = (await frame.load('v1/models'))?.models ?? [];
const { voices } = (await frame.load('v1/voices')) ?? { voices: [] };
tags = [...new Set(voices.map((voice) => primary(voice.lang)))];
fill(lang, tags, { page: frame.lang, others: say('otherLanguages'), chosen: spokenLanguage(navigator.languages.map(primary), tags) });
text.lang = lang.value;
show();
