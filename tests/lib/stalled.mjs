// SPDX-License-Identifier: GPL-3.0-or-later
// A client that reads nothing until requested, with a receive buffer so small that the kernel accepts hardly anything. In Python, because
// Node.js cannot set SO_RCVBUF.
import { spawn } from 'node:child_process';
import { once } from 'node:events';

const script = `
import base64, os, socket, struct, sys
port, path, body = int(sys.argv[1]), sys.argv[2], sys.stdin.buffer.read(int(sys.argv[3]))
s = socket.socket()
s.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 2048)
s.connect(('127.0.0.1', port))
if path.startswith('/v1/stream'):
    key = base64.b64encode(os.urandom(16)).decode()
    s.sendall(f'GET {path} HTTP/1.1\\r\\nHost: 127.0.0.1\\r\\nUpgrade: websocket\\r\\nConnection: Upgrade\\r\\nSec-WebSocket-Key: {key}\\r\\nSec-WebSocket-Version: 13\\r\\n\\r\\n'.encode())
    head = b''
    while b'\\r\\n\\r\\n' not in head:
        head += s.recv(1)
    if body:
        head = struct.pack('>BBH', 0x81, 0xfe, len(body)) if 125 < len(body) < 65536 else struct.pack('>BBQ', 0x81, 0xff, len(body))
        s.sendall(head + bytes(4) + body)
elif body:
    s.sendall(f'POST {path} HTTP/1.1\\r\\nHost: 127.0.0.1\\r\\nContent-Type: text/plain\\r\\nContent-Length: {len(body)}\\r\\n\\r\\n'.encode() + body)
else:
    s.sendall(f'GET {path} HTTP/1.1\\r\\nHost: 127.0.0.1\\r\\n\\r\\n'.encode())
print('connected', file=sys.stderr, flush=True)
sys.stdin.readline()
while True:
    data = s.recv(65536)
    if not data:
        break
    sys.stdout.buffer.write(data)
    sys.stdout.buffer.flush()
`;

/** Connects to a WebSocket and sends the body as one message; or sends an HTTP request, POST if there is a body. */
export async function stalled(port, path, body = '') {
  const bytes = Buffer.from(body);
  const child = spawn('python3', ['-c', script, String(port), path, String(bytes.length)]);
  child.stdin.write(bytes);
  child.stdin.on('error', () => {});
  let heard = Buffer.alloc(0);
  child.stdout.on('data', (data) => (heard = Buffer.concat([heard, data])));
  const [word] = await once(child.stderr, 'data');
  if (!String(word).startsWith('connected')) throw new Error(String(word));
  return {
    /** Starts reading. */
    read: () => child.stdin.write('\n'),
    /** Messages of the WebSocket received so far: texts as objects, media as bytes (RFC 6455, 5.2; servers do not mask). */
    messages() {
      const list = [];
      for (let at = 0; at + 4 <= heard.length; ) {
        const short = heard[at + 1] & 127, head = short === 127 ? 10 : short === 126 ? 4 : 2;
        if (at + head > heard.length) break;
        const size = short === 127 ? Number(heard.readBigUInt64BE(at + 2)) : short === 126 ? heard.readUInt16BE(at + 2) : short;
        const opcode = heard[at] & 15, data = heard.subarray(at + head, at + head + size);
        at += head + size;
        if (data.length < size) break;
        if (opcode === 1) list.push(JSON.parse(data));
        if (opcode === 2) list.push(data);
      }
      return list;
    },
    close: () => child.kill(),
  };
}
