// SPDX-License-Identifier: MIT
// The disc of emotions: where each lies, what a point means as a mixture, and the control that is dragged or moved by keys.

/** @typedef {{name: string, activation: number, evaluation: number, basic: boolean}} Affect */
/** @typedef {{name: string, intensity: number}[]} Mix */

const TURN = 2 * Math.PI;
const turn = (angle) => ((angle % TURN) + TURN) % TURN;
const LEAST = 0.005; // smallest intensity that counts

/**
 * Lays the affects out. Their true angle is that of (evaluation, activation), but some basic emotions nearly share it:
 * so the basic ones are put at equal distances in the order of their angles, and what lies between two of them stays
 * between them. The others lie inside, in the order of how far they are from neutral.
 * @param {Affect[]} affects
 * @returns {(Affect & {angle: number, radius: number})[]} angle: radians, counterclockwise from the right; radius 0..1
 */
export function layOut(affects) {
  const angle = (a) => turn(Math.atan2(a.activation, a.evaluation));
  const basics = affects.filter((a) => a.basic).sort((a, b) => angle(a) - angle(b) || a.name.localeCompare(b.name));
  if (!basics.length) return [];
  const first = angle(basics[0]);
  const step = TURN / basics.length;
  const size = (a) => Math.hypot(a.activation, a.evaluation);
  const others = affects.filter((a) => !a.basic).sort((a, b) => size(a) - size(b));
  return affects.map((affect) => {
    const own = basics.indexOf(affect);
    if (own >= 0) return { ...affect, angle: turn(first + own * step), radius: 1 };
    const from = turn(angle(affect) - first); // after the first basic one
    const starts = basics.map((b) => turn(angle(b) - first));
    let i = basics.length - 1;
    while (i > 0 && starts[i] > from) i--;
    const length = (starts[i + 1] ?? TURN) - starts[i];
    const share = length ? (from - starts[i]) / length : 0;
    const radius = 0.35 + 0.48 * (others.indexOf(affect) / Math.max(1, others.length - 1));
    return { ...affect, angle: turn(first + (i + share) * step), radius };
  });
}

/** Moves dots that lie on each other apart, along their circle. */
export function spread(placed, distance) {
  const done = [];
  for (const dot of placed) {
    const at = (angle) => ({ x: dot.radius * Math.cos(angle), y: dot.radius * Math.sin(angle) });
    const free = (p) => done.every((other) => Math.hypot(p.x - other.x, p.y - other.y) >= distance);
    let angle = dot.angle;
    for (let i = 1; i < 40 && !free(at(angle)); i++) angle = dot.angle + ((i % 2 ? 1 : -1) * Math.ceil(i / 2) * distance) / 3;
    done.push({ ...dot, ...at(angle) });
  }
  return done;
}

/**
 * Converts a point to a mixture: its direction gives the two basic emotions beside it, its distance from the middle how strong
 * they are.
 * @param {{x: number, y: number}} point in the circle of radius 1
 * @param {ReturnType<typeof layOut>} placed
 * @returns {Mix} the stronger one first; empty = neutral
 */
export function mixAt({ x, y }, placed) {
  const basics = placed.filter((a) => a.basic).sort((a, b) => a.angle - b.angle);
  const strength = Math.min(1, Math.hypot(x, y));
  if (!basics.length || strength < LEAST) return [];
  const angle = turn(Math.atan2(y, x));
  let i = basics.length - 1;
  while (i > 0 && basics[i].angle > angle) i--;
  if (basics[0].angle > angle) i = basics.length - 1;
  const [a, b] = [basics[i], basics[(i + 1) % basics.length]];
  const share = turn(angle - a.angle) / (turn(b.angle - a.angle) || TURN);
  return [
    { name: a.name, intensity: strength * (1 - share) },
    { name: b.name, intensity: strength * share },
  ]
    .map(({ name, intensity }) => ({ name, intensity: Math.round(intensity * 100) / 100 }))
    .filter(({ intensity }) => intensity >= LEAST)
    .sort((p, q) => q.intensity - p.intensity);
}

/**
 * Converts a mixture to a point, as the inverse of mixAt; its distance is the sum of the strengths. An emotion that is not
 * basic lies in its own direction.
 * @param {Mix} mix @param {ReturnType<typeof layOut>} placed
 * @returns {{x: number, y: number, affect: string|null}}
 */
export function pointOf(mix, placed) {
  const known = mix.map(({ name, intensity }) => ({ intensity, ...placed.find((a) => a.name === name) }));
  const parts = known.filter(({ angle }) => angle !== undefined);
  const strength = Math.min(1, parts.reduce((sum, { intensity }) => sum + intensity, 0));
  const [first, second] = parts;
  if (!strength) return { x: 0, y: 0, affect: null };
  const way = second ? turn(second.angle - first.angle + Math.PI) - Math.PI : 0; // the shorter one
  const angle = first.angle + (second ? (way * second.intensity) / (first.intensity + second.intensity) : 0);
  return { x: strength * Math.cos(angle), y: strength * Math.sin(angle), affect: second || first.basic ? null : first.name };
}

const ESCAPES = { '&': '&amp;', '<': '&lt;', '>': '&gt;', '"': '&quot;' };
const escape = (text) => text.replace(/[&<>"]/g, (c) => ESCAPES[c]);
const JSML = { joy: 'HAPPY', anger: 'ANGRY', sadness: 'SAD', fear: 'AFRAID', disgust: 'DISGUSTED', surprise: 'SURPRISED' };

/**
 * The mixture as markup round a text. APML knows one affect at a time: the strongest. JSML knows the basic ones.
 * @param {'apml'|'jsml'|'ssml'} kind @param {Mix} mix @param {string} text @param {string} lang
 * @returns {string}
 */
export function markupOf(kind, mix, text, lang) {
  const said = escape(text.trim());
  if (kind === 'apml') {
    const [strongest] = mix;
    const affect = strongest ? ` affect="${strongest.name}" intensity="${strongest.intensity}"` : '';
    return `<apml xml:lang="${lang}">\n  <performative type="inform">\n    <rheme${affect}>${said}</rheme>\n  </performative>\n</apml>`;
  }
  if (kind === 'jsml') {
    const known = mix.filter(({ name }) => JSML[name]);
    const open = known.map(({ name, intensity }) => `<${JSML[name]} WEIGHT="${intensity}">`).join('');
    const close = known.map(({ name }) => `</${JSML[name]}>`).reverse().join('');
    return `<jsml xml:lang="${lang}">\n  <div type="sentence">${open}${said}${close}</div>\n</jsml>`;
  }
  const categories = mix.map(({ name, intensity }) => `<emo:category name="${name}" value="${intensity}"/>`).join('');
  const inner = mix.length ? `<emo:emotion>${categories}${said}</emo:emotion>` : said;
  const spaces = 'xmlns="http://www.w3.org/2001/10/synthesis" xmlns:emo="http://www.w3.org/2009/10/emotionml"';
  return `<speak version="1.1" ${spaces} xml:lang="${lang}">\n  <s>${inner}</s>\n</speak>`;
}

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
  #now = { x: 0, y: 0, affect: null }; // the point; affect: chosen alone, independent of the direction

  /**
   * @param {SVGElement} disc with groups #spokes and #affects, and the point, #thumb
   * @param {object} ports called(name): an affect in the user's language; described(mix): a mixture; moved(): the user
   *   moved the point
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

  /** The affect that is chosen alone, or null. */
  get affect() {
    return this.#now.affect;
  }

  get strength() {
    return Math.min(1, Math.hypot(this.#now.x, this.#now.y));
  }

  /** @returns {Mix} */
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
      const aside = Math.abs(Math.cos(angle)) > 0.35; // begins beside its point; else is centred above or below it
      const label = svg('text', { ...at(aside ? 1.1 : 1.2), 'text-anchor': aside ? (Math.cos(angle) > 0 ? 'start' : 'end') : 'middle' });
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
