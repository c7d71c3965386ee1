// SPDX-License-Identifier: MIT
// Keeps a canvas over the head of the page, with what is behind its face.
import { AnatomyPainter } from '../../element/head/anatomy.mjs';

export class Anatomy {
  #drawn = '';
  #painter = new AnatomyPainter();
  #running = false;
  shows = { mesh: false, points: false, zone: 0 };

  /** @param {HTMLElement} element talking-head @param {HTMLCanvasElement} canvas over it */
  constructor(element, canvas) {
    Object.assign(this, { element, canvas });
  }

  /** @param {{mesh: boolean, points: boolean, zone: number}} shows zone: a FAP, 0: none */
  show(shows) {
    this.shows = shows;
    this.#drawn = '';
    this.canvas.hidden = !(shows.mesh || shows.points || shows.zone);
    if (this.#running || this.canvas.hidden) return;
    this.#running = true;
    const step = () => {
      this.#running = !this.canvas.hidden;
      if (!this.#running) return;
      this.#update();
      requestAnimationFrame(step);
    };
    step();
  }

  /** Draws after a change of the face or the view. */
  #update() {
    const { view } = this.element.debugParts?.().stage ?? {};
    if (!view?.head?.faps || !view.camera) return; // pictures
    const box = view.renderer.domElement.getBoundingClientRect();
    const around = this.canvas.parentElement.getBoundingClientRect();
    const place = { left: box.x - around.x, top: box.y - around.y, width: box.width, height: box.height };
    const cameras = [view.camera.matrixWorldInverse, view.camera.projectionMatrix].flatMap(({ elements }) => elements);
    const drawn = [...Object.values(place), ...view.head.faps, ...cameras].join();
    if (drawn === this.#drawn) return;
    this.#drawn = drawn;
    for (const [side, pixels] of Object.entries(place)) this.canvas.style[side] = `${pixels}px`;
    const ratio = globalThis.devicePixelRatio || 1;
    Object.assign(this.canvas, { width: Math.round(box.width * ratio), height: Math.round(box.height * ratio) });
    const context = this.canvas.getContext('2d');
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, box.width, box.height);
    this.#painter.paint(context, view, box, this.shows);
  }
}
