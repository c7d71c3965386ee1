// SPDX-License-Identifier: MIT

const MOST = { yaw: 25, pitch: 10 }; // degrees to either side
const ACROSS = 90; // degrees for a drag across the whole picture
const DRAG_PX = 4; // less is a tap
const STEP = 5; // degrees for an arrow key
const FOLLOW_S = 0.05; // time constants: behind the pointer and the keys
const BACK_S = 0.3; // of the way back
const THERE = 0.05; // degrees
const LAPSE_S = 0.1; // at most, between pictures

const limit = (value, most) => Math.min(most, Math.max(-most, value));

/**
 * Turns the view of the head: by dragging, or with the arrow keys on a slider that is visible while it has the focus. The head
 * turns back when it is released. Vertical swipes scroll the page.
 */
export class Orbit {
  #goal = { yaw: 0, pitch: 0 }; // degrees; yaw: the face to the right of the picture, pitch: down
  #now = { yaw: 0, pitch: 0 };
  #at = 0;
  #held = null; // the pointer
  #on = false;
  #drawn = false;

  /**
   * @param {HTMLElement} stage @param {HTMLInputElement} slider
   * @param {{moved: () => void}} ports the view is to be drawn anew
   */
  constructor(stage, slider, ports) {
    this.stage = stage;
    this.slider = slider;
    this.ports = ports;
    this.soft = true; // false: back at once, for those who want no motion
    Object.assign(slider, { min: -MOST.yaw, max: MOST.yaw, step: STEP, value: 0 });
    stage.addEventListener('pointerdown', (event) => this.#take(event));
    stage.addEventListener('pointermove', (event) => this.#drag(event));
    for (const type of ['pointerup', 'pointercancel', 'lostpointercapture'])
      stage.addEventListener(type, (event) => this.#drop(event));
    slider.addEventListener('input', () => this.#go(Number(slider.value), this.#goal.pitch));
    slider.addEventListener('keydown', (event) => this.#key(event));
    slider.addEventListener('blur', () => this.#back());
    this.#allow();
  }

  /** Whether the user may turn it. */
  set on(on) {
    this.#on = on;
    this.#allow();
  }

  /** Whether there is a head to be turned. */
  set drawn(drawn) {
    this.#drawn = drawn;
    this.#allow();
  }

  #allow() {
    const allowed = this.#on && this.#drawn;
    this.slider.disabled = !allowed;
    this.stage.classList.toggle('turnable', allowed);
    if (!allowed) this.#back();
  }

  #take({ target, pointerId, button, clientX, clientY }) {
    if (this.slider.disabled || button !== 0 || this.#held || target.closest('button, input')) return;
    this.#held = { id: pointerId, x: clientX, y: clientY, drags: false, from: { ...this.#goal } };
  }

  #drag({ pointerId, pointerType, clientX, clientY }) {
    const held = this.#held;
    if (pointerId !== held?.id) return;
    const [x, y] = [clientX - held.x, clientY - held.y];
    if (!held.drags && Math.hypot(x, y) < DRAG_PX) return;
    if (!held.drags) this.stage.setPointerCapture(pointerId);
    held.drags = true;
    const { clientWidth, clientHeight } = this.stage;
    const up = pointerType === 'mouse' ? (y / clientHeight) * ACROSS : 0;
    this.#go(held.from.yaw + (x / clientWidth) * ACROSS, held.from.pitch + up);
  }

  /** A finger is the canvas's first: what that loses, the stage gets. */
  #drop({ type, target, pointerId }) {
    if (pointerId !== this.#held?.id || (type === 'lostpointercapture' && target !== this.stage)) return;
    this.#back();
  }

  #key(event) {
    const pitch = { ArrowUp: -STEP, ArrowDown: STEP }[event.key];
    if (pitch) this.#go(this.#goal.yaw, this.#goal.pitch + pitch);
    else if (event.key === 'Escape') this.#back();
    else return;
    event.preventDefault();
  }

  #go(yaw, pitch) {
    this.#goal = { yaw: limit(yaw, MOST.yaw), pitch: limit(pitch, MOST.pitch) };
    this.slider.value = this.#goal.yaw;
    this.slider.setAttribute('aria-valuetext', `${Math.round(this.#goal.yaw)}°, ${Math.round(this.#goal.pitch)}°`);
    this.ports.moved();
  }

  #back() {
    this.#held = null;
    this.#go(0, 0);
  }

  /**
   * Goes on.
   * @param {number} seconds of the page's clock @returns {boolean} whether it is on its way
   */
  update(seconds) {
    const passed = Math.min(LAPSE_S, seconds - this.#at);
    this.#at = seconds;
    const resting = !this.#goal.yaw && !this.#goal.pitch;
    const share = this.soft ? 1 - Math.exp(-passed / (resting ? BACK_S : FOLLOW_S)) : 1;
    let moves = false;
    for (const axis of ['yaw', 'pitch']) {
      const left = this.#goal[axis] - this.#now[axis];
      const there = Math.abs(left) < THERE;
      this.#now[axis] = there ? this.#goal[axis] : this.#now[axis] + left * share;
      moves ||= !there;
    }
    return moves;
  }

  /** Degrees that the face is turned to the right of the picture, and down. */
  get turned() {
    return { ...this.#now };
  }
}
