// SPDX-License-Identifier: MIT
// An answer in own words can be typed, too, while a question without choices waits.
export class Reply {
  #late = 0; // timer
  #id = null;

  /** @param {HTMLElement} head @param {string} lang of the answer @param {() => void} wake somebody is there */
  constructor(head, lang, wake) {
    this.form = document.getElementById('reply');
    this.field = document.getElementById('reply-text');
    let offered = null; // id of what is on offer
    head.addEventListener('choices', ({ detail }) => (offered = detail.choices.length > 0 ? detail.id : null));
    head.addEventListener('asked', ({ detail }) => offered !== detail.id && this.#open(detail));
    head.addEventListener('answered', ({ detail }) => detail.id === this.#id && this.close());
    head.addEventListener('begin', () => this.close());
    this.form.addEventListener('submit', (event) => {
      event.preventDefault();
      const text = this.field.value.trim();
      if (text && head.said(text, { lang })) this.close();
    });
    this.field.addEventListener('input', wake);
  }

  close() {
    clearTimeout(this.#late);
    this.form.hidden = true;
    this.field.value = '';
  }

  #open({ id, seconds }) {
    this.close();
    this.#id = id;
    this.form.hidden = false;
    this.#late = setTimeout(() => this.close(), seconds * 1000);
  }
}
