// SPDX-License-Identifier: MIT
import type { ClientMessage } from './client-messages.js';
import type { ServerMessage } from './server-messages.js';

export type { ClientMessage, ServerMessage };

type Speak = Extract<ClientMessage, { type: 'speak' }>;
type Voice = Extract<ClientMessage, { type: 'voice' }>;

/** What came for one stretch of time. */
export interface Media {
  type: 'media';
  /** 0: idling. */
  utterance: number;
  /** Of what `start` and `samples` count in, Hz. */
  sampleRate: number;
  start: number;
  samples: number;
  fps: number;
  firstFrame: number;
  /** 0 silence, 1 PCM, 2 Opus. */
  audioCodec: 0 | 1 | 2;
  /** PCM samples, mono; Opus packets of 20 ms; null where it is silent. */
  audio: Int16Array | Uint8Array[] | null;
  /** For each frame FAP n at index n, 1 to 68 (ISO/IEC 14496-2), in its units; 0 is not used. */
  frames: Int32Array[];
}

/** `lost`: the connection was. */
export interface End {
  type: 'end';
  id?: string;
  utterance?: number;
  reason: 'done' | 'stopped' | 'failed' | 'lost';
  duration?: number;
}

export declare class Utterance implements AsyncIterable<Exclude<ServerMessage, { type: 'end' }> | Media | End> {
  readonly id: string;
  readonly number: number | null;
  readonly errors: Extract<ServerMessage, { type: 'error' }>[];
  readonly done: Promise<End>;
  write(text: string): boolean;
  sound(samples: Int16Array | Uint8Array): boolean;
  flush(): boolean;
  close(): boolean;
  cancel(): boolean;
  [Symbol.asyncIterator](): AsyncIterator<Exclude<ServerMessage, { type: 'end' }> | Media | End>;
}

export type State = 'connecting' | 'open' | 'waiting' | 'closed';

interface ClientEvents {
  message: CustomEvent<ServerMessage>;
  media: CustomEvent<Media>;
  state: CustomEvent<State>;
}

export declare class Client extends EventTarget {
  readonly hello: Extract<ServerMessage, { type: 'hello' }> | null;
  readonly state: State;
  send(message: ClientMessage): boolean;
  speak(text: string, options?: Partial<Omit<Speak, 'type' | 'text'>>): Utterance;
  open(options?: Partial<Omit<Speak, 'type' | 'text' | 'open'>>): Utterance;
  play(name: string, options?: { id?: string; mode?: 'queue' | 'replace' | 'interrupt' | 'quiet' }): Utterance;
  voice(options: Partial<Omit<Voice, 'type'>>): Utterance;
  close(): void;
  addEventListener<K extends keyof ClientEvents>(type: K, listener: (event: ClientEvents[K]) => void, options?: boolean | AddEventListenerOptions): void;
  addEventListener(type: string, listener: EventListenerOrEventListenerObject | null, options?: boolean | AddEventListenerOptions): void;
}

export interface Options {
  lang?: string;
  voice?: string;
  room?: string;
  token?: string;
  audio?: 'pcm' | 'opus' | 'none';
  fap?: 'plain' | 'fapc' | 'none';
  events?: 'packed';
  /** Where there is none: that of `ws`. */
  WebSocket?: unknown;
  signal?: AbortSignal;
  [member: string]: unknown;
}

export declare function connect(server: string, options?: Options): Promise<Client>;
