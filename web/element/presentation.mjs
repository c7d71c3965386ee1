// SPDX-License-Identifier: MIT
import { CaptionView } from './captions/view.mjs';
import { Attention } from './face/attention.mjs';
import { Breath } from './face/breath.mjs';
import { FaceMixer, faceValues } from './face/face-mixer.mjs';
import { FAP_VALUES } from './face/face-track.mjs';
import { BREATH } from './head/model/model.mjs';
import { IdleController } from './face/idle.mjs';
import { Orbit } from './orbit.mjs';
import { Seat } from './scene.mjs';
import { Stage } from './stage/stage.mjs';
import { Visibility } from './visibility.mjs';

const TICK_MS = 40; // words are heard also while nothing is drawn (a hidden page, no WebGL), or slowly

/** The visible side of a head: the face on its stage, speaking, idling or posed, and the captions. */
export class Presentation {
  #ticking = 0; // timer
  #drawn = { seconds: null, at: 0 };
  #mixer = new FaceMixer();
  #attention = new Attention();
  #breath = new Breath();
  #drawnValues = new Float32Array(FAP_VALUES); // the face and the breath
  #shown = this.#mixer.values; // drawn last
  #values = new Float32Array(FAP_VALUES); // drawn in company
  #accompanied = false; // whether company moves it
  #reducedMotion = matchMedia('(prefers-reduced-motion: reduce)');

  /**
   * @param {HTMLElement} element whose still, turn and life say how it moves
   * @param {ShadowRoot} root of the template
   * @param {object} parts controls, poster and speech of the element
   * @param {object} ports send(message) to the server; trouble(name), unfit(error): see Stage
   */
  constructor(element, root, { controls, poster, speech }, { send, trouble, unfit }) {
    this.element = element;
    this.speech = speech;
    this.seat = new Seat(element, speech, () => this.stage.wake());
    this.idle = new IdleController(send, () => this.idleChanged());
    this.visibility = new Visibility(root.querySelector('.layout'), () => this.#visibilityChanged());
    this.captions = new CaptionView(root.querySelector('.captions'));
    this.orbit = new Orbit(root.querySelector('.stage'), controls.turn, { moved: () => this.stage?.wake() });
    this.stage = new Stage(controls.canvas, {
      hear: (now) => this.#hear(now),
      frame: (now, ahead) => this.#frame(now, ahead),
      trouble,
      unfit,
      drawn: (on, turns) => {
        poster.drawn = on;
        controls.mouth.hidden = !on;
        this.orbit.drawn = on && turns;
      },
    });
  }

  open() {
    this.#reducedMotion.addEventListener('change', this.motionChanged);
    this.stage.open();
    this.motionChanged();
    this.visibility.open();
    this.captions.open();
    this.seat.open();
    this.#ticking = setInterval(() => this.#tick(performance.now()), TICK_MS);
  }

  close() {
    clearInterval(this.#ticking);
    this.seat.close();
    this.#reducedMotion.removeEventListener('change', this.motionChanged);
    this.visibility.close();
    this.captions.close();
    this.captions.clear();
    this.stage.close();
  }

  /** Media of the idle face. One that keeps still has no pictures running: it is drawn when its mood has changed. */
  idled(chunk) {
    this.idle.take(chunk, performance.now() / 1000);
    if (this.#mixer.still && !this.speech.busy) this.wake();
  }

  /** Something has changed. */
  wake() {
    this.stage.wake();
    this.seat.wakePartners();
  }

  /** Something has changed that a posed face does not show. */
  changed() {
    if (!this.#mixer.pose) this.wake();
  }

  /** Whether only the lips move; mood and affects are still shown. */
  get still() {
    return this.#mixer.still;
  }

  /** Applies changed wishes of the page or the user about motion. */
  motionChanged = () => {
    this.#mixer.still = this.element.still ?? this.#reducedMotion.matches;
    this.orbit.on = this.element.turn ?? !this.#mixer.still;
    this.orbit.soft = !this.#reducedMotion.matches;
    this.idleChanged();
    this.wake();
  };

  /** Requests idle movement while the face is visible; a still face gets its mood with it. */
  idleChanged() {
    const { still } = this.#mixer;
    const wanted = this.visibility.seen && (!still || this.idle.moody);
    // The first follower of a room decides how all idle: others may want motion.
    const life = still && !this.element.hasAttribute('room') ? 0 : this.element.life;
    this.idle.idle(wanted ? (life === null ? {} : { life }) : null);
    this.wake();
  }

  /** See TalkingHead. */
  pose(faps, ease) {
    this.#mixer.pose = faps && faceValues(faps);
    this.#mixer.ease = ease;
    this.wake();
  }

  /** Somebody speaks to her, or has ended: she looks at them. */
  attend(on) {
    this.#attention.on = on && !this.#mixer.still;
    this.wake();
  }

  /** The speaker pauses: she nods. */
  nod() {
    this.#attention.nod(performance.now());
    this.wake();
  }

  /** See TalkingHead. */
  express(mix, options) {
    this.idle.express(mix, options);
    this.wake();
  }

  /** The FAPs that are not 0, by number, as they were drawn last. */
  get faps() {
    return Object.fromEntries([...this.#shown.entries()].filter(([, value]) => value));
  }

  debug(now) {
    const { heard } = this.seat.heard(now);
    return {
      ...this.stage.debug,
      running: heard?.running ?? false,
      utterance: heard?.utterance.number ?? null,
      audioTime: heard?.seconds ?? null, // what is heard at this moment
      frameTime: this.#drawn.seconds, // what the face that was drawn last belongs to; null: to nothing that is spoken
      frameAge: now - this.#drawn.at, // milliseconds since it came on the display; negative: it is still on its way there
      fapValues: Array.from(this.#shown),
      turned: this.orbit.turned,
    };
  }

  #visibilityChanged() {
    this.stage.seen = this.visibility.seen;
    this.idleChanged();
  }

  /** Captions change with a picture, where there are pictures: what is drawn in between would hold up the next one. */
  #tick(now) {
    if (this.stage.drawing) this.speech.tick(now);
    else this.#hear(now);
  }

  /** @returns {boolean} whether the captions have changed */
  #hear(now) {
    this.speech.tick(now);
    const { captions, options, speaker } = this.seat.heard(now).heard?.utterance ?? {};
    return this.captions.show(captions?.lineOf(this.captions.size) ?? null, options?.lang, speaker?.name);
  }

  #frame(now, ahead) {
    const { heard, listens } = this.seat.heard(now, ahead / 1000);
    const { face } = this.idle;
    const rests = heard?.running || (listens && this.speech.busy); // idle movement pauses during the head's own utterances
    if (rests) face.leave();
    const idle = rests ? null : face.at(now / 1000, ahead / 1000);
    const changed = this.#mixer.update(now, heard && { ...heard, still: heard.utterance.options?.still === true }, idle);
    this.#drawn = { seconds: heard?.seconds ?? null, at: now + ahead };
    const changing = this.#mixer.changing(now);
    const turning = this.orbit.update(now / 1000);
    const values = this.#inCompany(now, Boolean(idle));
    const speaks = this.seat.busy || changing;
    const held = this.#mixer.pose && !changing; // overrides speech
    const attends = !heard?.running && !this.#mixer.pose && this.#attention.active(now);
    this.#shown = attends ? this.#attention.apply(values, now) : values;
    const breathes = this.#breathe(now / 1000, heard, idle);
    const more =
      attends || changed || turning || breathes || this.#accompanied || (!held && (speaks || (idle && !this.#mixer.still)));
    const still = this.#mixer.still || Boolean(this.#mixer.pose);
    return { values: this.#drawnValues, turned: this.orbit.turned, more, calm: !speaks && !turning, still };
  }

  /** The face as it is drawn, with the breath. @returns {boolean} whether it breathes on without anything else that moves */
  #breathe(now, heard, idle) {
    const speech = heard?.running ? heard : null;
    const alive = !this.#mixer.still && !this.#mixer.pose && (speech || idle) ? Math.min(1, this.element.life ?? 1) : 0;
    this.#drawnValues.set(this.#shown);
    this.#drawnValues[BREATH] = this.#breath.at(now, speech, alive, this.#shown[48]);
    return !alive && this.#breath.shows;
  }

  /** The face with what its company adds to it, unless it is posed or keeps still. */
  #inCompany(now, idles) {
    this.#accompanied = false;
    if (this.seat.alone || this.#mixer.still || this.#mixer.pose) return this.#mixer.values;
    this.#values.set(this.#mixer.values);
    this.#accompanied = this.seat.add(now, this.#values, idles);
    return this.#values;
  }
}
