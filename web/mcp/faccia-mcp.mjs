#!/usr/bin/env node
// SPDX-License-Identifier: MIT
import { readFileSync } from 'node:fs';
import { parseArgs } from 'node:util';
import { StdioServerTransport } from '@modelcontextprotocol/sdk/server/stdio.js';
import { Daemon } from './daemon.mjs';
import { serveHttp } from './http.mjs';
import { makeServer } from './server.mjs';

const usage = `Usage: faccia-mcp [OPTION]...
Lets a program that speaks the Model Context Protocol (MCP) speak through a faccia daemon.
On standard input and output, unless --http is given.

  --url URL        the daemon; default $FACCIA_URL, or http://127.0.0.1:8080
  --room ROOM      where tools speak if they name no room; default $FACCIA_ROOM, or home
  --http [HOST:]PORT  serve streamable HTTP at /mcp, on 127.0.0.1 unless HOST is given
  --help           print this and exit

$FACCIA_TOKEN is the token for the daemon. Over HTTP, a client's own bearer token goes before it, and
clients on other machines must have one if the daemon wants tokens.
`;

function fail(message) {
  process.stderr.write(`faccia-mcp: ${message}\nTry 'faccia-mcp --help'.\n`);
  process.exit(2);
}

function readOptions() {
  try {
    const options = { url: { type: 'string' }, room: { type: 'string' }, http: { type: 'string' }, help: { type: 'boolean' } };
    return parseArgs({ options }).values;
  } catch (error) {
    return fail(error.message);
  }
}

/** @param {string} text HOST:PORT, [ADDRESS]:PORT or PORT */
function readAddress(text) {
  const [, host, port] = /^(?:(.+):)?(\d{1,5})$/.exec(text) ?? [];
  if (port === undefined || Number(port) > 65535) fail(`--http: invalid address '${text}': expected [HOST:]PORT`);
  return { host: host?.replace(/^\[|\]$/g, '') ?? '127.0.0.1', port: Number(port) };
}

const { url = process.env.FACCIA_URL ?? 'http://127.0.0.1:8080', room = process.env.FACCIA_ROOM ?? 'home', http, help } = readOptions();
if (help) {
  process.stdout.write(usage);
  process.exit(0);
}
if (!URL.canParse(url)) fail(`--url: '${url}' is no address`);
const token = process.env.FACCIA_TOKEN || null;
const { version } = JSON.parse(readFileSync(new URL('package.json', import.meta.url), 'utf8'));
const make = (own) => makeServer(new Daemon(url, own), { room, version });
if (http === undefined) {
  await make(token).connect(new StdioServerTransport());
} else {
  const server = await serveHttp({ ...readAddress(http), token }, make).catch((error) => fail(error.message));
  process.stderr.write(`faccia-mcp: http://${http.includes(':') ? http.replace(/:\d+$/, '') : '127.0.0.1'}:${server.address().port}/mcp\n`);
  for (const signal of ['SIGINT', 'SIGTERM'])
    process.on(signal, () => {
      server.close(() => process.exit(0)); // whatever tools still wait for
      server.closeAllConnections();
    });
}
