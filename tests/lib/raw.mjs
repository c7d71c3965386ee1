// SPDX-License-Identifier: GPL-3.0-or-later
// Low-level clients that can send invalid data: bytes over TCP, HTTP answers, WebSocket frames.
import { once } from 'node:events';
import net from 'node:net';

/** A connection that records received bytes. */
export class Raw {
  static async open(port, host = '127.0.0.1') {
    const raw = new Raw();
    raw.heard = Buffer.alloc(0);
    raw.ended = false;
    raw.socket = net.connect({ port, host, allowHalfOpen: true });
    raw.socket.on('data', (data) => (raw.heard = Buffer.concat([raw.heard, data])));
    raw.socket.on('error', () => {});
    raw.socket.on('end', () => (raw.ended = true));
    raw.closed = new Promise((resolve) => raw.socket.on('close', resolve));
    await once(raw.socket, 'connect');
    return raw;
  }

  write(bytes) {
    this.socket.write(bytes);
    return this;
  }

  /** Waits until the condition returns something other than undefined. Returns false if the server closes first. */
  async until(condition, milliseconds = 20000) {
    for (const deadline = Date.now() + milliseconds; ; ) {
      const value = condition();
      if (value !== undefined) return value;
      if (this.ended || this.socket.destroyed) return false;
      if (Date.now() > deadline) throw new Error(`waited in vain; heard ${this.heard.toString('latin1', 0, 500)}`);
      await new Promise((resolve) => setTimeout(resolve, 2));
    }
  }

  /** Reads the next HTTP answer: {status, headers, body}; false at the end. head: the answer to a HEAD request. */
  async answer({ head = false, milliseconds } = {}) {
    return this.until(() => {
      const end = this.heard.indexOf('\r\n\r\n');
      if (end < 0) return undefined;
      const [line, ...fields] = this.heard.toString('latin1', 0, end).split('\r\n');
      const headers = Object.fromEntries(fields.map((field) => [field.slice(0, field.indexOf(':')).toLowerCase(), field.slice(field.indexOf(':') + 1).trim()]));
      const status = Number(line.split(' ')[1]);
      let at = end + 4, body = Buffer.alloc(0);
      if (headers['transfer-encoding'] === 'chunked' && !head) {
        for (;;) {
          const stop = this.heard.indexOf('\r\n', at);
          if (stop < 0) return undefined;
          const size = parseInt(this.heard.toString('latin1', at, stop), 16);
          if (this.heard.length < stop + 4 + size) return undefined;
          body = Buffer.concat([body, this.heard.subarray(stop + 2, stop + 2 + size)]);
          at = stop + 4 + size;
          if (!size) break;
        }
      } else if (!head && status >= 200) {
        const length = headers['content-length'] === undefined && ![204, 304].includes(status) ? NaN : Number(headers['content-length'] ?? 0);
        if (Number.isNaN(length) ? !this.ended : this.heard.length < at + length) return undefined;
        body = this.heard.subarray(at, Number.isNaN(length) ? undefined : at + length);
        at += body.length;
      }
      this.heard = this.heard.subarray(at);
      return { version: line.slice(0, 8), status, headers, body: String(body) };
    }, milliseconds);
  }

  /** Waits until the server has closed. */
  async end(milliseconds = 60000) {
    await this.until(() => (this.ended || this.socket.destroyed ? true : undefined), milliseconds);
    this.socket.destroy();
    return true;
  }

  close() {
    this.socket.destroy();
    return this.closed;
  }
}

/** Sends one request and returns its answer. */
export async function ask(port, bytes, options) {
  const raw = await Raw.open(port);
  raw.write(bytes);
  const answer = await raw.answer(options);
  await raw.close();
  return answer;
}

export const handshake = (fields = {}, path = '/v1/stream?audio=none&fap=none', method = 'GET') => {
  const all = { Host: '127.0.0.1', Upgrade: 'websocket', Connection: 'Upgrade', 'Sec-WebSocket-Version': '13', 'Sec-WebSocket-Key': 'dGhlIHNhbXBsZSBub25jZQ==', ...fields };
  return `${method} ${path} HTTP/1.1\r\n${Object.entries(all).filter(([, value]) => value !== null).map(([name, value]) => `${name}: ${value}\r\n`).join('')}\r\n`;
};

/** Makes a client frame (RFC 6455, 5.2). form: size of the extended length (0, 2 or 8 bytes) instead of the minimum. */
export function frame(opcode, payload = '', { fin = true, rsv = 0, mask = true, form, length } = {}) {
  const data = Buffer.from(payload), size = length ?? data.length;
  const bytes = form ?? (size < 126 ? 0 : size < 65536 ? 2 : 8);
  const head = Buffer.alloc(2 + bytes);
  head[0] = (fin ? 0x80 : 0) | (rsv << 4) | opcode;
  head[1] = (mask ? 0x80 : 0) | (bytes === 8 ? 127 : bytes === 2 ? 126 : size);
  if (bytes === 2) head.writeUInt16BE(size, 2);
  if (bytes === 8) head.writeBigUInt64BE(BigInt(size), 2);
  if (!mask) return Buffer.concat([head, data]);
  const key = Buffer.from([0x37, 0xfa, 0x21, 0x3d]);
  return Buffer.concat([head, key, data.map((byte, i) => byte ^ key[i % 4])]);
}

export const closeFrame = (code, reason = '') => frame(8, code === undefined ? '' : Buffer.concat([Buffer.from([code >> 8, code & 255]), Buffer.from(reason)]));

/** A WebSocket that sends frames unchanged. */
export class RawSocket extends Raw {
  static async open(port, fields = {}, path) {
    const raw = Object.setPrototypeOf(await Raw.open(port), RawSocket.prototype);
    raw.write(handshake(fields, path));
    raw.accepted = await raw.until(() => {
      const end = raw.heard.indexOf('\r\n\r\n');
      if (end < 0) return undefined;
      const text = raw.heard.toString('latin1', 0, end);
      raw.heard = raw.heard.subarray(end + 4);
      return text;
    });
    return raw;
  }

  /** Reads the server's next frame: {opcode, payload}; false at the end. */
  async frame(milliseconds) {
    return this.until(() => {
      const short = this.heard[1] & 127, head = short === 127 ? 10 : short === 126 ? 4 : 2;
      if (!(this.heard.length >= head)) return undefined;
      const size = short === 127 ? Number(this.heard.readBigUInt64BE(2)) : short === 126 ? this.heard.readUInt16BE(2) : short;
      if (this.heard.length < head + size) return undefined;
      const got = { fin: this.heard[0] >> 7, opcode: this.heard[0] & 15, payload: Buffer.from(this.heard.subarray(head, head + size)) };
      this.heard = this.heard.subarray(head + size);
      return got;
    }, milliseconds);
  }

  /** Reads the next frame with that opcode. */
  async next(opcode) {
    for (;;) {
      const got = await this.frame();
      if (!got || got.opcode === opcode) return got;
    }
  }

  /** Reads the next text message with those members. */
  async message(pattern) {
    for (;;) {
      const got = await this.next(1);
      if (!got) throw new Error(`closed before ${JSON.stringify(pattern)}`);
      const message = JSON.parse(got.payload);
      if (Object.entries(pattern).every(([name, value]) => message[name] === value)) return message;
    }
  }

  /** Waits for the server's close frame: {code, reason}; code undefined if it has none. */
  async goodbye() {
    const got = await this.next(8);
    if (!got) return false;
    const payload = got.payload;
    await this.end();
    return payload.length ? { code: payload.readUInt16BE(0), reason: String(payload.subarray(2)) } : { code: undefined, reason: '' };
  }
}
