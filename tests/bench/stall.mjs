// SPDX-License-Identifier: GPL-3.0-or-later
// How long others wait while long texts are read: the slowest of the pings that another client sends every 2 ms, for
// each kind of text. Usage: node tests/bench/stall.mjs [BYTES...]
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

const daemon = await Daemon.start(['--max-text', String(2 * Math.max(...sizes)), '--max-message', String(2 * Math.max(...sizes)), '--cache', '0']);
const other = await daemon.stream();
for (const [kind, [begin, piece, end]] of Object.entries(kinds))
  for (const bytes of sizes) {
    const text = begin + piece.repeat(Math.ceil(bytes / piece.length)) + end;
    const waits = [];
    for (const post of [false, true]) {
      let done = false, slowest = 0;
      const said = post
        ? fetch(`${daemon.url}/v1/speech?lang=en&format=ndjson`, { method: 'POST', body: text, headers: { 'content-type': 'application/xml' } }).then(async (r) => r.body.cancel())
        : daemon.stream('?lang=en').then(async (s) => {
            s.send({ type: 'speak', text });
            await s.wait((m) => ['begin', 'error'].includes(m.type), { milliseconds: 300000 });
            await s.close();
          });
      const over = said.catch(() => {}).then(() => (done = true));
      for (let id = 1; !done; id++) {
        const from = performance.now();
        other.send({ type: 'ping', id });
        await other.wait({ type: 'pong', id }, { milliseconds: 300000 });
        slowest = Math.max(slowest, performance.now() - from);
        other.messages.length = 0;
        await new Promise((resolve) => setTimeout(resolve, 2));
      }
      await over;
      waits.push(slowest);
    }
    console.log(`${kind}, ${bytes / 1e6} MB: slowest answer ${waits[0].toFixed(1)} ms (over the socket), ${waits[1].toFixed(1)} ms (posted)`);
  }
await other.close();
console.log(await daemon.stop());
