// SPDX-License-Identifier: MIT
import { applyStyles } from './stylesheet.mjs';
import { canDecode } from './audio/opus.mjs';
import { CaptionView } from './caption-view.mjs';
import { FaceMixer, faceValues } from './face-mixer.mjs';
import { Controls } from './controls.mjs';
import { ModelSource } from './head/source.mjs';
import { Demuxer } from './demuxer.mjs';
import { Link } from './link.mjs';
import { IdleController } from './idle-controller.mjs';
import { Orbit } from './orbit.mjs';
import { Player } from './audio/player.mjs';
import { Poster } from './poster.mjs';
import { Visibility } from './visibility.mjs';
import { addProperties, upgradeProperties } from './properties.mjs';
import { Speech } from './speech.mjs';
import { Stage } from './stage.mjs';
import { parts, styles } from './template.mjs';
import { Turns } from './turns.mjs';

const SPEAK_ATTRIBUTES = { lang: String, voice: String, rate: Number, markup: String, life: Number, blend: String, contacts: String };
const LINK_ATTRIBUTES = ['src', 'room', 'token'];
const TICK_MS = 40; // words are heard also while nothing is drawn (a hidden page, no WebGL), or slowly
const MOVE_MS = 100; // so long it may be out of the page without being given up: frameworks move elements

const turns = new Turns(); // of all heads in the page

/** `<talking-head>`: see web/README.md. Where there is no page (on a server) it can be imported, but not made. */
export class TalkingHead extends (globalThis.HTMLElement ?? class {}) {
  static observedAttributes = [
    ...LINK_ATTRIBUTES, 'model', 'poster', 'view', 'quality', 'captions', 'still', 'turn', 'life', 'expression', 'lang', 'label',
    'rate', 'polite',
  ];

  #opened = false;
  #leaving = 0; // timer
  #ticking = 0; // timer
  #reconnecting = false;
  #ready = false;
  #title = '';
  #drawn = { seconds: null, at: 0 };
  #reducedMotion = matchMedia('(prefers-reduced-motion: reduce)');
  #hello = null; // what the server has said of itself
  #controls;
  #poster;
  #captionView;
  #orbit;
  #stage;
  #mixer = new FaceMixer();
  #liveliness = new IdleController((message) => this.#link.send(message));
  #presence = new Visibility(this, () => this.#presenceChanged());
  #player = new Player((sound, reason) => this.#soundChanged(sound, reason));

  #link = new Link({
    source: () => ({ src: this.src, token: this.token }),
    onstate: (state) => this.#stateChanged(state),
    onmessage: (message) => this.#demuxer.text(message),
    onmedia: (data) => this.#demuxer.binary(data),
    ontrouble: (name, values, told) => this.#linkTrouble(name, values, told),
  });

  #speech = new Speech({
    player: this.#player,
    turns,
    state: () => this.#link.state,
    send: (message) => this.#link.send(message),
    emit: (type, detail) => this.#emit(type, detail),
    idle: (chunk) => this.#liveliness.face.take(chunk, performance.now() / 1000),
  });

  #demuxer = new Demuxer({
    hear: (message) => this.#message(message),
    media: (chunk) => {
      this.#speech.media(chunk);
      if (!this.#mixer.pose) this.#stage.wake();
    },
    mute: (error) => this.#wantPlainSound(error),
  });

  #models = new ModelSource({
    ask: (message) => this.#link.send(message),
    progress: (detail) => this.#emit('progress', detail),
    show: (json) => this.#show(json),
  });

  constructor() {
    super();
    const root = this.attachShadow({ mode: 'open' });
    root.append(...parts());
    applyStyles(root, styles);
    this.#controls = new Controls(root, {
      sound: () => this.#player.open(),
      captions: () => (this.captions = !this.captions),
    });
    this.#poster = new Poster(root.querySelector('.poster'), root.querySelector('.stage'));
    this.#captionView = new CaptionView(root.querySelector('.captions'));
    this.#orbit = new Orbit(root.querySelector('.stage'), this.#controls.turn, { moved: () => this.#stage?.wake() });
    this.#stage = new Stage(this.#controls.canvas, {
      hear: (now) => this.#hear(now),
      frame: (now, ahead) => this.#frame(now, ahead),
      trouble: (what) => this.#pictureTrouble(what),
      drawn: (on) => (this.#poster.drawn = this.#orbit.drawn = on),
    });
    upgradeProperties(this);
  }

  connectedCallback() {
    clearTimeout(this.#leaving);
    if (!this.#opened) this.#open();
  }

  /** Perhaps it is only moved: then it goes on. */
  disconnectedCallback() {
    clearTimeout(this.#leaving);
    this.#leaving = setTimeout(() => this.#close(), MOVE_MS);
  }

  connectedMoveCallback() {} // by moveBefore(): nothing changes

  adoptedCallback() {
    applyStyles(this.shadowRoot, styles);
  }

  attributeChangedCallback(name, before, value) {
    if (name === 'polite') {
      this.#speech.waits = this.polite;
      turns.next();
    }
    if (!this.#opened || before === value) return;
    if (LINK_ATTRIBUTES.includes(name)) this.#connectSoon();
    if (name === 'model' && this.#link.state === 'open') this.#openModel();
    if (name === 'model' || name === 'poster') this.#choosePoster();
    if (name === 'view') this.#stage.framing = value;
    if (name === 'quality') this.#stage.quality = value ?? 'auto';
    if (name === 'captions') this.#showCaptions();
    if (name === 'still' || name === 'turn') this.#motionChanged();
    if (name === 'life') this.#idle();
    if (name === 'expression') this.#express();
    if (name === 'rate' && this.rate) this.#speech.setRate(this.rate);
    if (name === 'lang' || name === 'label') this.#translate();
  }

  /**
   * Speaks the text after what is already queued.
   * @param {string} text
   * @param {object} [options] members of the protocol's `speak` message; those left out are taken from the attributes
   * @returns {Promise<object>} the `end` message, when the end is heard (or it failed, or was stopped)
   */
  speak(text, options = {}) {
    const defaults = {};
    for (const [name, type] of Object.entries(SPEAK_ATTRIBUTES))
      if (this.hasAttribute(name)) defaults[name] = type(this.getAttribute(name));
    if (this.#mixer.still) defaults.still = true;
    if (!defaults.voice && !options.voice) Object.assign(defaults, this.#voiceKind);
    const promise = this.#speech.speak(text, { ...defaults, ...options });
    this.#stage.wake();
    return promise;
  }

  /** Silence at once; what is queued is forgotten. */
  stop() {
    this.#speech.stop();
    this.#captionView.clear();
    this.#stage.wake();
  }

  /** Halts where it is, until `resume`; the face lives on. In a room, all are halted. */
  pause() {
    this.#speech.pause();
    this.#stage.wake();
  }

  /** Goes on after a pause. */
  resume() {
    this.#speech.resume();
    this.#stage.wake();
  }

  /** Goes on from a mark of what is spoken. @param {string} mark its name */
  jump(mark) {
    this.#speech.jump(mark);
  }

  /**
   * Holds the face in a pose, whatever is spoken, until it is called with null.
   * @param {Record<number, number>|null} faps values by FAP number
   * @param {{ease?: boolean}} [options] ease: go over to it smoothly, not at once
   */
  pose(faps, { ease = false } = {}) {
    this.#mixer.pose = faps && faceValues(faps);
    this.#mixer.ease = ease;
    this.#stage.wake();
  }

  /**
   * The mood of the face, speaking or not, until the next call; over what markup asks for.
   * @param {{name: string, intensity?: number}[]|Record<string, number>|string} mix up to four affects of
   *   `hello.expressions`; nothing = neutral
   * @param {{ease?: number}} [options] seconds that the change takes (0.3)
   */
  express(mix, options) {
    this.#liveliness.express(mix, options);
    this.#stage.wake();
  }

  /** The face as it was drawn last: the FAPs that are not 0, by number. @returns {Record<number, number>} */
  get faps() {
    return Object.fromEntries([...this.#mixer.values.entries()].filter(([, value]) => value));
  }

  /** Figures for tests and measurements, not for pages: they may change. Times in seconds of the utterance heard. */
  debug() {
    const now = performance.now();
    const heard = this.#speech.heard(now);
    return {
      ...this.#stage.debug,
      state: !this.#ready ? 'loading' : this.#speech.busy ? 'speaking' : 'idle',
      connection: this.#link.state,
      sound: this.#player.sound,
      sampleRate: this.#player.rate,
      underruns: this.#player.underruns,
      running: heard?.running ?? false,
      utterance: heard?.utterance.number ?? null,
      audioTime: heard?.seconds ?? null, // what is heard at this moment
      frameTime: this.#drawn.seconds, // what the face that was drawn last belongs to; null: to nothing that is spoken
      frameAge: now - this.#drawn.at, // milliseconds since it came on the display; negative: it is still on its way there
      fapValues: Array.from(this.#mixer.values),
      turned: this.#orbit.turned,
    };
  }

  #emit(type, detail) {
    this.dispatchEvent(new CustomEvent(type, { detail }));
  }

  #online = () => this.#link.hurry();

  #motionChanged = () => {
    this.#mixer.still = this.still ?? this.#reducedMotion.matches;
    this.#orbit.on = this.turn ?? !this.#mixer.still;
    this.#orbit.soft = !this.#reducedMotion.matches;
    this.#idle();
    this.#stage.wake();
  };

  #presenceChanged() {
    this.#stage.seen = this.#presence.seen;
    this.#idle();
  }

  /** Has the face idle while there is somebody to see it. */
  #idle() {
    const { life } = this;
    const wanted = this.#presence.seen && !this.#mixer.still;
    this.#liveliness.idle(wanted ? (life === null ? {} : { life }) : null);
    this.#stage.wake();
  }

  #express() {
    const mix = this.getAttribute('expression');
    if (mix !== null || this.#liveliness.mix.length) this.express(mix ?? []);
  }

  #translate() {
    this.#controls.translate(this.lang, this.getAttribute('label'), this.#title);
  }

  #showCaptions() {
    this.#captionView.shown = this.captions;
    this.#controls.captions.setAttribute('aria-pressed', String(this.captions));
  }

  #soundChanged(sound, reason) {
    this.#controls.sound.hidden = sound !== 'blocked';
    this.#emit('sound', { sound, ...(reason ? { reason } : {}) });
    this.#stage.wake();
  }

  // Being in the page, and leaving it

  #open() {
    this.#opened = true;
    this.#reducedMotion.addEventListener('change', this.#motionChanged);
    addEventListener('online', this.#online);
    this.#stage.quality = this.quality ?? 'auto';
    this.#stage.framing = this.view;
    this.#choosePoster();
    this.#stage.open();
    this.#motionChanged();
    this.#translate();
    this.#showCaptions();
    this.#express();
    this.#connect();
    this.#presence.open();
    this.#captionView.open();
    this.#ticking = setInterval(() => this.#tick(performance.now()), TICK_MS);
  }

  #close() {
    this.#opened = false;
    clearInterval(this.#ticking);
    this.#reducedMotion.removeEventListener('change', this.#motionChanged);
    removeEventListener('online', this.#online);
    this.#presence.close();
    this.#captionView.close();
    this.#speech.stop();
    this.#captionView.clear();
    this.#disconnect();
    this.#player.close();
    this.#stage.close();
    this.#ready = false;
  }

  // The connection and the model that comes through it

  #connect() {
    this.#disconnect();
    this.#controls.say('model', null);
    this.#link.open();
  }

  /** Once for all attributes that are changed together. */
  #connectSoon() {
    if (this.#reconnecting) return;
    this.#reconnecting = true;
    queueMicrotask(() => {
      this.#reconnecting = false;
      if (this.#opened) this.#connect();
    });
  }

  #disconnect() {
    this.#models.close();
    this.#link.close();
    this.#demuxer.reset();
  }

  #linkTrouble(name, values, told) {
    this.#controls.say('link', name, values);
    if (name && !told) this.#fail(name, values);
  }

  #pictureTrouble(name) {
    this.#controls.say('picture', name);
    if (name && name !== 'lost') this.#fail(name);
  }

  /** Tells the page. @param {string} name of a message @param {object} [values] */
  #fail(name, values) {
    const code = name.replace(/[A-Z]/g, (letter) => `-${letter.toLowerCase()}`);
    this.#emit('error', { type: 'error', code, message: this.#controls.text(name, values) });
  }

  /** Sound that needs no decoder: where there is none, or it failed. */
  #wantPlainSound(error) {
    console.warn('talking-head: Opus cannot be decoded here', error ?? '');
    this.#link.send({ type: 'media', audio: 'pcm_s16le' });
  }

  #stateChanged({ state, hello, retryIn }) {
    this.#emit('connection', { state, ...(retryIn === undefined ? {} : { retryIn }) });
    if (state === 'open') {
      this.#enter();
      this.#speech.linked();
      this.#liveliness.linked();
      this.#hello = hello;
      this.#openModel();
      this.#choosePoster();
      canDecode().then((can) => can || this.#wantPlainSound());
    } else {
      this.#demuxer.reset();
      this.#speech.unlinked();
      this.#liveliness.unlinked();
    }
    this.#stage.wake();
  }

  /** What is known of the head that is asked for. */
  get #model() {
    const { model } = this;
    const { models = [] } = this.#hello ?? {};
    return (model === null ? models[0] : models.find(({ name }) => name === model)) ?? (model === null ? {} : { name: model });
  }

  /** The kind of voice that suits the head, where none is named. */
  get #voiceKind() {
    const { gender, pitch } = this.#model.voice ?? {};
    return { ...(gender ? { gender } : {}), ...(pitch ? { pitch } : {}) };
  }

  #choosePoster() {
    let stream = null;
    try {
      stream = this.#link.address;
    } catch {
      // says the link
    }
    this.#poster.choose(this.poster, stream, this.#model);
  }

  #openModel() {
    const hello = this.#hello;
    if (this.model === null && !hello.models?.length) {
      this.#controls.say('model', 'noModel');
      this.#fail('noModel');
    } else this.#models.open(this.#link.address, hello, this.model);
  }

  /** Says who we are, and goes where we belong. */
  #enter() {
    const { token, room } = this;
    this.#speech.adopts = Boolean(room);
    if (token) this.#link.send({ type: 'authorize', token });
    if (room) this.#link.send({ type: 'join', room });
  }

  #message(message) {
    if (message.type === 'model') this.#models.take(message);
    else {
      this.#speech.hear(message);
      if (['hello', 'joined', 'authorized'].includes(message.type)) this.#emit(message.type, message);
      this.#stage.wake();
    }
  }

  async #show(json) {
    try {
      const model = await this.#stage.show(json);
      this.#title = model.title;
      this.#translate();
      this.#ready = true;
      this.#emit('ready', { model: model.name, title: model.title, credits: model.credits });
    } catch (error) {
      console.error('talking-head:', error);
      this.#controls.say('model', 'noModel');
      this.#emit('error', { type: 'error', code: 'bad-model', message: String(error.message) });
    }
  }

  // What is heard and shown

  /** Captions change with a picture, where there are pictures: what is drawn in between would hold up the next one. */
  #tick(now) {
    if (this.#stage.drawing) this.#speech.tick(now);
    else this.#hear(now);
  }

  /** @returns {boolean} whether the captions have changed */
  #hear(now) {
    this.#speech.tick(now);
    const { captions, options } = this.#speech.heard(now)?.utterance ?? {};
    return this.#captionView.show(captions?.lineOf(this.#captionView.size) ?? null, options?.lang);
  }

  #frame(now, ahead) {
    const heard = this.#speech.heard(now, ahead / 1000);
    const { face } = this.#liveliness;
    if (heard?.running) face.leave();
    const idle = heard?.running ? null : face.at(now / 1000, ahead / 1000);
    const changed = this.#mixer.update(now, heard, idle);
    this.#drawn = { seconds: heard?.seconds ?? null, at: now + ahead };
    const changing = this.#mixer.changing(now);
    const turning = this.#orbit.update(now / 1000);
    const speaks = this.#speech.busy || changing;
    const held = this.#mixer.pose && !changing; // whatever is heard
    const more = changed || turning || (!held && (speaks || idle));
    return { values: this.#mixer.values, turned: this.#orbit.turned, more, calm: !speaks && !turning };
  }
}

addProperties(TalkingHead.prototype);
