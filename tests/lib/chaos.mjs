// SPDX-License-Identifier: GPL-3.0-or-later
// Invalid and hostile messages and requests from a seeded generator.
import { readFileSync, readdirSync } from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

const documentsFolder = path.resolve(fileURLToPath(import.meta.url), '../../documents');

/** A seeded random generator (upper bits of a linear congruential generator). */
export class Chance {
  #state;
  token = null; // access token, if the daemon requires one

  constructor(seed) {
    this.#state = BigInt(seed) * 2654435761n + 1n;
  }

  /** Returns an integer from 0 to limit - 1. */
  below(limit) {
    this.#state = (this.#state * 6364136223846793005n + 1442695040888963407n) & 0xffffffffffffffffn;
    return Number(this.#state >> 33n) % limit;
  }

  one(of) {
    return this.below(of) === 0;
  }

  of(list) {
    return list[this.below(list.length)];
  }

  bytes(size) {
    return Buffer.from(Array.from({ length: size }, () => this.below(256)));
  }
}

const documents = readdirSync(documentsFolder).filter((name) => /\.(xml|txt)$/.test(name)).map((name) => readFileSync(path.join(documentsFolder, name))).filter((d) => d.length < 4000);

const rooms = ['hall', 'sala-1', 'a', '', '../x', 'x'.repeat(64), 'x'.repeat(65), 'è'];
const texts = ['Ciao.', 'Uno, due, tre. Quattro!', '', ' ', '<speak>Ciao <mark name="qui"/> a <emphasis>tutti</emphasis>.<break time="1s"/></speak>', '<apml><performative type="warn" affect="joy">Ehi!</performative></apml>',
  '<speak><prosody rate="x-slow">Piano</prosody></speak>', '<a', '<?xml version="1.0"?><!DOCTYPE a [<!ENTITY b "c">]><a>&b;</a>', '\u0000', '😀 e poi?', '1234567890'.repeat(50), '/stop', '//x', '/mood joy 0.5 fear', '/rate 9', '/join hall', '/jump qui'];
const hostile = [null, true, -1, 0, 1e308, -0.5, 1e-320, 2 ** 53, '', 'x', 'x'.repeat(70), 'a\u0000b', '\ud800', [], {}, [[]], ['a'], 'nan', '../../etc/passwd', 'espeak:it', 'it', 'weighted', 'interrupt', 'replace'];

/** Valid messages by type. */
const kinds = [
  (c) => ({ type: 'speak', text: c.one(2) ? c.of(texts) : c.of(documents).toString(), lang: c.of(['it', 'en', 'pt-BR', 'tr', undefined]), id: c.of(['a', 'b', undefined]), mode: c.of(['queue', 'replace', 'interrupt', 'quiet', undefined]), priority: c.of(['background', 'alarm', undefined]), topic: c.of(['t', undefined]), phones: c.one(2), blend: c.of(['regions', 'weighted']), fps: c.of([25, 1, 120]), rate: c.of([undefined, 40, 500]) }),
  (c) => ({ type: 'join', room: c.of(rooms) }),
  () => ({ type: 'leave' }),
  () => ({ type: 'stop' }),
  () => ({ type: 'pause' }),
  () => ({ type: 'resume' }),
  (c) => ({ type: 'rate', rate: c.of([40, 160, 500, 501]) }),
  () => ({ type: 'jump', mark: 'qui' }),
  (c) => ({ type: 'play', name: c.of(['all', 'none', '../all']), id: 'p', mode: c.of(['queue', 'interrupt']) }),
  (c) => ({ type: 'media', audio: c.of(['opus', 'pcm_s16le', 'none', undefined]), fap: c.of(['fapc', 'plain', 'none', undefined]) }),
  (c) => ({ type: 'idle', on: !c.one(3), life: c.of([0, 1, 2]), seed: c.below(9) }),
  (c) => ({ type: 'express', mix: Array.from({ length: c.below(6) }, () => ({ name: c.of(['joy', 'fear', 'none']), intensity: c.of([0, 0.5, 1, 2]) })), ease: c.of([0, 0.3, 11]) }),
  (c) => ({ type: 'model', name: c.of([undefined, 'mara', 'none']) }),
  (c) => ({ type: 'authorize', token: c.of([c.token ?? 'y', 'x', 'eyJhbGciOiJIUzI1NiJ9.eyJzdWIiOiJhIn0.AAAA', 'eyJhbGciOiJub25lIn0.e30.']) }),
  () => ({ type: 'ping', id: 'x' }),
  (c) => ({ type: 'speak', open: true, id: c.of(['w', 'v']), text: c.of([undefined, ...texts]), markup: c.of([undefined, 'plain', 'ssml', 'bml']), mode: c.of(['queue', 'replace', 'interrupt']) }),
  (c) => ({ type: 'text', id: c.of(['w', 'v', 'a']), text: c.one(2) ? c.of(texts) : c.of(documents).toString().slice(c.below(400), 400 + c.below(400)) }),
  (c) => ({ type: c.of(['flush', 'close', 'cancel']), id: c.of(['w', 'v', 'a', 'b']) }),
  (c) => ({ type: 'voice', id: c.of(['v', 'a']), codec: c.of([undefined, 'pcm', 'opus']), rate: c.of([8000, 16000, 48000, 96000]), channels: c.of([undefined, 1, 2, 8]), lookahead: c.of([undefined, 0, 120, 50]), fps: c.of([undefined, 1, 120]), mode: c.of([undefined, 'replace', 'interrupt']) }),
];

/** Changes, removes, duplicates or inserts bytes. */
function damage(c, bytes) {
  let out = Buffer.from(bytes);
  for (let i = 1 + c.below(3); i > 0 && out.length; i--) {
    const at = c.below(out.length), end = at + 1 + c.below(Math.min(30, out.length - at));
    const by = [() => [out.subarray(0, at), c.bytes(1), out.subarray(at + 1)], () => [out.subarray(0, at), out.subarray(end)], () => [out.subarray(0, end), out.subarray(at)],
      () => [out.subarray(0, at), Buffer.from(c.of(['"', '{', '\r\n', '\\u0000', '<', '&', '%', '\xff', ' '])), out.subarray(at)], () => [out.subarray(0, at)]];
    out = Buffer.concat(c.of(by)());
  }
  return out;
}

/** The text of a message: valid, with members of wrong types, damaged, or not a message at all. */
export function messageText(c) {
  const message = c.of(kinds)(c), members = Object.keys(message);
  for (let i = c.one(3) ? 1 + c.below(2) : 0; i > 0; i--) message[c.of([...members, 'rate', 'seed', 'life', 'voice', 'engine', 'markup', 'pitch', 'x'])] = c.of(hostile);
  const text = Buffer.from(JSON.stringify(message));
  switch (c.below(12)) {
    case 0: return damage(c, text);
    case 1: return Buffer.from(c.of(texts));
    case 2: return c.one(6) ? Buffer.from(`{"type":"ping","id":${'['.repeat(3000)}`) : text;
    case 3: return c.one(6) ? Buffer.from(`{"type":"speak","text":"${'a, '.repeat(60000)}"}`) : text;
    case 4: return c.one(6) ? Buffer.alloc(300000, 'a') : text;
    default: return text;
  }
}

/** A frame of RFC 6455 with any flags, valid or not. */
function frame(c, payload, { opcode = 1, fin = true, reserved = 0, masked = true, length = payload.length } = {}) {
  const head = Buffer.from([(fin ? 128 : 0) | reserved << 4 | opcode]), mask = c.one(2) ? Buffer.alloc(4) : c.bytes(4), flag = masked ? 128 : 0;
  const extended = length < 126 ? Buffer.from([flag | length]) : length < 65536 ? Buffer.from([flag | 126, length >> 8, length & 255]) : Buffer.concat([Buffer.from([flag | 127]), Buffer.alloc(8)]);
  if (length >= 65536) extended.writeBigUInt64BE(BigInt(length), 1);
  return Buffer.concat([head, extended, ...(masked ? [mask, payload.map((byte, i) => byte ^ mask[i & 3])] : [payload])]);
}

/** Splits a message into frames, mostly valid ones. */
export function webSocketFrames(c, text) {
  const cut = c.below(text.length + 1), close = (code, reason) => Buffer.concat([Buffer.from([code >> 8, code & 255]), Buffer.from(reason)]);
  switch (c.below(16)) {
    case 0: return [frame(c, text.subarray(0, cut), { fin: false }), frame(c, Buffer.from('p'), { opcode: 9 }), frame(c, text.subarray(cut), { opcode: 0 })];
    case 1: return [...text.subarray(0, 40)].map((byte, i) => frame(c, Buffer.from([byte]), { opcode: i ? 0 : 1, fin: false })).concat(frame(c, text.subarray(40), { opcode: text.length ? 0 : 1 }));
    case 2: return Array.from({ length: 1 + c.below(50) }, () => frame(c, c.bytes(c.below(126)), { opcode: c.of([9, 10]) }));
    case 3: return c.one(2) ? [frame(c, c.bytes(c.below(c.of([300, 40000]))), { opcode: 2 })] : [frame(c, Buffer.concat([text, Buffer.from([0xc3, 0x28])]))];
    case 4: return c.one(2) ? [frame(c, text)] : [c.of([
      () => frame(c, text, { reserved: 1 + c.below(7) }),
      () => frame(c, text, { masked: false }),
      () => frame(c, text, { opcode: 3 + c.below(5) }),
      () => frame(c, text, { opcode: 11 + c.below(5) }),
      () => frame(c, text, { opcode: 0 }), // a continuation without a start
      () => Buffer.concat([frame(c, text, { fin: false }), frame(c, text)]), // a second start before the end
      () => frame(c, c.bytes(200), { opcode: 9 }),
      () => frame(c, Buffer.from('p'), { opcode: 9, fin: false }),
      () => frame(c, text, { length: c.of([125, 65535, 2 ** 31, 2 ** 52]) }),
      () => c.bytes(c.below(100)),
      () => damage(c, frame(c, text)),
      () => frame(c, close(c.of([0, 999, 1000, 1001, 1005, 1006, 1015, 2999, 4000, 65535]), c.of(['', 'bye', '\xff'.repeat(120)])), { opcode: 8 }),
      () => frame(c, c.bytes(1), { opcode: 8 }),
      () => Buffer.concat([frame(c, close(1000, ''), { opcode: 8 }), frame(c, text)]), // data after a close frame
    ])()];
    default: return [frame(c, text)];
  }
}

const upgradeHeaders = (c) => `Connection: ${c.of(['Upgrade', 'keep-alive, Upgrade'])}\r\nUpgrade: websocket\r\nSec-WebSocket-Version: ${c.one(20) ? c.of(['8', '0', '14', '']) : 13}\r\n`
  + `Sec-WebSocket-Key: ${c.one(20) ? c.of(['', 'x', 'dGhlIHNhbXBsZSBub25jZQ', 'a'.repeat(500)]) : 'dGhlIHNhbXBsZSBub25jZQ=='}\r\n`;
const query = (c) => (c.one(2) ? '' : `?${Array.from({ length: 1 + c.below(4) }, () => c.of(['room=hall', 'lang=it', 'audio=pcm', 'fap=plain', 'rate=fast', `token=${c.token ?? 'y'}`, 'token=' + 'x'.repeat(c.below(700)), 'room', '=', '%', '%zz=%00', 'x=%ff', 'text=%3Cspeak%3E', 'format=' + c.of(['wav', 'ogg', 'fap', 'fapc', 'json', 'ndjson', 'arkit', 'arkit-ndjson', 'visemes', 'gif']), 'still=1', 'fps=120', 'id=a', 'name=all', 'mode=replace', `room=${c.of(['b', 'x'.repeat(70)])}`, '&&', 'a=b=c', '#'])).join('&')}`);

/** An upgrade request, mostly valid. */
export function upgradeRequest(c) {
  const protocol = c.of(['', '', 'Sec-WebSocket-Protocol: faccia.v1\r\n', 'Sec-WebSocket-Protocol: faccia.text.v1\r\n', `Sec-WebSocket-Protocol: x, faccia.v1, token.${'y'.repeat(c.below(300))}\r\n`, 'Sec-WebSocket-Protocol: none\r\n']);
  const extensions = c.one(4) ? 'Sec-WebSocket-Extensions: permessage-deflate; client_max_window_bits\r\n' : '';
  const text = `GET ${c.one(10) ? c.of(['/', '/v1/nothing', '*', '/v1/stream/']) : '/v1/stream'}${query(c)} HTTP/1.${c.one(20) ? 0 : 1}\r\nHost: 127.0.0.1\r\n${upgradeHeaders(c)}${protocol}${extensions}\r\n`;
  return c.one(12) ? damage(c, Buffer.from(text)) : Buffer.from(text);
}

const paths = ['/', '/healthz', '/metrics', '/v1/voices', '/v1/models', '/v1/models/mara', '/v1/rooms', '/v1/media', '/v1/expressions', '/v1/speech', '/v1/audio/speech', '/v1/say', '/v1/play', '/v1/stop', '/v1/rooms/r/commands', '/v1/events', '/v1/stream', '/../x', '/%2e%2e/x', '//', '/v1/speech/', '/talking-head.js'];

/** A body and its headers, which may be false. */
function body(c, path_) {
  const form = '--b\r\nContent-Disposition: form-data; name="fap"; filename="a.fap"\r\n\r\n2.1 x 25 1\n' + '0 '.repeat(68) + '\n0\n\r\n--b--\r\n';
  const type = path_ === '/v1/play' ? 'multipart/form-data; boundary=b' : c.of(['text/plain', 'application/ssml+xml', 'application/xml', 'application/json', 'image/png', 'multipart/form-data; boundary=']);
  const bytes = path_ === '/v1/play' ? (c.one(3) ? damage(c, form) : Buffer.from(form)) : c.one(2) ? Buffer.from(c.of(texts)) : c.of(documents);
  const head = `Content-Type: ${type}\r\n${c.one(10) ? 'Expect: 100-continue\r\n' : ''}`;
  switch (c.below(10)) {
    case 0: {
      const cut = c.below(bytes.length + 1), chunk = (part) => (part.length ? Buffer.concat([Buffer.from(`${part.length.toString(16)}\r\n`), part, Buffer.from('\r\n')]) : Buffer.alloc(0));
      const chunks = Buffer.concat([chunk(bytes.subarray(0, cut)), chunk(bytes.subarray(cut)), Buffer.from('0\r\n\r\n')]);
      return [`${head}Transfer-Encoding: chunked\r\n`, c.one(3) ? damage(c, chunks) : chunks];
    }
    case 1: return [`${head}Content-Length: ${c.of(['-1', '+5', '5a', '', '99999999999999999999', '0x5', ' 5 5', '5, 5', '0'])}\r\n`, bytes];
    case 2: return [`${head}Content-Length: ${bytes.length}\r\n${c.of(['Content-Length: 3', 'Transfer-Encoding: chunked', 'Transfer-Encoding: gzip, chunked'])}\r\n`, bytes];
    case 3: return [`${head}Content-Length: ${bytes.length + 10}\r\n`, bytes]; // the rest is never sent
    default: return [`${head}Content-Length: ${bytes.length}\r\n`, bytes];
  }
}

/** A request, valid or not. */
export function httpRequest(c) {
  const path_ = c.of(paths), method = path_.startsWith('/v1/s') && !c.one(4) ? 'POST' : c.of(['GET', 'GET', 'GET', 'POST', 'HEAD', 'OPTIONS', 'DELETE', 'PUT', 'TRACE', 'CONNECT', 'PRI', 'get', 'X'.repeat(40)]);
  const more = c.one(3) ? c.of([
    () => 'Connection: close\r\n', () => 'Connection: keep-alive\r\n', () => `Origin: ${c.of(['https://evil.example', 'null', 'http://localhost', 'x'.repeat(300)])}\r\n`,
    () => 'Upgrade: h2c\r\nConnection: Upgrade, HTTP2-Settings\r\nHTTP2-Settings: AAMAAABkAAQAAP__\r\n', () => upgradeHeaders(c), () => `Authorization: Bearer ${c.of([c.token ?? 'y', 'x'.repeat(c.below(4000))])}\r\n`,
    () => `X-${'y'.repeat(c.below(200))}: ${'z'.repeat(c.below(5000))}\r\n`, () => 'A: b\r\n'.repeat(c.below(200)), () => 'If-None-Match: "x"\r\nAccept-Encoding: gzip\r\n', () => 'Range: bytes=5-\r\n', () => ' folded: x\r\n', () => 'Host: other\r\n', () => 'A\0: b\r\n', () => 'A : b\r\n',
  ])() : '';
  const [headers, bytes] = method === 'POST' || method === 'PUT' || c.one(10) ? body(c, path_) : ['', Buffer.alloc(0)];
  const request = Buffer.concat([Buffer.from(`${method} ${path_}${query(c)} HTTP/${c.one(25) ? c.of(['1.0', '2.0', '0.9', '1.2', '1.1.1', '']) : '1.1'}\r\n${c.one(15) ? '' : 'Host: 127.0.0.1\r\n'}${more}${headers}\r\n`), bytes]);
  if (c.one(40)) return Buffer.from('PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n\0\0\0\x04\0\0\0\0\0', 'latin1');
  return c.one(10) ? damage(c, request) : request;
}
