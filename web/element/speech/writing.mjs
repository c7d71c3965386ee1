// SPDX-License-Identifier: MIT
/** A text that is spoken while it is written: what is written goes out at once, or with its `speak` when that waits. */
export class Writing {
  /** @param {(message: object) => boolean} send @param {(writing: Writing) => void} cancel */
  constructor(send, cancel) {
    this.send = send;
    this.cancelled = cancel;
    this.text = ''; // that waits
    this.key = null; // what the server knows it by, once it has been asked for
    this.closed = false;
    /** @type {Promise<object>} the `end` message, as of `speak` */
    this.done = null;
  }

  /** @param {string} text the next token, of any length */
  write(text) {
    if (this.closed || !String(text)) return;
    if (this.key) this.send({ type: 'text', id: this.key, text: String(text) });
    else this.text += text;
  }

  /** Speaks the text written so far without waiting for more. */
  flush() {
    if (!this.closed && this.key) this.send({ type: 'flush', id: this.key });
  }

  /** The text ends. */
  close() {
    if (this.closed) return;
    this.closed = true;
    if (this.key) this.send({ type: 'close', id: this.key });
  }

  /** It is cut, or not spoken at all; what else waits stays. */
  cancel() {
    this.closed = true;
    this.cancelled(this);
  }

  /** It goes out. @param {object} speak the message @returns {boolean} whether it did */
  begin(speak) {
    if (!this.send({ ...speak, text: this.text })) return false;
    this.key = speak.id;
    this.text = '';
    if (this.closed) this.send({ type: 'close', id: this.key });
    return true;
  }

  /** @param {ReadableStream|AsyncIterable} source of strings or UTF-8: all of it, and then the end */
  async from(source) {
    const decoder = new TextDecoder();
    const take = (part) => this.write(typeof part === 'string' ? part : decoder.decode(part, { stream: true }));
    try {
      if (source.getReader) {
        const reader = source.getReader();
        for (let next; !this.closed && !(next = await reader.read()).done; ) take(next.value);
        if (this.closed) reader.cancel().catch(() => {});
      } else {
        for await (const part of source) {
          if (this.closed) break;
          take(part);
        }
      }
      this.write(decoder.decode());
    } finally {
      this.close();
    }
  }
}
