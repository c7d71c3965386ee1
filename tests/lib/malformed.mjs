// SPDX-License-Identifier: GPL-3.0-or-later
// Bytes that RFC 9112 and RFC 6455 forbid. The daemon's tests send them, and so does bench/strict.mjs, to compare.
import { frame } from './raw.mjs';

const [MORE, TEXT, BINARY, CLOSE, PING, PONG] = [0, 1, 2, 8, 9, 10];

/** A GET request; `fields` are more headers, each with its line end. */
export const get = (target = '/healthz', fields = '') => `GET ${target} HTTP/1.1\r\nHost: localhost\r\n${fields}\r\n`;

/** The head of a POST request with a text. */
export const head = (fields, target = '/v1/speech?lang=it&format=json', version = '1.1') => `POST ${target} HTTP/${version}\r\nHost: localhost\r\nContent-Type: text/plain\r\n${fields}\r\n`;

/** Heads: [name, bytes, status, error code]. */
export const heads = [
  ['no host', 'GET /healthz HTTP/1.1\r\n\r\n', 400, 'bad-host'],
  ['two hosts', get('/healthz', 'Host: y\r\n'), 400, 'bad-host'],
  ['a host that is none', 'GET /healthz HTTP/1.1\r\nHost: a b\r\n\r\n', 400, 'bad-host'],
  ['a folded header', get('/healthz', 'X-A: b\r\n c\r\n'), 400, 'bad-header'],
  ['an empty header that is folded', get('/healthz', 'X-A:\r\n c\r\n'), 400, 'bad-header'],
  ['a bare CR in a header', get('/healthz', 'X-A: b\rc\r\n'), 400, 'bad-request'],
  ['a NUL in a header', get('/healthz', 'X-A: b\0c\r\n'), 400, 'bad-request'],
  ['a space before a colon', get('/healthz', 'X-A : b\r\n'), 400, 'bad-header'],
  ['a space in a name', get('/healthz', 'X A: b\r\n'), 400, 'bad-header'],
  ['a line without a colon', get('/healthz', 'nonsense\r\n'), 400, 'bad-request'],
  ['two spaces in the first line', 'GET  /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n', 400, 'bad-request'],
  ['a space in the address', 'GET /a b HTTP/1.1\r\nHost: localhost\r\n\r\n', 400, 'bad-request'],
  ['a fragment', get('/healthz#a'), 400, 'bad-target'],
  ['an unknown method', 'BREW /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n', 501, 'unknown-method'],
  ['a method that is not taken', 'PATCH /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n', 405, 'method-not-allowed'],
  ['CONNECT', 'CONNECT x:80 HTTP/1.1\r\nHost: localhost\r\n\r\n', 405, 'method-not-allowed'],
  ['HTTP/9.9', 'GET / HTTP/9.9\r\nHost: localhost\r\n\r\n', 505, 'unknown-version'],
  ['an expectation', get('/healthz', 'Expect: a miracle\r\n'), 417, 'unknown-expectation'],
  ['a long address', get(`/healthz?x=${'a'.repeat(9000)}`), 414, 'uri-too-long'],
  ['an address without end', `GET /${'a'.repeat(30000)}`, 414, 'uri-too-long'],
  ['large headers', get('/healthz', `X-A: ${'b'.repeat(20000)}\r\n`), 431, 'headers-too-large'],
  ['many headers', get('/healthz', 'X-A: b\r\n'.repeat(200)), 431, 'headers-too-large'],
];

/** Bodies: [name, bytes, status, error code]. The connection must be closed after each. */
export const bodies = [
  ['both lengths', head('Content-Length: 5\r\nTransfer-Encoding: chunked\r\n') + '0\r\n\r\n', 400, 'bad-length'],
  ['both, the other way round', head('Transfer-Encoding: chunked\r\nContent-Length: 5\r\n') + '0\r\n\r\n', 400, 'bad-length'],
  ['differing lengths', head('Content-Length: 5\r\nContent-Length: 6\r\n') + 'abcdef', 400, 'bad-length'],
  ['the same length twice', head('Content-Length: 5\r\nContent-Length: 5\r\n') + 'abcde', 400, 'bad-length'],
  ['a list of lengths', head('Content-Length: 5, 5\r\n') + 'abcde', 400, 'bad-length'],
  ['+5', head('Content-Length: +5\r\n') + 'abcde', 400, 'bad-length'],
  ['-5', head('Content-Length: -5\r\n') + 'abcde', 400, 'bad-length'],
  ['5a', head('Content-Length: 5a\r\n') + 'abcde', 400, 'bad-length'],
  ['0x5', head('Content-Length: 0x5\r\n') + 'abcde', 400, 'bad-length'],
  ['no number', head('Content-Length: \r\n') + 'abcde', 400, 'bad-length'],
  ['more than there can be', head('Content-Length: 99999999999999999999\r\n'), 400, 'bad-length'],
  ['gzip', head('Transfer-Encoding: gzip, chunked\r\n') + '0\r\n\r\n', 501, 'unknown-coding'],
  ['chunked twice', head('Transfer-Encoding: chunked, chunked\r\n') + '0\r\n\r\n', 501, 'unknown-coding'],
  ['chunked in two headers', head('Transfer-Encoding: chunked\r\nTransfer-Encoding: chunked\r\n') + '0\r\n\r\n', 501, 'unknown-coding'],
  ['an unknown coding', head('Transfer-Encoding: xchunked\r\n') + '0\r\n\r\n', 501, 'unknown-coding'],
  ['chunks in HTTP/1.0', head('Transfer-Encoding: chunked\r\n', undefined, '1.0') + '0\r\n\r\n', 400, 'bad-length'],
  ['a chunk with a sign', head('Transfer-Encoding: chunked\r\n') + '+5\r\nabcde\r\n0\r\n\r\n', 400, 'bad-chunk'],
  ['a chunk in another notation', head('Transfer-Encoding: chunked\r\n') + '0x5\r\nabcde\r\n0\r\n\r\n', 400, 'bad-chunk'],
  ['a chunk without a size', head('Transfer-Encoding: chunked\r\n') + '\r\nabcde\r\n0\r\n\r\n', 400, 'bad-chunk'],
  ['a chunk longer than it says', head('Transfer-Encoding: chunked\r\n') + '5\r\nabcdeXX0\r\n\r\n', 400, 'bad-chunk'],
  ['a chunk that ends by LF', head('Transfer-Encoding: chunked\r\n') + '5\nabcde\r\n0\r\n\r\n', 400, 'bad-chunk'],
  ['a chunk larger than any number', head('Transfer-Encoding: chunked\r\n') + 'fffffffffffffffff\r\n', 400, 'bad-chunk'],
  ['an extension without end', head('Transfer-Encoding: chunked\r\n') + `5;${'x'.repeat(5000)}`, 400, 'bad-chunk'],
  ['trailers without end', head('Transfer-Encoding: chunked\r\n') + `0\r\n${'X-A: b\r\n'.repeat(2000)}`, 400, 'bad-chunk'],
];

/** WebSocket frames by name: [bytes, reason of the close 1002]. */
export const frames = {
  'a length of 16 bits that fits 7': [frame(TEXT, 'abc', { form: 2 }), 'bad-frame'],
  'a length of 64 bits that fits 16': [frame(TEXT, 'abc', { form: 8 }), 'bad-frame'],
  'a length with its highest bit set': [Buffer.concat([Buffer.from([0x81, 0xff, 0x80, 0, 0, 0, 0, 0, 0, 1]), Buffer.alloc(8)]), 'bad-frame'],
  'a frame that is not masked': [frame(TEXT, 'abc', { mask: false }), 'not-masked'],
  'a ping that is not masked': [frame(PING, 'abc', { mask: false }), 'not-masked'],
  'RSV1': [frame(TEXT, 'abc', { rsv: 4 }), 'reserved-bits'],
  'RSV2': [frame(TEXT, 'abc', { rsv: 2 }), 'reserved-bits'],
  'RSV3 of a ping': [frame(PING, 'abc', { rsv: 1 }), 'reserved-bits'],
  'RSV1 of an empty close': [frame(CLOSE, '', { rsv: 4 }), 'reserved-bits'],
  ...Object.fromEntries([3, 4, 5, 6, 7, 11, 12, 13, 14, 15].map((opcode) => [`opcode ${opcode}`, [frame(opcode, 'abc'), 'reserved-opcode']])),
  'a ping of 126 bytes': [frame(PING, 'x'.repeat(126)), 'bad-frame'],
  'a pong of 126 bytes': [frame(PONG, 'x'.repeat(126)), 'bad-frame'],
  'a close of 126 bytes': [frame(CLOSE, Buffer.concat([Buffer.from([3, 232]), Buffer.alloc(124, 'x')])), 'bad-frame'],
  'a ping in pieces': [Buffer.concat([frame(PING, 'a', { fin: false }), frame(MORE, 'b')]), 'bad-frame'],
  'a continuation of nothing': [frame(MORE, 'abc'), 'continues-nothing'],
  'an unfinished continuation of nothing': [frame(MORE, 'abc', { fin: false }), 'continues-nothing'],
  'a continuation after a whole message': [Buffer.concat([frame(TEXT, '{"type":"ping","id":"w"}'), frame(MORE, 'abc')]), 'continues-nothing'],
  'a text within a text': [Buffer.concat([frame(TEXT, 'a', { fin: false }), frame(TEXT, 'b')]), 'not-continued'],
  'a binary message within a text': [Buffer.concat([frame(TEXT, 'a', { fin: false }), frame(BINARY, 'b')]), 'not-continued'],
};

/** Texts that are not UTF-8, in hexadecimal. */
export const badTexts = ['80', 'bf', 'c0af', 'c1bf', 'e08080', 'e09fbf', 'eda080', 'edbfbf', 'f0808080', 'f08fbfbf', 'f4908080', 'f5808080', 'f8888080', 'fe', 'ff', 'c328', 'e228a1', 'e2828c28ff'.slice(0, 8) + 'ff', 'cebae1bdb9cf83cebcceb5eda080656469746564'];
