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
  /** The work of the library that the text is from, by its id or that of a passage of it: its lexicon and the library's hold, as for a passage. At most 128 bytes. */
  work?: string;
  /** How words of the text are said: a document of the W3C's Pronunciation Lexicon Specification, which goes before all other lexicons. At most 65536 bytes. When left out: those of the work, the library, the room and the daemon only. */
  lexicon?: string;
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

// <server messages: made by protocol/make-messages.py>
/** What the server offers, at once after the upgrade. */
export interface ServerHello {
  type: 'hello';
  /** The version of the protocol. */
  protocol: 1;
  /** Name and version. */
  server: string;
  /** This connection's name. */
  stream: string;
  /** The default frame rate. */
  fps: number;
  /** The default language. */
  lang: string;
  /** The codecs of sound on offer. */
  audio: string[];
  /** The codecs of FAPs on offer. */
  fap: string[];
  /** How events can come. */
  events: string[];
  /** Samples at 48 kHz that an Opus decoder drops at an utterance's beginning. */
  opus_skip: number;
  /** Whether tokens are demanded. */
  tokens: boolean;
  /** Languages with a speech pack: tag, name, and the engines that speak it. */
  languages: { tag: string; name: string; engines: string[] }[];
  /** Tags of the further languages that voices speak; their lips follow the International Phonetic Alphabet. */
  more_languages: string[];
  /** What can make the movements of the mouth. */
  engines: string[];
  /** The affects that express takes. */
  expressions: string[];
  /** The heads: name, title, hash and bytes; about in a few words; voice the kind of voice that suits it, members of speak; poster the address of its neutral picture, pictures that of a set of them, from /v1/ on. */
  models: { name: string; title: string; hash: string; bytes: number; about?: string; voice?: { gender?: 'female' | 'male'; pitch?: number }; poster?: string; pictures?: string }[];
  /** What a client may ask for at most. */
  limits: Record<'text_bytes' | 'message_bytes' | 'queue' | 'open' | 'connections' | 'rooms' | 'play_bytes', number>;
}
/** An utterance begins: sent before its first chunk. */
export interface ServerBegin {
  type: 'begin';
  /** The name of the stream: of hello, or of the room. */
  stream: string;
  /** Its number on the stream. */
  utterance: number;
  /** The client's name for it, if it gave one. At most 64 bytes. */
  id?: string;
  /** Sample rate, Hz. */
  rate: number;
  /** FAP frames per second. */
  fps: number;
  /** The voice's id; not of a recording or somebody's own voice. */
  voice?: string;
  /** The language; not of a recording. */
  lang?: string;
  /** What makes the movements of the mouth; not of a recording. */
  engine?: string;
  /** What the text is, or was found to be; not of a recording or somebody's own voice. */
  markup?: string;
  /** The name of a recording, in place of voice, lang, engine and markup. */
  play?: string;
  /** Another daemon speaks it again when the one that speaks is lost. */
  again?: true;
  /** Of somebody's own voice: what is heard after a moment before it is shown, ms. */
  lookahead?: 0 | 40 | 80 | 120;
  /** The same: nobody knows the words; captions have to come from elsewhere. */
  captions?: false;
  /** With idling on: where it begins on the idle clock, in seconds. */
  idle?: number;
}
/** A sentence begins. */
export interface ServerSentence {
  type: 'sentence';
  /** The name of the stream: of hello, or of the room. */
  stream?: string;
  /** Its number on the stream. */
  utterance: number;
  /** The client's name for it, if it gave one. At most 64 bytes. */
  id?: string;
  /** Seconds. */
  time: number;
  /** The same in samples at the utterance's rate. */
  sample: number;
  /** Seconds. */
  duration: number;
  /** Where it begins, in bytes of UTF-8. */
  start: number;
  /** Where it ends, in bytes of UTF-8. */
  end: number;
  /** Where it begins, in units of UTF-16. */
  utf16_start: number;
  /** Where it ends, in units of UTF-16. */
  utf16_end: number;
  /** As it stands in the input, with its markup. */
  text: string;
}
/** A word begins. */
export interface ServerWord {
  type: 'word';
  /** The name of the stream: of hello, or of the room. */
  stream?: string;
  /** Its number on the stream. */
  utterance: number;
  /** The client's name for it, if it gave one. At most 64 bytes. */
  id?: string;
  /** Seconds. */
  time: number;
  /** The same in samples at the utterance's rate. */
  sample: number;
  /** Seconds. */
  duration: number;
  /** Where it begins, in bytes of UTF-8. */
  start: number;
  /** Where it ends, in bytes of UTF-8. */
  end: number;
  /** Where it begins, in units of UTF-16. */
  utf16_start: number;
  /** Where it ends, in units of UTF-16. */
  utf16_end: number;
  /** As it stands in the input. */
  text: string;
}
/** A phone begins; only when asked for. */
export interface ServerPhone {
  type: 'phone';
  /** The name of the stream: of hello, or of the room. */
  stream?: string;
  /** Its number on the stream. */
  utterance: number;
  /** The client's name for it, if it gave one. At most 64 bytes. */
  id?: string;
  /** Seconds. */
  time: number;
  /** The same in samples at the utterance's rate. */
  sample: number;
  /** Seconds. */
  duration: number;
  /** Its sign of the International Phonetic Alphabet; empty: a pause. */
  ipa: string;
}
/** A mark of the text is reached. */
export interface ServerMark {
  type: 'mark';
  /** The name of the stream: of hello, or of the room. */
  stream?: string;
  /** Its number on the stream. */
  utterance: number;
  /** The client's name for it, if it gave one. At most 64 bytes. */
  id?: string;
  /** Seconds. */
  time: number;
  /** The same in samples at the utterance's rate. */
  sample: number;
  /** The mark's name. */
  name: string;
}
/** The stream halts, and the utterance that has begun, if there is one. */
export interface ServerPaused {
  type: 'paused';
  /** The name of the stream: of hello, or of the room. */
  stream: string;
  /** Its number on the stream. */
  utterance?: number;
  /** The client's name for it, if it gave one. At most 64 bytes. */
  id?: string;
  /** Seconds. */
  time?: number;
  /** The same in samples at the utterance's rate. */
  sample?: number;
}
/** The stream goes on, and the utterance that has begun, if there is one. */
export interface ServerResumed {
  type: 'resumed';
  /** The name of the stream: of hello, or of the room. */
  stream: string;
  /** Its number on the stream. */
  utterance?: number;
  /** The client's name for it, if it gave one. At most 64 bytes. */
  id?: string;
  /** Seconds. */
  time?: number;
  /** The same in samples at the utterance's rate. */
  sample?: number;
  /** With idling on: when on the idle clock, in seconds. */
  idle?: number;
}
/** The utterance goes on from a mark: what was sent before and has not been heard is to be forgotten. */
export interface ServerJumped {
  type: 'jumped';
  /** The name of the stream: of hello, or of the room. */
  stream: string;
  /** Its number on the stream. */
  utterance: number;
  /** The client's name for it, if it gave one. At most 64 bytes. */
  id?: string;
  /** Seconds. */
  time: number;
  /** The same in samples at the utterance's rate. */
  sample: number;
  /** The mark's name. */
  mark: string;
}
/** Something was understood but not acted on, or replaced. Of an utterance when it names one. */
export interface ServerWarning {
  type: 'warning';
  /** Stable; more may come. */
  code: string;
  /** The member, parameter or header. */
  field?: string;
  /** For people. */
  message: string;
  /** Where in the message or file, from 0. */
  byte?: number;
  /** Where in the text, from 1. */
  line?: number;
  /** The character of the line, from 1. */
  column?: number;
  /** The name of the stream: of hello, or of the room. */
  stream?: string;
  /** Its number on the stream. */
  utterance?: number;
  /** The client's name for it, if it gave one. At most 64 bytes. */
  id?: string;
}
/** Something is refused or has failed. Of an utterance when it names one. A failed HTTP request is answered by the same object. */
export interface ServerError {
  type: 'error';
  /** Stable; more may come. */
  code: string;
  /** The member, parameter or header. */
  field?: string;
  /** For people. */
  message: string;
  /** Where in the message or file, from 0. */
  byte?: number;
  /** Where in the text, from 1. */
  line?: number;
  /** The character of the line, from 1. */
  column?: number;
  /** The name of the stream: of hello, or of the room. */
  stream?: string;
  /** Its number on the stream. */
  utterance?: number;
  /** Of the message that is refused, if it had one. At most 64 bytes. */
  id?: string;
}
/** An utterance has ended: exactly one for each speak, play and voice that was accepted or refused. One that was refused in a room names no utterance. */
export interface ServerEnd {
  type: 'end';
  /** How it ended. */
  reason: 'done' | 'stopped' | 'failed';
  /** Seconds of what was sent. */
  duration?: number;
  /** In a room: the sound of all who listened was blocked (media of the client), so that nobody heard it. */
  blocked?: true;
  /** The name of the stream: of hello, or of the room. */
  stream?: string;
  /** Its number on the stream. */
  utterance?: number;
  /** The client's name for it, if it gave one. At most 64 bytes. */
  id?: string;
}
/** The client is in a room. */
export interface ServerJoined {
  type: 'joined';
  /** Its name. */
  room: string;
  /** How many are in it now, this client among them. */
  followers: number;
  /** Whether it has the right to speak there. */
  may_speak: boolean;
}
/** The token is good. */
export interface ServerAuthorized {
  type: 'authorized';
  /** Of the token. */
  subject: string;
}
/** What can be answered; an empty list: nothing any more. */
export interface ServerChoices {
  type: 'choices';
  /** The name of the stream: of hello, or of the room. */
  stream: string;
  /** Of the choices, if they had one. At most 64 bytes. */
  id?: string;
  /** What is asked. At most 1000 bytes. */
  question?: string;
  /** Up to 8 texts. */
  choices: string[];
}
/** Somebody has answered; the choices are gone. */
export interface ServerChosen {
  type: 'chosen';
  /** The name of the stream: of hello, or of the room. */
  stream: string;
  /** Of the choices, if they had one. At most 64 bytes. */
  id?: string;
  /** Its place in the list, from 0. */
  choice: number;
  /** The choice itself. */
  text: string;
  /** Who chose: the subject of the token, else the name given at join, else the connection's. */
  by: string;
}
/** What the assistant behind the face is doing. */
export interface ServerState {
  type: 'state';
  /** The name of the stream: of hello, or of the room. */
  stream: string;
  /** What it is doing; asleep: nobody is there. */
  state: 'idle' | 'listening' | 'thinking' | 'muted' | 'asleep';
  /** What was heard, say. At most 1000 bytes. */
  text?: string;
}
/** The head has these feature points from now on, or its own again (reset). */
export interface ServerCalibrated {
  type: 'calibrated';
  /** The name of the stream: of hello, or of the room. */
  stream: string;
  /** The head's own points. */
  reset?: true;
  /** Feature points as ISO/IEC 14496-2 numbers them, any of them: mm on the neutral face, in the head's axes. */
  featurePointsCoord?: Record<string, [number, number, number]>;
  /** Places of feature points on the texture, v upward. */
  textureCoord?: Record<string, [number, number]>;
  /** A picture of the skin, in base64. */
  texture?: { type: 'image/png' | 'image/jpeg' | 'image/webp'; data: string };
}
/** The mood of the room is another; an empty mix: neutral. */
export interface ServerExpressed {
  type: 'expressed';
  /** The name of the stream: of hello, or of the room. */
  stream: string;
  /** Up to 4 affects with their intensities. */
  mix: { name: string; intensity: number }[];
  /** Who set it, as chosen tells; left out where it came with a state, or over HTTP. */
  by?: string;
}
/** Whether a study may write down what happens. */
export interface ServerConsent {
  type: 'consent';
  /** The name of the stream: of hello, or of the room. */
  stream: string;
  /** The question or the answer. asked: with what is asked; given: yes; declined: no; none: nothing is asked any more. */
  consent: 'asked' | 'given' | 'declined' | 'none';
  /** What was asked. At most 1000 bytes. */
  text?: string;
  /** Who asked or answered, as chosen tells. */
  by: string;
}
/** Who looks on in the room, in the order in which they came; told to them alone. */
export interface ServerDesks {
  type: 'desks';
  /** The name of the stream: of hello, or of the room. */
  stream: string;
  /** Up to 32: the name, and whether it may direct the room (speaks). */
  desks: { name: string; speaks: boolean }[];
  /** How many there are, also of those that are not listed. */
  count: number;
}
// </server messages>

export interface EndMessage extends Omit<ServerEnd, 'duration'> {
  /** Seconds of speech. */
  duration?: number;
  /** Why the page's own connection or sound failed, if so. */
  code?: string;
  /** Why nobody heard it, if so. */
  sound?: 'blocked' | 'none';
}

export interface ReadResult {
  reason: 'done' | 'stopped' | 'failed';
  code?: string;
}

export interface TalkingHeadEventMap {
  progress: CustomEvent<{ loaded: number; total: number | null; ratio: number | null }>;
  ready: CustomEvent<{ model: string; title: string; credits: string[] }>;
  connection: CustomEvent<{ state: 'connecting' | 'open' | 'waiting' | 'closed'; retryIn?: number }>;
  // <server events: made by protocol/make-messages.py>
  hello: CustomEvent<ServerHello>;
  begin: CustomEvent<ServerBegin>;
  sentence: CustomEvent<ServerSentence>;
  word: CustomEvent<ServerWord>;
  phone: CustomEvent<ServerPhone>;
  mark: CustomEvent<ServerMark>;
  paused: CustomEvent<ServerPaused>;
  resumed: CustomEvent<ServerResumed>;
  jumped: CustomEvent<ServerJumped>;
  warning: CustomEvent<ServerWarning>;
  joined: CustomEvent<ServerJoined>;
  authorized: CustomEvent<ServerAuthorized>;
  choices: CustomEvent<ServerChoices>;
  chosen: CustomEvent<ServerChosen>;
  state: CustomEvent<ServerState>;
  calibrated: CustomEvent<ServerCalibrated>;
  expressed: CustomEvent<ServerExpressed>;
  consent: CustomEvent<ServerConsent>;
  desks: CustomEvent<ServerDesks>;
  // </server events>
  /** What has come of an utterance, before it is heard; not to be changed. */
  media: CustomEvent<MediaDetail>;
  end: CustomEvent<EndMessage>;
  error: CustomEvent<
    ServerError & {
      /** Of `bad-calibration`: what of it is wrong. */
      place?: string;
      /** Of `bad-avatar`. */
      reason?: 'missing' | 'too-large' | 'not-glb' | 'damaged' | 'unsupported' | 'no-face' | 'bad-map' | 'no-script';
    }
  >;
  /** Of `read`: a word of the page is heard. */
  reading: CustomEvent<{ range: Range; text: string; lang: string; sentence: number; sentences: number }>;
  read: CustomEvent<ReadResult>;
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
