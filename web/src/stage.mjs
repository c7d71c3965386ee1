// SPDX-License-Identifier: MIT
import { Head } from './head/head.mjs';
import { readModel } from './head/model.mjs';
import { Governor } from './head/quality.mjs';
import { View } from './head/view.mjs';
import { Pace } from './pace.mjs';

const PAUSE_MS = 3000; // between frames: more is no slow machine but a hidden page
const AHEAD_MOST_MS = 300; // for longer nothing is foreseen
const CALM_MS = 30; // between pictures of a face that only idles: saves the battery

/**
 * The canvas: draws the head when something has changed, at the display's rate while something moves, and finds the
 * quality that the machine can afford. Without WebGL it does nothing, and says so.
 */
export class Stage {
  /**
   * @param {HTMLCanvasElement} canvas
   * @param {object} ports frame(now, ahead) -> {values, more, calm}: what to show `ahead` milliseconds later, when the
   *   picture is on the display, whether it goes on moving, and whether slowly; trouble('noWebgl' | 'lost' | null)
   */
  constructor(canvas, ports) {
    this.canvas = canvas;
    this.ports = ports;
    this.wish = 'auto';
    this.governor = new Governor();
    this.request = 0;
    this.last = -Infinity;
    this.calm = false;
    this.following = false; // whether the next frame is to come right after the last one
    this.frames = 0;
    this.interval = 0; // of the frames that follow each other, smoothed
    this.view = null;
    this.pace = new Pace(() => this.view.mark());
    this.lost = false;
    this.observer = new ResizeObserver(() => this.#resize());
    canvas.addEventListener('webglcontextlost', (event) => {
      event.preventDefault();
      this.lost = true;
      ports.trouble('lost');
    });
    canvas.addEventListener('webglcontextrestored', () => {
      this.lost = false;
      ports.trouble(null);
      this.wake();
    });
  }

  /** Begins to draw. */
  open() {
    try {
      this.view = new View(this.canvas);
    } catch (error) {
      console.warn('talking-head:', error.message);
      this.ports.trouble('noWebgl');
      return;
    }
    this.governor = new Governor(this.wish, this.view.software);
    this.view.setLevel(this.governor.level);
    this.observer.observe(this.canvas);
    this.#resize();
  }

  close() {
    cancelAnimationFrame(this.request);
    this.request = 0;
    this.observer.disconnect();
    this.view?.dispose();
    this.view = null;
  }

  /** @param {object} json the head model @returns {Promise<object>} the model as read */
  async show(json) {
    const model = readModel(json);
    if (!this.view) return model;
    const head = await Head.create(model);
    this.view?.show(head);
    this.wake();
    return model;
  }

  /** @param {'auto'|'high'|'low'} wish */
  set quality(wish) {
    this.wish = wish;
    this.governor.wish(wish);
    this.view?.setLevel(this.governor.level);
    this.wake();
  }

  /** Something has changed. */
  wake() {
    if (!this.request && this.view) this.request = requestAnimationFrame((now) => this.#draw(now));
  }

  #resize() {
    const { clientWidth, clientHeight } = this.canvas;
    this.view?.resize(clientWidth, clientHeight);
    this.#paint();
  }

  #draw(now) {
    this.request = 0;
    const interval = now - this.last;
    this.pace.tick(now);
    if (this.pace.busy || (this.calm && interval < CALM_MS)) {
      this.wake();
      return;
    }
    this.last = now;
    if (!this.following || interval > PAUSE_MS) this.governor.pause();
    else {
      const taken = this.calm ? interval - CALM_MS / 2 : interval;
      this.interval = this.interval ? this.interval + 0.1 * (taken - this.interval) : taken;
      if (this.governor.frame(taken)) this.view.setLevel(this.governor.level);
    }
    const begun = performance.now();
    const { values, more, calm } = this.ports.frame(begun, Math.min(AHEAD_MOST_MS, this.pace.ahead(begun)));
    this.view.head?.setFaps(values);
    this.#paint();
    this.pace.drawn(begun);
    this.following = more;
    this.calm = Boolean(calm);
    if (more) this.wake();
  }

  #paint() {
    if (this.lost || !this.view?.head) return;
    this.view.draw();
    this.frames++;
  }

  get debug() {
    return {
      fps: this.interval ? 1000 / this.interval : 0,
      frames: this.frames,
      level: this.governor.level.name,
      triangles: this.view?.head?.triangles ?? 0,
      drawCalls: this.view?.renderer.info.render.calls ?? 0,
    };
  }
}
