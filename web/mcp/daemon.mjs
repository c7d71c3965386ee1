// SPDX-License-Identifier: MIT
// The HTTP interface of a faccia daemon, as far as the tools need it. Failures are in words for people.

const PATIENCE_MS = 30000; // for an answer
const EVENT_BYTES_MAX = 1 << 20;

/** A failure; `message` says what it is in plain words. */
export class DaemonError extends Error {
  /** @param {string} message @param {string} code of the protocol, or `no-daemon` */
  constructor(message, code) {
    super(message);
    this.code = code;
  }
}

/** Finds the messages in a text of server-sent events. */
class EventReader {
  #rest = '';

  /** @param {string} text @returns {object[]} */
  take(text) {
    const parts = (this.#rest + text).split('\n\n');
    this.#rest = parts.pop();
    if (this.#rest.length > EVENT_BYTES_MAX) throw new DaemonError('The daemon sent an event that is too long.', 'bad-answer');
    const dataOf = (part) => part.split('\n').filter((line) => line.startsWith('data:')).map((line) => line.slice(5)).join('\n');
    return parts.map(dataOf).filter(Boolean).map((json) => JSON.parse(json));
  }
}

export class Daemon {
  /** @param {string} url of the daemon @param {string|null} token */
  constructor(url, token) {
    this.url = new URL(url).href.replace(/\/$/, '');
    this.token = token;
  }

  /** Stops or removes what is at the address; what is gone already counts as removed. @param {string} path */
  async remove(path) {
    const answer = await this.#fetch(path, { method: 'DELETE', signal: AbortSignal.timeout(PATIENCE_MS) });
    if (!answer.ok && answer.status !== 404) throw await this.#refusal(answer);
  }

  async #fetch(path, { method = 'GET', json, signal } = {}) {
    const headers = {
      ...(this.token ? { authorization: `Bearer ${this.token}` } : {}),
      ...(json === undefined ? {} : { 'content-type': 'application/json' }),
    };
    try {
      const body = json === undefined ? undefined : JSON.stringify(json);
      return await fetch(this.url + path, { method, headers, body, signal });
    } catch (error) {
      if (error.name === 'TimeoutError') throw new DaemonError(`The faccia daemon at ${this.url} does not answer.`, 'no-daemon');
      if (error.name === 'AbortError') throw error;
      throw new DaemonError(`No faccia daemon answers at ${this.url}. Is facciad running there?`, 'no-daemon');
    }
  }

  async #refusal(answer) {
    const error = await answer.json().catch(() => ({}));
    const text = error.message ?? `The faccia daemon answered ${answer.status}.`;
    if (answer.status === 401)
      return new DaemonError(`The faccia daemon does not accept the token, or wants one: ${text} 'faccia token' makes one.`, error.code);
    return refusal(error, text);
  }

  /** @param {string} path with its query @param {object} [json] of a POST @returns {Promise<object>} @throws {DaemonError} */
  async ask(path, json) {
    const signal = AbortSignal.timeout(PATIENCE_MS);
    const answer = await this.#fetch(path, { method: json === undefined ? 'GET' : 'POST', json, signal });
    if (!answer.ok) throw await this.#refusal(answer);
    return answer.json();
  }

  /** A message to a room. @throws {DaemonError} also when the room refuses it */
  async command(room, message) {
    const answer = await this.ask(`/v1/rooms/${encodeURIComponent(room)}/commands`, message);
    if (answer.refused) throw refusal(answer.refused, 'The text was refused.');
    return answer;
  }

  /**
   * Watches a room. @param {string} room @param {AbortSignal} signal ends it
   * @returns {Promise<AsyncGenerator<object>>} when it watches: its messages
   */
  async listen(room, signal) {
    const answer = await this.#fetch(`/v1/events?watch=1&room=${encodeURIComponent(room)}`, { signal });
    if (!answer.ok) throw await this.#refusal(answer);
    return messagesOf(answer.body.pipeThrough(new globalThis.TextDecoderStream()).getReader());
  }
}

/** @param {{code?: string, field?: string, message?: string}} error of the protocol @param {string} text without a message */
function refusal({ code, field, message }, text) {
  return new DaemonError(`${field ? `${field}: ` : ''}${message ?? text}`, code);
}

async function* messagesOf(reader) {
  const events = new EventReader();
  for (;;) {
    const { done, value } = await reader.read();
    if (done) throw new DaemonError('The connection to the faccia daemon was lost.', 'no-daemon');
    yield* events.take(value);
  }
}
