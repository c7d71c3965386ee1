// SPDX-License-Identifier: MIT
// The disc of emotions in a page: drawn, dragged, moved by keys. What its points mean is in emotion-disc.js.
import { layOut, mixAt, pointOf, spread } from './emotion-disc.js';

const R = 100; // of the disc, in units of the picture
const DOTS_APART = 0.13;
const STEP = 0.1;
const SMALL_STEP = 0.02;
const FIRST_STRENGTH = 0.7; // of an affect that is pointed at while the point is in the middle

const svg = (name, attributes = {}) => {
  const element = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  return element;
};

export class MoodDisc {
  #placed = []; // the affects on the disc
  #now = { x: 0, y: 0, affect: null }; // the point; affect: that one alone, not what the direction says

  /**
   * @param {SVGElement} disc with groups #spokes and #affects, and the point, #thumb
   * @param {object} ports called(name): an affect in the reader's language; described(mix): a mixture; moved(): by whoever
   *   reads the page
   */
  constructor(disc, ports) {
    Object.assign(this, { disc, ports });
    this.parts = Object.fromEntries(['spokes', 'affects', 'thumb'].map((id) => [id, disc.querySelector(`#${id}`)]));
    disc.addEventListener('pointerdown', (event) => this.#down(event));
    disc.addEventListener('pointermove', (event) => disc.hasPointerCapture(event.pointerId) && this.#pointAt(event));
    this.parts.thumb.addEventListener('keydown', (event) => this.#key(event));
  }

  /** Those of /v1/expressions. */
  set affects(affects) {
    this.#placed = spread(layOut(affects), DOTS_APART);
    this.draw();
  }

  get names() {
    return this.#placed.map(({ name }) => name);
  }

  /** The one that is chosen alone, or null. */
  get affect() {
    return this.#now.affect;
  }

  get strength() {
    return Math.min(1, Math.hypot(this.#now.x, this.#now.y));
  }

  /** @returns {import('./emotion-disc.js').Mix} */
  get mix() {
    if (!this.#now.affect) return mixAt(this.#now, this.#placed);
    const intensity = Math.round(100 * this.strength) / 100;
    return intensity ? [{ name: this.#now.affect, intensity }] : [];
  }

  /** Shows a mixture that came from elsewhere. */
  show(mix) {
    this.#now = pointOf(mix, this.#placed);
    this.update();
  }

  /** In the reader's language. */
  draw() {
    const basics = this.#placed.filter((a) => a.basic);
    this.parts.spokes.replaceChildren(...basics.flatMap(({ name, angle }) => {
      const at = (radius) => ({ x: radius * R * Math.cos(angle), y: -radius * R * Math.sin(angle) });
      const label = svg('text', at(1.24));
      label.textContent = this.ports.called(name);
      const { x, y } = at(1);
      return [svg('line', { class: 'spoke', x2: x, y2: y }), label];
    }));
    this.parts.affects.replaceChildren(...this.#placed.map((affect) => this.#dot(affect)));
  }

  /** Shows where the point is and what that means. */
  update() {
    const { mix } = this, { thumb, affects } = this.parts;
    thumb.setAttribute('transform', `translate(${this.#now.x * R} ${-this.#now.y * R})`);
    thumb.setAttribute('aria-valuenow', Math.round(100 * this.strength));
    thumb.setAttribute('aria-valuetext', this.ports.described(mix));
    for (const { classList, dataset } of affects.children) classList.toggle('chosen', mix.some((p) => p.name === dataset.name));
  }

  move(x, y, affect = null) {
    const far = Math.max(1, Math.hypot(x, y));
    this.#now = { x: x / far, y: y / far, affect };
    this.update();
    this.ports.moved();
  }

  /** Moves the point along its direction, or that of the affect. */
  strengthen(intensity, affect = this.#now.affect) {
    const own = this.#placed.find(({ name }) => name === affect);
    const angle = own ? own.angle : this.strength ? Math.atan2(this.#now.y, this.#now.x) : Math.PI / 2;
    const radius = Math.min(1, Math.max(0, intensity));
    this.move(radius * Math.cos(angle), radius * Math.sin(angle), affect);
  }

  /** One alone, as strong as the mixture was; null: as the direction says. */
  choose(affect) {
    if (affect) this.strengthen(this.strength || FIRST_STRENGTH, affect);
    else this.move(this.#now.x, this.#now.y);
  }

  #dot({ name, basic, x, y }) {
    const group = svg('g', { class: basic ? 'basic' : '', 'data-name': name });
    const title = svg('title');
    title.textContent = this.ports.called(name);
    group.append(svg('circle', { cx: x * R, cy: -y * R, r: basic ? 5 : 3.5 }), title);
    if (!basic) {
      const label = svg('text', { x: x * R, y: -y * R - 5 });
      label.textContent = this.ports.called(name);
      group.append(label);
    }
    return group;
  }

  #pointAt(event) {
    const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(this.disc.getScreenCTM().inverse());
    this.move(at.x / R, -at.y / R);
  }

  #down(event) {
    const dot = event.target.closest('[data-name]');
    event.preventDefault();
    this.parts.thumb.focus({ preventScroll: true });
    if (dot) {
      this.choose(dot.dataset.name);
      return;
    }
    this.disc.setPointerCapture(event.pointerId);
    this.#pointAt(event);
  }

  #key(event) {
    const step = event.shiftKey ? SMALL_STEP : STEP, { x, y } = this.#now;
    const way = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, step], ArrowDown: [0, -step] }[event.key];
    if (way) this.move(x + way[0], y + way[1]);
    else if (event.key === 'Home') this.move(0, 0);
    else if (event.key === 'End') this.strengthen(1);
    else if (event.key === 'PageUp') this.strengthen(this.strength + STEP);
    else if (event.key === 'PageDown') this.strengthen(this.strength - STEP);
    else return;
    event.preventDefault();
  }
}
