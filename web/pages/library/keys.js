// SPDX-License-Identifier: MIT
// Keyboard shortcuts for all functions, which can be switched off (WCAG 2.1, 2.1.4).
import { forGood } from '../shared/storage.js';

const KEY = 'faccia.keys';
const WRITES = 'input:not([type="checkbox"], [type="range"]), textarea, select';
const PRESSES = 'button, a, summary, [tabindex="0"]';

/**
 * @param {HTMLInputElement} on @param {HTMLElement} list that shows the keys
 * @param {{key: string, shown?: string, word: string, act: () => void}[]} keys
 * @returns {(say: (name: string) => string) => void} shows the keys in the page's language
 */
export function openKeys(on, list, keys) {
  on.checked = forGood.get(KEY) !== 'off';
  on.addEventListener('change', () => forGood.set(KEY, on.checked ? 'on' : 'off'));
  document.addEventListener('keydown', (event) => {
    if (!on.checked || event.ctrlKey || event.metaKey || event.altKey || event.target.closest?.(WRITES)) return;
    if (event.key === ' ' && event.target.closest?.(`${PRESSES}, input`)) return;
    const found = keys.find(({ key }) => key === event.key);
    if (!found) return;
    event.preventDefault();
    found.act();
  });
  return (say) => {
    const rows = keys.flatMap(({ key, shown, word }) => {
      const term = document.createElement('dt');
      const kbd = document.createElement('kbd');
      kbd.textContent = shown ?? key;
      term.append(kbd);
      const about = document.createElement('dd');
      about.textContent = say(word);
      return [term, about];
    });
    list.replaceChildren(...rows);
  };
}
