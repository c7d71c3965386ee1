// SPDX-License-Identifier: MIT
// A picture with the points of the face, which can be moved by pointer, buttons or keys.

const WIDE = 480; // size in pixels of the displayed area
const AROUND = 0.35; // of the face's height, on each side
const STEP = 2; // pixels of it
const ARROWS = [['leftward', '←', [-1, 0], 'ArrowLeft'], ['up', '↑', [0, -1], 'ArrowUp'], ['down', '↓', [0, 1], 'ArrowDown'], ['rightward', '→', [1, 0], 'ArrowRight']];

export class PictureBox {
  #moved = new Map(); // landmark -> its new position

  /**
   * @param {{picture: ImageData, landmarks: number[][]}} view @param {{HANDLES: object[], withMoved: Function}} tools of
   *   portrait.js
   * @param {{say: (name: string, values?: object) => string, remove: () => void}} page
   */
  constructor({ picture, landmarks }, { HANDLES, withMoved }, { say, remove }) {
    Object.assign(this, { picture, found: landmarks, withMoved, say });
    this.item = document.createElement('li');
    this.title = document.createElement('h3');
    this.stage = document.createElement('div');
    this.stage.className = 'points';
    this.canvas = document.createElement('canvas');
    this.canvas.setAttribute('role', 'img');
    this.stage.append(this.canvas);
    this.#draw();
    this.points = HANDLES.map((handle) => this.#mark(handle));
    this.stage.append(...this.points.map(({ mark }) => mark));
    this.gone = Object.assign(document.createElement('button'), { type: 'button' });
    this.gone.addEventListener('click', remove);
    this.item.append(this.title, this.stage, this.#arrows());
    this.#place();
  }

  /** @returns {{picture: ImageData, landmarks: number[][]}} with the user's corrections */
  get view() {
    return { picture: this.picture, landmarks: this.withMoved(this.found, this.#moved) };
  }

  translate(number) {
    const { say } = this;
    this.title.textContent = say('picture', { number });
    this.canvas.ariaLabel = `${say('points')}, ${say('picture', { number })}`;
    this.gone.textContent = say('remove');
    this.gone.ariaLabel = `${say('remove')}: ${say('picture', { number })}`;
    this.field.firstChild.textContent = say('point');
    this.steps.forEach((button) => (button.ariaLabel = say(button.dataset.step)));
    for (const option of this.select.options) {
      const [, base, side] = /^(.*?)(Left|Right)?$/.exec(option.value);
      option.textContent = side ? say(side.toLowerCase(), { point: say(base) }) : say(base);
    }
  }

  /** The area with the face; positions are in its pixels from here on. */
  #draw() {
    const xs = this.found.map(([x]) => x);
    const ys = this.found.map(([, y]) => y);
    const [left, right, top, bottom] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    const side = (bottom - top) * (1 + 2 * AROUND);
    this.corner = [(left + right - side) / 2, (top + bottom - side) / 2];
    this.scale = WIDE / side;
    Object.assign(this.canvas, { width: WIDE, height: WIDE });
    const whole = Object.assign(document.createElement('canvas'), { width: this.picture.width, height: this.picture.height });
    whole.getContext('2d').putImageData(this.picture, 0, 0);
    this.canvas.getContext('2d').drawImage(whole, ...this.corner, side, side, 0, 0, WIDE, WIDE);
  }

  /** Adds the visible dot of a point, which can be dragged. */
  #mark(handle) {
    const mark = Object.assign(document.createElement('span'), { className: 'point', ariaHidden: 'true' });
    mark.dataset.point = handle.name;
    mark.addEventListener('pointerdown', (event) => {
      mark.setPointerCapture(event.pointerId);
      this.select.value = handle.name;
      this.#place();
    });
    mark.addEventListener('pointermove', (event) => {
      if (!mark.hasPointerCapture(event.pointerId)) return;
      const box = this.canvas.getBoundingClientRect();
      const [x, y] = [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height].map((t) =>
        Math.min(1, Math.max(0, t)));
      this.#put(handle, [this.corner[0] + (x * WIDE) / this.scale, this.corner[1] + (y * WIDE) / this.scale]);
    });
    return { ...handle, mark };
  }

  /** The same without a pointer: select a point, and move it by buttons or, on these, by the arrow keys. */
  #arrows() {
    this.select = document.createElement('select');
    this.select.append(...this.points.map(({ name }) => Object.assign(document.createElement('option'), { value: name })));
    this.select.addEventListener('change', () => this.#place());
    this.field = Object.assign(document.createElement('label'), { className: 'field' });
    this.field.append(document.createElement('span'), this.select);
    const move = ([dx, dy], far) => {
      const handle = this.points.find(({ name }) => name === this.select.value);
      const [x, y] = this.view.landmarks[handle.at];
      this.#put(handle, [x + (dx * far) / this.scale, y + (dy * far) / this.scale]);
    };
    this.steps = ARROWS.map(([word, sign, step]) => {
      const button = Object.assign(document.createElement('button'), { type: 'button', textContent: sign });
      button.dataset.step = word;
      button.addEventListener('click', () => move(step, STEP));
      return button;
    });
    const row = Object.assign(document.createElement('div'), { className: 'row' });
    row.append(this.field, ...this.steps, this.gone);
    row.addEventListener('keydown', (event) => {
      const arrow = ARROWS.find(([, , , key]) => key === event.key);
      if (!arrow || event.target === this.select) return;
      event.preventDefault();
      move(arrow[2], event.shiftKey ? 4 * STEP : STEP / 2);
    });
    return row;
  }

  #put({ at }, place) {
    this.#moved.set(at, place);
    this.#place();
  }

  #place() {
    const { landmarks } = this.view;
    for (const { mark, name, at } of this.points) {
      const [x, y] = [0, 1].map((k) => (100 * (landmarks[at][k] - this.corner[k]) * this.scale) / WIDE);
      mark.style.left = `${x}%`;
      mark.style.top = `${y}%`;
      mark.classList.toggle('chosen', name === this.select.value);
    }
  }
}
