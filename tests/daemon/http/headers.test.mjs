// SPDX-License-Identifier: GPL-3.0-or-later
// Security headers: policies for content, frames, referrers and resources.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Daemon } from '../../lib/daemon.mjs';

let daemon;
before(async () => (daemon = await Daemon.start()));
after(async () => assert.deepEqual(await daemon.stop(), { code: 0, signal: null }));

const policy = (response) =>
  Object.fromEntries(response.headers.get('content-security-policy').split(';').map((d) => d.trim().split(/ (.*)/s)).map(([name, value]) => [name, value ?? '']));
const fetched = async (address, from = daemon, options = {}) => {
  const response = await from.get(address, options);
  await response.arrayBuffer();
  return response;
};
const pages = ['/', '/voices.html', '/emotion.html', '/avatar.html'];

test('the policy of pages allows only their own scripts and no inline code', async () => {
  for (const page of pages) {
    const response = await fetched(page);
    const directives = policy(response);
    assert.equal(directives['default-src'], "'none'");
    assert.equal(directives['script-src'], "'self' 'wasm-unsafe-eval'");
    assert.equal(directives['style-src'], "'self'");
    assert.equal(directives['manifest-src'], "'self'", 'the page of a room can be installed');
    assert.equal(directives['base-uri'], "'none'");
    assert.equal(directives['form-action'], "'none'");
    assert.equal(directives['media-src'], "'self' blob:", 'a video that its reader has chosen');
    assert.equal(directives['require-trusted-types-for'], "'script'");
    const others = response.headers.get('content-security-policy').replace(/media-src [^;]*/, '');
    assert.doesNotMatch(others, /unsafe-inline|unsafe-eval(?<!wasm-unsafe-eval)|blob:|\*/);
    assert.equal(directives['frame-ancestors'], "'none'");
    assert.equal(response.headers.get('x-frame-options'), 'DENY');
  }
});

test('every response forbids type sniffing, referrers and loading', async () => {
  const answers = ['/', '/talking-head.js', '/v1/models/mara', '/v1/voices', '/healthz', '/nowhere', '/metrics', '/v1/speech?text=Ciao', '/v1/openapi.json', '/v1/stream'];
  for (const address of answers) {
    const { headers } = await fetched(address);
    assert.equal(headers.get('x-content-type-options'), 'nosniff', address);
    assert.equal(headers.get('referrer-policy'), 'no-referrer', address);
    const script = address.endsWith('.js') ? " connect-src 'self';" : ''; // for web workers
    if (address !== '/') assert.equal(headers.get('content-security-policy'), `default-src 'none';${script} frame-ancestors 'none'`, address);
  }
});

test('allows scripts and heads to be embedded anywhere, but not API responses', async () => {
  for (const address of ['/talking-head.js', '/page.css', '/v1/models/mara'])
    assert.equal((await fetched(address)).headers.get('cross-origin-resource-policy'), 'cross-origin', address);
  for (const address of ['/v1/voices', '/v1/speech?text=Ciao', '/healthz'])
    assert.equal((await fetched(address)).headers.get('cross-origin-resource-policy'), 'same-origin', address);
  // a 304 response has the same headers
  const { headers } = await fetched('/talking-head.js');
  const again = await fetched('/talking-head.js', daemon, { headers: { 'if-none-match': headers.get('etag') } });
  assert.equal(again.status, 304);
  assert.equal(again.headers.get('cross-origin-resource-policy'), 'cross-origin');
});

test('--embed allows the named sites to frame pages', async () => {
  const own = await Daemon.start(['--embed', 'https://portal.example', '--embed', 'https://*.school.example', '--embed', "https://x.example; script-src 'unsafe-inline'"]);
  const response = await fetched('/', own);
  const directives = policy(response);
  assert.equal(directives['frame-ancestors'], "'self' https://portal.example https://*.school.example", 'what is no origin is left out');
  assert.equal(directives['script-src'], "'self' 'wasm-unsafe-eval'");
  assert.equal(response.headers.get('x-frame-options'), null);
  for (const page of ['/library.html', '/room.html'])
    assert.equal(policy(await fetched(page, own))['frame-ancestors'], "'self' https://portal.example https://*.school.example", page);
  // pages where a click has effects or other people's text is displayed
  for (const page of ['/operator.html', '/editor.html', '/avatar.html', '/player.html', '/emotion.html', '/examples.html']) {
    const answer = await fetched(page, own);
    assert.deepEqual([answer.status, policy(answer)['frame-ancestors'], answer.headers.get('x-frame-options')], [200, "'none'", 'DENY'], page);
  }
  assert.equal((await fetched('/v1/voices', own)).headers.get('content-security-policy'), "default-src 'none'; frame-ancestors 'none'");
  assert.equal((await own.stop()).code, 0);
  const all = await Daemon.start(['--embed', '*']);
  assert.equal(policy(await fetched('/', all))['frame-ancestors'], "'self' *");
  assert.equal((await all.stop()).code, 0);
});
