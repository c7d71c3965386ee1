// SPDX-License-Identifier: MIT
// The browser's own recogniser, for those who choose it: it may send the sound to the maker of the browser.
export const Recogniser = globalThis.SpeechRecognition ?? globalThis.webkitSpeechRecognition;

/** As `hear` of the head: {stop(), stopAtSilence(), open, done}. */
export class BrowserWords {
  open = true;

  /**
   * @param {HTMLElement} head @param {{lang: string, handsFree?: boolean, onset?: () => void}} options
   * @param {object} ports changed({on, speaking}); heard({text, final, id})
   */
  constructor(head, { lang, handsFree = false, onset }, ports) {
    const recogniser = new Recogniser(), id = `ear-browser-${Date.now().toString(36)}`;
    Object.assign(recogniser, { lang, interimResults: true, continuous: handsFree });
    this.recogniser = recogniser;
    const tell = (text, final, more = {}) => {
      head.said(text, { id, final, lang, ...more });
      ports.heard({ text, final, id });
    };
    recogniser.addEventListener('start', () => ports.changed({ on: true, speaking: true }));
    recogniser.addEventListener('speechstart', () => onset?.());
    recogniser.addEventListener('result', ({ results, resultIndex }) => {
      for (const result of [...results].slice(resultIndex)) {
        const [{ transcript, confidence }] = result;
        tell(transcript.trim(), result.isFinal, result.isFinal && confidence ? { confidence: Math.min(1, confidence) } : {});
      }
    });
    this.done = new Promise((resolve, reject) => {
      recogniser.addEventListener('error', ({ error }) => ['no-speech', 'aborted'].includes(error) || reject(new Error(error)));
      recogniser.addEventListener('end', () => resolve(null));
    }).finally(() => {
      this.open = false;
      ports.changed({ on: false, speaking: false });
    });
    this.done.catch(() => {});
    recogniser.start();
  }

  stop() {
    this.open = false;
    this.recogniser.stop();
  }

  stopAtSilence() {} // it does so by itself
}
