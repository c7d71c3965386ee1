// SPDX-License-Identifier: MIT
import { contexts } from './contexts.mjs';
import { engineOf } from './engines.mjs';
import { calibrate } from '../head/model/calibrate.mjs';
import { checkCalibration } from '../head/model/check.mjs';
import { readModel } from '../head/model/model.mjs';
import { Governor } from '../head/quality.mjs';
import { FramePacer } from './frame-pacer.mjs';
import { isPictures, readPictures } from '../pictures/set.mjs';
import { VisibleChange } from './visible-change.mjs';

const PAUSE_MS = 3000; // longest gap between frames that counts as slow drawing: beyond it the page was hidden
const AHEAD_MOST_MS = 300; // for longer nothing is foreseen
const LAPSE_MS = 250; // from a picture to the next: beyond, they do not follow each other
const CALM_MS = 30; // between pictures of a face that only idles: saves the battery;
const REST_MS = 100; // as long as nothing moves by as much as this share of a point of the picture
const SEEN = 0.35;
const RESTORE_MS = 3000; // that a browser has to give a lost context back; then the face takes another, each time later
const RESTORE_MOST_MS = 60000;
const DISSOLVE_MS = 240; // from one quality to the next

/**
 * The canvas: draws the head after a change, at the display's rate while something moves, and finds the quality that the
 * machine can afford. Without WebGL it draws pictures; without pictures it shows a message.
 */
export class Stage {
  /**
   * @param {HTMLCanvasElement} canvas
   * @param {object} ports hear(now) -> whether the page beside the canvas changes with the picture that follows;
   *   frame(now, ahead) -> {values, turned, more, calm, still}: what to show, from where, `ahead` milliseconds later, when the
   *   picture is on the display, whether it goes on moving, whether slowly, and whether nothing but the lips may move;
   *   trouble('noWebgl' | 'lost' | 'tooMany' | null);
   *   drawn(on, turns): whether there is a face on the canvas, and whether it can be seen from the side;
   *   unfit(error): the server's calibration does not fit the head, and is passed over
   */
  constructor(canvas, ports) {
    this.canvas = canvas;
    this.ports = ports;
    this.wish = 'auto';
    this.governor = new Governor();
    this.request = 0;
    this.last = -Infinity;
    this.calm = false;
    this.rested = false; // beats of the display have passed in which nothing visible moved
    this.change = null; // of the head since it was drawn; null: not known
    this.following = false; // whether the next frame is to come right after the last one
    this.frames = 0;
    this.interval = 0; // of the frames that follow each other, smoothed
    this.view = null;
    this.framed = null;
    this.fades = true;
    this.read = null; // the model as it came
    this.model = null; // drawn, after calibration
    this.calibrations = { server: null, page: null };
    this.opened = false;
    this.visible = false;
    this.used = false; // the canvas has had a context, and cannot have another
    this.pacer = new FramePacer(() => this.view.mark());
    this.lost = false;
    this.restoring = 0; // timer
    this.patience = RESTORE_MS;
    this.observer = new ResizeObserver(() => this.#resize());
  }

  /** Begins to draw, as soon as it can have a context. */
  open() {
    this.opened = true;
    contexts.ask(this);
  }

  close() {
    this.opened = false;
    this.model = this.read = null;
    this.leave();
    contexts.leave(this);
  }

  /** Whether it is visible. */
  set seen(on) {
    this.visible = on;
    if (this.opened) contexts.ask(this);
  }

  /** It may have a context of the graphics processor: see Contexts. */
  enter() {
    if (this.used) this.#replaceCanvas();
    this.used = true;
    try {
      this.view = this.#engine.view(this.canvas);
    } catch (error) {
      console.warn('talking-head:', error.message);
      this.ports.trouble('noWebgl');
      return;
    }
    this.lost = false;
    this.ports.trouble(null);
    this.#heed(this.canvas);
    this.governor = new Governor(this.wish, this.view.software);
    this.view.setLevel(this.governor.level);
    this.view.fading = this.fades;
    this.view.framing = this.framed;
    this.observer.observe(this.canvas);
    this.#resize();
    if (this.model) this.#build().catch((error) => console.error('talking-head:', error));
  }

  /** Gives its context back. */
  leave() {
    clearTimeout(this.restoring);
    cancelAnimationFrame(this.request);
    this.request = 0;
    this.observer.disconnect();
    const { view } = this;
    this.view = null; // first: the callback may request another frame
    if (view?.head) this.ports.drawn?.(false);
    view?.dispose();
  }

  /** Called when no context is free. */
  refuse() {
    this.ports.trouble('tooMany');
  }

  /** @param {object} json the head model, a set of pictures, or an avatar @returns {Promise<object>} the model as read */
  async show(json) {
    const before = this.#engine;
    this.read = json.engine ? json : isPictures(json) ? readPictures(json) : readModel(json);
    const wrong = this.#fit();
    if (wrong?.by === 'server') {
      this.calibrations.server = null;
      this.ports.unfit?.(wrong.error);
    }
    const { model } = this;
    if (this.view && before !== this.#engine) {
      this.leave(); // a canvas draws the one or the other
      this.enter();
    } else if (this.view) await this.#build();
    if (wrong && wrong.by !== 'server') throw wrong.error;
    return model;
  }

  /**
   * Fits the head to feature points: protocol/head-model.md.
   * @param {object|null} calibration of this head and later ones; null: none
   * @param {'page'|'server'} [by] source: the page's overrides the server's
   * @throws {import('../head/model/check.mjs').ModelError} with the invalid field; nothing changes then
   */
  async calibrate(calibration, by = 'page') {
    if (calibration) checkCalibration(calibration);
    const before = this.calibrations[by];
    this.calibrations[by] = calibration;
    const wrong = this.read && this.#fit();
    if (wrong) {
      this.calibrations[by] = before;
      this.#fit();
      throw wrong.error;
    }
    if (this.view && this.read) await this.#build();
  }

  /** Applies the calibrations to the loaded model. @returns {{by: string, error: Error}|null} the first that does not fit */
  #fit() {
    const { read } = this;
    this.model = read;
    if (read.engine || isPictures(read)) return null;
    let wrong = null;
    for (const [by, calibration] of Object.entries({ file: read.calibration, ...this.calibrations }))
      try {
        if (calibration) this.model = calibrate(this.model, calibration, by === 'file' ? 'calibration.' : '');
      } catch (error) {
        wrong ??= { by, error };
      }
    return wrong;
  }

  /** The engine for the loaded model, or for the one that is wanted. */
  get #engine() {
    return engineOf(this.model, this.wish);
  }

  async #build() {
    const { model, view } = this;
    const engine = this.#engine;
    const head = await engine.head(model, { software: view.software });
    if (this.view !== view || this.model !== model) {
      head.dispose(); // replaced or no longer wanted
      return;
    }
    view.show(head);
    this.change = head.model?.fapu ? new VisibleChange(head.model.fapu) : null;
    this.ports.drawn?.(true, engine.turns);
    this.wake();
    if (view.software) await head.slim();
  }

  #replaceCanvas() {
    const fresh = this.canvas.cloneNode();
    this.canvas.replaceWith(fresh);
    this.canvas = fresh;
  }

  /** The browser may take the context away, and give it back. */
  #heed(canvas) {
    const now = () => canvas === this.canvas && this.view;
    canvas.addEventListener('webglcontextlost', (event) => {
      if (!now()) return;
      event.preventDefault();
      this.lost = true;
      this.ports.trouble('lost');
      clearTimeout(this.restoring);
      this.restoring = setTimeout(() => this.#anew(), this.patience);
    });
    canvas.addEventListener('webglcontextrestored', () => {
      if (!now()) return;
      clearTimeout(this.restoring);
      this.lost = false;
      this.ports.trouble(null);
      this.wake();
    });
  }

  /** The browser has not given the context back, as after the death of its graphics process: another canvas has another. */
  #anew() {
    if (!this.view || !this.lost) return;
    this.patience = Math.min(RESTORE_MOST_MS, 2 * this.patience);
    this.leave();
    this.enter();
    if (!this.view) this.restoring = setTimeout(() => !this.view && contexts.has(this) && this.enter(), this.patience);
  }

  /** @param {'auto'|'high'|'low'|'pictures'} wish */
  set quality(wish) {
    this.wish = wish;
    this.governor.wish(wish);
    this.#level();
    this.wake();
  }

  /** @param {string|null} name of a view: see View */
  set framing(name) {
    this.framed = name;
    if (this.view) this.view.framing = name;
    this.wake();
  }

  /** @param {boolean} fades whether shoulders vanish towards the lower border: before a backdrop they are cut by it */
  set fading(fades) {
    this.fades = fades;
    if (this.view) this.view.fading = fades;
    this.wake();
  }

  /** Something has changed. */
  wake() {
    if (!this.request && this.view) this.request = requestAnimationFrame((now) => this.#draw(now));
  }

  /** Whether pictures follow each other. */
  get drawing() {
    return this.following && performance.now() - this.last < LAPSE_MS;
  }

  #resize() {
    const { clientWidth, clientHeight } = this.canvas;
    this.view?.resize(clientWidth, clientHeight);
    this.#paint();
  }

  #draw(now) {
    this.request = 0;
    const interval = now - this.last;
    this.pacer.tick(now);
    if (this.pacer.busy || (this.calm && interval < CALM_MS)) {
      this.wake();
      return;
    }
    const begun = performance.now();
    const beside = this.ports.hear(begun);
    const ahead = Math.min(AHEAD_MOST_MS, this.pacer.ahead(begun, beside));
    const { values, turned, more, calm, still } = this.ports.frame(begun, ahead);
    if (calm && this.calm && more && interval < REST_MS && !this.#moved(values, interval)) {
      this.rested = true;
      this.wake();
      return;
    }
    this.last = now;
    if (!this.following || interval > PAUSE_MS) this.governor.pause();
    else {
      const taken = this.rested ? this.pacer.usual : this.calm ? interval - CALM_MS / 2 : interval;
      this.interval = this.interval ? this.interval + 0.1 * (taken - this.interval) : taken;
      if (this.governor.frame(taken)) this.#level();
    }
    this.rested = false;
    this.view.head?.setFaps(values, still ? null : begun / 1000);
    this.change?.drawn(values);
    this.view.turned = turned;
    this.#paint();
    this.pacer.drawn(begun, beside);
    this.following = more || Boolean(this.view.head?.sways);
    this.calm = Boolean(calm);
    if (this.following) this.wake();
  }

  /** Whether it can be seen that the face has moved since it was drawn. */
  #moved(values, interval) {
    const { head, point } = this.view;
    if (!this.change || !point) return true;
    return Math.max(this.change.since(values), ((head.swing ?? 0) * interval) / 1000) > SEEN * point;
  }

  /** Goes over to the quality that is chosen: the picture as it was lies on top, and fades. */
  #level() {
    const { view, canvas } = this;
    const { level } = this.governor;
    if (!view || view.level === level) return;
    if (view.head && !this.lost && canvas.isConnected && canvas.width && canvas.height) {
      const veil = document.createElement('canvas');
      Object.assign(veil, { width: canvas.width, height: canvas.height, ariaHidden: 'true' });
      view.draw(); // it is kept until this task ends
      veil.getContext('2d').drawImage(canvas, 0, 0);
      canvas.after(veil);
      const gone = () => veil.remove();
      veil.animate([{ opacity: 1 }, { opacity: 0 }], { duration: DISSOLVE_MS, easing: 'ease-in-out' }).finished.then(gone, gone);
    }
    view.setLevel(level);
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
      level: this.view?.name ?? this.governor.level.name,
      triangles: this.view?.head?.triangles ?? 0,
      drawCalls: this.view?.renderer?.info.render.calls ?? 0,
    };
  }
}
