// SPDX-License-Identifier: MIT
// A picture of a face from the side, with its detected outline.

const HIGH = 480; // pixels of what is shown
const DOT = 3;

export class ProfileBox {
  /**
   * @param {{picture: ImageData, outlines: object, points: number[][]}} view of portrait.js @param {object} tools not needed
   * @param {{say: (name: string, values?: object) => string, remove: () => void}} page
   */
  constructor(view, tools, { say, remove }) {
    Object.assign(this, { view, say });
    this.item = document.createElement('li');
    this.title = document.createElement('h3');
    this.stage = document.createElement('div');
    this.stage.className = 'points';
    this.canvas = document.createElement('canvas');
    this.canvas.setAttribute('role', 'img');
    this.stage.append(this.canvas);
    this.gone = Object.assign(document.createElement('button'), { type: 'button' });
    this.gone.addEventListener('click', remove);
    const row = Object.assign(document.createElement('div'), { className: 'row' });
    row.append(this.gone);
    this.item.append(this.title, this.stage, row);
    this.#draw();
  }

  translate(number) {
    const { say } = this;
    this.title.textContent = say('picture', { number });
    this.canvas.ariaLabel = `${say('profileLine')}, ${say('picture', { number })}`;
    this.gone.textContent = say('remove');
    this.gone.ariaLabel = `${say('remove')}: ${say('picture', { number })}`;
  }

  #draw() {
    const { picture, points } = this.view;
    const scale = HIGH / picture.height;
    Object.assign(this.canvas, { width: Math.round(picture.width * scale), height: HIGH });
    const whole = Object.assign(document.createElement('canvas'), { width: picture.width, height: picture.height });
    whole.getContext('2d').putImageData(picture, 0, 0);
    const context = this.canvas.getContext('2d');
    context.drawImage(whole, 0, 0, this.canvas.width, HIGH);
    for (const [fill, size] of [['#000', DOT + 1], ['#ffd84d', DOT]]) {
      context.fillStyle = fill;
      for (const [x, y] of points) {
        context.beginPath();
        context.arc(x * scale, y * scale, size, 0, 2 * Math.PI);
        context.fill();
      }
    }
  }
}
