// SPDX-License-Identifier: MIT
// The examples of the element: what each shows, and what its buttons do. What a button does is shown as it stands here, so each
// function says all of it. No page needed: tests/web reads this.
import { roomStories } from './room.js';
import { lookStories } from './look.js';

/**
 * @typedef {object} Story
 * @property {string} id its place in the page's address
 * @property {string} group @property {string} title @property {string} about
 * @property {string[]} shows of custom-elements.json, beside its controls: `speak()`, `@word`, `.faps`, `::canvas`, `slot`
 * @property {string[]} [controls] attributes and custom properties that can be changed
 * @property {Record<string, string>} [attributes] those that it begins with @property {string} [content] of the element
 * @property {string} [css]
 * @property {[string, object, string][]} [beside] elements beside it: name, attributes, text
 * @property {Record<string, [string, Function]>} [actions] by name: what the button says, what it does with the element
 */

const speaking = 'Speaking';
const reading = 'Reading and listening';

/** @type {Story[]} */
const speechStories = [
  {
    id: 'speak', group: speaking, title: 'Speak a text',
    about: 'One line has her speak; what is asked for meanwhile waits its turn. The events come when they are heard.',
    shows: ['speak()', 'stop()', '@begin', '@sentence', '@word', '@end'],
    controls: ['lang', 'voice', 'rate'], attributes: { lang: 'it' },
    actions: {
      speak: ['Speak', (head) => head.speak('Nel mezzo del cammin di nostra vita mi ritrovai per una selva oscura.')],
      atOnce: ['Speak at once', (head) => head.speak('Buongiorno!', { mode: 'replace' })],
      stop: ['Stop', (head) => head.stop()],
    },
  },
  {
    id: 'pause', group: speaking, title: 'Pause and go on',
    about: 'She halts within a few milliseconds, lives on, and goes on where she was.',
    shows: ['pause()', 'resume()', '@paused', '@resumed'], attributes: { lang: 'en' },
    actions: {
      speak: ['Speak', (head) => head.speak('One, two, three, four, five, six, seven, eight, nine, ten.')],
      pause: ['Pause', (head) => head.pause()],
      resume: ['Go on', (head) => head.resume()],
    },
  },
  {
    id: 'markup', group: speaking, title: 'Markup, marks and jumps',
    about: 'SSML, APML, JSML, EmotionML, BML and FML are recognised, or named by markup. Marks are told as they are heard, and can be jumped to.',
    shows: ['jump()', '@mark', '@jumped'], controls: ['markup'], attributes: { lang: 'en' },
    actions: {
      speak: ['Speak', (head) => head.speak('<speak>First this. <mark name="middle"/> Then that. <mark name="last"/> And here it ends.</speak>')],
      jump: ['Jump to the last mark', (head) => head.jump('last')],
    },
  },
  {
    id: 'numbers', group: speaking, title: 'Numbers and signs',
    about: 'Numbers, signs and short forms are put into words before the voice sees them, by the rules of the language; with normalization="off" the voice reads them as it can.',
    shows: [], controls: ['normalization'], attributes: { lang: 'en' },
    actions: { speak: ['Speak', (head) => head.speak('On 3 May 1994 Dr Smith paid $1,250.50, i.e. 12% more.')] },
  },
  {
    id: 'open', group: speaking, title: 'A text while it is written',
    about: 'What a language model writes is spoken sentence by sentence, while it goes on writing. A stream of a response can be given, too.',
    shows: ['open()'], attributes: { lang: 'en' },
    actions: {
      write: ['Write', (head) => {
        const utterance = head.open();
        for (const word of 'This is being written. She does not wait for the end.'.split(' ')) utterance.write(`${word} `);
        utterance.close();
        return utterance.done;
      }],
    },
  },
  {
    id: 'details', group: speaking, title: 'Phones, and what comes',
    about: 'With phones each sound is told with its time; media brings the frames and the sound themselves, before they are heard.',
    shows: ['@phone', '@media'], controls: ['contacts', 'blend'], attributes: { lang: 'it' },
    actions: { speak: ['Speak', (head) => head.speak('La mamma parla piano.', { phones: true })] },
  },
  {
    id: 'wrong', group: speaking, title: 'What is wrong',
    about: 'Markup that is said to be SSML and is none gives an error with its place; what is left out of a text, a warning. She goes on living.',
    shows: ['@error', '@warning'], attributes: { lang: 'en' },
    actions: {
      error: ['Markup that does not end', (head) => head.speak('<speak>Good morning.</spaek>', { markup: 'ssml' })],
      warning: ['An element that is not known', (head) => head.speak('<speak>Good <blink>morning</blink>.</speak>')],
    },
  },
  {
    id: 'turns', group: speaking, title: 'Taking turns',
    about: 'Heads of one page wait for each other; polite="off" speaks at once.',
    shows: [], controls: ['polite'], attributes: { lang: 'en' },
    beside: [['talking-head', { id: 'other', lang: 'en', quality: 'low', label: 'The other head' }, '']],
    actions: {
      both: ['Have both speak', (head) => {
        document.querySelector('#other').speak('I was asked first.');
        return head.speak('And I was asked after.');
      }],
    },
  },
  {
    id: 'read', group: reading, title: 'Read the page',
    about: 'She reads the element that for names; its words are marked as they are heard, and can be clicked.',
    shows: ['read()', '@reading', '@read'], controls: ['for'], attributes: { for: '#poem', lang: 'it' },
    beside: [['p', { id: 'poem', lang: 'it' }, 'Nel mezzo del cammin di nostra vita mi ritrovai per una selva oscura.']],
    actions: { read: ['Read', (head) => head.read()], stop: ['Stop', (head) => head.stop()] },
  },
  {
    id: 'listen', group: reading, title: 'Somebody’s own voice',
    about: 'Her lips follow the microphone, or a stream of a call, without a text. The browser asks for the microphone; nothing is kept.',
    shows: ['listen()'], attributes: { lang: 'en' },
    actions: {
      listen: ['Listen to the microphone', (head) => head.listen(null, { sound: false })],
      stop: ['Stop', (head) => head.stop()],
    },
  },
  {
    id: 'follow', group: reading, title: 'A sound of the page',
    about: 'Whenever the audio plays she speaks along with it. The attribute for does the same without a script.',
    shows: ['follow()'], attributes: { lang: 'it' },
    beside: [['audio', { id: 'sound', controls: '', src: 'v1/speech?text=La+mamma+parla+piano.&lang=it&format=wav' }, '']],
    actions: {
      follow: ['Follow it', (head) => {
        head.follow(document.querySelector('#sound'));
        return document.querySelector('#sound').play();
      }],
    },
  },
];

export const stories = [...speechStories, ...lookStories, ...roomStories];
