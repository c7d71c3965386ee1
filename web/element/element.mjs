// SPDX-License-Identifier: MIT
import { applyStyles, parts, styles } from './template.mjs';
import { Controls } from './controls.mjs';
import { Backdrop } from './backdrop.mjs';
import { Hearing } from './speech/hearing.mjs';
import { VoiceInputs } from './speech/voice-inputs.mjs';
import { readMix } from './face/expression.mjs';
import { Player } from './audio/player.mjs';
import { captureOutput } from './audio/shared-context.mjs';
import { Poster } from './poster.mjs';
import { Presentation } from './presentation.mjs';
import { addProperties, upgradeProperties } from './properties.mjs';
import { Reader } from './reading/reader.mjs';
import { Session } from './session.mjs';
import { SPEAK_ATTRIBUTES } from './speak-attributes.mjs';
import { Speech } from './speech/speech.mjs';
import { Turns } from './speech/turns.mjs';

const LINK_ATTRIBUTES = ['src', 'audio', 'room', 'token', 'watch'];
const PLAY_EVENTS = ['connection', 'begin', 'end', 'paused', 'resumed']; // after which the button for a recording may differ
const MODEL_ATTRIBUTES = ['model', 'avatar', 'avatar-map', 'pictures', 'quality'];
const BEAT_MS = 1000; // between pictures of a still face that is captured
const MOVE_MS = 100; // grace period outside the page before it closes: frameworks move elements

let said = 0; // words that were sent
const turns = new Turns(); // of all heads in the page

/** `<talking-head>`: see web/docs/element. Without a page (on a server) it can be imported, but not constructed. */
export class TalkingHead extends (globalThis.HTMLElement ?? class {}) {
  static observedAttributes = [
    ...LINK_ATTRIBUTES, 'model', 'avatar', 'avatar-map', 'pictures', 'poster', 'view', 'quality', 'captions', 'still', 'turn', 'life', 'expression', 'lang', 'label',
    'rate', 'polite', 'for', 'backdrop', 'partner', 'persona',
  ];

  #opened = false;
  #leaving = 0; // timer
  #blocked = false; // whether the server knows that its sound is blocked
  #ready = false;
  #title = '';
  #playing = null; // promise of `play`
  #wider = null; // the view before that of the mouth alone
  #controls;
  #player = new Player((sound, reason) => this.#soundChanged(sound, reason));
  #speech = new Speech({
    player: this.#player,
    turns,
    state: () => this.#session.state,
    send: (message) => this.#session.send(message),
    sendSound: (sound, bytes) => this.#session.sendSound(sound, bytes),
    emit: (type, detail) => this.#emit(type, detail),
    idle: (chunk) => this.#presentation.idled(chunk),
  });
  #presentation;
  #reader;
  #session;
  #hearing = null;
  #backdrop;
  #voiceInputs = new VoiceInputs({
    speak: (options) => {
      const voice = this.#speech.listen(options);
      this.#presentation.wake();
      return voice;
    },
    fail: (error) => this.#emit('error', { type: 'error', code: 'no-listening', message: String(error.message) }),
    wake: () => this.#presentation.wake(),
  });

  constructor() {
    super();
    const root = this.attachShadow({ mode: 'open' });
    root.append(...parts());
    applyStyles(root, styles);
    const speech = this.#speech;
    const controls = new Controls(root, {
      sound: () => this.#player.open(),
      captions: () => (this.captions = !this.captions),
      mouth: () => this.#switchMouth(),
      play: () => (this.#speech.busy && !this.#speech.paused ? this.pause() : this.play()),
    });
    const poster = new Poster(root.querySelector('.poster'), root.querySelector('.stage'));
    const presentation = new Presentation(this, root, { controls, poster, speech }, {
      send: (message) => this.#session.send(message),
      trouble: (name) => this.#pictureTrouble(name),
      unfit: (error) => this.#unfit(error),
    });
    this.#controls = controls;
    this.#presentation = presentation;
    this.#backdrop = new Backdrop(root.querySelector('.stage'), (there) => (presentation.stage.fading = !there));
    this.#session = new Session(this, { controls, poster, speech, presentation }, {
      emit: (type, detail) => {
        this.#emit(type, detail);
        if (type === 'connection' && detail.state === 'open' && this.#session.recital && this.autoplay) this.play();
        if (type === 'hello') this.#voiceInputs.linked();
        if (type === 'backdrop') this.#backdrop.told = detail.source;
        if (type === 'joined') this.#backdrop.told = null; // the room tells its own
        if (type === 'joined') this.#player.open(); // an announcer in the room must know beforehand whether it can be heard
        if (type === 'hello') {
          this.#blocked = false; // as the server takes it
          this.#tellSound(this.#player.sound);
        }
      },
      fail: (name, values) => this.#fail(name, values),
      show: (json) => this.#show(json),
      unfit: (error) => this.#unfit(error),
    });
    this.#reader = new Reader(this, {
      speak: (text, options) => this.speak(text, options),
      jump: (mark) => this.jump(mark),
      resume: () => this.#speech.paused && this.resume(),
      stop: () => this.stop(),
      running: (id) => this.#speech.running(id),
      emit: (type, detail) => this.#emit(type, detail),
      fail: (name, values) => this.#fail(name, values),
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
    if (name === 'for' && this.#opened) this.#followFor();
    if (name === 'backdrop') this.#backdrop.own = value;
    if (name === 'polite') {
      this.#speech.waits = this.polite;
      turns.next();
    }
    if (name === 'for' && before !== value) this.#reader.close();
    if (!this.#opened || before === value) return;
    if (LINK_ATTRIBUTES.includes(name)) this.#session.connectSoon();
    if (name === 'poster') this.#session.choosePoster();
    if (name === 'view') this.#viewChanged(before);
    if (name === 'quality') this.#presentation.stage.quality = value ?? 'auto';
    if (MODEL_ATTRIBUTES.includes(name)) this.#session.modelChanged();
    if (name === 'captions') this.#showCaptions();
    if (name === 'still' || name === 'turn') this.#presentation.motionChanged();
    if (name === 'partner' || name === 'persona') this.#presentation.seat.changed();
    if (name === 'life') this.#presentation.idleChanged();
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
    const promise = this.#speech.speak(text, this.#speakOptions(options));
    this.#presentation.wake();
    return promise;
  }

  /**
   * Speaks a text while it is written, after what is already queued.
   * @param {ReadableStream|AsyncIterable|null} [source] of strings or UTF-8, which writes it; without one, who calls does
   * @param {object} [options] as of `speak`
   * @returns {{write(text: string): void, flush(): void, close(): void, cancel(): void, done: Promise<object>}}
   */
  open(source = null, options = {}) {
    const writing = this.#speech.write(this.#speakOptions(options));
    this.#presentation.wake();
    if (source) writing.from(source).catch(() => {}); // what came before it broke is spoken
    return writing;
  }

  /**
   * Speaks the recording of `src`, from where it was paused, or from the time that was sought.
   * @returns {Promise<object>} as of `speak`
   */
  play() {
    this.#player.open(); // while the user's gesture counts
    if (this.#speech.paused) this.resume();
    this.#playing ??= this.#recite().finally(() => (this.#playing = null));
    return this.#playing;
  }

  async #recite() {
    const recital = await this.#session.recorded();
    if (!recital) return { type: 'end', reason: 'failed', code: 'no-recording', duration: 0 };
    const { lang } = recital.recording.events[0];
    const done = this.#speech.speak('', { recording: true, ...(lang && { lang }) });
    this.#presentation.wake();
    return done;
  }

  /** Goes to a time of the recording, or has the next `play` begin there. @param {number} seconds */
  seek(seconds) {
    this.#session.send({ type: 'seek', time: seconds });
    this.#presentation.wake();
  }

  /** The time of the recording that is heard, or where the next `play` begins, in seconds. */
  get currentTime() {
    const { recital } = this.#session;
    return this.#speech.heard(performance.now())?.seconds ?? recital?.start ?? 0;
  }

  /** Length of the recording in seconds; null: there is none, or it has not come. */
  get duration() {
    return this.#session.recital?.duration ?? null;
  }

  #speakOptions(options) {
    const defaults = {};
    for (const [name, { member, type }] of Object.entries(SPEAK_ATTRIBUTES))
      if (this.hasAttribute(name)) defaults[member] = type(this.getAttribute(name));
    if (this.#presentation.still) defaults.still = true;
    if (!defaults.voice && !options.voice) Object.assign(defaults, this.#session.voiceKind);
    return { ...defaults, ...options };
  }

  /**
   * Shows a head that the page has, in place of the server's, until the attribute `model` changes.
   * @param {object} json see protocol/head-model.md @returns {Promise<void>} when it is shown, or could not be (event `error`)
   */
  showHead(json) {
    this.#session.keepModel();
    return this.#show(json);
  }

  /**
   * Reads the element that `for` names aloud, and marks its words as they are heard.
   * @param {Range|StaticRange|Node} [from] where to start
   * @returns {Promise<{reason: string, code?: string}>} resolves after the last word, on stop, and on failure
   */
  read(from) {
    this.#player.open(); // while the user's gesture counts
    return this.#reader.read(from);
  }

  /**
   * Moves the lips to a live voice, without a text, until the stream ends or is stopped.
   * @param {MediaStream|MediaStreamTrack|null} [stream] of a call, for example; null: the user's microphone, which browsers
   *   grant after a user gesture only
   * @param {object} [options] members of the protocol's `voice` message; sound: false = muted on this page; codec: 'pcm'
   * @returns {{stop(): void, done: Promise<object>}} done: as the result of `speak`
   */
  listen(stream = null, options = {}) {
    this.#player.open(); // while the user's gesture counts
    return this.#voiceInputs.listen(stream, this.#speakOptions(options));
  }

  /**
   * Moves her lips to a sound of the page, whenever it plays. It is heard when they are seen, somewhat later.
   * @param {HTMLMediaElement} media @param {object} [options] as of `listen` @returns {{stop(): void}}
   */
  follow(media, options = {}) {
    return this.#voiceInputs.follow(media, this.#speakOptions(options));
  }

  /**
   * Opens the microphone for a server that recognises speech (`hello.hears`); the event `heard` has the words. The microphone
   * needs a user gesture; it is open until the hearing is stopped.
   * @param {object} [options] lang; stream: a MediaStream in place of the microphone; handsFree: any number of utterances, each
   *   found by its loudness; onset(): somebody begins to speak; noise(): dB by which they must be louder now; codec: 'pcm'
   * @returns {{stop(): void, stopAtSilence(): void, done: Promise<object|null>}} done: the last `heard`, if there was one
   */
  hear(options = {}) {
    this.#player.open(); // while the user's gesture counts
    this.#hearing?.stop();
    const hearing = new Hearing({
      send: (message) => this.#session.send(message),
      sendSound: (sound, bytes) => this.#session.sendSound(sound, bytes),
      on: (type, listener) => this.addEventListener(type, listener),
      off: (type, listener) => this.removeEventListener(type, listener),
      changed: (detail) => {
        if (hearing !== this.#hearing) return;
        this.#presentation.attend(detail.speaking);
        this.#emit('hearing', detail);
      },
      paused: () => this.#presentation.nod(),
    }, options);
    this.#hearing = hearing;
    return hearing;
  }

  /**
   * Words that the page has recognised itself, or that were typed: they can choose an offered answer, or answer a question.
   * @param {string} text @param {{id?: string, final?: boolean, lang?: string, confidence?: number}} [options]
   * @returns {boolean} as `offer`
   */
  said(text, { id = `said-${++said}`, ...options } = {}) {
    return this.#session.send({ ...options, type: 'said', id, text });
  }

  /**
   * Sends an observer the speech of the room's listeners (`overheard`), if they consent.
   * @param {boolean} [on] @returns {boolean} as `offer`
   */
  overhear(on = true) {
    return this.#session.send({ type: 'overhear', on });
  }

  /**
   * Drives the face of the room in real time; the event `driven` tells who does.
   * @param {{time: number, faps: Record<number, number>}[]|null} frames with the times of the page's clock, s; null: no longer
   * @returns {boolean} as `offer`
   */
  drive(frames) {
    return this.#session.send(frames ? { type: 'drive', frames } : { type: 'drive', on: false });
  }

  /**
   * Says a question, and waits for its answer: a choice, or words.
   * @param {string} text @param {object} [options] choices: texts; seconds: how long to wait (60); others as of `speak`
   * @returns {boolean} as `offer`; the event `answered` tells how it ends
   */
  ask(text, options = {}) {
    return this.#session.send({ ...options, type: 'ask', text });
  }

  /**
   * How all texts of the room are spoken, for who listens there: factors from 0.5 to 2.
   * @param {{speed?: number, pitch?: number, volume?: number}} manner @returns {boolean} as `offer`
   */
  setManner(manner = {}) {
    return this.#session.send({ ...manner, type: 'manner' });
  }

  /**
   * A picture or a film behind the face of all in the room.
   * @param {string} source its address; empty: none @returns {boolean} as `offer`
   */
  showBackdrop(source) {
    return this.#session.send({ type: 'backdrop', source });
  }

  #followFor() {
    this.#voiceInputs.name(this.for && this.ownerDocument.getElementById(this.for), () => this.#speakOptions({}));
  }

  /** Silence at once; what is queued is forgotten. */
  stop() {
    this.#speech.stop();
    this.#presentation.captions.clear();
    this.#presentation.wake();
  }

  /** Halts where it is, until `resume`; the face lives on. In a room, all are halted. */
  pause() {
    this.#speech.pause();
    this.#presentation.wake();
  }

  /** Goes on after a pause. */
  resume() {
    this.#speech.resume();
    this.#presentation.wake();
  }

  /** Goes on from a mark of what is spoken. @param {string} mark its name */
  jump(mark) {
    this.#speech.jump(mark);
  }

  /**
   * Holds the face in a pose, even during speech, until it is called with null.
   * @param {Record<number, number>|null} faps values by FAP number
   * @param {{ease?: boolean}} [options] ease: move there smoothly rather than at once
   */
  pose(faps, { ease = false } = {}) {
    this.#presentation.pose(faps, ease);
  }

  /**
   * The mood of the face, speaking or not, until the next call; over what markup asks for.
   * @param {{name: string, intensity?: number}[]|Record<string, number>|string} mix up to four affects of
   *   `hello.expressions`; nothing = neutral
   * @param {{ease?: number}} [options] seconds that the change takes (0.3)
   */
  express(mix, options) {
    this.#presentation.express(mix, options);
  }

  /**
   * Offers answers to the people in the room; the event `chosen` reports their choice. An empty list withdraws the offer.
   * @param {string[]} choices up to 8 @param {{id?: string, question?: string}} [options]
   * @returns {boolean} whether it could be sent
   */
  offer(choices, options = {}) {
    return this.#session.send({ ...options, type: 'choices', choices });
  }

  /** Answers. @param {number} choice from 0 @param {string} [id] of that @returns {boolean} see `offer` */
  choose(choice, id) {
    return this.#session.send({ type: 'choose', choice, ...(id === undefined ? {} : { id }) });
  }

  /**
   * Shows in the room what the assistant is doing.
   * @param {'idle'|'listening'|'thinking'|'muted'|'error'|'asleep'} state
   * @param {{text?: string, mix?: object, ease?: number}} [options] text: what it has heard, say; mix, ease: as `express`
   * @returns {boolean} as `offer`
   */
  tell(state, { mix, ...options } = {}) {
    return this.#session.send({ ...options, type: 'state', state, ...(mix === undefined ? {} : { mix: readMix(mix) }) });
  }

  /**
   * Has everybody who looks at the room see another head: the event `head` reports it, and the page sets `model`.
   * @param {string} name a head of the server; empty: each page's own @returns {boolean} as `offer`
   */
  showHeadAll(name) {
    return this.#session.send({ type: 'head', head: name });
  }

  /**
   * Asks the room's listeners to consent to being recorded in a study, or sends their answer. The event `consent` reports both.
   * @param {'asked'|'given'|'declined'|'none'} consent none: withdraws the question
   * @param {string} [text] the question, which says what is recorded and for whom @returns {boolean} as `offer`
   */
  consent(consent, text) {
    return this.#session.send({ type: 'consent', consent, ...(text ? { text } : {}) });
  }

  /**
   * Fits the head to the feature points of a person, even while it speaks.
   * @param {import('./talking-head.d.ts').Calibration|null} calibration null: restores the original head
   * @returns {Promise<void>} settles when it is drawn; rejects with the `place` of the error, and leaves the face unchanged
   */
  calibrate(calibration) {
    return this.#presentation.stage.calibrate(calibration);
  }

  /**
   * The same for all who hear this stream or room, and who come later: `calibrated` tells when it is drawn.
   * @param {import('./talking-head.d.ts').Calibration|null} calibration null: the head's own points
   * @returns {boolean} as `offer`
   */
  calibrateAll(calibration) {
    return this.#session.send({ type: 'calibrate', ...(calibration ?? { reset: true }) });
  }

  /** The face as it was drawn last: the FAPs that are not 0, by number. @returns {Record<number, number>} */
  get faps() {
    return this.#presentation.faps;
  }

  /**
   * The picture and the sound as tracks, to be recorded or sent on. The sound is that of all heads of the page; there is none
   * where the browser has no audio. A face that keeps still is sent once a second, for those who come later.
   * @param {number} fps at most @returns {MediaStream}
   */
  captureStream(fps = 25) {
    const stream = this.#controls.canvas.captureStream(fps);
    const kept = new WeakRef(stream.getVideoTracks()[0]);
    const beat = setInterval(() => {
      const track = kept.deref();
      if (track?.readyState === 'live') this.#presentation.stage.wake();
      else clearInterval(beat);
    }, BEAT_MS);
    for (const track of captureOutput()?.getTracks() ?? []) stream.addTrack(track);
    return stream;
  }

  /** Figures for tests and measurements, not for pages: they may change. Times in seconds of the utterance heard. */
  debug() {
    return {
      ...this.#presentation.debug(performance.now()),
      state: !this.#ready ? 'loading' : this.#speech.busy ? 'speaking' : 'idle',
      connection: this.#session.state,
      sound: this.#player.sound,
      sampleRate: this.#player.rate,
      underruns: this.#player.underruns,
    };
  }

  /** Returns the stage and the player, for measurements of single frames. */
  debugParts() {
    return { stage: this.#presentation.stage, player: this.#player };
  }

  #emit(type, detail) {
    if (PLAY_EVENTS.includes(type)) {
      const { recital } = this.#session;
      this.#controls.offerPlay(Boolean(recital?.recording), this.#speech.busy && !this.#speech.paused);
    }
    if (type === 'sentence') this.#presentation.seat.sentence(detail.text, performance.now());
    if (type === 'end' && !this.#speech.busy) this.#presentation.seat.sentence('', performance.now());
    this.dispatchEvent(new CustomEvent(type, { detail }));
  }

  /** Tells the page. @param {string} name of a message @param {object} [values] */
  #fail(name, values) {
    const code = name.replace(/[A-Z]/g, (letter) => `-${letter.toLowerCase()}`);
    const place = values?.byte === undefined ? {} : { byte: values.byte };
    this.#emit('error', { type: 'error', code, message: this.#controls.text(name, values), ...place });
  }

  #unfit({ place, message }) {
    this.#emit('error', { type: 'error', code: 'bad-calibration', message, ...(place ? { place } : {}) });
  }

  #pictureTrouble(name) {
    this.#controls.say('picture', name);
    if (name && name !== 'lost') this.#fail(name);
  }

  #soundChanged(sound, reason) {
    this.#controls.sound.hidden = sound !== 'blocked';
    this.#tellSound(sound);
    this.#emit('sound', { sound, ...(reason ? { reason } : {}) });
    this.#presentation.wake();
  }

  /** Tells the server whether the browser blocks the sound, so that speakers know that they are not heard. */
  #tellSound(sound) {
    const blocked = sound === 'blocked';
    if (blocked !== this.#blocked && this.#session.send({ type: 'media', blocked })) this.#blocked = blocked;
  }

  #express() {
    const mix = this.getAttribute('expression');
    if (mix !== null || this.#presentation.idle.mix.length) this.express(mix ?? []);
  }

  #translate() {
    this.#controls.translate(this.lang, this.getAttribute('label'), this.#title);
  }

  #showCaptions() {
    this.#presentation.captions.shown = this.captions;
    this.#controls.captions.setAttribute('aria-pressed', String(this.captions));
  }

  #switchMouth() {
    this.view = this.view === 'mouth' ? this.#wider : 'mouth';
  }

  /** @param {string|null} before the view that it had */
  #viewChanged(before) {
    const alone = this.view === 'mouth';
    if (alone) this.#wider = before;
    this.#controls.mouth.setAttribute('aria-pressed', String(alone));
    this.#presentation.stage.framing = this.view;
  }

  async #show(json) {
    try {
      const model = await this.#presentation.stage.show(json);
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

  #open() {
    this.#opened = true;
    this.#presentation.stage.quality = this.quality ?? 'auto';
    this.#viewChanged(this.#wider);
    this.#session.choosePoster();
    this.#presentation.open();
    this.#translate();
    this.#showCaptions();
    this.#express();
    this.#session.open();
    this.#followFor();
  }

  #close() {
    this.#opened = false;
    this.#reader.close();
    this.#voiceInputs.close();
    this.#hearing?.stop();
    this.#speech.stop();
    this.#session.close();
    this.#player.close();
    this.#presentation.close();
    this.#ready = false;
  }
}

addProperties(TalkingHead.prototype);
