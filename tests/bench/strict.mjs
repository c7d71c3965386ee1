// SPDX-License-Identifier: GPL-3.0-or-later
// Number of invalid requests, bodies, frames and texts of the daemon's tests that are rejected by facciad, and by libwebsockets with its own parsers
// (roles.c), in the same run. Then valid input: a chunked body, a request whose client has closed its side, a character split between frames.
// Usage: strict.mjs [--all], which also lists the inputs that libwebsockets accepts.
import { spawn } from 'node:child_process';
import { once } from 'node:events';
import { Daemon } from '../lib/daemon.mjs';
import { badTexts, bodies, frames, get, head, heads } from '../lib/malformed.mjs';
import { frame, Raw, RawSocket } from '../lib/raw.mjs';
import { needProgram } from './need.mjs';

const WAIT_MS = 3000;
const [MORE, TEXT] = [0, 1];
const listAll = process.argv.includes('--all');

/** Resolves to the promise's value, or to 'waits' after some seconds. */
const soon = (promise) => Promise.race([promise, new Promise((resolve) => setTimeout(resolve, WAIT_MS, 'waits'))]);

/** Sends a forbidden request and an allowed one: 'refused', 'cut' (closed without an answer), 'waits', or 'taken', also where the second one is answered. */
async function request(port, bytes) {
  const raw = await Raw.open(port);
  raw.write(bytes + get('/healthz'));
  const answer = await soon(raw.answer().catch(() => false));
  const second = answer?.status >= 400 ? await soon(raw.answer().catch(() => false)) : false;
  raw.socket.destroy();
  if (answer === 'waits' || answer === false) return answer || 'cut';
  return answer.status >= 400 && !second?.status ? 'refused' : answer.status < 400 ? 'taken' : 'refused, goes on';
}

/** Sends forbidden frames: 'refused' (a close frame with that code), 'another code', 'cut' (no close frame) or 'waits'. */
async function socket(port, bytes, code) {
  const raw = await RawSocket.open(port);
  raw.write(bytes);
  const end = await soon(raw.next(8).catch(() => false));
  raw.socket.destroy();
  if (end === 'waits' || end === false) return end || 'cut';
  return end.payload.readUInt16BE(0) === code ? 'refused' : 'another code';
}

/** Whether a request is answered with 200 and its whole body was read. */
async function taken(port, bytes, { end = false, size } = {}) {
  const raw = await Raw.open(port);
  raw.write(bytes);
  if (end) raw.socket.end();
  const answer = await soon(raw.answer().catch(() => false));
  raw.socket.destroy();
  return answer?.status === 200 && (size === undefined || !/^\d+\n$/.test(answer.body) || Number(answer.body) === size) ? 'taken' : answer?.status ? `${answer.status}, ${answer.body.trim().slice(0, 20)}` : answer || 'cut';
}

async function cutText(port) {
  const raw = await RawSocket.open(port);
  const bytes = Buffer.from('{"type":"ping","id":"κόσμε"}');
  raw.write(Buffer.concat([frame(TEXT, bytes.subarray(0, 22), { fin: false }), frame(MORE, bytes.subarray(22))]));
  const answer = await soon((async () => {
    for (let got; (got = await raw.frame()); ) if (got.opcode === 8 || /pong|taken/.test(got.payload)) return got.opcode === 8 ? 'refused' : 'taken';
    return 'cut';
  })());
  raw.socket.destroy();
  return answer;
}

async function measure(port) {
  const each = (list, run) => Promise.all(list.map(async ([name, ...rest]) => [name, await run(...rest)])).then(Object.fromEntries);
  const result = {};
  result.heads = await each(heads, (bytes) => request(port, bytes));
  result.bodies = await each(bodies, (bytes) => request(port, bytes));
  result.frames = await each(Object.entries(frames).map(([name, [bytes]]) => [name, bytes]), (bytes) => socket(port, bytes, 1002));
  result.texts = await each(badTexts.map((text) => [text, frame(TEXT, Buffer.from(text, 'hex'))]), (bytes) => socket(port, bytes, 1007));
  result.allowed = {
    'a chunked body': await taken(port, head('Transfer-Encoding: chunked\r\n') + '4\r\nBuon\r\n7\r\ngiorno.\r\n0\r\n\r\n', { size: 11 }),
    'a request, then the end of the client’s side': await taken(port, get('/healthz'), { end: true }),
    'a character cut between frames': await cutText(port),
  };
  return result;
}

const program = needProgram('roles');
const daemon = await Daemon.start(['--max-connections', '500']);
const ours = await measure(daemon.port);
await daemon.stop();
const roles = spawn(program, { stdio: ['ignore', 'pipe', 'inherit'] });
const port = Number(String((await once(roles.stdout, 'data'))[0]));
let died = null;
roles.on('exit', (code, signal) => (died = signal ?? code));
const theirs = await measure(port);
if (died !== null) console.log(`libwebsockets' server ended: ${died}`);
roles.kill();

for (const kind of ['heads', 'bodies', 'frames', 'texts']) {
  const count = (result) => {
    const counts = {};
    for (const answer of Object.values(result[kind])) counts[answer] = (counts[answer] ?? 0) + 1;
    return Object.entries(counts).sort((a, b) => b[1] - a[1]).map(([answer, n]) => `${n} ${answer}`).join(', ');
  };
  console.log(`${kind} (${Object.keys(ours[kind]).length}): facciad ${count(ours)}; libwebsockets ${count(theirs)}`);
  if (listAll) for (const [name, answer] of Object.entries(theirs[kind])) if (answer !== 'refused') console.log(`    ${answer}: ${name}`);
}
console.log('allowed:');
for (const name of Object.keys(ours.allowed)) console.log(`    ${name}: facciad ${ours.allowed[name]}; libwebsockets ${theirs.allowed[name]}`);
