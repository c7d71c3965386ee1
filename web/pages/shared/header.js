// SPDX-License-Identifier: MIT
// What the header of the pages (header.html) does: its menu, whose groups open one at a time and which a button opens on narrow
// screens; the state of the connection; the texts of a page.

/** Writes texts and labels. @param {ParentNode} within @param {(name: string) => string} say */
export function fillTexts(within, say) {
  for (const element of within.querySelectorAll('[data-text]')) element.textContent = say(element.dataset.text);
  for (const element of within.querySelectorAll('[data-label]')) element.ariaLabel = say(element.dataset.label);
}

/** @param {string} state of the connection @param {(name: string) => string} say */
export function showConnection(state, say) {
  const shown = document.getElementById('connection');
  shown.dataset.state = state;
  shown.querySelector('.text').textContent = say(state);
}

/** Shows the page, once its texts are written (see page.css). */
export const showPage = () => document.documentElement.classList.add('written');

/** Makes the menu work, if the page has one. */
export function openMenu() {
  const [button, menu] = ['menu', 'site'].map((id) => document.getElementById(id));
  if (!menu) return;
  const groups = [...menu.querySelectorAll('details')];
  const narrow = () => getComputedStyle(button).display !== 'none';
  const show = (open) => {
    button.ariaExpanded = String(open);
    menu.classList.toggle('open', open);
    // where all is listed below each other, the group of this page is open
    for (const group of groups) group.open = open && Boolean(group.querySelector('[aria-current]'));
  };
  button.addEventListener('click', () => show(button.ariaExpanded !== 'true'));
  for (const group of groups)
    group.addEventListener('toggle', () => {
      if (!group.open) return;
      for (const other of groups) if (other !== group) other.open = false; // for browsers that do not know details[name]
    });
  document.addEventListener('click', ({ target }) => {
    if (!menu.contains(target) && !button.contains(target)) show(false);
  });
  document.addEventListener('keydown', (event) => {
    if (event.key !== 'Escape' || !menu.contains(document.activeElement)) return;
    const open = groups.find((group) => group.open);
    event.stopPropagation();
    show(false);
    (narrow() ? button : (open ?? groups[0]).querySelector('summary')).focus();
  });
}
