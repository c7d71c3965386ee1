// SPDX-License-Identifier: GPL-3.0-or-later
// Delay of other clients while long texts are parsed: the slowest ping of another client, which runs in a thread and sends one every
// 2 ms, for each kind of text. Usage: node tests/bench/run.mjs stall [BYTES...]
import { isMainThread, parentPort, Worker, workerData } from 'node:worker_threads';
import WebSocket from 'ws';
import { Daemon } from '../lib/daemon.mjs';

const sizes = process.argv.length > 2 ? process.argv.slice(2).map(Number) : [1e5, 1e7];
const kinds = {
  plain: ['', 'The wind blows over the white houses of the port. ', ''],
  ssml: ['<speak>', '<emphasis>The wind</emphasis> blows over the white houses of the port. ', '</speak>'],
  'ssml, one word': ['<speak>', '<emphasis>wind</emphasis>', '</speak>'],
  apml: ['<apml>', '<performative type="inform"><theme affect="joy">The <emphasis x-pitchaccent="Hstar">wind</emphasis></theme> blows.</performative>', '</apml>'],
  jsml: ['<jsml>', '<SENT>The <HAPPY>wind</HAPPY> blows. <BREAK MSECS="200"/></SENT>', '</jsml>'],
  bml: ['<bml>', '<speech><text>The <sync id="a"/>wind blows.</text></speech><head lexeme="NOD" start="0.5"/>', '</bml>'],
};


/** The other client: reports, on request, the slowest answer since the last request. */
async function ping(port) {
  const socket = new WebSocket(`ws://127.0.0.1:${port}/v1/stream?audio=none&fap=none`, [], { perMessageDeflate: false });
  let slowest = 0, sent = 0;
  const send = () => {
    sent = performance.now();
    socket.send('{"type":"ping","id":1}');
  };
  socket.on('open', send).on('message', (data) => {
    if (!String(data).includes('"pong"')) return;
    slowest = Math.max(slowest, performance.now() - sent);
    setTimeout(send, 2);
  });
  parentPort.on('message', (what) => {
    if (what === 'close') {
      socket.terminate();
      parentPort.close();
      return;
    }
    parentPort.postMessage(slowest);
    slowest = 0;
  });
}

async function measure() {
  const limit = String(2 * Math.max(...sizes));
  const daemon = await Daemon.start(['--max-text', limit, '--max-message', limit, '--cache', '0']);
  const other = new Worker(new URL(import.meta.url), { workerData: daemon.port });
  const slowest = () => new Promise((resolve) => {
    other.once('message', resolve);
    other.postMessage('slowest');
  });
  for (const [kind, [begin, piece, end]] of Object.entries(kinds))
    for (const bytes of sizes) {
      const text = begin + piece.repeat(Math.ceil(bytes / piece.length)) + end;
      const waits = [];
      for (const post of [false, true]) {
        const stream = await daemon.stream('?lang=en');
        await slowest();
        if (post) {
          const answer = await fetch(`${daemon.url}/v1/speech?lang=en&format=ndjson`, { method: 'POST', body: text, headers: { 'content-type': 'application/xml' } });
          await answer.body.cancel();
        } else {
          stream.send({ type: 'speak', text });
          await stream.wait((m) => ['begin', 'error'].includes(m.type), { milliseconds: 300000 });
        }
        waits.push(await slowest());
        await stream.close();
      }
      console.log(`${kind}, ${bytes / 1e6} MB: slowest answer ${waits[0].toFixed(1)} ms (over the socket), ${waits[1].toFixed(1)} ms (posted)`);
    }
  other.postMessage('close');
  console.log(await daemon.stop());
}

if (isMainThread) await measure();
else await ping(workerData);
