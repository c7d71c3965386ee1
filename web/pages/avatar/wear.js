// SPDX-License-Identifier: MIT
// What the head wears: the picture's proposal of hairstyle, hair's colour, beard and glasses, which the user confirms or
// changes.

const LOOK = { width: 72, height: 94 }; // CSS pixels of a head's picture

/** Colours of hair to choose from, linear. */
const COLOURS = {
  black: [0.006, 0.005, 0.005], dark: [0.03, 0.018, 0.011], brown: [0.11, 0.06, 0.032], blond: [0.5, 0.33, 0.16],
  red: [0.24, 0.075, 0.025],
  grey: [0.3, 0.29, 0.28], white: [0.72, 0.71, 0.69],
};
const AGES = [['', 'age_young'], ['58', 'age_middle'], ['68', 'age_old'], ['80', 'age_oldest']]; // years that each stands for

const option = (value, label) => Object.assign(document.createElement('option'), { value, textContent: label });

export class Wear {
  #fields;

  #say;

  #chosen = {}; // by the user, who is not overruled by another picture

  #offer = null;

  #of = null; // the landmarks that it was made of

  /**
   * @param {{seen: HTMLElement, style: HTMLElement, hair: HTMLSelectElement, beard: HTMLSelectElement, glasses:
   *   HTMLSelectElement, age: HTMLSelectElement}} fields
   * @param {(name: string, values?: object) => string} say @param {() => void} changed
   */
  constructor(fields, say, changed) {
    this.#fields = fields;
    this.#say = say;
    for (const name of ['style', 'hair', 'beard', 'glasses', 'age'])
      fields[name].addEventListener('change', ({ target }) => {
        this.#chosen[name] = target.value;
        changed();
      });
  }

  /**
   * Shows what is proposed for a picture.
   * @param {{picture: ImageData, landmarks: number[][]}} front
   * @param {{all: object, styles: object, offerOf: Function}} tools all: heads and hairstyles
   * @param {{name: string, title: string, poster?: string}[]} models
   */
  show(front, tools, models) {
    if (this.#of !== String(front.landmarks)) {
      this.#of = String(front.landmarks);
      this.#offer = tools.offerOf(front, tools.all);
    }
    const { first, colour, unsure } = this.#offer;
    this.#showStyles([...models.map((model) => ({ ...model, poster: model.poster && `v1/${model.poster}` })), ...Object.keys(tools.styles).map((name) => ({ name, title: this.#say(`style_${name}`), poster: `wear-${name}.webp` }))]);
    this.#fill('hair', [...(colour ? [['photo', 'hairPhoto']] : []), ['head', 'hairHead'], ...Object.keys(COLOURS).map((name) => [name, `hair_${name}`])], colour ? 'photo' : 'head');
    this.#fill('beard', tools.BEARDS.map((name) => [name, `beard_${name}`]), first.beard);
    this.#fill('glasses', tools.GLASSES.map((name) => [name, `glasses_${name}`]), first.glasses);
    this.#fill('age', AGES, '');
    const list = (names) => names.map((name) => this.#say(`seen_${name}`)).join(', ');
    const sure = Object.entries(this.#offer.traits).flatMap(([name, answer]) => (answer === 'yes' ? [name] : []));
    const sentences = [...(sure.length ? [this.#say('seen', { list: list(sure) })] : []), ...(unsure.length ? [this.#say('unsure', { list: list(unsure) })] : [])];
    this.#fields.seen.textContent = sentences.join(' ');
    this.#fields.seen.hidden = !sentences.length;
  }

  #fill(name, offers, proposed) {
    const select = this.#fields[name];
    select.replaceChildren(...offers.map(([value, label]) => option(value, this.#say(label))));
    const chosen = this.#chosen[name];
    select.value = offers.some(([value]) => value === chosen) ? chosen : proposed;
  }

  /** The three most similar and none come first; nothing is chosen where the picture does not tell. */
  #showStyles(models) {
    const { styles, first } = this.#offer;
    const now = this.#chosen.style ?? first.hair;
    const named = (name) => models.find((model) => model.name === name);
    const best = styles.map(named).filter(Boolean);
    const others = models.filter((model) => !best.includes(model));
    const none = { name: 'none', title: this.#say('hairNone') };
    this.#fields.style.replaceChildren(...[...best, none, ...others].map((one) => this.#style(one, one.name === now)));
  }

  #style({ name, title, poster }, checked) {
    const label = document.createElement('label');
    label.append(Object.assign(document.createElement('input'), { type: 'radio', name: 'style', value: name, checked }));
    if (poster) label.append(Object.assign(document.createElement('img'), { src: poster, alt: '', loading: 'lazy', ...LOOK }));
    label.append(Object.assign(document.createElement('span'), { textContent: title }));
    return label;
  }

  /** The head whose irises are the most similar. */
  get eyes() {
    return this.#offer.eyes;
  }

  /** Whether a hairstyle is chosen; focuses the choice otherwise. */
  get isComplete() {
    const { style } = this.#fields;
    if (style.querySelector(':checked')) return true;
    style.querySelector('input').focus();
    return false;
  }

  /**
   * Options of makeHead. @param {string} like @param {{wornOf: Function, all: object}} tools
   * @param {(name: string) => Promise<object>} load
   */
  async options(like, { wornOf, all }, load) {
    const { style, hair, beard, glasses, age } = this.#fields;
    const choice = { hair: style.querySelector(':checked').value, beard: beard.value, glasses: glasses.value };
    const isOwn = hair.value === 'photo';
    const colour = isOwn ? this.#offer.colour : (COLOURS[hair.value] ?? null);
    return { ...(await wornOf(choice, like, all, load)), hair: choice.hair === 'none' ? 'none' : colour, brows: isOwn ? this.#offer.brows : null, beard: isOwn ? this.#offer.beard : null, age: Number(age.value) || null };
  }
}
