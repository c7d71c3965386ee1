// SPDX-License-Identifier: GPL-3.0-or-later
// A server that imitates MaryTTS (POST /process, port 59125) with espeak-ng's voice. Runs in a thread, so that it serves while a test blocks
// on a child process. Posts its port. workerData: {names: MaryTTS's phones in IPA}
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import http from 'node:http';
import os from 'node:os';
import path from 'node:path';
import { parentPort, workerData } from 'node:worker_threads';
import { build } from './daemon.mjs';

const named = new Map(Object.entries(workerData.names).map(([name, ipa]) => [ipa, name]));
const spoken = new Map();

/** MaryTTS's name for a phone of espeak-ng. */
const nameOf = ({ ipa, stress }) => {
  const plain = ipa.replace('ɾ', 'r').replace('ɪ', 'i').replace('ʊ', 'u');
  return (stress ? named.get(`ˈ${plain}`) : undefined) ?? named.get(plain) ?? named.get(plain.replace('ː', '')) ?? '_';
};

/** {sound: WAV, durations: a line per phone: end time, an unused number, name} */
function speak(text) {
  if (!spoken.has(text)) {
    const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'faccia-'));
    const [wav, json] = [path.join(folder, 'wav'), path.join(folder, 'json')];
    const { FACCIA_VOICE_CONFIG: _, ...env } = process.env;
    spawnSync(path.join(build, 'server/cli/faccia'), ['say', '--still', '-l', 'it', '-v', 'espeak:it', '--wav', wav, '--json', json, '-'], { input: text, env });
    // durations are whole milliseconds; a long consonant is one phone
    const list = [];
    let end = 0;
    for (const phone of JSON.parse(fs.readFileSync(json)).phones) {
      const [name, last] = [nameOf(phone), list.at(-1)];
      end += Math.round((phone.end - phone.start) * 1000) / 1000;
      if (last && last.name === name && (name === '_' || named.has(`${workerData.names[name]}ː`)))
        Object.assign(last, { end, name: name === '_' ? name : named.get(`${workerData.names[name]}ː`) });
      else list.push({ name, end });
    }
    spoken.set(text, { sound: fs.readFileSync(wav), durations: `#\n${list.map((p) => `${Math.fround(p.end)} 125 ${p.name}\n`).join('')}` });
    fs.rmSync(folder, { recursive: true });
  }
  return spoken.get(text);
}

const refuse = (response, status, why) => response.writeHead(status, { 'Content-Type': 'text/plain' }).end(why);

const server = http.createServer(async (request, response) => {
  let body = '';
  for await (const part of request.setEncoding('utf8')) body += part;
  const url = new URL(request.url, 'http://localhost');
  const asked = request.method === 'POST' ? new URLSearchParams(body) : url.searchParams;
  if (url.pathname !== '/process') return refuse(response, 404, 'no such thing');
  for (const key of ['INPUT_TYPE', 'OUTPUT_TYPE', 'LOCALE', 'INPUT_TEXT'])
    if (!asked.get(key)) return refuse(response, 400, `Please specify a value for ${key}`);
  if (asked.get('INPUT_TYPE') !== 'TEXT' || asked.get('LOCALE') !== 'it' || asked.get('VOICE') !== 'istc-lucia-hsmm')
    return refuse(response, 400, 'no such voice');
  const { sound, durations } = speak(asked.get('INPUT_TEXT'));
  if (asked.get('OUTPUT_TYPE') === 'REALISED_DURATIONS') return response.writeHead(200, { 'Content-Type': 'text/plain; charset=UTF-8' }).end(durations);
  if (asked.get('OUTPUT_TYPE') !== 'AUDIO' || !['WAVE', 'WAVE_FILE'].includes(asked.get('AUDIO'))) return refuse(response, 400, 'no such output');
  return response.writeHead(200, { 'Content-Type': 'audio/x-wav' }).end(sound);
});
server.listen(0, '127.0.0.1', () => parentPort.postMessage(server.address().port));
