// SPDX-License-Identifier: MIT
import { fetchModel, httpBase, ModelAssembler } from './loader.mjs';

/**
 * Brings the head: by HTTP, where caches help; where that way is closed (another origin that does not allow it, say), through
 * the stream.
 */
export class ModelSource {
  #assembler = new ModelAssembler();
  #aborter = null;
  #name = null; // of the model that is here or on its way
  #state = ''; // 'fetched': by HTTP; 'asked': through a stream, and lost with it; 'here'

  /** @param {object} ports ask(message): through the stream; progress({loaded, total, ratio}); show(json): the model is here */
  constructor(ports) {
    this.ports = ports;
  }

  /** Forgets what is here or on its way. */
  close() {
    this.#aborter?.abort();
    this.#assembler = new ModelAssembler();
    this.#name = null;
  }

  /**
   * The stream is there, once more perhaps.
   * @param {string} stream its address
   * @param {object} hello the server's
   * @param {string|null} wish the name of a model; null: the server's first
   */
  async open(stream, hello, wish) {
    const name = wish ?? hello.models?.[0]?.name;
    if (!name || (name === this.#name && this.#state !== 'asked')) return;
    this.#name = name;
    this.#state = 'fetched';
    this.#aborter = new AbortController();
    const { signal } = this.#aborter;
    const size = hello.models?.find((model) => model.name === name)?.bytes;
    const progress = (loaded, total) => this.ports.progress({ loaded, total, ratio: total ? loaded / total : null });
    let json;
    try {
      json = await fetchModel(`${httpBase(stream)}models/${encodeURIComponent(name)}`, size, progress, signal);
    } catch {
      if (signal.aborted) return;
      this.#state = 'asked';
      this.ports.ask({ type: 'model', name });
      return;
    }
    this.#show(json);
  }

  /** @param {object} message of type `model` */
  take(message) {
    const { index, count } = message;
    this.ports.progress({ loaded: index + 1, total: count, ratio: (index + 1) / count });
    const json = this.#assembler.take(message);
    if (json) this.#show(json);
  }

  #show(json) {
    this.#state = 'here';
    this.ports.show(json);
  }
}
