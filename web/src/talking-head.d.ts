// SPDX-License-Identifier: MIT
// Types of talking-head.js, for editors and TypeScript.

/** A mixture of affects: by name, as a list, or as text ("joy 0.6, surprise 0.2"). */
export type Expression = Record<string, number> | { name: string; intensity?: number }[] | string | null;

/** What the assistant behind the face is doing. */
export type AssistantState = 'idle' | 'listening' | 'thinking' | 'muted' | 'asleep';

export type Consent = 'asked' | 'given' | 'declined' | 'none';

/** Of a voice without a text: see the protocol's `voice`. */
export interface ListenOptions {
  lang?: string;
  engine?: string;
  fps?: number;
  life?: number;
  still?: boolean;
  /** What is heard after a moment before it is shown, ms. */
  lookahead?: 0 | 40 | 80 | 120;
  mode?: 'queue' | 'replace' | 'interrupt' | 'quiet';
  priority?: 'background' | 'chat' | 'alarm';
  topic?: string;
  id?: string;
  /** false: it is seen here, and not heard. */
  sound?: boolean;
  /** How the sound goes to the server: Opus where the browser codes it (left out), else PCM. */
  codec?: 'opus' | 'pcm';
}

export interface Listening {
  stop(): void;
  /** Shown under her until the next; a recogniser's words, say. */
  caption(text: string | null): void;
  /** As of `speak`; fails where there is no microphone, or it is refused. */
  done: Promise<EndMessage>;
}

export interface SpeakOptions {
  id?: string;
  mode?: 'queue' | 'replace' | 'interrupt' | 'quiet';
  /** What goes before what: `chat` when left out. */
  priority?: 'background' | 'chat' | 'alarm';
  /** Takes the place of those that wait with the same. */
  topic?: string;
  lang?: string;
  voice?: string;
  gender?: 'any' | 'female' | 'male';
  rate?: number;
  pitch?: number;
  volume?: number;
  engine?: string;
  markup?: string;
  life?: number;
  blend?: string;
  contacts?: 'engine' | 'on' | 'off';
  /** Off: numbers, signs and short forms are left to the voice. */
  normalize?: 'on' | 'off';
  fps?: number;
  still?: boolean;
  seed?: number;
  phones?: boolean;
  again?: boolean;
}

/** Feature points by MPEG-4's numbers ("8.4"): mm in the head's axes; places on the texture from 0 to 1. */
export interface Calibration {
  featurePointsCoord: Record<string, [number, number, number]>;
  textureCoord?: Record<string, [number, number]>;
  texture?: { type: 'image/png' | 'image/jpeg' | 'image/webp'; data: string };
}

export interface MediaDetail {
  type: 'media';
  utterance: number;
  id?: string;
  fps: number;
  /** Number of the first frame, from 0; FAP values by their number, 1 to 68. */
  firstFrame: number;
  frames: Int32Array[];
  /** Sample of the utterance at `rate` (Hz) where the sound begins; null: silent, or it could not be decoded. */
  start: number;
  rate: number;
  audio: Int16Array | Float32Array | null;
}

export interface EndMessage {
  type: 'end';
  reason: 'done' | 'stopped' | 'failed';
  /** Seconds of speech. */
  duration?: number;
  code?: string;
  id?: string;
  /** Why nobody heard it, if so. */
  sound?: 'blocked' | 'none';
}

export interface ReadResult {
  reason: 'done' | 'stopped' | 'failed';
  code?: string;
}

interface Message {
  type: string;
  id?: string;
  [member: string]: unknown;
}

interface TimedMessage extends Message {
  /** Seconds from the utterance's beginning. */
  time: number;
  text: string;
}

export interface TalkingHeadEventMap {
  progress: CustomEvent<{ loaded: number; total: number | null; ratio: number | null }>;
  ready: CustomEvent<{ model: string; title: string; credits: string[] }>;
  connection: CustomEvent<{ state: 'connecting' | 'open' | 'waiting' | 'closed'; retryIn?: number }>;
  hello: CustomEvent<Message>;
  joined: CustomEvent<Message>;
  authorized: CustomEvent<Message>;
  choices: CustomEvent<{ type: 'choices'; stream: string; id?: string; question?: string; choices: string[] }>;
  chosen: CustomEvent<{ type: 'chosen'; stream: string; id?: string; choice: number; text: string; by: string }>;
  expressed: CustomEvent<{ type: 'expressed'; stream: string; mix: { name: string; intensity: number }[]; by?: string }>;
  consent: CustomEvent<{ type: 'consent'; stream: string; consent: Consent; text?: string; by: string }>;
  desks: CustomEvent<{ type: 'desks'; stream: string; desks: { name: string; speaks: boolean }[]; count: number }>;
  calibrated: CustomEvent<{ type: 'calibrated'; stream: string; reset?: true } & Partial<Calibration>>;
  state: CustomEvent<{ type: 'state'; stream: string; state: AssistantState; text?: string }>;
  begin: CustomEvent<Message>;
  sentence: CustomEvent<TimedMessage>;
  word: CustomEvent<TimedMessage>;
  phone: CustomEvent<Message>;
  mark: CustomEvent<Message>;
  /** What has come of an utterance, before it is heard; not to be changed. */
  media: CustomEvent<MediaDetail>;
  end: CustomEvent<EndMessage>;
  paused: CustomEvent<Message>;
  resumed: CustomEvent<Message>;
  jumped: CustomEvent<Message>;
  error: CustomEvent<{
    type: 'error';
    code: string;
    message: string;
    id?: string;
    /** Of `bad-calibration`: what of it is wrong. */
    place?: string;
    /** Of `bad-avatar`. */
    reason?: 'missing' | 'too-large' | 'not-glb' | 'damaged' | 'unsupported' | 'no-face' | 'bad-map' | 'no-script';
  }>;
  /** Of `read`: a word of the page is heard. */
  reading: CustomEvent<{ range: Range; text: string; lang: string; sentence: number; sentences: number }>;
  read: CustomEvent<ReadResult>;
  warning: CustomEvent<{ type: 'warning'; code: string; message: string; id?: string }>;
  sound: CustomEvent<{ sound: 'on' | 'blocked' | 'none'; reason?: 'autoplay' | 'no-audio' | 'no-device' | 'no-worklet' }>;
}

type AllEvents = Omit<HTMLElementEventMap, keyof TalkingHeadEventMap> & TalkingHeadEventMap;

/** What the event carries. */
export type TalkingHeadEvent<K extends keyof TalkingHeadEventMap> = TalkingHeadEventMap[K];

/** What a template of a framework may set: attributes' values, or properties. */
export interface TalkingHeadAttributes {
  src?: string | null;
  for?: string | null;
  model?: string | null;
  avatar?: string | null;
  'avatar-map'?: string | null;
  pictures?: string | null;
  poster?: string | null;
  view?: 'face' | 'bust' | 'mouth' | null;
  quality?: 'auto' | 'high' | 'low' | 'pictures' | null;
  room?: string | null;
  /** Only looks on; a text that is neither on nor off is the name by which others who look on know it. */
  watch?: boolean | string | null;
  token?: string | null;
  voice?: string | null;
  markup?: string | null;
  blend?: string | null;
  contacts?: 'engine' | 'on' | 'off' | null;
  normalize?: 'on' | 'off' | null;
  label?: string | null;
  lang?: string;
  rate?: number | string | null;
  life?: number | string | null;
  'caption-size'?: 'large' | 'larger' | 'largest' | null;
  'caption-colours'?: 'contrast' | 'light' | 'yellow' | null;
  captions?: boolean | 'on' | 'off' | null;
  polite?: boolean | 'on' | 'off' | null;
  still?: boolean | 'on' | 'off' | null;
  turn?: boolean | 'on' | 'off' | null;
  expression?: Expression;
}

/** The events, as React and Svelte name them: `onword`. */
export type TalkingHeadHandlers = { [K in keyof TalkingHeadEventMap as `on${K}`]?: (event: TalkingHeadEventMap[K]) => void };

/** A text that is spoken while it is written. */
export interface Writing {
  write(text: string): void;
  flush(): void;
  close(): void;
  cancel(): void;
  readonly done: Promise<EndMessage>;
}

export class TalkingHead extends HTMLElement {
  src: string | null;
  /** What is read: an id, or a selector. */
  for: string | null;
  model: string | null;
  avatar: string | null;
  avatarMap: string | null;
  /** The address of a set of pictures, shown in place of the head's where pictures are. */
  pictures: string | null;
  poster: string | null;
  view: 'face' | 'bust' | 'mouth' | null;
  quality: 'auto' | 'high' | 'low' | 'pictures' | null;
  room: string | null;
  /** Only to look on in the room: one does not count as a listener. */
  watch: boolean;
  token: string | null;
  voice: string | null;
  markup: string | null;
  blend: string | null;
  contacts: string | null;
  normalize: string | null;
  label: string | null;
  rate: number | null;
  life: number | null;
  captionSize: 'large' | 'larger' | 'largest' | null;
  captionColours: 'contrast' | 'light' | 'yellow' | null;
  get captions(): boolean;
  set captions(on: boolean | string | null | undefined);
  get polite(): boolean;
  set polite(on: boolean | string | null | undefined);
  get still(): boolean | null;
  set still(on: boolean | string | null | undefined);
  get turn(): boolean | null;
  set turn(on: boolean | string | null | undefined);
  get expression(): { name: string; intensity: number }[];
  set expression(mix: Expression | undefined);
  readonly faps: Record<number, number>;

  speak(text: string, options?: SpeakOptions): Promise<EndMessage>;
  showHead(json: object): Promise<void>;
  read(from?: Range | StaticRange | Node): Promise<ReadResult>;
  open(source?: ReadableStream<string | Uint8Array> | AsyncIterable<string | Uint8Array> | null, options?: SpeakOptions): Writing;
  /** Without a stream: the user's microphone, only while the user does something. */
  listen(stream?: MediaStream | MediaStreamTrack | null, options?: ListenOptions): Listening;
  follow(media: HTMLMediaElement, options?: ListenOptions): Omit<Listening, 'done'>;
  stop(): void;
  pause(): void;
  resume(): void;
  jump(mark: string): void;
  /** Rejects with an error whose `place` says what is wrong; the face then stays as it was. */
  calibrate(calibration: Calibration | null): Promise<void>;
  /** For all who hear this stream or room; null: the head's own points. */
  calibrateAll(calibration: Calibration | null): boolean;
  pose(faps: Record<number, number> | null, options?: { ease?: boolean }): void;
  express(mix: Expression, options?: { ease?: number }): void;
  offer(choices: string[], options?: { id?: string; question?: string }): boolean;
  choose(choice: number, id?: string): boolean;
  consent(consent: Consent, text?: string): boolean;
  tell(state: AssistantState, options?: { text?: string; mix?: Expression; ease?: number }): boolean;

  addEventListener<K extends keyof AllEvents>(
    type: K,
    listener: (this: TalkingHead, event: AllEvents[K]) => unknown,
    options?: boolean | AddEventListenerOptions,
  ): void;
  addEventListener(type: string, listener: EventListenerOrEventListenerObject, options?: boolean | AddEventListenerOptions): void;
  removeEventListener<K extends keyof AllEvents>(
    type: K,
    listener: (this: TalkingHead, event: AllEvents[K]) => unknown,
    options?: boolean | EventListenerOptions,
  ): void;
  removeEventListener(type: string, listener: EventListenerOrEventListenerObject, options?: boolean | EventListenerOptions): void;
}

/**
 * Where the files lie that are fetched when they are needed (`talking-head-worklet.js`, `opus-decoder.js`,
 * `talking-head-avatar.js`): for pages that bundle the script and serve those from elsewhere than beside it.
 */
export function setCompanions(address: string | URL): void;

declare global {
  interface HTMLElementTagNameMap {
    'talking-head': TalkingHead;
  }
}
