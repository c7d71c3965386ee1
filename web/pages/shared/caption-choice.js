// SPDX-License-Identifier: MIT
// The look of captions: chosen by the user, stored for later visits.
import { forGood } from './storage.js';

const KEY = 'faccia.captions';
const SIZES = ['normal', 'large', 'larger', 'largest'];
const COLOURS = ['standard', 'contrast', 'light', 'yellow'];

function restored() {
  let kept = {};
  try {
    kept = JSON.parse(forGood.get(KEY)) ?? {};
  } catch {
    // not ours
  }
  return {
    on: kept.on !== false,
    size: SIZES.includes(kept.size) ? kept.size : SIZES[0],
    colours: COLOURS.includes(kept.colours) ? kept.colours : COLOURS[0],
  };
}

const make = (name, { text, words, ...properties } = {}, ...children) => {
  const element = Object.assign(document.createElement(name), properties);
  if (words) element.dataset.text = words;
  element.append(...(text ? [text] : []), ...children);
  return element;
};

function radios(name, legend, values, look) {
  const choice = (value) => {
    const input = make('input', { type: 'radio', name, value });
    return make('label', { className: 'choice' }, input, make('span', { words: value }), ...look(value));
  };
  return make('fieldset', {}, make('legend', { words: legend }), make('div', { className: 'row' }, ...values.map(choice)));
}

function swatch(colours) {
  const sample = make('span', { className: 'swatch', ariaHidden: 'true' }, make('span', { words: 'sampleSaid' }), make('b', { words: 'sampleWord' }));
  sample.dataset.colours = colours;
  return [sample];
}

/**
 * Fills a `details` with the choices, and applies them to the head. @param {HTMLDetailsElement} box
 * @param {HTMLElement} head @param {{on?: boolean}} [wish] settings of a link, which are not stored
 */
export function openCaptionChoice(box, head, wish = {}) {
  const state = { ...restored(), ...wish };
  const shown = make('input', { type: 'checkbox', id: 'captions' });
  shown.setAttribute('role', 'switch');
  box.append(
    make('summary', { words: 'captions' }),
    make('label', { className: 'choice' }, shown, make('span', { words: 'captionsOn' })),
    radios('caption-size', 'captionSize', SIZES, () => []),
    radios('caption-colours', 'captionColours', COLOURS, swatch),
  );
  const radio = (name) => box.querySelector(`input[name="${name}"][value="${name === 'caption-size' ? state.size : state.colours}"]`);
  const apply = () => {
    head.setAttribute('captions', state.on ? 'on' : 'off');
    head.setAttribute('caption-size', state.size);
    head.setAttribute('caption-colours', state.colours);
    shown.checked = state.on;
    radio('caption-size').checked = radio('caption-colours').checked = true;
  };
  const keep = () => forGood.set(KEY, JSON.stringify(state));
  box.addEventListener('change', ({ target }) => {
    if (target === shown) state.on = shown.checked;
    if (target.name === 'caption-size') state.size = target.value;
    if (target.name === 'caption-colours') state.colours = target.value;
    apply();
    keep();
  });
  apply();
  // the head's own button may switch them, too
  new MutationObserver(() => {
    const on = head.getAttribute('captions') !== 'off';
    if (on === state.on) return;
    state.on = shown.checked = on;
    keep();
  }).observe(head, { attributeFilter: ['captions'] });
}
