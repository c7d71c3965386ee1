// SPDX-License-Identifier: MIT
// Voices of the page that the head speaks with: a microphone, a track of a call, the page's own sound.
import { Capture } from '../audio/capture.mjs';
import { voiceCodec } from '../audio/voice-coder.mjs';
import { GivenCaptions } from '../captions/captions.mjs';
import { acquireContext, releaseContext } from '../audio/shared-context.mjs';

const sources = new WeakMap(); // media element -> {context, node}: there can be but one for each

/** Opens the microphone, after a user gesture only: a prompt must not come as a surprise. */
export async function microphone() {
  if (navigator.userActivation?.isActive === false)
    throw new globalThis.DOMException('The microphone is asked for when the user does something.', 'NotAllowedError');
  if (!navigator.mediaDevices) throw new globalThis.DOMException('The page has no microphones.', 'NotSupportedError');
  return navigator.mediaDevices.getUserMedia({ audio: { echoCancellation: true, channelCount: 1 } });
}

/** Returns the current captions of a media element: the active cues of its enabled `<track>`s. */
function cuesOf(media) {
  const tracks = [...(media.textTracks ?? [])].filter((track) => track.mode !== 'disabled' && ['captions', 'subtitles'].includes(track.kind));
  return tracks.flatMap((track) => [...(track.activeCues ?? [])].map((cue) => (cue.text ?? '').replace(/<[^>]*>/g, ''))).join(' ');
}

/** A stream that the head lends its lips to, until it ends. */
export class Listening {
  #captions = new GivenCaptions();
  #capture = null;
  #voice = null;
  #stopped = false;

  /** @type {Promise<object>} the `end` message of the voice */
  done;

  /**
   * @param {object} ports speak(options) -> OwnVoice
   * @param {MediaStream|MediaStreamTrack|null} source null: the user's microphone
   * @param {object} options of `listen`
   */
  constructor(ports, source, options) {
    this.done = this.#run(ports, source, options);
    this.done.catch(() => {}); // callers handle it themselves
  }

  /** @param {string|null} text being said, from a recogniser for example: the only source of captions */
  caption(text) {
    this.#captions.give(text);
  }

  stop() {
    this.#stopped = true;
    this.#voice?.close();
    this.#capture?.close();
  }

  async #run(ports, source, options) {
    const own = source ? null : await microphone();
    const tracks = source instanceof globalThis.MediaStreamTrack ? [source] : (source ?? own).getAudioTracks();
    const context = acquireContext();
    const over = () => this.stop();
    try {
      if (!context || !tracks.length) throw new globalThis.DOMException('There is no sound in that.', 'NotSupportedError');
      const node = context.createMediaStreamSource(new globalThis.MediaStream(tracks));
      const capture = await Capture.open(node, (samples) => this.#voice?.write(samples));
      this.#capture = capture;
      for (const track of tracks) track.addEventListener('ended', over);
      const codec = await voiceCodec(options.codec);
      if (this.#stopped) throw new globalThis.DOMException('It was stopped.', 'AbortError');
      this.#voice = ports.speak({ ...options, codec, captions: this.#captions });
      return await this.#voice.done;
    } finally {
      this.#capture?.close();
      for (const track of tracks) track.removeEventListener('ended', over);
      own?.getTracks().forEach((track) => track.stop());
      if (context) releaseContext();
    }
  }
}

/**
 * A media element that the head lip-syncs. Its sound goes to the server, returns with the face, and is played then, so that
 * lips and sound agree at the cost of latency. On failure the element plays its own sound.
 */
export class Following {
  #voice = null;
  #capture = null;
  #context = null;
  #node = null;
  #closed = false;
  #asking = false;

  /** @param {object} ports as of Listening @param {HTMLMediaElement} media @param {object} options of `follow` */
  constructor(ports, media, options) {
    this.ports = ports;
    this.media = media;
    this.options = options;
    this.captions = new GivenCaptions(() => cuesOf(media));
    for (const type of ['play', 'playing']) media.addEventListener(type, this.#begin);
    for (const type of ['pause', 'ended']) media.addEventListener(type, this.#end);
    if (!media.paused) this.#begin();
  }

  /** @param {string|null} text in place of what the sound's `<track>`s say; null: those again */
  caption(text) {
    this.captions.give(text);
  }

  stop() {
    this.#closed = true;
    for (const type of ['play', 'playing']) this.media.removeEventListener(type, this.#begin);
    for (const type of ['pause', 'ended']) this.media.removeEventListener(type, this.#end);
    this.#end();
    this.#aloud(true);
    this.#capture?.close();
    this.#capture = null;
    if (this.#context) releaseContext();
    this.#context = null;
  }

  /** There is a connection (again). */
  linked() {
    if (!this.media.paused) this.#begin();
  }

  #begin = async () => {
    if (this.#voice || this.#closed || this.#asking) return;
    this.#asking = true;
    const codec = await voiceCodec(this.options.codec);
    this.#asking = false;
    if (this.#closed || this.media.paused) return;
    const voice = this.ports.speak({ ...this.options, codec, captions: this.captions });
    this.#voice = voice;
    try {
      await this.#open();
      this.#aloud(false);
      await voice.done;
    } catch (error) {
      voice.cancel();
      this.ports.fail(error);
    }
    if (this.#voice !== voice) return;
    this.#voice = null; // connection lost or speech stopped: the element plays its own sound again
    this.#aloud(true);
  };

  #end = () => {
    const voice = this.#voice;
    this.#voice = null;
    voice?.close();
  };

  async #open() {
    if (this.#capture) return;
    this.#context ??= acquireContext();
    if (!sources.has(this.media)) sources.set(this.media, this.#context.createMediaElementSource(this.media));
    this.#node = sources.get(this.media);
    this.#aloud(true);
    this.#capture = await Capture.open(this.#node, (samples) => this.#voice?.write(samples));
  }

  /** Switches the element's own sound on or off. */
  #aloud(on) {
    if (!this.#node) return;
    const { destination } = this.#node.context;
    if (on) this.#node.connect(destination);
    else
      try {
        this.#node.disconnect(destination);
      } catch {
        // it was not connected
      }
  }
}
