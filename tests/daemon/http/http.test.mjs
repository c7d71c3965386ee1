// SPDX-License-Identifier: GPL-3.0-or-later
// HTTP: speech in three formats, models and pages as cacheable files.
import assert from 'node:assert/strict';
import { once } from 'node:events';
import http from 'node:http';
import { after, before, test } from 'node:test';
import zlib from 'node:zlib';
import { Daemon } from '../../lib/daemon.mjs';

let daemon;
before(async () => (daemon = await Daemon.start()));
after(async () => assert.deepEqual(await daemon.stop(), { code: 0, signal: null }));

const post = (query, body) => daemon.get(`/v1/speech?${query}`, { method: 'POST', body, headers: { 'content-type': 'text/plain' } });

test('returns playable WAV', async () => {
  const response = await post('lang=it&format=wav', 'Buongiorno a tutti.');
  assert.equal(response.headers.get('content-type'), 'audio/wav');
  const wav = Buffer.from(await response.arrayBuffer());
  assert.equal(wav.toString('latin1', 0, 4) + wav.toString('latin1', 8, 16), 'RIFFWAVEfmt ');
  assert.equal(wav.readUInt16LE(22), 1);
  const samples = new Int16Array(wav.buffer, wav.byteOffset + 44, (wav.length - 44) / 2);
  assert.ok(samples.length > wav.readUInt32LE(24) / 2, 'more than half a second');
  assert.ok(samples.some((s) => Math.abs(s) > 3000));
});

test('encoding sound for one client does not delay others', async () => {
  const text = `Una frase ${'assai lunga e senza una virgola '.repeat(20)}.`;
  await (await post('lang=it', text)).arrayBuffer(); // now in the cache
  let coded = 0;
  const all = Array.from({ length: 6 }, async () => {
    const response = await post('lang=it&format=ogg', text);
    const size = (await response.arrayBuffer()).byteLength;
    coded++;
    return size;
  });
  for (let i = 0; i < 5; i++) await (await daemon.get('/healthz')).text();
  assert.equal(coded, 0, 'five answers meanwhile');
  const sizes = await Promise.all(all);
  assert.ok(sizes[0] > 50000, `${sizes[0]} bytes`);
  assert.deepEqual(sizes, sizes.map(() => sizes[0]));
});

test('returns WAV by default, with matching JSON and FAPs', async () => {
  const text = 'La mamma parla piano. Il papà ascolta.';
  const wav = Buffer.from(await (await post('lang=it', text)).arrayBuffer());
  const json = await (await post('lang=it&format=json', text)).json();
  const fap = await (await post('lang=it&format=fap', text)).text();
  const seconds = (wav.length - 44) / 2 / json.rate;
  // espeak-ng's output varies by some samples
  assert.ok(Math.abs(json.duration - seconds) < 0.02, `${json.duration} ${seconds}`);
  assert.equal(json.phones[0].start, 0);
  json.phones.forEach((p, i) => i && assert.ok(Math.abs(p.start - json.phones[i - 1].end) < 1e-4));
  assert.ok(Math.abs(json.phones.at(-1).end - json.duration) < 1e-4);
  assert.equal(json.words.map((w) => w.text).join(' '), 'La mamma parla piano Il papà ascolta');
  const lines = fap.split('\n');
  const header = lines[0].split(' ');
  assert.equal(header[0], '2.1');
  assert.equal(Number(header.at(-2)), 25);
  assert.equal(Number(header.at(-1)), Math.ceil(json.duration * 25 - 1e-6));
  assert.equal(lines.filter(Boolean).length, 1 + 2 * Number(header.at(-1)));
});

test('sends speech before the last sentence is generated', async () => {
  const request = http.request(`${daemon.url}/v1/speech?lang=it`, { method: 'POST', headers: { 'content-type': 'text/plain' } });
  request.end('Una frase come tante. '.repeat(4000));
  const [response] = await once(request, 'response');
  const [first] = await once(response, 'data');
  assert.equal(first.toString('latin1', 0, 4), 'RIFF');
  assert.equal(first.readUInt32LE(40), 0xffffffff);
  request.destroy();
  assert.equal((await daemon.get('/healthz')).status, 200);
});

test('counts HTTP requests as speech in the metrics', async () => {
  const seconds = async () => Number((await (await daemon.get('/metrics')).text()).match(/^faccia_speech_seconds_total (.*)$/m)[1]);
  await daemon.left(2); // the aborted request is noticed
  const before = await seconds();
  const { duration } = await (await daemon.get('/v1/speech?lang=it&format=json', { method: 'POST', body: 'Una frase. Un’altra.' })).json();
  assert.ok(Math.abs((await seconds()) - before - duration) < 0.01);
});

test('serves many requests on one connection', async () => {
  const agent = new http.Agent({ keepAlive: true, maxSockets: 1 });
  for (let i = 0; i < 20; i++) {
    const request = http.request(`${daemon.url}/healthz`, { agent });
    request.end();
    const [response] = await once(request, 'response');
    assert.equal(response.statusCode, 200);
    response.resume();
    await once(response, 'end');
  }
  for (const text of ['Uno.', 'Due.', 'Tre.']) {
    const request = http.request(`${daemon.url}/v1/speech?format=json`, { agent, method: 'POST' });
    request.setHeader('content-type', 'text/plain');
    request.end(text);
    const [response] = await once(request, 'response');
    assert.equal(response.statusCode, 200);
    response.resume();
    await once(response, 'end');
  }
  agent.destroy();
});

/** GET without decoding the body. */
async function plain(address, headers) {
  const request = http.get(daemon.url + address, { headers });
  const [response] = await once(request, 'response');
  const pieces = [];
  response.on('data', (piece) => pieces.push(piece));
  await once(response, 'end');
  return { status: response.statusCode, headers: response.headers, body: Buffer.concat(pieces) };
}

test('compresses and hashes the model, and does not send it twice', async () => {
  const { models } = await (await daemon.get('/v1/models')).json();
  const address = `/v1/models/${models[0].name}`;
  const full = await plain(address, {});
  const packed = await plain(address, { 'accept-encoding': 'gzip' });
  assert.equal(full.headers['content-encoding'], undefined);
  assert.equal(packed.headers['content-encoding'], 'gzip');
  assert.deepEqual(zlib.gunzipSync(packed.body), full.body);
  assert.ok(packed.body.length <= 3 << 20, `${packed.body.length} bytes`);
  assert.equal(full.body.length, models[0].bytes);
  assert.ok(full.headers.etag.includes(models[0].hash));
  const again = await plain(address, { 'if-none-match': full.headers.etag });
  assert.equal(again.status, 304);
  assert.equal(again.body.length, 0);
  const fixed = await plain(`${address}?v=${models[0].hash}`, {});
  assert.match(fixed.headers['cache-control'], /immutable/);
});

test('serves the page and its script', async () => {
  const page = await daemon.get('/');
  assert.match(page.headers.get('content-type'), /text\/html/);
  const script = (await page.text()).match(/src="\.?\/?([^"]+\.m?js)"/)[1];
  assert.equal((await daemon.get(`/${script}`)).status, 200);
  const head = await daemon.get('/', { method: 'HEAD' });
  assert.equal(head.status, 200);
  assert.equal(await head.text(), '');
});

test('speaks in all four languages with all voices', async () => {
  const { voices } = await (await daemon.get('/v1/voices')).json();
  for (const [lang, text] of [['it', 'Ciao.'], ['pt-BR', 'Bom dia.'], ['tr', 'Merhaba.'], ['en', 'Hello.']]) {
    assert.ok(voices.some((v) => v.lang.toLowerCase().startsWith(lang.toLowerCase().slice(0, 2))), lang);
    const json = await (await post(`lang=${lang}&format=json`, text)).json();
    assert.equal(json.lang, lang);
    assert.ok(json.phones.length > 3);
    assert.deepEqual(json.warnings, []);
  }
});
