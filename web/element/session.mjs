// SPDX-License-Identifier: MIT
import { AvatarSource } from './avatar/source.mjs';
import { canDecode } from './audio/opus.mjs';
import { Demuxer } from './stream/demuxer.mjs';
import { Fitting } from './head/model/fitting.mjs';
import { ModelSource } from './head/model/source.mjs';
import { isRecording, unpackHead } from './recording/source.mjs';
import { Recital } from './recording/recital.mjs';
import { Link } from './stream/link.mjs';
import { wantsPictures } from './pictures/choice.mjs';
import { PicturesSource } from './pictures/source.mjs';

/** Messages that are passed to the page unchanged. */
const TOLD = ['hello', 'joined', 'authorized', 'choices', 'chosen', 'asked', 'answered', 'heard', 'state', 'consent', 'observers', 'expressed', 'head', 'backdrop', 'overheard', 'driven'];
const MERELY = ['', 'on', 'true', 'yes'];

/** Joins a head to its server: the link, the messages that arrive, and the model that is requested. */
export class Session {
  #opened = false;
  #inPage; // resolves the next
  #begun = new Promise((resolve) => (this.#inPage = resolve));
  #loading = null; // promise, of a recording
  #reconnecting = false;
  #kept = false; // what is shown is not the server's
  #hello = null; // what the server has said of itself
  #online = () => this.#link.hurry();

  #stream = new Link({
    source: () => ({ src: this.element.src, token: this.element.token, room: this.element.room }),
    onstate: (state) => this.#stateChanged(state),
    onmessage: (message) => this.#demuxer.text(message),
    onmedia: (data) => this.#demuxer.binary(data),
    ontrouble: (name, values, told) => this.#linkTrouble(name, values, told),
  });

  #recital = new Recital({
    source: () => ({ src: this.element.src, audio: this.element.audio }),
    onstate: (state) => this.#stateChanged(state),
    onmessage: (message) => this.#message(message),
    onmedia: (chunk) => this.#media(chunk),
    ontrouble: (name, values) => this.#linkTrouble(name, values),
    heard: () => this.speech.heard(performance.now())?.seconds ?? null,
  });

  #link = this.#stream; // or the recital

  #demuxer = new Demuxer({
    hear: (message) => this.#message(message),
    media: (chunk) => this.#media(chunk),
    mute: (error) => this.#wantPlainSound(error),
  });

  #models = new ModelSource({
    ask: (message) => this.#link.send(message),
    progress: (detail) => this.ports.emit('progress', detail),
    show: (json) => this.ports.show(json),
    fail: () => this.#modelMissing(),
  });

  #avatars = new AvatarSource({
    progress: (detail) => this.ports.emit('progress', detail),
    show: (model) => this.ports.show(model),
    fail: (reason, message) => this.#ownFailed({ code: 'bad-avatar', reason, message }),
  });

  #pictures = new PicturesSource({
    progress: (detail) => this.ports.emit('progress', detail),
    show: (set) => this.ports.show(set),
    fail: (message) => this.#ownFailed({ code: 'bad-pictures', message }),
  });

  #fitting = new Fitting({
    calibrate: (calibration) => this.presentation.stage.calibrate(calibration, 'server'),
    fitted: (message) => this.ports.emit('calibrated', message),
    unfit: (error) => this.ports.unfit(error),
  });

  /**
   * @param {HTMLElement} element whose src, room, token, model and poster say what is wanted
   * @param {object} parts controls, poster, speech and presentation of the element
   * @param {object} ports emit(type, detail): an event of the element; fail(name, values): an error by the name of its message;
   *   show(json): the model has come; unfit(error): a calibration does not fit it
   */
  constructor(element, { controls, poster, speech, presentation }, ports) {
    this.element = element;
    this.controls = controls;
    this.poster = poster;
    this.speech = speech;
    this.presentation = presentation;
    this.ports = ports;
  }

  open() {
    this.#opened = true;
    this.#inPage();
    addEventListener('online', this.#online);
    this.#openOwn();
    this.#connect();
  }

  close() {
    this.#opened = false;
    removeEventListener('online', this.#online);
    this.#avatars.close();
    this.#pictures.close();
    this.#disconnect();
  }

  get state() {
    return this.#link.state;
  }

  /** What speaks the recording of `src`; null: `src` is a stream. */
  get recital() {
    return this.#link === this.#recital ? this.#recital : null;
  }

  /** @returns {Promise<Recital|null>} when the recording is here; null: it cannot be spoken, or there is none */
  async recorded() {
    await this.#begun;
    while (this.#reconnecting) await null;
    await this.#loading;
    return this.state === 'open' ? this.recital : null;
  }

  /** @returns {boolean} whether it could be sent */
  send(message) {
    return this.#link.send(message);
  }

  /** @param {Int16Array} samples of a voice @returns {boolean} whether they could be sent */
  sendSound(sound, bytes) {
    return this.#link.sendSound(sound, bytes);
  }

  /** Connects anew; once for all attributes that are changed together. */
  connectSoon() {
    if (this.#reconnecting) return;
    this.#reconnecting = true;
    queueMicrotask(() => {
      this.#reconnecting = false;
      if (this.#opened) this.#connect();
    });
  }

  /** The page has brought a model: the server's are not wanted. */
  keepModel() {
    this.#kept = true;
    this.#models.close();
  }

  /** Another model is wanted, or the same in another way. */
  modelChanged() {
    this.#kept = false;
    this.#openOwn();
    if (this.state === 'open') this.#openModel();
    this.choosePoster();
  }

  choosePoster() {
    let stream = null;
    try {
      stream = this.recital ? null : this.#stream.address;
    } catch {
      // says the link
    }
    this.poster.choose(this.element.poster, stream, this.#own ? {} : this.#model);
  }

  /** The kind of voice that suits the head, where none is named: members of speak. */
  get voiceKind() {
    const { gender, pitch } = this.#model.voice ?? {};
    return { ...(gender ? { gender } : {}), ...(pitch ? { pitch } : {}) };
  }

  /** The server's description of the requested head. */
  get #model() {
    const { model } = this.element;
    const { models = [] } = this.#hello ?? {};
    return (model === null ? models[0] : models.find(({ name }) => name === model)) ?? (model === null ? {} : { name: model });
  }

  #connect() {
    this.#disconnect();
    this.controls.say('model', null);
    this.#link = isRecording(this.element.src, document.baseURI) ? this.#recital : this.#stream;
    this.speech.recorded = Boolean(this.recital);
    this.#loading = this.#link.open();
  }

  #disconnect() {
    this.#models.close();
    this.#link.close();
    this.#demuxer.reset();
  }

  #linkTrouble(name, values, told) {
    this.controls.say('link', name, values);
    if (name && !told) this.ports.fail(name, values);
  }

  /** Requests PCM when no decoder exists, or it failed. */
  #wantPlainSound(error) {
    console.warn('talking-head: Opus cannot be decoded here', error ?? '');
    this.#link.send({ type: 'media', audio: 'pcm_s16le' });
  }

  #stateChanged({ state, hello, retryIn }) {
    this.ports.emit('connection', { state, ...(retryIn === undefined ? {} : { retryIn }) });
    if (state === 'open') {
      this.#fitting.begin();
      this.#enter();
      this.speech.linked();
      this.presentation.idle.linked();
      this.#hello = hello;
      this.#openModel();
      this.choosePoster();
      canDecode().then((can) => can || this.#wantPlainSound());
    } else {
      this.#demuxer.reset();
      this.speech.unlinked();
      this.presentation.idle.unlinked();
    }
    this.presentation.wake();
  }

  /** Says who we are, and goes where we belong. */
  #enter() {
    const { token, room, watch } = this.element;
    const as = watch && this.element.getAttribute('watch').trim(); // name that other observers see
    this.speech.adopts = Boolean(room) && !this.recital;
    if (token) this.#link.send({ type: 'authorize', token });
    if (room) this.#link.send({ type: 'join', room, ...(watch && { watch }), ...(as && !MERELY.includes(as.toLowerCase()) && { as: [...as].slice(0, 16).join('') }) });
  }

  /** Shows the page's own avatar or pictures in place of the server's head, where they can be drawn. */
  #openOwn() {
    const { avatar, avatarMap, pictures, quality } = this.element;
    const drawn = !wantsPictures(quality);
    this.#avatars.open(drawn ? avatar : null, avatarMap);
    this.#pictures.open(drawn ? null : pictures);
    if (this.#own) this.#models.close();
  }

  get #own() {
    return this.#avatars.there || this.#pictures.there;
  }

  /** The server's head stands in. */
  #ownFailed(detail) {
    this.ports.emit('error', { type: 'error', ...detail });
    this.modelChanged();
  }

  #openModel() {
    if (this.#kept || this.#own) return;
    const { model, quality } = this.element;
    if (this.recital) this.#openRecorded(model, this.recital.recording);
    else if (model === null && !this.#hello.models?.length) this.#modelMissing();
    else this.#models.open(this.#link.address, this.#hello, model, wantsPictures(quality));
  }

  /** The page's head, whose address `model` then is, goes before that of the recording. */
  async #openRecorded(model, recording) {
    const address = model === null ? recording.model : new URL(model, document.baseURI).href;
    if (model !== null || !recording.head) {
      if (address) this.#models.load(address);
      else this.#modelMissing();
      return;
    }
    const json = await unpackHead(recording.head).catch((error) => console.error('talking-head:', error));
    if (this.recital?.recording !== recording || this.element.model !== null || this.#kept || this.#own) return;
    if (json) this.ports.show(json);
    else this.#modelMissing();
  }

  #modelMissing() {
    this.controls.say('model', 'noModel');
    this.ports.fail('noModel');
  }

  #media(chunk) {
    this.speech.media(chunk);
    this.presentation.changed();
  }

  #message(message) {
    if (message.type === 'model') this.#models.take(message);
    else if (message.type === 'calibrated') this.#fitting.take(message);
    else {
      this.speech.hear(message);
      if (message.type === 'expressed') this.presentation.idle.heard(message.mix);
      if (TOLD.includes(message.type)) this.ports.emit(message.type, message);
      this.presentation.wake();
    }
  }
}
