// SPDX-License-Identifier: MIT
// Has the face ask a questionnaire, one item after the other, and shows the answers of all who were asked.
import { answersCsv, plot, readQuestionnaire, tally } from './questionnaire.js';

const KEEP = 1000; // results

export class Questions {
  #questionnaire = null;
  #results = []; // of people: {began, room, answers}
  #running = null; // {at, answers, began, since}
  #asked = 0;

  /**
   * @param {HTMLElement} box with #questionnaire and what belongs to it
   * @param {object} ports head; say(name, values): words; lang(): of the page; consented(): whether answers may be kept;
   *   problem(error); download(name, text, type); log(what, text, more)
   */
  constructor(box, ports) {
    Object.assign(this, { box, ports });
    const part = (id) => box.querySelector(`#${id}`);
    this.parts = Object.fromEntries(['questions-file', 'ask-questions', 'stop-questions', 'questions-state', 'answers-box', 'answers', 'answers-json', 'answers-csv', 'answers-svg'].map((id) => [id, part(id)]));
    const { parts } = this;
    parts['questions-file'].addEventListener('change', async ({ target }) => {
      for (const file of target.files) this.#take(await file.text());
      target.value = '';
    });
    parts['ask-questions'].addEventListener('click', () => this.#begin());
    parts['stop-questions'].addEventListener('click', () => this.#stop());
    parts['answers-json'].addEventListener('click', () => this.#results.forEach((result, i) => ports.download(`answers-${i + 1}.json`, JSON.stringify({ ...this.#questionnaire, ...result }, null, 2), 'application/json')));
    parts['answers-csv'].addEventListener('click', () => ports.download('answers.csv', answersCsv(this.#questionnaire.items, this.#people), 'text/csv'));
    parts['answers-svg'].addEventListener('click', () => parts.answers.querySelectorAll('svg').forEach((svg, i) => ports.download(`answers-${i + 1}.svg`, new globalThis.XMLSerializer().serializeToString(svg), 'image/svg+xml')));
    ports.head.addEventListener('answered', ({ detail }) => this.#answered(detail));
    ports.head.addEventListener('asked', ({ detail }) => this.#running && detail.id === this.#running.id && (this.#running.since = performance.now()));
    this.translate();
  }

  get #people() {
    return this.#results.map(({ answers }) => answers);
  }

  /** The listener does not consent any more: the answers given here are forgotten. */
  forget() {
    this.#running = null;
    this.#results = this.#results.filter(({ here }) => !here);
    this.translate();
  }

  /** A questionnaire, or the answers of somebody. */
  #take(source) {
    try {
      const read = readQuestionnaire(JSON.parse(source)), { answers, room, began, ...questionnaire } = read;
      const same = this.#questionnaire?.title === read.title;
      this.#questionnaire = same && answers ? this.#questionnaire : questionnaire;
      if (!same) this.#results = [];
      if (answers && this.#results.length < KEEP) this.#results.push({ room, began, answers });
    } catch (error) {
      this.ports.problem({ code: 'bad-scene', message: this.ports.say('badQuestions', { place: error.message }) });
    }
    this.translate();
  }

  #begin() {
    const { head } = this.ports;
    if (!head.room || !this.#questionnaire || this.#running) return;
    this.#running = { at: -1, answers: [], began: new Date().toISOString(), room: head.room };
    this.#next();
  }

  #next() {
    const { head } = this.ports, { items, lang } = this.#questionnaire, running = this.#running;
    const item = items[++running.at];
    if (!item) {
      this.#end();
      return;
    }
    running.id = `item-${++this.#asked}-${item.id}`.slice(0, 60);
    running.since = performance.now();
    const { scale: choices, seconds } = item;
    head.ask(item.text, { id: running.id, ...(choices && { choices }), ...(seconds && { seconds }), ...(lang && { lang }) });
    this.translate();
  }

  #answered({ id, reason, text, choice }) {
    const running = this.#running;
    if (!running || id !== running.id) return;
    if (reason === 'withdrawn' || reason === 'failed') {
      this.#stop();
      return;
    }
    const seconds = Math.round((performance.now() - running.since) / 100) / 10;
    const given = { ...(choice !== undefined && { choice }), ...(text !== undefined && { text }) };
    running.answers.push({ id: this.#questionnaire.items[running.at].id, reason, ...given, seconds });
    this.#next();
  }

  #end() {
    const { began, room, answers } = this.#running;
    this.#running = null;
    if (this.ports.consented()) this.#results.push({ began, room, answers, here: true });
    this.ports.log('questionnaire', this.#questionnaire.title);
    this.translate();
  }

  #stop() {
    if (!this.#running) return;
    this.#running = null;
    this.ports.head.offer([]);
    this.translate();
  }

  translate() {
    const { parts, ports: { say, lang } } = this, questionnaire = this.#questionnaire, running = this.#running;
    parts['ask-questions'].hidden = !questionnaire || Boolean(running);
    parts['stop-questions'].hidden = !running;
    const n = running ? running.at + 1 : 0;
    parts['questions-state'].textContent = running ? say('questionOf', { n, of: questionnaire.items.length }) : (questionnaire?.title ?? say('noQuestions'));
    parts['answers-box'].hidden = !this.#results.length;
    const average = new Intl.NumberFormat(lang(), { maximumFractionDigits: 2 });
    parts.answers.replaceChildren(...(questionnaire ? tally(questionnaire.items, this.#people) : []).map((item) => {
      const row = document.createElement('li'), what = document.createElement('p');
      what.textContent = `${item.text} (${item.n}${item.mean === null ? '' : `; ⌀ ${average.format(item.mean)}`})`;
      const quoted = (words) => Object.assign(document.createElement('blockquote'), { textContent: words });
      row.append(what, ...(item.counts.length ? [plot(item, lang())] : item.words.map(quoted)));
      return row;
    }));
  }
}
