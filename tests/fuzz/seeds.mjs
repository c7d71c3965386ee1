// SPDX-License-Identifier: GPL-3.0-or-later
// Writes inputs for a fuzz target, made from files of the repository: node seeds.mjs TARGET FOLDER
import { mkdirSync, readFileSync, readdirSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { deflateSync } from 'node:zlib';
import { Chance, httpRequest, messageText, upgradeRequest, webSocketFrames } from '../lib/chaos.mjs';
import { FbaWriter } from '../lib/fba-writer.mjs';
import { wavOf } from '../lib/wav.mjs';

const root = path.join(import.meta.dirname ?? path.dirname(new URL(import.meta.url).pathname), '..', '..');
const read = (...names) => readFileSync(path.join(root, ...names));
const json = (...names) => JSON.parse(read(...names));
const list = (folder, ending) => readdirSync(path.join(root, folder)).filter((name) => name.endsWith(ending)).map((name) => path.join(folder, name));
const hex = (text) => Buffer.from(text, 'hex');

const u16 = (value) => Buffer.from([value & 255, value >> 8 & 255]);
const u32 = (value) => Buffer.concat([u16(value), u16(value >>> 16)]);
const u64 = (value) => Buffer.concat([u32(value), u32(0)]);
const joined = (...parts) => Buffer.concat(parts.map((part) => (typeof part === 'number' ? Buffer.from([part]) : Buffer.from(part))));
/** With its size before it. */
const sized = (bytes) => joined(u16(Buffer.byteLength(bytes)), bytes);

/** Language, a text, and lexemes for its words. */
const lexicons = [
  ['it', "L'ONU di  Ginevra, R&D e perche\u0301 😀!", '<lexeme><grapheme>ONU di Ginevra</grapheme><alias>sede 12</alias></lexeme><lexeme><grapheme>R&amp;D</grapheme><grapheme>perché</grapheme><phoneme>ˈbobo</phoneme></lexeme><lexeme><grapheme>😀</grapheme><alias>sorriso</alias></lexeme>'],
  ['pt-BR', 'Dona Inês, <b>às</b> 8.', '<lexeme role="n"><grapheme>Inês</grapheme><phoneme prefer="true" alphabet="x-sampa">tSitSi</phoneme><phoneme>a</phoneme></lexeme><meta name="a" content="b"/><lexeme><alias>x</alias></lexeme>'],
  ['tr', "Ankara'da IŞIK ve ışık.", '<lexeme><grapheme>Ankara</grapheme><alias>başkent</alias></lexeme><lexeme><grapheme>ışık</grapheme><alias>nur</alias></lexeme>'],
  ['en', "<speak>Worcester's <emphasis>R&amp;D</emphasis> <sub alias='x'>NASA</sub></speak>", '<lexeme><grapheme>Worcester</grapheme><alias>Wooster</alias></lexeme><lexeme><grapheme>R&amp;D</grapheme><alias>research</alias></lexeme><!-- x --><metadata><a/></metadata>'],
  ['ja', '東京都に行く。', '<lexeme><grapheme>東京都</grapheme><alias>とうきょう</alias></lexeme><lexeme><grapheme></grapheme></lexeme>'],
];

const documents = () => [...list('tests/documents', '.xml'), ...list('tests/documents', '.txt')].map((name) => read(name));
const tone = (rate, count, channels = 1) => wavOf(Int16Array.from({ length: count * channels }, (_, i) => 8000 * Math.sin(i / 5)), rate, channels);

const timesFiles = {
  lab: 'signal x\n#\n0.1 125 pau\n0.25 125 a\n0.5 125 m\n',
  htk: '#!MLF!#\n"*/frase.lab"\n0 1000000 sil -10.5 sil\n1000000 2000000 tS -1.5 uno\n2000000 3000000 a -2\n3000000 4000000 o -1 due\n.\n',
  textgrid: 'File type = "ooTextFile"\nObject class = "TextGrid"\n\n0\n0.5\n<exists>\n2\n"IntervalTier"\n"words"\n0\n0.5\n2\n0\n0.1\n""\n0.1\n0.5\n"uno due"\n'
    + '"IntervalTier"\n"phones"\n0\n0.5\n2\n0\n0.1\n""\n0.1\n0.5\n"a"\n',
  json: '{"phones": [{"ipa": "", "start": 0, "end": 0.1}, {"ipa": "a", "start": 0.1, "end": 0.4, "stress": 2}], "words": [{"text": "uno", "start": 0.1, "end": 0.2}, {"text": "due", "start": 0.2, "end": 0.4}]}',
  offsets: '0: 680 ##\n1: 1048 nn\n2: 3464 \'a~\n3: 5686 uu\n4: 8694 ##\n5: 9000\n',
};
const utf16 = (text) => joined([0xff, 0xfe], Buffer.from(text, 'utf16le'));

const messages = [
  { type: 'speak', text: 'Ciao, mondo!', id: 'a', lang: 'it', voice: 'espeak:it', engine: 'dominance', markup: 'ssml', rate: 160, pitch: 1.5, volume: 0.5, fps: 50, seed: 7, life: 0.5, blend: 'weighted', still: true, phones: true, mode: 'interrupt' },
  { type: 'idle', on: true, life: 1.5, seed: 3 },
  { type: 'express', mix: [{ name: 'joy', intensity: 0.5 }, { name: 'fear' }], ease: 0.25 },
  { type: 'media', audio: 'opus', fap: 'fapc' },
  { type: 'join', room: 'hall' }, { type: 'rate', rate: 200 }, { type: 'jump', mark: 'here' }, { type: 'play', name: 'x', id: 'b' },
];
const answers = [
  { type: 'begin', stream: 's1', utterance: 1, rate: 22050, fps: 25, voice: 'espeak:it' },
  { type: 'word', time: 0.25, duration: 0.5, text: 'mon\u0007do', start: 0, end: 4 },
  { type: 'error', code: 'bad-xml', message: 'no', line: 2, column: 3 }, { type: 'end', reason: 'done', duration: 1.5 },
];
const say = (text) => Buffer.from(typeof text === 'string' ? text : JSON.stringify(text));

/** A frame of the worker's socket, and its contents (server/voice/wire.h). */
const frame = (type, ...parts) => { const body = joined(...parts); return joined(u32(body.length), u32(type), u32(1), body); };
const text = (value) => (value === null ? u32(0xffffffff) : joined(u32(Buffer.byteLength(value)), value, 0));
const event = {
  phone: (ipa, start, end) => joined(u32(1), u64(start), u64(end), u32(0), text(ipa), text(ipa)),
  word: (span, offset, bytes, start, end) => joined(u32(2), u32(span), u64(offset), u64(bytes), u64(start), u64(end)),
  mark: (name, at) => joined(u32(3), text(name), u64(at)),
  warning: (message) => joined(u32(4), text(message)),
};

const parts = {
  markup: () => documents().flatMap((document, i) => [joined(0, 0, document), joined(1 + i % 5, i % 8, document)]),
  lexicon: () => lexicons.flatMap(([lang, said, lexemes], i) => [false, true].map((folds) => joined(i % 6, sized(said),
    `<?xml version="1.0"?>\n<lexicon version="1.0" xmlns="http://www.w3.org/2005/01/pronunciation-lexicon" xmlns:f="urn:f" alphabet="ipa" xml:lang="${lang}"${folds ? ' f:case="any"' : ''}>${lexemes}</lexicon>`))),
  score: () => documents().map((document, i) => joined(i % 6, i * 37 % 256, i % 2 * 60, document)),
  face: () => [0, 1, 2, 3, 4].map((lang) => joined(lang, lang * 5, 128, ...['', 'p', 'a', 't͡ʃ', 'o', '', 'm', 'u', 'kː'].map((ipa, i) => joined(0, i % 3, u16(800), ipa, '\n')),
    5, u16(3000), 'ağlar\n', 7, lang * 9, u16(2000), [255, 255, 0, 128, 90, 90])),
  fap: () => list('protocol/vectors/fap', '.fap').map((name) => read(name)),
  fapc: () => {
    const { streams, bad } = json('protocol', 'vectors', 'fapc.json');
    const packet = ({ frames = [0], bytes }) => joined(frames.length, sized(hex(bytes)));
    const file = ({ packets }) => joined('FPC1', u32(2500), ...packets.map(({ frames, bytes }) => joined(frames.length, sized(hex(bytes)))));
    return [...streams.map((s) => joined(1, ...s.packets.map(packet))), ...bad.map((b) => joined(1, packet(streams[0].packets[0]), packet(b))), ...streams.map((s) => joined(0, file(s))),
      joined(2, 0, 7, ...Array.from({ length: 40 }, (_, i) => joined(3, i, 1, u32(i * 99), i, 0, u16(i * 1000), i, 0, 5, 7, 1, 2, 3, 4, 5, 6, 7, 8)))];
  },
  fba: () => {
    const face = [0, ...Array(9).fill(3)];
    const stream = (intra, next, end) => {
      const writer = new FbaWriter();
      writer.frame({ intra: true, ...intra });
      for (const frame of next) writer.frame(frame);
      return joined(0, writer.end(end));
    };
    const levels = (by) => ({ 3: by, 4: -by, 19: 2 * by, 48: by });
    return [stream({ types: face, quant: 4, ranges: [10, 10, 9, 9], rate: [25, 0, 0], levels: levels(20) }, [1, -1, 5].map((by) => ({ levels: levels(by) })), 'code'),
      stream({ types: [3, 1, 2, 0, 3, 0, 0, 0, 2, 1], mask: [3, 4, 19], quant: 17, time: [1, 2, 3], viseme: [1, 2, 30, 1], expression: [1, 2, 3, 4, 1, 0], levels: levels(3) },
        [{ viseme: [2, 1, 60, 0], expression: [6, 60, 0, 0, 0, 1], levels: levels(-1), skip: 17 }], 'ones'),
      stream({ types: face, dct: true }, [], 'zeros'), joined(1, 4, 28, 9, 40, Array.from({ length: 200 }, (_, i) => (i * 37) % 256)), joined(1, 0, 200, 23, 1, Array.from({ length: 300 }, (_, i) => (i * 91) % 251))];
  },
  fapfit: () => {
    const frame = Array(66).fill([1, 40, 0]).flat();
    const none = Array(66).fill(0);
    const node = 'FIT {\n FAPs [3 4 5 -1 6 7 -1 72 73 74 75 -1 12 17 -1]\n Graph [1 2 3 4] # two links\n numeratorTerms [4 1 2 2] denominatorTerms [2 1 1 1]\n numeratorExp [1 0 0 0 1 0 0 0 1 1 2 0 0 1 0 0 1 0 0 0 0 0 1 0 1 0 0 0 0 0 1]\n denominatorExp [0 0 1 1 1 1 0 0 0 0 0 0 0 0 0 0 0]\n numeratorImpulse [72 6 74 6 72 6 74 6] numeratorCoefs [1 2 3 4 1 .6 .6 -1.5 -1.5] denominatorCoefs [5 6 1 1 1]\n}';
    return [joined(0, frame.slice(0, 9), none.slice(3), 3, 1, 6, 30, node), joined(0, none, 0, 0, 0, 0, '<Face><fit><FIT DEF="t" FAPs="3 -1 4 -1" Graph="1 2" numeratorTerms="1" denominatorTerms="0" numeratorExp="1" numeratorCoefs="2"/></fit></Face>'),
      joined(1, 3, 4, frame, 0, 0, 0, 0, frame, 0, 0, 0, 0)];
  },
  chunks: () => {
    const { good, loose, bad } = json('protocol', 'vectors', 'chunks.json');
    return [...good, ...loose, ...bad].flatMap((v) => [joined(0, hex(v.hex)), joined(1, sized(hex(v.hex)), sized(hex(v.hex)))]);
  },
  requests: () => [...messages.map((m) => joined(0, say(m))), joined(1, Object.entries(messages[0]).map(([name, value]) => `${name}=${value}\n`).join('')), ...answers.map((m) => joined(2, say(m)))],
  settings: () => [joined(0, '{"listen": {"host": "::1", "port": 9000, "origins": ["https://a.example"], "remote": true}, "limits": {"text_bytes": 1000, "queue": 3}, "voices": {"plugins": {"espeak": {}}}}'),
    joined(1, 3, 0, 0, 1), ...[0, 1, 5, 9, 14].map((i) => joined(2, i, '12.5'))],
  times: () => Object.values(timesFiles).flatMap((file, i) => [joined(5, 0, file), joined(i, 8 + i, file), joined(5, 4, utf16(file))]),
  tokens: () => [joined(0, 'eyJhbGciOiJIUzI1NiJ9.eyJzdWIiOiJhbm5hIn0.AAAA'), joined(0, 'eyJhbGciOiJub25lIn0.eyJzdWIiOiJhIn0.'),
    joined(1, '\n{"sub": "anna", "room": "hall", "rights": "listen speak", "exp": 2000000}'), joined(1, '{"typ": "JWT"}\n{"sub": "a", "rights": "operate", "exp": 9e99, "nbf": 5, "iat": 1}'),
    joined(2, 2, u16(99), u16(8), 5, 'anna\nhall'), joined(3, 'https://www.example.org:8443\nwww.example.org\nhttps://*.example.org:8443\nnull\n*'), joined(3, 'http://localhost:80\n127.0.0.1\n'),
    joined(4, 'short\n0123456789abcdef0123456789abcdef0\r\n\nfedcba9876543210fedcba9876543210')],
  wire: () => {
    const audio = frame(6, u32(16000), Buffer.alloc(3200, 1));
    return [joined(audio, frame(7, event.phone('a', 0, 800), event.word(0, 0, 7, 0, 800), event.mark('qui', 800), event.phone('p', 800, 1600)), audio, frame(8, u32(0), text(''))),
      joined(audio, frame(7, event.word(0, 8, 2, 100, 0), event.word(3, 0, 3, 900, 1000), event.warning('no'))),
      joined(frame(1, text('{}'), u32(64), u32(5), u32(1), u32(0)), frame(4, text('{"name": "x", "capabilities": 3, "voices": [{"id": "b", "name": "B", "lang": "it", "gender": "male", "sample_rate": 16000, "rate": 150}, {"id": "b"}, {"id": ""}]}')), frame(5, text('no')), frame(3),
        frame(2, u32(5), text('it'), u32(1), u32(0), u32(3), Buffer.alloc(48), text('uno'), text('it'), text(null), text('digits'), text(null)))];
  },
  cluster: () => {
    const short = (value) => joined(value.length, value);
    const piece = (end, last, index, ...rest) => joined(1, 'fw1l', end, last, u32(index), ...rest);
    const packet = (head, ...body) => joined(2, JSON.stringify(head), '\n', ...body);
    const sound = Buffer.alloc(800, 3);
    return [joined(0, 'fw1l', frame(2, u32(5))), joined(0, 'fw1b'), piece(0, 0, 0, short('q:abc:live:3 17-0'), short('w1'), frame(6, u32(16000), Buffer.alloc(32, 1))), piece(1, 1, 258, short('t'), short('a')),
      packet({ v: 3, kind: 'here', room: 'hall', from: 'f'.repeat(32), ways: [1, 2], n: 7 }), packet({ v: 3, kind: 'said', room: 'hall', at: 0.1, token: 12, parts: [{ event: 'word', size: 40, line: 9 }, { as: [1, 2, 0, false], size: 24 }] }, Buffer.alloc(64, 9)), packet({ v: 1, kind: 'gone', room: 'hall' }),
      joined(3, 1, u32(sound.length), deflateSync(sound))];
  },
  // the first byte sets the length of the pieces
  heard: () => ['the second one\n', '{"text":"","final":false}\n', 'one\n two \n', '{"text":"Sì, gr","final":false}\n{"text":"Sì, grazie","confidence":0.5}\n', '{"text":7}\n[]\n\xff\0\u0007x', '{"type":"transcript","data_length":15}\n{"text":"words"}',
    '{"type":"transcript-chunk","data":{"text":"x"},"payload_length":2}\nab'].map((output) => joined(3, output)),
  replies: () => ['+PONG\r\n', '-NOSCRIPT no such script\r\n', ':-17\r\n', '$-1\r\n', '$0\r\n\r\n', '$5\r\nhe\r\no\r\n', '*-1\r\n', '*0\r\n:1\r\n', '*3\r\n$9\r\nsubscribe\r\n$1\r\na\r\n:1\r\n*3\r\n$7\r\nmessage\r\n$1\r\na\r\n$3\r\nxyz\r\n',
    '*2\r\n*1\r\n*2\r\n:1\r\n$-1\r\n*1\r\n*0\r\n', '*1\r\n'.repeat(7), '*2147483647\r\n:1\r\n', '*-2\r\n', '$2147483647\r\nx', '$-2\r\n', ':9223372036854775808\r\n', '$05\r\nhello\r\n', '+a\rb\r\n', '>2\r\n', `+${'x'.repeat(5000)}`]
    .flatMap((reply) => [0, 63].map((step) => joined(step, reply))),
  packs: () => Array.from({ length: 16 }, (_, i) => joined(i % 8, u16(i * 7), i % 9, u16(3), 1, 'a')),
  tables: () => Array.from({ length: 15 }, (_, i) => joined(i % 5, u16(i * 11), i % 9, u16(3), 1, 'a')),
  reading: () => ['12', '-1.234,5', '1/2', '3 1/2', '1.5.2024', '2024-05-01', '12:30:15', '7pm', '2h3m4s', 'PT2H', '€ 3,50', '$1,000.99', '5 kg', '3.5 km/h', 'anna@example.it', 'https://a.example/b?c=d', 'XIV', '+39 06 123', 'MCMXC']
    .flatMap((t, i) => [0, 1, 2, 3].map((lang) => joined(lang, (i * 3 + lang) % 20, t))),
  models: () => [joined(0, read('tests/fuzz/head.json')), ...Array.from({ length: 9 }, (_, i) => joined(1, u16(i * 5), i, u16(2), 1, 'a'))],
  capture: () => {
    const text = (words) => Buffer.from(words + '\0'.repeat(4 - (words.length % 4)));
    const message = (name, weight) => joined(text('/VMC/Ext/Blend/Val'), text(',sf'), text(name), Buffer.from(new Uint8Array(new Float32Array([weight]).buffer)).reverse());
    const apply = joined(text('/VMC/Ext/Blend/Apply'), text(','));
    const element = (bytes) => joined(Buffer.from([0, 0, bytes.length >> 8, bytes.length & 255]), bytes);
    const bundle = (...parts) => joined('#bundle\0', Buffer.alloc(8), ...parts.map(element));
    const table = (head, ...rows) => [head, ...rows].join('\r\n');
    const number = (value) => Buffer.from(new Uint8Array(new Float32Array([value]).buffer)).reverse();
    const bone = (...rotation) => joined(text('/VMC/Ext/Bone/Pos'), text(',sfffffff'), text('Head'), ...[0, 0, 0, ...rotation].map(number));
    const link = joined(6, 0, 0, 0, 2, 'id', 0, 0, 0, 4, 'face', 0, 0, 1, 0, number(0.5), 0, 0, 0, 60, 0, 0, 0, 1, 61, ...Array.from({ length: 61 }, (_, i) => number(i / 61)));
    return [
      table('Timecode,BlendShapeCount,JawOpen,EyeBlinkLeft,HeadYaw,HeadPitch,LeftEyePitch', '10:00:00:00.000,61,0.1,0,0.1,0.2,0.3', '10:00:00:30.500,61,0.9,1,-0.1,0,0', '10:00:01:00,61,0,0,0,0,0'),
      table('Timecode,BlendShapeCount,MouthClose', '23:59:59:59,61,0.5', '00:00:00:01,61,0.6', 'x,61,nan'),
      'time,LI,LS,AR,PI,PS,EM,confidence\n0,0,0,0,0,0,0,1\n0.04,8,2,-3,1,1,10,1\n0.1,-1,0,5,0,0,0,0\n',
      joined(0, sized(message('jawOpen', 0.5)), sized(apply), sized(bundle(message('EyeBlinkLeft', 1), bundle(message('mouthClose', -1e30), apply)))),
      joined(0, sized(bundle(bundle(bundle(bundle(bundle(apply)))))), sized(message('jawOpen', NaN)), 9, 0, '#bundle'),
      joined(0, sized('jawOpen-12|mouthSmile_L-5|=head#1,-2.5,3,0,0,0|rightEye#1,2,3|'), sized('jawOpen&-12|eyeBlink_R&1e9|head#1,2|___iFacialMocap'), sized('=head#nan,0,0|a-|-|&')),
      joined(0, sized(bundle(bone(0, 0.1, 0, 0.995), message('jawOpen', 0.5), apply)), sized(link), sized(link.subarray(0, 40)), sized(bone(NaN, 0, 0, 0))),
    ];
  },
  people: () => Object.values(timesFiles).concat('start,end,ipa\n0,0.1,_\n0.1,0.3,a\n0.3,0.5,p\n', '0.1 100 SIL\n0.3 100 AA1\n0.5 100 P\n').flatMap((times) =>
    ['time,LI,LS\n0,0,0\n0.1,1,1\n0.2,5,2\n0.5,1,1\n', 't;ul_z;ll_z;jaw_z;tt_x\n0;1;2;3;4\n0.25;2;-3;3;4\n0.5;1;2;3;4\n'].map((curves) => `${curves}---\n${times}`)),
  voice: () => {
    const pcm = (count, channels = 1) => tone(16000, count, channels).subarray(44), begin = (kind, rate) => joined(kind, 4, u16(rate / 2));
    const packets = [0x48, 0x68, 0xf8, 0x4b, 0x80].map((toc) => joined(toc, ...Array.from({ length: 20 }, (_, i) => (i * 73 + toc) % 256)));
    return [[8000, 1], [16000, 2], [48000, 8]].map(([rate, channels]) => joined(begin(2 * (channels - 1), rate), sized(pcm(700, channels)), sized(pcm(333)), sized(Buffer.alloc(6001))))
      .concat([8000, 24000, 48000].map((rate, i) => joined(begin(1 + 2 * (i % 2), rate), ...packets.map(sized), sized(Buffer.alloc(0)), sized(packets[2].subarray(0, 2)))));
  },
  sound: () => [0, 1, 2, 3].flatMap((who) => [joined(who, tone(16000, 400)), joined(who, tone(44100, 300, 2))]),
  recording: () => Object.entries({ textgrid: 0, lab: 1, htk: 2, offsets: 3, json: 4 }).map(([format, ending]) =>
    joined(ending, sized('{"name": "Anna", "lang": "it", "gender": "female", "names": {"a": "a", "tS": "t͡ʃ"}}'), sized('Uno due. Tre, quattro!'), sized(timesFiles[format]), tone(16000, 8000))),
  command: () => [joined(0, '{"voices": [{"id": "a", "lang": "it", "argv": ["cat"], "raw": 8000}]}'), ...Array.from({ length: 9 }, (_, i) => joined(1, u16(i * 3), i, u16(2), 1, 'a')),
    ...['lab', 'htk', 'textgrid', 'json'].map((format, i) => joined(2, i + 64, sized(timesFiles[format]), tone(16000, 9600))), joined(2, 131, sized(timesFiles.json), Buffer.alloc(9000, 3))],
  http: () => Array.from({ length: 60 }, (_, i) => {
    const chance = new Chance(i);
    return joined(0, i, ...Array.from({ length: 1 + i % 3 }, () => httpRequest(chance)).map((request) => request.subarray(0, 1500)), i % 4 ? '' : upgradeRequest(chance));
  }).concat(joined(3, 'multipart/form-data; boundary=b\n--b\r\nContent-Disposition: form-data; name="fap"; filename="a.fap"\r\n\r\nx\r\n--b\r\nContent-Disposition: form-data; name="sound"\r\n\r\n--\r\n--b--\r\n')),
  websocket: () => Array.from({ length: 60 }, (_, i) => {
    const chance = new Chance(i);
    return joined(i, ...Array.from({ length: 1 + i % 3 }, () => webSocketFrames(chance, messageText(chance).subarray(0, 300))).flat());
  }),
  picture_size: () => {
    const png = (width, height) => joined('\x89PNG\r\n\x1a\n'.split('').map((c) => c.charCodeAt(0)), [0, 0, 0, 13], 'IHDR', u32(width).reverse(), u32(height).reverse(), [8, 2, 0, 0, 0, 0, 0, 0, 0]);
    const webp = (kind, ...body) => joined('RIFF', u32(22), 'WEBP', kind, u32(10), ...body);
    return [png(16000, 16000), png(2 ** 32 - 1, 1), webp('VP8X', u32(0), [255, 1, 0, 255, 255, 255]), webp('VP8L', [0x2f], u32(0x3fc1ff), Buffer.alloc(5)), webp('VP8 ', [0, 0, 0, 0x9d, 1, 0x2a, 64, 65, 64, 66]),
      joined([0xff, 0xd8, 0xff, 0xe0, 0, 4, 1, 2, 0xff, 0xff, 0xc2, 0, 17, 8, 1, 2, 3, 4])];
  },
  phones: () => [joined(0, 200, 't͡ʃaˈo̞ː ʎɲɡ'), joined(1, 200, 'tS a "o_o: L J g <\\>_~'), joined(2, 0, timesFiles.offsets), ...[0, 1, 2, 3, 4, 5].map((pack) => joined(3, pack, 'tʃaʊ̯ɲːk͡px'))],
};

const [target, folder] = process.argv.slice(2);
mkdirSync(folder, { recursive: true });
(parts[target]?.() ?? []).forEach((bytes, i) => writeFileSync(path.join(folder, `seed-${String(i).padStart(3, '0')}`), bytes));
