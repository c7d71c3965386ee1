// SPDX-License-Identifier: GPL-3.0-or-later
// What a page asks for and sends, and that no picture is in it.
import assert from 'node:assert/strict';

/** Takes down what the page does from now on: {asked, sent, complaints}. */
export function watchPage(page) {
  const watched = { asked: [], sent: [], complaints: [] };
  page.on('request', (request) => watched.asked.push(request));
  page.on('websocket', (socket) => socket.on('framesent', ({ payload }) => watched.sent.push(payload)));
  page.on('console', (message) => message.type() === 'error' && watched.complaints.push(message.text()));
  page.on('pageerror', (error) => watched.complaints.push(String(error)));
  return watched;
}

/** Nothing of a picture has left the page for the server, which is asked for files and told small texts only. */
export function checkStayed({ asked, sent, complaints }, server) {
  for (const request of asked) {
    assert.ok(request.url().startsWith(server) || /^(blob|data):/.test(request.url()), request.url());
    assert.deepEqual([request.method(), request.postData()], ['GET', null], request.url());
    assert.ok(request.url().startsWith('data:') || request.url().length < 300, request.url().slice(0, 300));
  }
  assert.ok(sent.every((payload) => typeof payload === 'string' && payload.length < 2000), 'what is sent is small and text');
  assert.deepEqual(complaints, []);
}
