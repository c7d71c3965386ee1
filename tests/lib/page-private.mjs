// SPDX-License-Identifier: GPL-3.0-or-later
// Records what a page requests and sends, and checks that no picture leaves it.
import assert from 'node:assert/strict';

/** Records requests, sent data and console errors from now on: {asked, sent, complaints}. */
export function watchPage(page) {
  const watched = { asked: [], sent: [], complaints: [] };
  page.on('request', (request) => watched.asked.push(request));
  page.on('websocket', (socket) => socket.on('framesent', ({ payload }) => watched.sent.push(payload)));
  page.on('console', (message) => message.type() === 'error' && watched.complaints.push(message.text()));
  page.on('pageerror', (error) => watched.complaints.push(String(error)));
  return watched;
}

/** Checks that the page only requested files from the server and sent it short texts, no picture. */
export function checkStayed({ asked, sent, complaints }, server) {
  for (const request of asked) {
    assert.ok(request.url().startsWith(server) || /^(blob|data):/.test(request.url()), request.url());
    assert.deepEqual([request.method(), request.postData()], ['GET', null], request.url());
    assert.ok(request.url().startsWith('data:') || request.url().length < 300, request.url().slice(0, 300));
  }
  assert.ok(sent.every((payload) => typeof payload === 'string' && payload.length < 2000), 'what is sent is small and text');
  assert.deepEqual(complaints, []);
}
