// SPDX-License-Identifier: MIT
// Types of talking-head.js, for editors and TypeScript.

/** A mixture of affects: by name, as a list, or as text ("joy 0.6, surprise 0.2"). */
export type Expression = Record<string, number> | { name: string; intensity?: number }[] | string | null;

/** What the assistant behind the face is doing. */
export type AssistantState = 'idle' | 'listening' | 'thinking' | 'muted' | 'asleep';

export type Consent = 'asked' | 'given' | 'declined' | 'none';

/** Of a voice without a text: see the protocol's `voice`. */
export interface ListenOptions {
  // <voice options: made by protocol/make-messages.py>
  /** The client's name for the utterance; comes back in every message about it. At most 64 bytes. */
  id?: string;
  /** What is heard after a moment before it is shown, ms. */
  lookahead?: 0 | 40 | 80 | 120;
  /** Whose lips. When left out: hello.lang. */
  lang?: string;
  /** network: the mouth is told from the sound itself; or one of hello.engines, which makes it of the sounds that were heard. At most 64 bytes. */
  engine?: string;
  /** FAP frames per second. */
  fps?: number;
  /** Strength of the signs of life. */
  life?: number;
  /** Only the lips move, without life and expressions. */
  still?: boolean;
  /** When it is spoken. queue: after all that waits; replace: at once, and all else is forgotten; interrupt: at once; what speaks is cut, what waits comes afterwards; quiet: only when nothing speaks or waits, else it is refused. */
  mode?: 'queue' | 'replace' | 'interrupt' | 'quiet';
  /** Of two, the higher one comes first and cuts the lower one. */
  priority?: 'background' | 'chat' | 'alarm';
  /** What it is about: takes the place of those that wait with the same. At most 64 bytes. */
  topic?: string;
  // </voice options>
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

/** Members of the protocol's `speak`. */
export interface SpeakOptions {
  // <speak options: made by protocol/make-messages.py>
  /** The id of a passage of the library, to be spoken instead of a text. At most 128 bytes. */
  passage?: string;
  /** UTF-16 units of the passage that are left out. */
  from?: number;
  /** The stretches of a plain text that are in other languages: "START-END:LANG", in UTF-16 units, parted by spaces, such as "6-18:la 30-41:fr". Of a passage: the library knows. */
  languages?: string;
  /** The client's name for the utterance; comes back in every message about it. At most 64 bytes. */
  id?: string;
  /** A tag of hello.languages or hello.more_languages (BCP 47, such as pt-BR), or a POSIX locale that names one (it_IT.UTF-8). When left out: what the root element of markup says, else hello.lang. */
  lang?: string;
  /** An id of /v1/voices. At most 128 bytes. When left out: the first of the language. */
  voice?: string;
  /** Of the voice, where none is named. */
  gender?: 'any' | 'female' | 'male';
  /** What makes the movements of the mouth: one of hello.engines, if the language has it (hello.languages). At most 64 bytes. */
  engine?: string;
  /** What the text is; auto: found from the text. */
  markup?: 'auto' | 'plain' | 'apml' | 'jsml' | 'ssml' | 'emotionml' | 'bml' | 'fml';
  /** Words per minute. When left out: the voice's own. */
  rate?: number;
  /** A factor of the voice's own pitch. */
  pitch?: number;
  /** A factor of the voice's own loudness. */
  volume?: number;
  /** FAP frames per second. */
  fps?: number;
  /** For an exactly repeatable face: the same number gives the same one. */
  seed?: number;
  /** Strength of the signs of life. */
  life?: number;
  /** How expressions share the mouth with speech; auto: weighted where the text names a weight, else regions. */
  blend?: 'auto' | 'regions' | 'weighted';
  /** Whether lips that must touch do so whatever the engine makes; engine: as the engine has it. */
  contacts?: 'engine' | 'on' | 'off';
  /** Whether numbers, signs and short forms are put into words before the voice sees the text, and Markdown and emoji of a plain text are left out. */
  normalize?: 'on' | 'off';
  /** How the lines of a plain text that end without punctuation are read. run-on: only where punctuation asks for a pause; pause: a comma's worth at each line's end. */
  verse?: 'run-on' | 'pause';
  /** When it is spoken. queue: after all that waits; replace: at once, and all else is forgotten; interrupt: at once; what speaks is cut, what waits comes afterwards; quiet: only when nothing speaks or waits, else it is refused. */
  mode?: 'queue' | 'replace' | 'interrupt' | 'quiet';
  /** Of two, the higher one comes first and cuts the lower one. */
  priority?: 'background' | 'chat' | 'alarm';
  /** What it is about: takes the place of those that wait with the same. At most 64 bytes. */
  topic?: string;
  /** What is lost with the daemon that was to speak it, where several share the room, is asked of the next one. */
  again?: boolean;
  /** Its phones are events, too. */
  phones?: boolean;
  /** Only the lips move, without life and expressions. */
  still?: boolean;
  // </speak options>
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
  // <speak attributes: made by protocol/make-messages.py>
  lang?: string;
  voice?: string | null;
  markup?: 'auto' | 'plain' | 'apml' | 'jsml' | 'ssml' | 'emotionml' | 'bml' | 'fml' | null;
  rate?: number | string | null;
  life?: number | string | null;
  blend?: 'auto' | 'regions' | 'weighted' | null;
  contacts?: 'engine' | 'on' | 'off' | null;
  normalization?: 'on' | 'off' | null;
  verse?: 'run-on' | 'pause' | null;
  // </speak attributes>
  label?: string | null;
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
  // <speak properties: made by protocol/make-messages.py>
  voice: string | null;
  markup: 'auto' | 'plain' | 'apml' | 'jsml' | 'ssml' | 'emotionml' | 'bml' | 'fml' | null;
  rate: number | null;
  life: number | null;
  blend: 'auto' | 'regions' | 'weighted' | null;
  contacts: 'engine' | 'on' | 'off' | null;
  normalization: 'on' | 'off' | null;
  verse: 'run-on' | 'pause' | null;
  // </speak properties>
  label: string | null;
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
