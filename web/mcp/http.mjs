// SPDX-License-Identifier: MIT
// MCP over streamable HTTP.
import { Buffer } from 'node:buffer';
import { randomUUID } from 'node:crypto';
import http from 'node:http';
import { StreamableHTTPServerTransport } from '@modelcontextprotocol/sdk/server/streamableHttp.js';

const SESSIONS_MAX = 100;
const BODY_MAX = 1 << 20;
const IDLE_MS = 30 * 60000; // after which a session is forgotten
const LOOPBACK = ['127.0.0.1', '::1', 'localhost'];

/** Reads a message; drops the rest of one that is too long. @returns {Promise<object>} */
function bodyOf(request) {
  const pieces = [];
  let size = 0;
  return new Promise((resolve, reject) => {
    request.on('error', reject);
    request.on('data', (piece) => {
      if ((size += piece.length) > BODY_MAX) reject(new Error('the message is longer than 1 MiB'));
      else pieces.push(piece);
    });
    request.on('end', () => resolve(Buffer.concat(pieces)));
  }).then((bytes) => JSON.parse(bytes.toString()));
}

function refuse(response, status, message) {
  response.writeHead(status, { 'content-type': 'application/json' });
  response.end(JSON.stringify({ jsonrpc: '2.0', error: { code: -32000, message }, id: null }));
}

/** Whether the address that a browser names is this machine: pages of other sites must not get in by a name of their own. */
function isLocal(value) {
  if (value === undefined) return true;
  try {
    return LOOPBACK.includes(new URL(value.includes('://') ? value : `http://${value}`).hostname.replace(/^\[|\]$/g, ''));
  } catch {
    return false;
  }
}

/**
 * Serves at /mcp. A client's own bearer token goes to the daemon. The token of this program is lent to this machine only.
 * @param {{host: string, port: number, token: string|null}} options
 * @param {(token: string|null) => import('@modelcontextprotocol/sdk/server/mcp.js').McpServer} make
 * @returns {Promise<http.Server>} when it listens
 */
export async function serveHttp({ host, port, token }, make) {
  const local = LOOPBACK.includes(host);
  const sessions = new Map(); // id -> {transport, used}
  const forget = setInterval(() => {
    for (const { transport, used } of sessions.values()) if (Date.now() - used > IDLE_MS) transport.close();
  }, 60000).unref();

  async function open(own) {
    const transport = new StreamableHTTPServerTransport({
      sessionIdGenerator: randomUUID,
      onsessioninitialized: (id) => sessions.set(id, { transport, own, used: Date.now() }),
    });
    transport.onclose = () => sessions.delete(transport.sessionId);
    await make(own ?? (local ? token : null)).connect(transport);
    return transport;
  }

  async function answer(request, response) {
    const { pathname } = new URL(request.url, 'http://here');
    if (pathname !== '/mcp') return refuse(response, 404, 'The Model Context Protocol is at /mcp.');
    if (local && !(isLocal(request.headers.host) && isLocal(request.headers.origin))) return refuse(response, 403, 'Only this machine may come in.');
    const own = /^Bearer (\S+)$/i.exec(request.headers.authorization ?? '')?.[1] ?? null;
    const body = request.method === 'POST' ? await bodyOf(request) : undefined;
    const id = request.headers['mcp-session-id'];
    const session = sessions.get(id);
    if (id !== undefined && (!session || session.own !== own)) return refuse(response, 404, 'There is no such session.');
    if (!session && sessions.size >= SESSIONS_MAX) return refuse(response, 503, `There are ${SESSIONS_MAX} sessions.`);
    if (session) session.used = Date.now();
    return (session?.transport ?? (await open(own))).handleRequest(request, response, body);
  }

  const server = http.createServer((request, response) => {
    answer(request, response).catch((error) => {
      if (response.headersSent) response.destroy();
      else refuse(response, 400, error.message);
    });
  });
  server.on('close', () => clearInterval(forget));
  await new Promise((resolve, reject) => server.once('error', reject).listen(port, host, resolve));
  return server;
}
