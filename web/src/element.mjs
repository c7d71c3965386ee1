// SPDX-License-Identifier: MIT
import { CaptionView } from './caption-view.mjs';
import { Connection } from './connection.mjs';
import { FaceMixer, faceValues } from './face-mixer.mjs';
import { Furniture } from './furniture.mjs';
import { ModelSource } from './head/source.mjs';
import { Liveliness } from './liveliness.mjs';
import { Player } from './audio/player.mjs';
import { Presence } from './presence.mjs';
import { Speech } from './speech.mjs';
import { Stage } from './stage.mjs';
import { template } from './template.mjs';
import { Intake } from './intake.mjs';

const SPEAK_ATTRIBUTES = { lang: String, voice: String, rate: Number, markup: String, life: Number, blend: String };
const TICK_MS = 40; // words are heard also while nothing is drawn (a hidden page, no WebGL), or slowly

/** `<talking-head>`: see web/README.md. */
export class TalkingHead extends HTMLElement {
  static observedAttributes = ['src', 'model', 'quality', 'captions', 'still', 'life', 'expression', 'room', 'token', 'lang', 'label'];

  #speech = null;
  #connection = null;
  #ready = false;
  #title = '';
  #drawn = { seconds: null, at: 0 };
  #reducedMotion = matchMedia('(prefers-reduced-motion: reduce)');

  constructor() {
    super();
    const root = this.attachShadow({ mode: 'open' });
    root.innerHTML = template;
    this.furniture = new Furniture(root, { sound: () => this.player.open(), captions: () => (this.captions = !this.captions) });
    this.captionView = new CaptionView(root.querySelector('.captions'));
    this.mixer = new FaceMixer();
    this.liveliness = new Liveliness((message) => this.#connection?.send(message) ?? false);
    this.presence = new Presence(this, () => this.#idle());
    this.player = new Player((sound) => this.#soundChanged(sound));
    this.stage = new Stage(this.furniture.canvas, {
      hear: (now) => this.#hear(now),
      frame: (now, ahead) => this.#frame(now, ahead),
      trouble: (what) => this.furniture.say(what),
    });
  }

  connectedCallback() {
    this.#speech = new Speech({
      player: this.player,
      send: (message) => this.#connection?.send(message) ?? false,
      emit: (type, detail) => this.#emit(type, detail),
      idle: (chunk) => this.liveliness.face.take(chunk, performance.now() / 1000),
    });
    this.#reducedMotion.addEventListener('change', this.#motionChanged);
    addEventListener('online', this.#online);
    this.stage.quality = this.getAttribute('quality') ?? 'auto';
    this.stage.open();
    this.#motionChanged();
    this.#translate();
    this.#showCaptions();
    this.#express();
    this.#connect();
    this.presence.open();
    this.timer = setInterval(() => this.#tick(performance.now()), TICK_MS);
  }

  disconnectedCallback() {
    clearInterval(this.timer);
    this.#reducedMotion.removeEventListener('change', this.#motionChanged);
    removeEventListener('online', this.#online);
    this.presence.close();
    this.#speech.stop();
    this.#disconnect();
    this.player.close();
    this.stage.close();
  }

  attributeChangedCallback(name, before, value) {
    if (!this.isConnected || !this.#speech || before === value) return;
    if (['src', 'model', 'room', 'token'].includes(name)) this.#connect();
    if (name === 'quality') this.stage.quality = value ?? 'auto';
    if (name === 'captions') this.#showCaptions();
    if (name === 'still') this.#motionChanged();
    if (name === 'life') this.#idle();
    if (name === 'expression') this.#express();
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
    if (this.mixer.still) defaults.still = true;
    const promise = this.#speech.speak(text, { ...defaults, ...options });
    this.stage.wake();
    return promise;
  }

  /** Silence at once; what is queued is forgotten. */
  stop() {
    this.#speech.stop();
    this.captionView.clear();
    this.stage.wake();
  }

  /** Halts where it is, until `resume`; the face lives on. In a room, all are halted. */
  pause() {
    this.#speech.pause();
    this.stage.wake();
  }

  /** Goes on after a pause. */
  resume() {
    this.#speech.resume();
    this.stage.wake();
  }

  /** Goes on from a mark of what is spoken. @param {string} mark its name */
  jump(mark) {
    this.#speech.jump(mark);
  }

  /** Words per minute: of the sentences that have not begun, and of what is spoken from now on. */
  get rate() {
    return this.hasAttribute('rate') ? Number(this.getAttribute('rate')) : null;
  }

  set rate(rate) {
    this.setAttribute('rate', rate);
    this.#speech.setRate(Number(rate));
  }

  /**
   * Holds the face in a pose, whatever is spoken, until it is called with null.
   * @param {Record<number, number>|null} faps values by FAP number
   * @param {{ease?: boolean}} [options] ease: go over to it smoothly, not at once
   */
  pose(faps, { ease = false } = {}) {
    this.mixer.pose = faps && faceValues(faps);
    this.mixer.ease = ease;
    this.stage.wake();
  }

  /**
   * The mood of the face, speaking or not, until the next call; over what markup asks for.
   * @param {{name: string, intensity?: number}[]|Record<string, number>|string} mix up to four affects of
   *   `hello.expressions`; nothing = neutral
   * @param {{ease?: number}} [options] seconds that the change takes (0.3)
   */
  express(mix, options) {
    this.liveliness.express(mix, options);
    this.stage.wake();
  }

  /** The face as it was drawn last: the FAPs that are not 0, by number. @returns {Record<number, number>} */
  get faps() {
    return Object.fromEntries([...this.mixer.values.entries()].filter(([, value]) => value));
  }

  get captions() {
    return this.getAttribute('captions') !== 'off';
  }

  set captions(on) {
    this.setAttribute('captions', on ? 'on' : 'off');
  }

  /** Figures for tests and measurements, not for pages: they may change. Times in seconds of the utterance heard. */
  debug() {
    const now = performance.now();
    const heard = this.#speech?.heard(now);
    return {
      ...this.stage.debug,
      state: !this.#ready ? 'loading' : this.#speech.busy ? 'speaking' : 'idle',
      connection: this.#connection?.state ?? 'closed',
      sound: this.player.sound,
      sampleRate: this.player.rate,
      underruns: this.player.underruns,
      running: heard?.running ?? false,
      utterance: heard?.utterance.number ?? null,
      audioTime: heard?.seconds ?? null, // what is heard at this moment
      frameTime: this.#drawn.seconds, // what the face that was drawn last belongs to; null: to nothing that is spoken
      frameAge: now - this.#drawn.at, // milliseconds since it came on the display; negative: it is still on its way there
      fapValues: Array.from(this.mixer.values),
    };
  }

  #emit(type, detail) {
    this.dispatchEvent(new CustomEvent(type, { detail }));
  }

  #online = () => this.#connection?.hurry();

  #motionChanged = () => {
    const still = this.getAttribute('still');
    this.mixer.still = still === null ? this.#reducedMotion.matches : still !== 'off';
    this.#idle();
    this.stage.wake();
  };

  /** Has the face idle while there is somebody to see it. */
  #idle() {
    const life = this.getAttribute('life');
    const wanted = this.presence.seen && !this.mixer.still;
    this.liveliness.idle(wanted ? (life === null ? {} : { life: Number(life) }) : null);
    this.stage.wake();
  }

  #express() {
    const mix = this.getAttribute('expression');
    if (mix !== null || this.liveliness.mix.length) this.express(mix ?? []);
  }

  #translate() {
    this.furniture.translate(this.lang, this.getAttribute('label'), this.#title);
  }

  #showCaptions() {
    this.captionView.shown = this.captions;
    this.furniture.captions.setAttribute('aria-pressed', String(this.captions));
  }

  #soundChanged(sound) {
    this.furniture.sound.hidden = sound !== 'blocked';
    this.#emit('sound', { sound });
    this.stage.wake();
  }

  // The connection and the model that comes through it

  get #address() {
    const url = new URL(this.getAttribute('src') || '/v1/stream', document.baseURI);
    url.protocol = url.protocol.replace(/^http/, 'ws');
    if (!url.searchParams.has('events')) url.searchParams.set('events', 'packed');
    return url.href;
  }

  #connect() {
    this.#disconnect();
    if (this.furniture.said === 'badAddress' || this.furniture.said === 'noModel') this.furniture.say(null);
    this.#intake.reset();
    try {
      this.#connection = new Connection(this.#address, {
        onstate: (state) => this.#stateChanged(state),
        onmessage: (message) => this.#intake.text(message),
        onmedia: (data) => this.#intake.binary(data),
      });
      this.#connection.open();
    } catch {
      this.furniture.say('badAddress', { src: this.getAttribute('src') });
      this.#emit('error', { type: 'error', code: 'bad-address', message: this.furniture.text('badAddress', { src: this.getAttribute('src') }) });
    }
  }

  #disconnect() {
    this.#models.close();
    this.#connection?.close();
    this.#connection = null;
  }

  #intake = new Intake({
    hear: (message) => this.#message(message),
    media: (chunk) => {
      this.#speech.media(chunk);
      if (!this.mixer.pose) this.stage.wake();
    },
  });

  #models = new ModelSource({
    ask: (message) => this.#connection?.send(message),
    progress: (detail) => this.#emit('progress', detail),
    show: (json) => this.#show(json),
  });

  #stateChanged({ state, hello, retryIn }) {
    this.#emit('connection', { state, ...(retryIn === undefined ? {} : { retryIn }) });
    if (state === 'open') {
      this.#enter();
      this.#speech.linked();
      this.liveliness.linked();
      this.#models.open(this.#address, hello, this.getAttribute('model'));
    } else {
      this.#intake.reset();
      this.#speech.unlinked();
      this.liveliness.unlinked();
    }
    this.stage.wake();
  }

  /** Says who we are, and goes where we belong. */
  #enter() {
    const token = this.getAttribute('token');
    const room = this.getAttribute('room');
    this.#speech.adopts = Boolean(room);
    if (token) this.#connection.send({ type: 'authorize', token });
    if (room) this.#connection.send({ type: 'join', room });
  }

  #message(message) {
    if (message.type === 'model') this.#models.take(message);
    else {
      this.#speech.hear(message);
      if (['hello', 'joined', 'authorized'].includes(message.type)) this.#emit(message.type, message);
      this.stage.wake();
    }
  }

  async #show(json) {
    try {
      const model = await this.stage.show(json);
      this.#title = model.title;
      this.#translate();
      this.#ready = true;
      this.#emit('ready', { model: model.name, title: model.title, credits: model.credits });
    } catch (error) {
      console.error('talking-head:', error);
      this.furniture.say('noModel');
      this.#emit('error', { type: 'error', code: 'bad-model', message: String(error.message) });
    }
  }

  // What is heard and shown

  /** Captions change with a picture, where there are pictures: what is drawn in between would hold up the next one. */
  #tick(now) {
    if (this.stage.drawing) this.#speech.tick(now);
    else this.#hear(now);
  }

  /** @returns {boolean} whether the captions have changed */
  #hear(now) {
    this.#speech.tick(now);
    const { captions, options } = this.#speech.heard(now)?.utterance ?? {};
    return this.captionView.show(captions?.line ?? null, options?.lang);
  }

  #frame(now, ahead) {
    const heard = this.#speech.heard(now, ahead / 1000);
    const { face } = this.liveliness;
    if (heard?.running) face.leave();
    const idle = heard?.running ? null : face.at(now / 1000, ahead / 1000);
    const changed = this.mixer.update(now, heard, idle);
    this.#drawn = { seconds: heard?.seconds ?? null, at: now + ahead };
    const changing = this.mixer.changing(now);
    const speaks = this.#speech.busy || changing;
    const held = this.mixer.pose && !changing; // whatever is heard
    return { values: this.mixer.values, more: changed || (!held && (speaks || idle)), calm: !speaks };
  }
}
