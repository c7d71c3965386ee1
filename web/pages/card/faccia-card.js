// SPDX-License-Identifier: MIT
// A card for Home Assistant's dashboards: the face of a room. Add it there as a resource, a JavaScript module:
// http://SERVER:8080/faccia-card.js; protocol/mqtt.md says how the room becomes a device.
const SIGNS = ['listening', 'thinking', 'muted', 'error', 'processing', 'unavailable']; // of an assistant's entity, or of the room

const FORM = [
  { name: 'url', required: true, selector: { text: { type: 'url' } } },
  { name: 'room', required: true, selector: { text: {} } },
  { name: 'entity', selector: { entity: { domain: ['sensor', 'assist_satellite'] } } },
  { name: 'height', selector: { number: { min: 120, max: 1200, unit_of_measurement: 'px', mode: 'box' } } },
  { name: 'view', selector: { select: { options: ['bust', 'face', 'mouth'] } } },
  { name: 'model', selector: { text: {} } },
  { name: 'captions', selector: { boolean: {} } },
  { name: 'token', selector: { text: { type: 'password' } } },
];
const LABELS = { url: 'Address of faccia', room: 'Room', entity: 'Entity whose state she shows', height: 'Height', view: 'View', model: 'Head', captions: 'Captions', token: 'Token' };
const HEIGHT = 320, ROW = 50;

/** Checks a card's settings; throws an error for the dashboard to show. */
function check(config) {
  let address;
  try {
    address = new URL(config.url);
  } catch {
    throw new Error(`url: '${config.url ?? ''}' is no address of faccia, such as http://192.168.1.2:8080`);
  }
  if (!/^https?:$/.test(address.protocol)) throw new Error('url: begins with http:// or https://');
  if (!/^[\w.-]{1,64}$/.test(config.room ?? '')) throw new Error('room: 1 to 64 letters, digits, and any of - _ .');
  if (config.height !== undefined && !(config.height >= 120 && config.height <= 1200)) throw new Error('height: 120 to 1200');
  return address;
}

class FacciaCard extends HTMLElement {
  #head = null;
  #config = null;
  #hass = null;
  #sign = document.createElement('span');
  #question = document.createElement('div');
  #states = { entity: '', room: '' };

  static getStubConfig = () => ({ url: new URL('.', import.meta.url).href.replace(/\/$/, ''), room: 'home' });

  static getConfigForm = () => ({ schema: FORM, computeLabel: ({ name }) => LABELS[name], assertConfig: check });

  /** @param {object} config as stored by the dashboard; throws an error if invalid */
  setConfig(config) {
    const address = check(config);
    this.#config = config;
    if (!this.#head) this.#make();
    const stream = new URL('v1/stream', address.href.endsWith('/') ? address : `${address.href}/`);
    stream.protocol = stream.protocol === 'https:' ? 'wss:' : 'ws:';
    const attributes = { src: stream.href, room: config.room, view: config.view, model: config.model, token: config.token, captions: config.captions === false ? 'off' : null };
    for (const [name, value] of Object.entries(attributes))
      if (value) this.#head.setAttribute(name, value);
      else this.#head.removeAttribute(name);
    this.#head.style.height = `${config.height ?? HEIGHT}px`;
    if (this.#hass) this.hass = this.#hass;
  }

  /** Receives the state of Home Assistant on every change; some dashboards set it before the card's settings. */
  set hass(hass) {
    this.#hass = hass;
    if (!this.#head) return;
    const entity = hass.states?.[this.#config?.entity], state = entity?.state;
    if (hass.language && this.#head.lang !== hass.language) this.#head.lang = hass.language;
    this.#show('entity', SIGNS.includes(state) ? state : '');
  }

  getCardSize() {
    return Math.ceil((this.#config?.height ?? HEIGHT) / ROW);
  }

  getGridOptions() {
    return { columns: 6, min_columns: 3, rows: 'auto' };
  }

  #make() {
    const card = document.createElement('ha-card');
    const style = document.createElement('style');
    style.textContent = `
      :host { display: block; }
      ha-card { position: relative; overflow: hidden; }
      talking-head { display: block; inline-size: 100%; }
      span { position: absolute; inset: 8px 8px auto auto; padding: 2px 8px; border-radius: 10px; font-size: 14px;
        background: var(--card-background-color, #fff); color: var(--primary-text-color, #222); }
      span:empty { display: none; }
      div { padding: 8px; display: flex; flex-wrap: wrap; gap: 8px; color: var(--primary-text-color, #222); }
      div[hidden] { display: none; }
      p { margin: 0; inline-size: 100%; font-size: 18px; }
      button { min-block-size: 48px; flex: 1 1 auto; padding: 4px 16px; border: 0; border-radius: 12px; font: inherit; font-size: 18px;
        background: var(--primary-color, #06c); color: var(--text-primary-color, #fff); }`;
    this.#head = document.createElement('talking-head');
    this.#head.addEventListener('state', ({ detail }) => this.#show('room', SIGNS.includes(detail.state) ? detail.text || detail.state : ''));
    this.#question.role = 'group';
    this.#ask({ choices: [] });
    this.#head.addEventListener('choices', ({ detail }) => this.#ask(detail));
    this.#head.addEventListener('chosen', () => this.#ask({ choices: [] }));
    this.#head.addEventListener('connection', ({ detail }) => detail.state !== 'open' && this.#ask({ choices: [] }));
    card.append(this.#head, this.#sign, this.#question);
    this.attachShadow({ mode: 'open' }).append(style, card);
  }

  /** Shows the answers as buttons; an empty list removes them. */
  #ask({ id, question = '', choices }) {
    const what = document.createElement('p');
    what.textContent = this.#question.ariaLabel = question;
    this.#question.hidden = !choices.length;
    this.#question.replaceChildren(what, ...choices.map((text, choice) => {
      const button = document.createElement('button');
      button.type = 'button';
      button.textContent = text;
      button.addEventListener('click', () => this.#head.choose(choice, id));
      return button;
    }));
  }

  #show(from, text) {
    this.#states[from] = text;
    this.#sign.textContent = this.#states.entity || this.#states.room;
  }
}

if (!customElements.get('talking-head')) await import(new URL('./talking-head.js', import.meta.url));
if (!customElements.get('faccia-card')) customElements.define('faccia-card', FacciaCard);
globalThis.customCards ??= [];
globalThis.customCards.push({ type: 'faccia-card', name: 'faccia', description: 'A face that speaks, in a room of the house', preview: true, documentationURL: new URL('./', import.meta.url).href });
