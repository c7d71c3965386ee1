// SPDX-License-Identifier: GPL-3.0-or-later
// The card for Home Assistant dashboards, in a page of another origin that imitates a dashboard.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { PNG } from 'pngjs';
import { launch } from '../../lib/browser.mjs';
import { artefacts, Daemon, eventually } from '../../lib/daemon.mjs';
import { servePages } from '../../lib/page-server.mjs';

let daemon, browser, pages, page;
const problems = [];
before(async () => {
  pages = await servePages({ '/': { body: '<!doctype html><html lang="it"><title>Casa</title><main></main>', type: 'text/html' } });
  daemon = await Daemon.start(['--origin', pages.url]);
  browser = await launch({ webgl: false });
  page = await browser.newPage({ locale: 'it-IT' });
  page.on('pageerror', (error) => problems.push(String(error)));
  await page.goto(pages.url);
  await page.evaluate(async (server) => {
    // an element that dashboards define
    customElements.define('ha-card', class extends HTMLElement {});
    await import(`${server}/faccia-card.js`);
    window.states = { 'sensor.kitchen_state': { state: 'idle' } };
    window.tell = (state) => {
      window.states = { ...window.states, 'sensor.kitchen_state': { state } };
      window.card.hass = { language: 'it', states: window.states };
    };
    window.card = document.createElement('faccia-card');
    window.card.setConfig({ type: 'custom:faccia-card', url: server, room: 'kitchen', entity: 'sensor.kitchen_state', height: 240, view: 'mouth' });
    document.querySelector('main').append(window.card);
    window.tell('idle');
    window.head = window.card.shadowRoot.querySelector('talking-head');
  }, daemon.url);
});
after(async () => {
  await browser?.close();
  await pages?.close();
  assert.equal((await daemon.stop()).code, 0);
  assert.deepEqual(problems, []);
});
const sign = () => page.evaluate(() => window.card.shadowRoot.querySelector('span').textContent);
const post = (path, body) => daemon.get(`/v1/${path}?room=kitchen&lang=it`, { method: 'POST', body });

test('offers the card with a settings form and default settings', async () => {
  const { offered, stub, names, size } = await page.evaluate(() => {
    const Card = customElements.get('faccia-card'), form = Card.getConfigForm();
    form.assertConfig(Card.getStubConfig());
    return { offered: window.customCards, stub: Card.getStubConfig(), size: window.card.getCardSize(), names: form.schema.map((field) => [field.name, form.computeLabel(field)]) };
  });
  assert.deepEqual(offered.map((card) => card.type), ['faccia-card']);
  assert.deepEqual(stub, { url: daemon.url, room: 'home' });
  assert.equal(size, 5);
  for (const [name, label] of names) assert.ok(label, name);
});

test('shows the face of the room, speaks, and shows the states of entity and room', async () => {
  await page.waitForFunction(() => window.head.debug?.().state === 'idle', null, { timeout: 120000 });
  assert.deepEqual(await page.evaluate(() => [window.head.room, window.head.view, window.head.lang, window.head.offsetHeight]), ['kitchen', 'mouth', 'it', 240]);
  await eventually(async () => (await (await daemon.get('/v1/rooms')).json()).rooms.some(({ name, listeners }) => name === 'kitchen' && listeners === 1), 'the card in the room');
  const heard = page.evaluate(() => new Promise((resolve) => window.head.addEventListener('sentence', ({ detail }) => resolve(detail.text), { once: true })));
  assert.equal((await post('say', 'La cena è pronta.')).status, 202);
  assert.equal(await heard, 'La cena è pronta.');
  await page.evaluate(() => window.tell('listening'));
  assert.equal(await sign(), 'listening');
  await page.evaluate(() => window.tell('idle'));
  assert.equal(await sign(), '');
  assert.equal((await post('rooms/kitchen/commands', JSON.stringify({ type: 'state', state: 'thinking', text: 'Che tempo fa?' }))).status, 202);
  await eventually(async () => (await sign()) === 'Che tempo fa?', 'the state of the room');
});

test('offers answers as buttons, and sends the chosen one', async () => {
  const script = await daemon.stream('?room=kitchen&watch=1');
  await script.wait({ type: 'joined' });
  const shown = () => page.evaluate(() => {
    const box = window.card.shadowRoot.querySelector('div');
    return box.hidden ? null : [box.querySelector('p').textContent, ...[...box.querySelectorAll('button')].map((each) => each.textContent)];
  });
  assert.equal(await shown(), null);
  script.send({ type: 'choices', id: 'q', question: 'Viene?', choices: ['Sì', 'Fra poco'] });
  await eventually(async () => JSON.stringify(await shown()) === '["Viene?","Sì","Fra poco"]', 'the answers');
  await page.screenshot({ path: `${artefacts}/card.png` });
  await page.evaluate(() => window.card.shadowRoot.querySelectorAll('button')[1].click());
  await script.wait({ type: 'chosen', id: 'q', choice: 1, text: 'Fra poco' });
  await eventually(async () => (await shown()) === null, 'no answers any more');
  script.send({ type: 'choices', choices: ['Uno'] });
  await eventually(shown, 'other answers');
  script.send({ type: 'choices', choices: [] });
  await eventually(async () => (await shown()) === null, 'them to be withdrawn');
  await script.close();
});

test('applies changed settings in place and reports invalid ones', async () => {
  const wrong = await page.evaluate((server) => [{}, { url: 'kitchen', room: 'a' }, { url: 'ftp://x', room: 'a' }, { url: server }, { url: server, room: 'no spaces' }, { url: server, room: 'a', height: 9 }].map((config) => {
    try {
      window.card.setConfig(config);
      return '';
    } catch ({ message }) {
      return message.split(':')[0];
    }
  }), daemon.url);
  assert.deepEqual(wrong, ['url', 'url', 'url', 'room', 'room', 'height']);
  await page.evaluate((server) => window.card.setConfig({ url: `${server}/`, room: 'hall', captions: false }), daemon.url);
  await eventually(async () => (await (await daemon.get('/v1/rooms')).json()).rooms.some(({ name }) => name === 'hall'), 'the other room');
  assert.equal(await page.evaluate(() => window.head.captions), false);
});

test('draws the face even if the dashboard sends its state before the settings', async () => {
  const seeing = await launch();
  try {
    const dashboard = await seeing.newPage({ viewport: { width: 420, height: 420 } });
    const wrong = [];
    dashboard.on('pageerror', (error) => wrong.push(String(error)));
    await dashboard.goto(pages.url);
    await dashboard.evaluate(async (server) => {
      customElements.define('ha-card', class extends HTMLElement {});
      await import(`${server}/faccia-card.js`);
      const card = window.card = document.createElement('faccia-card');
      card.hass = { language: 'it', states: { 'sensor.hall_state': { state: 'thinking' } } };
      card.setConfig({ type: 'custom:faccia-card', url: server, room: 'hall', entity: 'sensor.hall_state', height: 240 });
      document.querySelector('main').append(card);
      const head = card.shadowRoot.querySelector('talking-head');
      head.setAttribute('quality', 'low');
      head.setAttribute('poster', 'off');
      await new Promise((resolve) => head.addEventListener('ready', resolve, { once: true }));
      head.pose({ 3: 0 });
    }, daemon.url);
    const skin = async () => {
      const { data } = PNG.sync.read(await dashboard.screenshot({ path: `${artefacts}/card-face.png` }));
      let count = 0;
      for (let i = 0; i < data.length; i += 4) if (data[i] > 100 && data[i] > data[i + 1] + 15 && data[i + 1] > data[i + 2]) count++;
      return count;
    };
    await eventually(async () => (await skin()) > 2000, 'the face in the card');
    assert.deepEqual(await dashboard.evaluate(() => {
      const head = window.card.shadowRoot.querySelector('talking-head');
      return [head.lang, window.card.shadowRoot.querySelector('span').textContent, head.offsetHeight];
    }), ['it', 'thinking', 240]);
    assert.deepEqual(wrong, []);
  } finally {
    await seeing.close();
  }
});
