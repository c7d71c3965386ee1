// SPDX-License-Identifier: MIT
// Who speaks: the server's heads, to be chosen by their pictures.
import { forGood } from '../shared/storage.js';

const KEY = 'faccia.head';

/**
 * The head that the reader chose before, if the server still has it.
 * @param {{name: string}[]} models @returns {string|null}
 */
export function keptHead(models) {
  const kept = forGood.get(KEY);
  return models.some(({ name }) => name === kept) ? kept : null;
}

function item({ name, title, about, poster }, chosen, choose) {
  const radio = document.createElement('input');
  Object.assign(radio, { type: 'radio', name: 'head', value: name, checked: chosen });
  radio.addEventListener('change', () => {
    forGood.set(KEY, name);
    choose(name);
  });
  const label = document.createElement('label');
  if (about) label.title = about;
  label.append(radio);
  if (poster) {
    const image = document.createElement('img');
    Object.assign(image, { src: `v1/${poster}`, alt: '', width: 72, height: 94, loading: 'lazy' });
    label.append(image);
  }
  const called = document.createElement('span');
  called.textContent = title;
  label.append(called);
  return label;
}

/**
 * Fills the choice of heads; hides it when there is only one.
 * @param {HTMLElement} box @param {object[]} models of `hello` @param {string|null} chosen
 * @param {(name: string) => void} choose
 */
export function fillHeads(box, models, chosen, choose) {
  box.hidden = models.length < 2;
  const now = chosen ?? models[0]?.name;
  box.querySelector('.heads').replaceChildren(...models.map((model) => item(model, model.name === now, choose)));
}
