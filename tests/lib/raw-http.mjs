// SPDX-License-Identifier: GPL-3.0-or-later
// HTTP requests with any headers, also those that fetch forbids.
import http from 'node:http';

/** @returns {Promise<{status: number, headers: object, text: string}>} */
export const request = (port, { path = '/', method = 'GET', headers = {}, body, ...rest } = {}) =>
  new Promise((resolve, reject) => {
    const asked = http.request({ host: '127.0.0.1', port, path, method, headers, ...rest }, (response) => {
      let text = '';
      response.setEncoding('utf8').on('data', (piece) => (text += piece));
      response.on('end', () => resolve({ status: response.statusCode, headers: response.headers, text }));
    });
    asked.on('error', reject).end(body);
  });
