// SPDX-License-Identifier: MIT
// Moves the face with that of the user before a camera. The pictures are processed in this page and never sent; the movements
// go to the server, which moves the face with them, in the room of the address (?room=) for all.
import { Frame } from '../shared/frame.js';
import { mirror as words } from '../texts/index.js';
import { Take } from './take.js';

const LONGEST = 640; // pixels of the picture that is looked at,
const CLOSE = 320; // and of the piece with the face
const LEAST_SCORE = 0.5;
const CALM_LOOKS = 3; // one after the other, at which the face may be at rest, before it counts as such
const LEAST_STEP = 1 / 40; // seconds between frames: a room takes 120 messages a second

const $ = (id) => document.getElementById(id);
const frame = new Frame(words);
const { head, say } = frame;
const room = new URL(location.href).searchParams.get('room');
let tools = null;
let stream = null; // of the camera
let reader = null; // FaceReader, once the face at rest is known
let take = null; // the recording in progress
let said = null;

function tell(name, values) {
  said = name && [name, values];
  $('state').textContent = name ? say(name, values) : '';
}

async function load() {
  if (tools) return tools;
  tell('loading');
  const module = await import('./portrait.js');
  tools = { ...module, eye: await module.openEye(new URL('./', import.meta.url).href) };
  return tools;
}

/** Finds the face: near where it was, or anywhere. @returns {Promise<{landmarks: number[][]|null, box: number[]|null}>} */
async function look(picture, box) {
  try {
    if (!box) {
      const landmarks = await tools.eye(picture);
      return { landmarks, box: tools.boxOf(landmarks) };
    }
    const { landmarks, score } = await tools.eye.closeUp(picture, box, CLOSE);
    return score < LEAST_SCORE ? { landmarks: null, box: null } : { landmarks, box: tools.boxOf(landmarks) };
  } catch (error) {
    if (!error.code) throw error;
    return { landmarks: null, box: null, code: error.code };
  }
}

function send(time, faps) {
  head.drive([{ time, faps }]);
  if (take && !take.add(time, faps)) stopTake();
}

/** Follows the face as long as this camera is on. */
async function follow(mine) {
  const calm = new tools.Calm();
  let [box, seen, last] = [null, 0, 0];
  while (stream === mine) {
    const wait = Math.max(0, 1000 * (last + LEAST_STEP) - performance.now());
    await new Promise((resolve) => setTimeout(resolve, wait)); // lets the page draw
    if (stream !== mine) return;
    const time = (last = performance.now() / 1000);
    const found = await look(await tools.readPicture($('video'), LONGEST), box);
    if (stream !== mine) return;
    box = found.box;
    if (!found.landmarks) {
      tell(found.code === 'several_faces' ? 'several_faces' : 'no_face');
      continue;
    }
    seen = tools.mayRest(found.landmarks) ? seen + 1 : 0;
    if (!reader && seen >= CALM_LOOKS) reader = new tools.FaceReader(found.landmarks);
    if (!reader) {
      tell('resting');
      continue;
    }
    const faps = calm.take(time, reader.read(found.landmarks));
    tell(take ? 'recording' : 'moving', { seconds: Math.round(take?.seconds ?? 0) });
    send(time, $('mirrored').checked ? tools.mirrored(faps) : faps);
  }
}

function show() {
  const on = Boolean(stream);
  $('live').hidden = $('off').hidden = !on;
  $('on').hidden = on;
  $('record').ariaPressed = String(Boolean(take));
  $('record').textContent = say(take ? 'recordEnd' : 'record');
}

async function cameraOn() {
  $('on').disabled = true;
  try {
    await load();
    stream = await navigator.mediaDevices.getUserMedia({ video: { facingMode: 'user', width: { ideal: 640 }, height: { ideal: 480 } } });
  } catch (error) {
    tell(tools ? 'no_camera' : 'failed', { message: error.message });
    return;
  } finally {
    $('on').disabled = false;
  }
  const mine = stream;
  reader = null;
  head.still = false; // the face moves because the user wants it
  $('video').srcObject = stream;
  stream.getVideoTracks()[0].addEventListener('ended', () => stream === mine && cameraOff());
  show();
  $('off').focus();
  try {
    await $('video').play();
    await follow(mine);
  } catch (error) {
    if (stream !== mine) return;
    cameraOff();
    tell('failed', { message: error.message });
  }
}

function cameraOff() {
  if (take) stopTake();
  stream?.getTracks().forEach((track) => track.stop());
  stream = null;
  $('video').srcObject = null;
  head.drive(null);
  tell(null);
  show();
  $('on').focus();
}

function stopTake() {
  URL.revokeObjectURL($('save').href);
  const file = take.seconds ? new Blob([take.file('mirror')], { type: 'application/octet-stream' }) : null;
  take = null;
  $('saved').hidden = !file;
  if (file) Object.assign($('save'), { href: URL.createObjectURL(file), download: 'mirror.fap' });
  show();
}

$('on').addEventListener('click', cameraOn);
$('off').addEventListener('click', cameraOff);
$('rest').addEventListener('click', () => (reader = null));
$('record').addEventListener('click', () => {
  if (take) stopTake();
  else {
    take = new Take();
    $('saved').hidden = true;
    show();
  }
});
addEventListener('pagehide', () => stream && cameraOff());
frame.onTranslate(() => {
  $('consent').textContent = room ? say('consentRoom', { room }) : say('consent');
  if (said) tell(...said);
  show();
});

if (room) {
  head.setAttribute('room', room);
  $('mirrored').checked = false; // the others see the user, not a mirror
}
await frame.open();
