// SPDX-License-Identifier: GPL-3.0-or-later
// A Redis that sends garbage: the daemon keeps serving by itself.
import assert from 'node:assert/strict';
import crypto from 'node:crypto';
import net from 'node:net';
import { after, before, test } from 'node:test';
import { Daemon, eventually } from '../../lib/daemon.mjs';

const bulk = (text) => `$${Buffer.byteLength(text)}\r\n${text}\r\n`;
const message = (channel, text = 'x') => `*3\r\n${bulk('message')}${bulk(channel)}${bulk(text)}`;
const odd = ['+OK\r\n', '$-1\r\n', ':1\r\n', ':-9223372036854775808\r\n', '*0\r\n', '*-1\r\n', '$5\r\nhello\r\n', '*2\r\n:1\r\n$3\r\nabc\r\n', '-ERR no\r\n',
  '*1\r\n*1\r\n*1\r\n*1\r\n:1\r\n', '-NOSCRIPT x\r\n', '*5\r\n$-1\r\n:0\r\n$0\r\n\r\n*0\r\n+x\r\n', '*2\r\n*1\r\n*3\r\n:1\r\n:1\r\n:1\r\n*1\r\n:1\r\n',
  '*8\r\n:9\r\n:1\r\n:9\r\n:1\r\n:9\r\n:9\r\n*1\r\n:1\r\n*3\r\n:1\r\n:1\r\n:1\r\n'];

/** Kinds of false answers. Arguments: socket, number of the command on its connection, the command's channel if any. */
const lies = {
  noise: (socket) => socket.write(crypto.randomBytes(3000)),
  'a string that never ends': (socket) => socket.write(`$2147483646\r\n${'x'.repeat(100000)}`),
  'an array of 2^31 - 1': (socket) => socket.write(`*2147483647\r\n${':1\r\n'.repeat(1000)}`),
  'an array of 2^32 + 1': (socket) => socket.write('*4294967297\r\n'),
  'arrays in arrays': (socket) => socket.write('*1\r\n'.repeat(5000)),
  'a line that never ends': (socket) => socket.write(`+${'x'.repeat(100000)}`),
  'a push of RESP3': (socket) => socket.write(`>3\r\n${bulk('message')}${bulk('x')}${bulk('y')}`),
  'a message that nobody asked for': (socket) => socket.write(`+OK\r\n${message('x')}`),
  'messages of another channel': (socket) => socket.write(message('faccia:to:somebody').repeat(200)),
  'many large messages': (socket, _, channel) => socket.write(message(channel ?? 'x', 'y'.repeat(100000)).repeat(50)),
  'a message that is none': (socket) => socket.write(`*3\r\n${bulk('message')}:1\r\n*0\r\n`),
  'an unsubscription': (socket, _, channel) => socket.write(`*3\r\n${bulk('unsubscribe')}${bulk(channel ?? 'x')}${bulk('many')}`),
  'half a subscription': (socket) => socket.write(`*1\r\n${bulk('subscribe')}`),
  'replies of other types': (socket, number) => socket.write(odd[number % odd.length]),
  'more replies than questions': (socket) => socket.write('+OK\r\n'.repeat(1000)),
  'an error that nobody asked for': (socket) => socket.write('+OK\r\n-ERR max number of clients reached\r\n'),
  'one byte at a time': (socket) => { for (const byte of '+OK\r\n') socket.write(byte); },
  silence: () => {},
  'the end': (socket) => socket.destroy(),
};

/** Each connection gets the next kind, at once or after a correct greeting. */
class Liar {
  static async start() {
    const liar = Object.assign(new Liar(), { served: new Map(), next: 0, sockets: new Set() });
    liar.server = net.createServer((socket) => liar.serve(socket));
    await new Promise((resolve) => liar.server.listen(0, '127.0.0.1', resolve));
    liar.url = `redis://127.0.0.1:${liar.server.address().port}`;
    return liar;
  }

  serve(socket) {
    const names = Object.keys(lies);
    // alternates: a greeted connection counts as established, so the daemon reconnects quickly
    const name = names[(this.next >> 1) % names.length], greets = this.next % 2 === 0;
    let commands = 0, closing;
    this.next++;
    this.sockets.add(socket);
    socket.on('error', () => {}).on('close', () => clearTimeout(closing) || this.sockets.delete(socket));
    socket.on('data', (data) => {
      const text = String(data);
      for (const command of text.split(/(?=\*\d+\r\n\$)/)) {
        const channel = command.match(/SUBSCRIBE\r\n\$\d+\r\n(.*)\r\n/)?.[1];
        if (greets && command.includes('PING')) socket.write('+PONG\r\n');
        else {
          if (greets && channel) socket.write(`*3\r\n${bulk('subscribe')}${bulk(channel)}:1\r\n`);
          lies[name](socket, commands++, channel);
          // moves on to the next kind even if the daemon accepts this one
          if (!closing) closing = setTimeout(() => socket.destroy(), 150);
          this.served.set(`${name}, ${greets ? 'greeted' : 'at once'}`, true);
        }
        if (socket.destroyed) return;
      }
    });
  }

  stop() {
    this.server.close();
    for (const socket of this.sockets) socket.destroy();
  }
}

let liar, daemon;
before(async () => {
  liar = await Liar.start();
  daemon = await Daemon.start(['--cluster', liar.url]);
});
after(() => liar.stop());

test('speech, rooms and health survive any replies of Redis', async () => {
  const speaks = async () => {
    const response = await daemon.get('/v1/speech?lang=it&format=json', { method: 'POST', body: 'Buongiorno a tutti.', signal: AbortSignal.timeout(30000) });
    assert.equal(response.status, 200, await response.text());
    assert.equal((await daemon.get('/healthz', { signal: AbortSignal.timeout(5000) })).status, 200);
  };
  await speaks();
  const wanted = 2 * Object.keys(lies).length;
  await eventually(() => {
    assert.equal(daemon.process.exitCode ?? daemon.process.signalCode, null, daemon.log.slice(-2000));
    return liar.served.size >= wanted;
  }, 'every lie to be told');
  await speaks();
  const stream = await daemon.stream('?room=x');
  stream.send({ type: 'speak', id: 'u', lang: 'it', text: 'Ciao.' });
  await stream.wait({ type: 'end', id: 'u', reason: 'done' }, { milliseconds: 20000 });
  await stream.close();
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
  assert.doesNotMatch(daemon.log, /Assertion|Sanitizer/);
  assert.ok(daemon.log.length < 200000, `${daemon.log.length} characters of log`);
});
