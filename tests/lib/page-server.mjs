// SPDX-License-Identifier: GPL-3.0-or-later
// Serves a test's pages from a separate origin, with chosen headers.
import http from 'node:http';
import { once } from 'node:events';

/**
 * @param {Record<string, string | {body: string | Buffer, type?: string, headers?: object, cut?: number}>} files by path; a string is an HTML page; cut: stops
 *   sending after so many bytes
 * @returns {Promise<{port: number, url: string, files: object, served: Set<string>, close: () => Promise<void>}>}
 */
export async function servePages(files) {
  const served = new Set();
  const server = http.createServer((request, response) => {
    const { pathname } = new URL(request.url, 'http://here');
    const file = files[pathname];
    if (file !== undefined) served.add(pathname);
    const { body, type = 'text/html; charset=utf-8', headers = {}, cut } = typeof file === 'string' ? { body: file } : (file ?? {});
    response.writeHead(file === undefined ? 404 : 200, { 'content-type': type, ...(cut === undefined ? {} : { 'content-length': body.length }), ...headers });
    if (cut === undefined) response.end(body);
    else response.write(body.subarray(0, cut));
  });
  server.listen(0, '127.0.0.1');
  await once(server, 'listening');
  const { port } = server.address();
  return {
    port,
    url: `http://127.0.0.1:${port}`,
    files,
    served, // existing paths that were requested
    close() {
      server.closeAllConnections();
      return new Promise((resolve) => server.close(resolve));
    },
  };
}

/** The five-line page of the README, with the script and the stream of a daemon. */
export const fiveLines = (daemon, attributes = 'lang="it"') => `<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>Five lines</title>
<script type="module" src="${daemon}/talking-head.js"></script></head>
<body><talking-head src="${daemon.replace('http', 'ws')}/v1/stream" quality="low" ${attributes}></talking-head></body></html>`;
