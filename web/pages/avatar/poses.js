// SPDX-License-Identifier: MIT
// Pictures of the user smiling, frowning, saying A...: assigns poses, checks suitability, and learns the movements.
// Slow work runs in a worker; nothing leaves the page.
import { throughFilm } from './film.js';

const MOST = 40; // pictures
const LONGEST = 1600; // pixels of one
const WIDE = 200; // size in pixels of the displayed area
const AROUND = 0.25; // of the face's height, on each side
const LOOKS = 6; // at the camera for a pose
const READ_MS = 1500; // time to read the request
const SHOWS = { strength: 0.3, like: 0.3 }; // thresholds for a requested pose
const PLAIN = 0.5; // threshold for a guessed pose: transitions between poses are weaker
const WORKER = 'portrait-poses.js';

/** Sends requests to the worker. */
class Learner {
  #worker;
  #waiting = new Map(); // id -> handler of its answer
  #last = 0;

  constructor() {
    const trusted = globalThis.trustedTypes?.createPolicy('faccia-poses', { createScriptURL: () => WORKER });
    this.#worker = new Worker(trusted?.createScriptURL('') ?? WORKER);
    this.#worker.addEventListener('message', ({ data: { id, answer, error } }) => {
      const { resolve, reject } = this.#waiting.get(id);
      this.#waiting.delete(id);
      if (error) reject(Object.assign(new Error(error.message), { code: error.code }));
      else resolve(answer);
    });
    this.#worker.addEventListener('error', (event) => {
      for (const { reject } of this.#waiting.values()) reject(new Error(event.message ?? WORKER));
      this.#waiting.clear();
    });
  }

  ask(act, values) {
    this.#last++;
    return new Promise((resolve, reject) => {
      this.#waiting.set(this.#last, { resolve, reject });
      this.#worker.postMessage({ id: this.#last, act, ...values });
    });
  }
}

/** One picture in the list. */
class PoseItem {
  constructor(number, { picture, landmarks }, name, { say, changed, remove }) {
    Object.assign(this, { number, view: { picture, landmarks }, name, say, state: name ? ['pose_waits'] : ['pose_none'] });
    this.item = document.createElement('li');
    this.canvas = Object.assign(document.createElement('canvas'), { width: WIDE, height: WIDE });
    this.canvas.setAttribute('role', 'img');
    this.field = Object.assign(document.createElement('label'), { className: 'field' });
    this.select = document.createElement('select');
    this.field.append(document.createElement('span'), this.select);
    this.told = document.createElement('p');
    this.gone = Object.assign(document.createElement('button'), { type: 'button' });
    this.gone.addEventListener('click', remove);
    this.select.addEventListener('change', () => {
      this.name = this.select.value || null;
      this.tell(this.name ? 'pose_waits' : 'pose_none');
      changed();
    });
    this.item.append(this.canvas, this.field, this.told, this.gone);
    this.#draw();
  }

  #draw() {
    const { picture, landmarks } = this.view;
    const [xs, ys] = [0, 1].map((k) => landmarks.map((p) => p[k]));
    const [left, right, top, bottom] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    const side = (bottom - top) * (1 + 2 * AROUND);
    const whole = Object.assign(document.createElement('canvas'), { width: picture.width, height: picture.height });
    whole.getContext('2d').putImageData(picture, 0, 0);
    const [x, y] = [(left + right - side) / 2, (top + bottom - side) / 2];
    this.canvas.getContext('2d').drawImage(whole, x, y, side, side, 0, 0, WIDE, WIDE);
  }

  tell(name, values) {
    this.state = [name, values];
    this.told.textContent = this.say(name, values);
    this.item.dataset.state = name;
  }

  translate(names) {
    const { say } = this;
    const options = [['', say('pose_choose')], ...names.map((name) => [name, say(`pose_${name}`)])];
    this.select.replaceChildren(...options.map(([value, textContent]) =>
      Object.assign(document.createElement('option'), { value, textContent })));
    this.select.value = this.name ?? '';
    this.field.firstChild.textContent = say('pose');
    this.canvas.ariaLabel = say(this.name ? `pose_${this.name}` : 'pose_choose');
    this.gone.textContent = say('remove');
    this.gone.ariaLabel = `${say('remove')}: ${this.canvas.ariaLabel}`;
    this.tell(...this.state);
  }
}

export class Poses {
  #items = [];
  #learner = null;
  #rest = null; // the face at rest, as sent to the worker
  #number = 0;

  /**
   * @param {HTMLElement} list @param {{say: Function, tell: (name: string, values?: object) => void, focus: () => void}} page
   *   focus: moves the focus after a picture was removed
   */
  constructor(list, page) {
    Object.assign(this, { list, page });
  }

  get count() {
    return this.#items.length;
  }

  /** The pictures with an assigned pose. */
  get named() {
    return this.#items.filter(({ name }) => name);
  }

  /**
   * @param {File[]} files
   * @param {object} tools of portrait.js
   * @param {{json: object, base: object, view: object}} rest the base
   *   head, its landmarks, and the picture at rest
   */
  async addFiles(files, tools, rest) {
    if (this.count + files.length > MOST) {
      this.page.tell('pose_many', { most: MOST });
      return;
    }
    const guess = this.guessOf(tools, rest);
    const unfit = [];
    for (const [i, file] of files.entries()) {
      this.page.tell('pose_looking', { number: i + 1, count: files.length });
      await new Promise((resolve) => setTimeout(resolve)); // so that it can be read
      try {
        if (file.type.startsWith('video/')) {
          await this.#addFilm(file, tools, guess);
          continue;
        }
        const word = file.name.replace(/\.[^.]*$/, '');
        const named = tools.nameOf(word) ?? tools.nameOf(word.replace(/[-_ ]\d+$/, ''));
        if (tools.LEFT_OUT[named]) throw Object.assign(new Error(tools.LEFT_OUT[named]), { code: 'left_out' });
        const view = await this.#viewOf(file, tools);
        if (guess.isOther(view.landmarks)) throw Object.assign(new Error('other face'), { code: 'other_face' });
        this.#add(view, named ?? guess.best(view.landmarks), tools);
      } catch (error) {
        if (!error.code) throw error;
        unfit.push(`${file.name}: ${this.page.say(error.code)}`);
      }
    }
    if (unfit.length) this.page.tell('pose_unfit', { list: unfit.join(' ') });
    else this.page.tell('pose_added');
  }

  /** Adds, for each pose in a video, the frame that shows it best. */
  async #addFilm(file, tools, guess) {
    const best = new Map(); // pose -> {picture, strength}
    let faces = 0;
    await throughFilm(file, async (still, share) => {
      this.page.tell('pose_film', { percent: Math.round(100 * share) });
      await new Promise((resolve) => setTimeout(resolve));
      const picture = await tools.readPicture(still, LONGEST);
      const landmarks = await tools.find(picture).catch(() => null); // no face just now
      if (!landmarks || guess.isOther(landmarks)) return;
      faces++;
      const name = guess.best(landmarks);
      const strength = guess.looks(landmarks).find((one) => one.name === name)?.strength;
      if (strength > PLAIN && !(best.get(name)?.strength >= strength)) best.set(name, { picture, strength });
    });
    if (!best.size) throw Object.assign(new Error('no pose'), { code: faces ? 'film_none' : 'film_nobody' });
    if (this.count + best.size > MOST) throw Object.assign(new Error('too many'), { code: 'film_many' });
    for (const [name, { picture }] of best)
      this.#add({ picture, landmarks: await tools.landmarksOf(tools.find, picture) }, name, tools);
  }

  guessOf(tools, { json, base, view }) {
    return new tools.PoseGuess(json, base, view.landmarks);
  }

  async #viewOf(source, tools) {
    const picture = await tools.readPicture(source, LONGEST);
    return { picture, landmarks: await tools.landmarksOf(tools.find, picture) };
  }

  #add(view, name, tools) {
    const again = () => this.show(tools);
    const item = new PoseItem(++this.#number, view, name, {
      say: this.page.say, changed: again,
      remove: () => {
        this.#items = this.#items.filter((one) => one !== item);
        again();
        this.page.focus();
      },
    });
    this.#items.push(item);
    again();
  }

  show(tools) {
    this.list.replaceChildren(...this.#items.map(({ item }) => item));
    if (tools) this.#items.forEach((one) => one.translate(Object.keys(tools.POSES)));
  }

  /**
   * Captures one pose after the other from the camera, keeping the best of several frames for each.
   * @param {HTMLVideoElement} video @param {AbortSignal} signal
   */
  async take(video, tools, rest, signal) {
    const guess = this.guessOf(tools, rest);
    const there = new Set(this.named.map(({ name }) => name));
    for (const name of Object.keys(tools.POSES)) {
      if (there.has(name) || signal.aborted || this.count >= MOST) continue;
      this.page.tell('pose_now', { pose: this.page.say(`pose_${name}`) });
      await new Promise((resolve) => setTimeout(resolve, READ_MS));
      let best = null;
      for (let look = 0; look < LOOKS && !signal.aborted; look++) {
        await new Promise((resolve) => setTimeout(resolve)); // lets the page draw and play sound
        const picture = await tools.readPicture(video, LONGEST);
        const landmarks = await tools.find(picture).catch(() => null); // no face just now
        const seen = landmarks && !guess.isOther(landmarks) && guess.looks(landmarks).find((one) => one.name === name);
        if (seen && seen.strength > SHOWS.strength && seen.like > SHOWS.like && !(best?.strength >= seen.strength))
          best = { picture, strength: seen.strength };
      }
      if (best) this.#add({ picture: best.picture, landmarks: await tools.landmarksOf(tools.find, best.picture) }, name, tools);
    }
    this.page.tell('pose_added');
  }

  /**
   * Adds the person's movements, learned from the pictures, to a head made from the face at rest.
   * @returns {Promise<{head: object, taken: number, actions: number}>}
   */
  async learn(head, rest) {
    this.#learner ??= new Learner();
    const { json, base: points, view } = rest;
    const known = JSON.stringify([json.name, view.landmarks]);
    if (this.#rest !== known) {
      this.#rest = null;
      await this.#learner.ask('rest', { json, points, view });
      this.#rest = known;
      this.#items.forEach((item) => (item.followed = null));
    }
    const taken = [];
    for (const [i, item] of this.named.entries()) {
      this.page.tell('pose_learning', { number: i + 1, count: this.named.length });
      const { number, name } = item;
      if (item.followed?.name !== name) {
        try {
          item.followed = { name, ...(await this.#learner.ask('follow', { number, name, view: item.view })) };
        } catch (error) {
          if (!error.code) throw error;
          item.followed = { name, code: error.code };
        }
      }
      const { strength, code } = item.followed;
      if (code) item.tell('pose_not', { why: this.page.say(code) });
      else {
        item.tell('pose_taken', { percent: Math.round(100 * strength) });
        taken.push(number);
      }
    }
    if (!taken.length) return { head, taken: 0, actions: 0 };
    return { taken: taken.length, ...(await this.#learner.ask('give', { head, numbers: taken })) };
  }
}
