// SPDX-License-Identifier: GPL-3.0-or-later
// The recipe of the documentation sends the face by WHIP; a second page is the endpoint, and shows what arrives.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import http from 'node:http';
import { once } from 'node:events';
import path from 'node:path';
import { after, before, test } from 'node:test';
import { launch } from '../../lib/browser.mjs';
import { Daemon, root } from '../../lib/daemon.mjs';

const TOKENLESS = /<script type="module" src="http:[^]*?<\/script>\n(?=```)/;
let daemon, browser, server, receiver;
const asked = [];

before(async () => {
  server = http.createServer(async (request, response) => {
    let body = '';
    for await (const piece of request.setEncoding('utf8')) body += piece;
    if (request.method === 'GET' && request.url !== '/') return response.writeHead(404).end();
    if (request.url === '/') return response.writeHead(200, { 'content-type': 'text/html; charset=utf-8' }).end(page);
    asked.push({ method: request.method, url: request.url, type: request.headers['content-type'], body });
    if (request.method === 'DELETE') return response.writeHead(200).end();
    const answer = await receiver.evaluate((sdp) => window.take(sdp), body);
    return response.writeHead(201, { 'content-type': 'application/sdp', location: '/sessions/1' }).end(answer);
  });
  server.listen(0, '127.0.0.1');
  await once(server, 'listening');
  const origin = `http://127.0.0.1:${server.address().port}`;
  daemon = await Daemon.start(['--origin', origin]);
  const guide = fs.readFileSync(path.join(root, 'web/docs/start/stream.md'), 'utf8');
  page = `<!doctype html><meta charset="utf-8">${guide.match(TOKENLESS)[0].replaceAll('127.0.0.1:8080', `127.0.0.1:${daemon.port}`).replace('room="studio"', 'room="studio" quality="low" lang="it"')}`;
  // the pages are no devices of a person: their addresses may be told
  browser = await launch({ flags: ['--disable-features=WebRtcHideLocalIpsWithMdns', '--autoplay-policy=no-user-gesture-required'] });
  receiver = await browser.newPage();
  await receiver.goto('about:blank');
  await receiver.evaluate(() => {
    window.take = async (sdp) => {
      const peer = (window.peer = new RTCPeerConnection());
      const video = Object.assign(document.createElement('video'), { autoplay: true });
      document.body.append(video);
      peer.addEventListener('track', ({ streams: [stream] }) => (video.srcObject = stream));
      await peer.setRemoteDescription({ type: 'offer', sdp });
      await peer.setLocalDescription(await peer.createAnswer());
      if (peer.iceGatheringState !== 'complete')
        await new Promise((resolve) => peer.addEventListener('icegatheringstatechange', () => peer.iceGatheringState === 'complete' && resolve()));
      return peer.localDescription.sdp;
    };
  });
});
after(async () => {
  await browser?.close();
  server?.closeAllConnections();
  server?.close();
  assert.deepEqual(await daemon.stop(), { code: 0, signal: null });
});
let page = '';

test('the face and the voice arrive by WHIP', async () => {
  const sender = await browser.newPage({ viewport: { width: 640, height: 480 }, reducedMotion: 'no-preference' });
  await sender.goto(`http://127.0.0.1:${server.address().port}/`);
  await sender.waitForFunction(() => document.querySelector('talking-head').debug?.().frames > 0, null, { timeout: 180000 });
  await sender.click('button');
  await sender.waitForFunction(() => window.stopLive, null, { timeout: 120000 });
  assert.deepEqual([asked[0].method, asked[0].url, asked[0].type], ['POST', '/whip', 'application/sdp']);
  assert.match(asked[0].body, /m=audio[^]*a=sendonly|m=video[^]*a=sendonly/);
  const answer = await fetch(`${daemon.url}/v1/say?room=studio&lang=it`, { method: 'POST', body: 'Buongiorno a tutti, questa è la mia voce, e si vede il mio volto.' });
  assert.equal(answer.status, 202);
  /** Pictures decoded, energy of the sound, and the colours of the picture. */
  const arrived = () => receiver.evaluate(async () => {
    const stats = [...(await window.peer.getStats()).values()].filter(({ type }) => type === 'inbound-rtp');
    const of = (kind) => stats.find((one) => one.kind === kind) ?? {};
    const video = document.querySelector('video');
    const canvas = Object.assign(document.createElement('canvas'), { width: 64, height: 48 });
    const context = canvas.getContext('2d');
    if (video.videoWidth) context.drawImage(video, 0, 0, 64, 48);
    const { data } = context.getImageData(0, 0, 64, 48);
    return { frames: of('video').framesDecoded ?? 0, energy: of('audio').totalAudioEnergy ?? 0, colours: new Set(new Uint32Array(data.buffer)).size };
  });
  let seen;
  for (const end = Date.now() + 120000; Date.now() < end; await new Promise((resolve) => setTimeout(resolve, 500))) {
    seen = await arrived();
    if (seen.frames > 20 && seen.energy > 1e-4 && seen.colours > 200) break;
  }
  assert.ok(seen.frames > 20 && seen.energy > 1e-4 && seen.colours > 200, JSON.stringify(seen));
  await sender.evaluate(() => window.stopLive());
  assert.deepEqual([asked.at(-1).method, asked.at(-1).url], ['DELETE', '/sessions/1']);
});

test('a face that keeps still is sent on, once a second', async () => {
  const page = await browser.newPage({ viewport: { width: 320, height: 240 }, reducedMotion: 'reduce' });
  await page.goto(`http://127.0.0.1:${server.address().port}/`);
  await page.waitForFunction(() => document.querySelector('talking-head').debug?.().frames > 0, null, { timeout: 180000 });
  const pictures = await page.evaluate(async () => {
    const [track] = document.querySelector('talking-head').captureStream(25).getVideoTracks();
    const reader = new window.MediaStreamTrackProcessor({ track }).readable.getReader();
    const times = [];
    while (times.length < 3) {
      const { value } = await reader.read();
      times.push(performance.now());
      value.close();
    }
    track.stop();
    return times.length;
  });
  assert.equal(pictures, 3); // the test waits for them
  await page.close();
});
