// SPDX-License-Identifier: MIT
// A button that makes a film and saves it: with progress, and to stop it.
import { saveFilm } from './film.js';

export class FilmButton {
  #stop = null; // AbortController of the film that is being made

  /**
   * @param {import('./frame.js').Frame} frame @param {HTMLButtonElement} button @param {HTMLProgressElement} progress
   * @param {(told: (share: number) => void, signal: AbortSignal) => Promise<{film: Blob, name: string}|null>} make
   *   null: stopped
   */
  constructor(frame, button, progress, make) {
    Object.assign(this, { frame, button, progress, make });
    button.addEventListener('click', () => (this.#stop ? this.#stop.abort() : this.#run()));
    frame.onTranslate(() => this.#show());
  }

  #show() {
    this.button.textContent = this.frame.say(this.#stop ? 'filmStop' : 'filmMake');
    this.progress.hidden = !this.#stop;
  }

  async #run() {
    const { frame, progress } = this;
    this.#stop = new AbortController();
    frame.problem.clear();
    frame.tell('filming');
    progress.removeAttribute('value');
    this.#show();
    try {
      const made = await this.make((share) => share && (progress.value = share), this.#stop.signal);
      if (made) saveFilm(made.film, made.name);
      frame.tell(made ? 'filmed' : null);
    } catch (error) {
      frame.tell(null);
      frame.problem.show({ code: error.code ?? 'film-failed', message: error.message, field: error.field });
    }
    this.#stop = null;
    this.#show();
  }
}
