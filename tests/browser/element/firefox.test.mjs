// SPDX-License-Identifier: GPL-3.0-or-later
// Firefox under the documented policy, and on a machine without a sound device, where its audio never starts.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Daemon } from '../../lib/daemon.mjs';
import { Firefox } from '../../lib/firefox.mjs';
import { servePages } from '../../lib/page-server.mjs';

let daemon, firefox, server;
before(async () => {
  daemon = await Daemon.start();
  server = await servePages({});
  firefox = await Firefox.launch();
});
after(async () => {
  await firefox?.close();
  await server?.close();
  assert.equal((await daemon.stop()).code, 0);
});

test('plays speech to its end and requests a tap once, with or without an output device', async () => {
  const stream = daemon.url.replace('http', 'ws');
  server.files['/page.js'] = {
    type: 'text/javascript',
    body: `
      const head = document.querySelector('talking-head');
      const button = head.shadowRoot.querySelector('.sound');
      document.addEventListener('securitypolicyviolation', (e) => console.log('violation', e.effectiveDirective, e.blockedURI));
      head.addEventListener('sound', ({ detail }) => console.log('sound', detail.sound, detail.reason, button.hidden));
      const speak = () => head.speak('La mamma parla.').then(({ reason, sound }) => console.log('end', reason, sound, button.hidden));
      head.addEventListener('hello', speak);
      const again = ({ detail }) => detail.sound !== 'blocked' && speak().then(() => console.log('that is all'));
      document.addEventListener('click', () => head.addEventListener('sound', again), { once: true });`,
  };
  server.files['/'] = {
    body: `<!doctype html><meta charset="utf-8"><script type="module" src="${daemon.url}/talking-head.js"></script>
      <talking-head lang="it" src="${stream}/v1/stream"></talking-head><script type="module" src="page.js"></script>`,
    headers: {
      'content-security-policy': `default-src 'none'; script-src 'self' ${daemon.url}; style-src 'self'; connect-src ${daemon.url} ${stream}; img-src ${daemon.url}; require-trusted-types-for 'script'; trusted-types 'none'`,
    },
  };
  await firefox.open(server.url);
  assert.equal(await firefox.said('sound'), 'sound blocked autoplay false');
  assert.equal(await firefox.said('end'), 'end done blocked false');
  await firefox.click(100, 100);
  assert.match(await firefox.said('sound'), /^sound (on undefined|none no-device) true$/);
  assert.match(await firefox.said('end'), /^end done (undefined|none) true$/);
  await firefox.said('that is all');
  assert.equal(await Promise.race([firefox.said('violation'), null]), null);
});
