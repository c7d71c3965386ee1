// SPDX-License-Identifier: MIT
// Types of talking-head.js, for editors and TypeScript.

/** A mixture of affects: by name, as a list, or as text ("joy 0.6, surprise 0.2"). */
export type Expression = Record<string, number> | { name: string; intensity?: number }[] | string | null;

/** What the assistant behind the face is doing. */
export type AssistantState = 'idle' | 'listening' | 'thinking' | 'muted' | 'error' | 'asleep';

export type Consent = 'asked' | 'given' | 'declined' | 'none';

/** Of a voice without a text: see the protocol's `voice`. */
export interface ListenOptions {
  // <voice options: made by protocol/make-messages.py>
  /** The client's name for the utterance; returned in every message about it. At most 64 bytes. */
  id?: string;
  /** How much sound after a moment is analysed before that moment is shown, ms. */
  lookahead?: 0 | 40 | 80 | 120;
  /** The language spoken. When left out: hello.lang. */
  lang?: string;
  /** network: the mouth is derived from the sound directly; or one of hello.engines, applied to the recognised phones. At most 64 bytes. */
  engine?: string;
  /** FAP frames per second. */
  fps?: number;
  /** Strength of the idle motion. */
  life?: number;
  /** Only the lips move; no signs of life, no gestures and accents. The affects of the text show, without head and gaze. */
  still?: boolean;
  /** When to speak it. queue: after all that waits; replace: at once, and all else is forgotten; interrupt: at once; what speaks is cut, what waits comes afterwards; quiet: only when nothing speaks or waits, else it is refused. */
  mode?: 'queue' | 'replace' | 'interrupt' | 'quiet';
  /** A higher priority goes first and interrupts a lower one. */
  priority?: 'background' | 'chat' | 'alarm';
  /** Its subject: replaces waiting utterances with the same topic. At most 64 bytes. */
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

export interface HearOptions {
  /** A BCP 47 tag of what is spoken. */
  lang?: string;
  /** In place of the user's microphone. */
  stream?: MediaStream;
  /** Any number of utterances, each found by its loudness. */
  handsFree?: boolean;
  /** Somebody begins to speak. */
  onset?: () => void;
  /** dB by which they must be louder now, because the page itself makes a sound. */
  noise?: () => number;
  /** pcm: uncompressed sound instead of Opus. */
  codec?: 'opus' | 'pcm';
}

export interface Hearing {
  /** Whether the microphone is, or will be. */
  readonly open: boolean;
  /** Ends the utterance, and closes the microphone. */
  stop(): void;
  /** Ends by itself once somebody has spoken and is silent. */
  stopAtSilence(): void;
  /** The last `heard`, if there was one; fails where there is no microphone, or it is refused. */
  done: Promise<ServerHeard | null>;
}

/** Members of the protocol's `speak`. */
export interface SpeakOptions {
  // <speak options: made by protocol/make-messages.py>
  /** The id of a library passage to speak instead of a text. At most 128 bytes. */
  passage?: string;
  /** UTF-16 units to skip at the start of the passage. */
  from?: number;
  /** Ranges of a plain text in other languages: "START-END:LANG", in UTF-16 units, separated by spaces, such as "6-18:la 30-41:fr". For a passage, the library knows them. */
  languages?: string;
  /** Who speaks the text: any name, or with `work` an id of its cast; returned in speaker events, captions and exports. At most 208 bytes. */
  speaker?: string;
  /** Who speaks which ranges of a plain text: a JSON array of {id, name, voice, gender, pitch, rate, affect, at}, where `at` is like "0-12 30-44" in UTF-16 units. For a passage, the library knows them. At most 1048576 bytes. */
  speakers?: string;
  /** Whether the speakers of a passage have the voices of the work's cast. auto: if no voice is named; on: always; `voice` is the narrator's; off: one voice speaks everything. */
  cast?: 'auto' | 'on' | 'off';
  /** Whether the narrator speaks the stage directions of a passage. */
  directions?: 'silent' | 'spoken';
  /** How to read the dialogue of plain prose that does not say who speaks. one-voice: one voice speaks everything; voices: what stands in quotation marks or after dashes is spoken by the persons whom the narrator names, or two in turn. */
  dialogue?: 'one-voice' | 'voices';
  /** Whether the narrator speaks the speakers' names in a section of the library. */
  names?: boolean;
  /** The client's name for the utterance; returned in every message about it. At most 64 bytes. */
  id?: string;
  /** A tag of hello.languages or hello.more_languages (BCP 47, such as pt-BR), or a POSIX locale that names one (it_IT.UTF-8). When left out: what the root element of markup says, else hello.lang. */
  lang?: string;
  /** An id of /v1/voices. At most 128 bytes. When left out: the first of the language. */
  voice?: string;
  /** Gender of the voice; used when no voice is named. */
  gender?: 'any' | 'female' | 'male';
  /** The engine that moves the mouth: one of hello.engines that the language supports (hello.languages). At most 64 bytes. */
  engine?: string;
  /** The markup of the text; auto: detected. */
  markup?: 'auto' | 'plain' | 'apml' | 'jsml' | 'ssml' | 'emotionml' | 'bml' | 'fml';
  /** Words per minute. When left out: the voice's own. */
  rate?: number;
  /** Pitch, as a factor of the voice's own. */
  pitch?: number;
  /** Loudness, as a factor of the voice's own. */
  volume?: number;
  /** Emotion of the whole text, in voice and face: an affect of /v1/expressions or a synonym (joy, happy). Markup in the text overrides it. At most 64 bytes. When left out: none. */
  affect?: string;
  /** FAP frames per second. */
  fps?: number;
  /** Makes the face repeatable: the same number gives the same movements. */
  seed?: number;
  /** Strength of the idle motion. */
  life?: number;
  /** How expressions share the mouth with speech; auto: weighted if the text names a weight, else regions. */
  blend?: 'auto' | 'regions' | 'weighted';
  /** Whether lips that must touch are made to touch; engine: the engine's default. */
  contacts?: 'engine' | 'on' | 'off';
  /** Whether numbers, signs and abbreviations become words before the voice gets the text, and Markdown and emoji of plain text are left out. */
  normalize?: 'on' | 'off';
  /** The library work that the text is from (its id or that of one of its passages): its lexicon and the library's apply. At most 128 bytes. */
  work?: string;
  /** Pronunciations, as a document of the W3C's Pronunciation Lexicon Specification; overrides all other lexicons. At most 65536 bytes. When left out: those of the work, the library, the room and the daemon only. */
  lexicon?: string;
  /** How to read lines of plain text that end without punctuation. run-on: only where punctuation asks for a pause; pause: a comma's worth at each line's end where sense asks for it; scan: a comma's worth at each line's end, and a fifth slower, as a school scans verse. */
  verse?: 'run-on' | 'pause' | 'scan';
  /** When to speak it. queue: after all that waits; replace: at once, and all else is forgotten; interrupt: at once; what speaks is cut, what waits comes afterwards; quiet: only when nothing speaks or waits, else it is refused. */
  mode?: 'queue' | 'replace' | 'interrupt' | 'quiet';
  /** A higher priority goes first and interrupts a lower one. */
  priority?: 'background' | 'chat' | 'alarm';
  /** Its subject: replaces waiting utterances with the same topic. At most 64 bytes. */
  topic?: string;
  /** In a shared room: if the daemon that was to speak it is lost, the next leader speaks it again. */
  again?: boolean;
  /** A bell sounds before it, and pages flash. */
  bell?: boolean;
  /** Also send its phones as events. */
  phones?: boolean;
  /** Only the lips move; no signs of life, no gestures and accents. The affects of the text show, without head and gaze. */
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
/** What the server offers; sent right after the upgrade. */
export interface ServerHello {
  type: 'hello';
  /** The version of the protocol. */
  protocol: 1;
  /** The server's name and version. */
  server: string;
  /** This connection's name. */
  stream: string;
  /** The default frame rate. */
  fps: number;
  /** The default language. */
  lang: string;
  /** The available sound codecs. */
  audio: string[];
  /** The available FAP codecs. */
  fap: string[];
  /** The available forms of events. */
  events: string[];
  /** Samples at 48 kHz that an Opus decoder drops at the beginning of an utterance. */
  opus_skip: number;
  /** Whether tokens are required. */
  tokens: boolean;
  /** Whether it recognises what listeners say (hear). */
  hears: boolean;
  /** Languages with a speech pack: tag, name, and their engines. */
  languages: { tag: string; name: string; engines: string[] }[];
  /** Tags of other languages that voices speak; their lips follow the International Phonetic Alphabet. */
  more_languages: string[];
  /** The available engines. */
  engines: string[];
  /** The affects that express accepts. */
  expressions: string[];
  /** The heads: name, title, hash, bytes; about: a short description; voice: members of speak for a voice that suits it; poster: the address of its neutral picture, and pictures: of its set of pictures, from /v1/ on. */
  models: { name: string; title: string; hash: string; bytes: number; about?: string; voice?: { gender?: 'female' | 'male'; pitch?: number }; poster?: string; pictures?: string }[];
  /** The limits in force. */
  limits: Record<'text_bytes' | 'message_bytes' | 'queue' | 'open' | 'connections' | 'rooms' | 'play_bytes', number>;
}
/** An utterance begins; sent before its first chunk. */
export interface ServerBegin {
  type: 'begin';
  /** The stream's name: that of hello, or the room's. */
  stream: string;
  /** Its number on the stream. */
  utterance: number;
  /** The client's id for it, if given. At most 64 bytes. */
  id?: string;
  /** Sample rate, Hz. */
  rate: number;
  /** FAP frames per second. */
  fps: number;
  /** The voice's id; not for a recording or a live voice. */
  voice?: string;
  /** The language; not for a recording. */
  lang?: string;
  /** The engine; not for a recording. */
  engine?: string;
  /** The markup of the text, given or detected; not for a recording or a live voice. */
  markup?: string;
  /** The name of a recording, instead of voice, lang, engine and markup. */
  play?: string;
  /** The daemon that spoke it was lost; another one speaks it again. */
  again?: true;
  /** A bell sounds first: a page may show it. */
  bell?: true;
  /** For a live voice: its lookahead, ms. */
  lookahead?: 0 | 40 | 80 | 120;
  /** For a live voice: its words are unknown; captions must come from elsewhere. */
  captions?: false;
  /** With idling on: the time on the idle clock at which it begins, in seconds. */
  idle?: number;
}
/** A sentence begins. */
export interface ServerSentence {
  type: 'sentence';
  /** The stream's name: that of hello, or the room's. */
  stream?: string;
  /** Its number on the stream. */
  utterance: number;
  /** The client's id for it, if given. At most 64 bytes. */
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
  /** The sentence as in the input, with its markup. */
  text: string;
}
/** A word begins. */
export interface ServerWord {
  type: 'word';
  /** The stream's name: that of hello, or the room's. */
  stream?: string;
  /** Its number on the stream. */
  utterance: number;
  /** The client's id for it, if given. At most 64 bytes. */
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
  /** The word as in the input. */
  text: string;
}
/** A person begins or continues to speak: sent with each sentence of an utterance whose request says who speaks. */
export interface ServerSpeaker {
  type: 'speaker';
  /** The stream's name: that of hello, or the room's. */
  stream: string;
  /** Its number on the stream. */
  utterance: number;
  /** The client's id for it, if given. At most 64 bytes. */
  id?: string;
  /** Seconds. */
  time: number;
  /** The same in samples at the utterance's rate. */
  sample: number;
  /** The id; empty: the narrator. */
  speaker: string;
  /** The name to show; empty: the narrator. */
  name: string;
}
/** A phone begins; only if requested. */
export interface ServerPhone {
  type: 'phone';
  /** The stream's name: that of hello, or the room's. */
  stream?: string;
  /** Its number on the stream. */
  utterance: number;
  /** The client's id for it, if given. At most 64 bytes. */
  id?: string;
  /** Seconds. */
  time: number;
  /** The same in samples at the utterance's rate. */
  sample: number;
  /** Seconds. */
  duration: number;
  /** Its IPA symbol; empty: a pause. */
  ipa: string;
}
/** A mark of the text is reached. */
export interface ServerMark {
  type: 'mark';
  /** The stream's name: that of hello, or the room's. */
  stream?: string;
  /** Its number on the stream. */
  utterance: number;
  /** The client's id for it, if given. At most 64 bytes. */
  id?: string;
  /** Seconds. */
  time: number;
  /** The same in samples at the utterance's rate. */
  sample: number;
  /** The mark's name. */
  name: string;
}
/** The stream pauses, with the current utterance if there is one. */
export interface ServerPaused {
  type: 'paused';
  /** The stream's name: that of hello, or the room's. */
  stream: string;
  /** Its number on the stream. */
  utterance?: number;
  /** The client's id for it, if given. At most 64 bytes. */
  id?: string;
  /** Seconds. */
  time?: number;
  /** The same in samples at the utterance's rate. */
  sample?: number;
}
/** The stream continues, with the current utterance if there is one. */
export interface ServerResumed {
  type: 'resumed';
  /** The stream's name: that of hello, or the room's. */
  stream: string;
  /** Its number on the stream. */
  utterance?: number;
  /** The client's id for it, if given. At most 64 bytes. */
  id?: string;
  /** Seconds. */
  time?: number;
  /** The same in samples at the utterance's rate. */
  sample?: number;
  /** With idling on: the time on the idle clock, in seconds. */
  idle?: number;
}
/** The utterance continues from a mark: discard earlier media that have not been played. */
export interface ServerJumped {
  type: 'jumped';
  /** The stream's name: that of hello, or the room's. */
  stream: string;
  /** Its number on the stream. */
  utterance: number;
  /** The client's id for it, if given. At most 64 bytes. */
  id?: string;
  /** Seconds. */
  time: number;
  /** The same in samples at the utterance's rate. */
  sample: number;
  /** The mark's name. */
  mark: string;
}
/** Something was understood but ignored or replaced. It concerns an utterance if it names one. */
export interface ServerWarning {
  type: 'warning';
  /** Stable; more codes may be added. */
  code: string;
  /** The member, parameter or header. */
  field?: string;
  /** Text for people. */
  message: string;
  /** Offset in the message or file, from 0. */
  byte?: number;
  /** Line in the text, from 1. */
  line?: number;
  /** Column in characters, from 1. */
  column?: number;
  /** The stream's name: that of hello, or the room's. */
  stream?: string;
  /** Its number on the stream. */
  utterance?: number;
  /** The client's id for it, if given. At most 64 bytes. */
  id?: string;
}
/** Something was refused or failed. It concerns an utterance if it names one. A failed HTTP request gets the same object. */
export interface ServerError {
  type: 'error';
  /** Stable; more codes may be added. */
  code: string;
  /** The member, parameter or header. */
  field?: string;
  /** Text for people. */
  message: string;
  /** Offset in the message or file, from 0. */
  byte?: number;
  /** Line in the text, from 1. */
  line?: number;
  /** Column in characters, from 1. */
  column?: number;
  /** The stream's name: that of hello, or the room's. */
  stream?: string;
  /** Its number on the stream. */
  utterance?: number;
  /** The id of the refused message, if it had one. At most 64 bytes. */
  id?: string;
}
/** An utterance has ended: exactly one for each speak, play and voice, accepted or refused. After a refusal in a room it names no utterance. */
export interface ServerEnd {
  type: 'end';
  /** How it ended. */
  reason: 'done' | 'stopped' | 'failed';
  /** Seconds of media sent. */
  duration?: number;
  /** In a room: every listener's sound was blocked (blocked of media), so nobody heard it. */
  blocked?: true;
  /** The stream's name: that of hello, or the room's. */
  stream?: string;
  /** Its number on the stream. */
  utterance?: number;
  /** The client's id for it, if given. At most 64 bytes. */
  id?: string;
}
/** The client has joined a room. */
export interface ServerJoined {
  type: 'joined';
  /** Its name. */
  room: string;
  /** The number of followers, including this client. */
  followers: number;
  /** Whether this client has the right to speak there. */
  may_speak: boolean;
}
/** The token is valid. */
export interface ServerAuthorized {
  type: 'authorized';
  /** The token's subject. */
  subject: string;
}
/** The answers on offer; an empty list withdraws them. */
export interface ServerChoices {
  type: 'choices';
  /** The stream's name: that of hello, or the room's. */
  stream: string;
  /** The id of the choices, if they had one. At most 64 bytes. */
  id?: string;
  /** The question. At most 1000 bytes. */
  question?: string;
  /** Up to 8 texts. */
  choices: string[];
}
/** A listener has answered; the choices are withdrawn. */
export interface ServerChosen {
  type: 'chosen';
  /** The stream's name: that of hello, or the room's. */
  stream: string;
  /** The id of the choices, if they had one. At most 64 bytes. */
  id?: string;
  /** Index in the list, from 0. */
  choice: number;
  /** The choice itself. */
  text: string;
  /** Who chose: the token's subject, else the name given at join, else the connection's name. */
  by: string;
}
/** A question has been said, and waits for its answer: a page may listen now. */
export interface ServerAsked {
  type: 'asked';
  /** The stream's name: that of hello, or the room's. */
  stream: string;
  /** The id of the question. At most 64 bytes. */
  id: string;
  /** Its text. At most 1000 bytes. */
  question: string;
  /** How long it waits. */
  seconds: number;
}
/** The end of a question, sent to followers who may speak in the room. Over HTTP it is the answer to ask. */
export interface ServerAnswered {
  type: 'answered';
  /** The stream's name: that of hello, or the room's. */
  stream: string;
  /** The id of the question. At most 64 bytes. */
  id: string;
  /** How it ended. chosen: one of its choices; heard: the words of a listener; timeout: no answer in time; withdrawn: another question or other choices took its place; failed: it could not be said. */
  reason: 'chosen' | 'heard' | 'timeout' | 'withdrawn' | 'failed';
  /** The answer. At most 1000 bytes. */
  text?: string;
  /** Index in the list of choices, from 0. */
  choice?: number;
  /** Who answered, as in chosen. */
  by?: string;
}
/** What a listener said, sent to that client and to observers who may speak in the room. */
export interface ServerHeard {
  type: 'heard';
  /** The stream's name: that of hello, or the room's. */
  stream: string;
  /** The id of the hear message. At most 64 bytes. */
  id: string;
  /** The words; final and empty: none were recognised. At most 1000 bytes. */
  text: string;
  /** False: a preview, which later ones replace. */
  final: boolean;
  /** How sure the recogniser is, if it says so. */
  confidence?: number;
  /** Who spoke, as in chosen. */
  by: string;
}
/** The picture or film behind the face. */
export interface ServerBackdrop {
  type: 'backdrop';
  /** The stream's name: that of hello, or the room's. */
  stream: string;
  /** Its address; empty: none. At most 2000 bytes. */
  source: string;
}
/** A piece of what a listener says, as sound, sent to observers who asked to overhear and may speak in the room, while its listener consents. */
export interface ServerOverheard {
  type: 'overheard';
  /** The stream's name: that of hello, or the room's. */
  stream: string;
  /** The id of the hear message. At most 64 bytes. */
  id: string;
  /** Who speaks, as in chosen. */
  by: string;
  /** The form of the data. pcm_s16le: samples, signed 16 bit, little-endian, interleaved; opus: one packet. */
  codec: 'pcm_s16le' | 'opus';
  /** Samples per second. */
  rate: number;
  /** Channels. */
  channels: number;
  /** The sound, in base64. */
  data: string;
}
/** What the assistant behind the face is doing. */
export interface ServerState {
  type: 'state';
  /** The stream's name: that of hello, or the room's. */
  stream: string;
  /** The state; error: the assistant failed, the text says why; asleep: nobody is present, and the screen is dark. */
  state: 'idle' | 'listening' | 'thinking' | 'muted' | 'error' | 'asleep';
  /** A text to show with it, such as what was recognised. At most 1000 bytes. */
  text?: string;
}
/** The head has these feature points, or its own again (reset). */
export interface ServerCalibrated {
  type: 'calibrated';
  /** The stream's name: that of hello, or the room's. */
  stream: string;
  /** The head's own points. */
  reset?: true;
  /** Any feature points of ISO/IEC 14496-2, by number: mm on the neutral face, in the head's axes. */
  featurePointsCoord?: Record<string, [number, number, number]>;
  /** Texture coordinates of feature points, v upward. */
  textureCoord?: Record<string, [number, number]>;
  /** A picture of the skin, in base64. */
  texture?: { type: 'image/png' | 'image/jpeg' | 'image/webp'; data: string };
}
/** A client drives the face, or no longer does. */
export interface ServerDriven {
  type: 'driven';
  /** The stream's name: that of hello, or the room's. */
  stream: string;
  /** Whether the face is driven. */
  on: boolean;
  /** Who drives it, as in chosen; absent when it is over. */
  by?: string;
}
/** Another head is shown; empty: each page's own. */
export interface ServerHead {
  type: 'head';
  /** The stream's name: that of hello, or the room's. */
  stream: string;
  /** The head's name. At most 64 bytes. */
  head: string;
}
/** The room's mood has changed; an empty mix: neutral. */
export interface ServerExpressed {
  type: 'expressed';
  /** The stream's name: that of hello, or the room's. */
  stream: string;
  /** Up to 4 affects with their intensities. */
  mix: { name: string; intensity: number }[];
  /** Who set it, as in chosen; absent if it came with a state or over HTTP. */
  by?: string;
}
/** Whether a study may log what happens. */
export interface ServerConsent {
  type: 'consent';
  /** The stream's name: that of hello, or the room's. */
  stream: string;
  /** The question or the answer. asked: the question, with its text; given: yes; declined: no; none: the study is over. */
  consent: 'asked' | 'given' | 'declined' | 'none';
  /** The question. At most 1000 bytes. */
  text?: string;
  /** Who asked or answered, as in chosen. */
  by: string;
  /** Whether a session is recorded, or was and can still be deleted with declined. */
  recorded: boolean;
}
/** The observers of the room, in the order in which they joined; sent to observers only. */
export interface ServerObservers {
  type: 'observers';
  /** The stream's name: that of hello, or the room's. */
  stream: string;
  /** Up to 32, each with its name and whether it may direct the room (speaks). */
  observers: { name: string; speaks: boolean }[];
  /** The number of observers, including those not listed. */
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
  speaker: CustomEvent<ServerSpeaker>;
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
  asked: CustomEvent<ServerAsked>;
  answered: CustomEvent<ServerAnswered>;
  heard: CustomEvent<ServerHeard>;
  backdrop: CustomEvent<ServerBackdrop>;
  overheard: CustomEvent<ServerOverheard>;
  state: CustomEvent<ServerState>;
  calibrated: CustomEvent<ServerCalibrated>;
  driven: CustomEvent<ServerDriven>;
  head: CustomEvent<ServerHead>;
  expressed: CustomEvent<ServerExpressed>;
  consent: CustomEvent<ServerConsent>;
  observers: CustomEvent<ServerObservers>;
  // </server events>
  /** It goes on at another time of the recording. */
  seeked: CustomEvent<{ time: number; sample: number; utterance: number }>;
  /** Of `hear`: whether the microphone is on, and whether an utterance is being sent. */
  hearing: CustomEvent<{ on: boolean; speaking: boolean }>;
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
  audio?: string | null;
  autoplay?: boolean | 'on' | 'off' | null;
  for?: string | null;
  model?: string | null;
  avatar?: string | null;
  'avatar-map'?: string | null;
  pictures?: string | null;
  poster?: string | null;
  backdrop?: string | null;
  view?: 'face' | 'bust' | 'mouth' | null;
  quality?: 'auto' | 'high' | 'low' | 'pictures' | null;
  /** The id of the head whose speech it shares. */
  partner?: string | null;
  /** The ids of the speakers that it shows. */
  persona?: string | null;
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
  verse?: 'run-on' | 'pause' | 'scan' | null;
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
  /** The address of a stream, or of a recording. */
  src: string | null;
  /** The address of the sound, if `src` is a face alone. */
  audio: string | null;
  get autoplay(): boolean;
  set autoplay(on: boolean | string | null | undefined);
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
  /** The id of the head whose speech it shares, see `persona`. */
  partner: string | null;
  /** The ids of the speakers that it shows, separated by spaces, in a scene with partners. */
  persona: string | null;
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
  verse: 'run-on' | 'pause' | 'scan' | null;
  // </speak properties>
  label: string | null;
  backdrop: string | null;
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
  /** Of the recording, in seconds. */
  readonly currentTime: number;
  readonly duration: number | null;

  speak(text: string, options?: SpeakOptions): Promise<EndMessage>;
  /** Speaks the recording of `src`. */
  play(): Promise<EndMessage>;
  seek(seconds: number): void;
  showHead(json: object): Promise<void>;
  read(from?: Range | StaticRange | Node): Promise<ReadResult>;
  open(source?: ReadableStream<string | Uint8Array> | AsyncIterable<string | Uint8Array> | null, options?: SpeakOptions): Writing;
  /** Without a stream: the user's microphone, only while the user does something. */
  listen(stream?: MediaStream | MediaStreamTrack | null, options?: ListenOptions): Listening;
  /** Opens the microphone for a server that recognises speech. */
  hear(options?: HearOptions): Hearing;
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
  /** The picture and the sound as tracks; fps: at most (25). */
  captureStream(fps?: number): MediaStream;
  express(mix: Expression, options?: { ease?: number }): void;
  offer(choices: string[], options?: { id?: string; question?: string }): boolean;
  choose(choice: number, id?: string): boolean;
  consent(consent: Consent, text?: string): boolean;
  /** Says a question, and waits for its answer: the event `answered`. */
  ask(text: string, options?: SpeakOptions & { choices?: string[]; seconds?: number }): boolean;
  /** Words that the page has recognised itself, or that were typed. */
  said(text: string, options?: { id?: string; final?: boolean; lang?: string; confidence?: number }): boolean;
  /** Sends an observer the speech of listeners, if they consent: the event `overheard`. */
  overhear(on?: boolean): boolean;
  /** Drives the face of the room in real time with frames of FAPs, times in seconds; null: no longer. The event `driven` tells who does. */
  drive(frames: { time: number; faps: Record<number, number> }[] | null): boolean;
  /** How all texts of the room are spoken, for who listens there: factors from 0.5 to 2. */
  setManner(manner?: { speed?: number; pitch?: number; volume?: number }): boolean;
  /** A picture or a film behind the face of all in the room; empty: none. */
  showBackdrop(source: string): boolean;
  /** Another head for all in the room; empty: each listener's own. */
  showHeadAll(name: string): boolean;
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
