// SPDX-License-Identifier: MIT
// Examples of rooms: many who hear one stream, answers, states, consent, tokens.

const rooms = 'Rooms and servers';

/** @type {import('./stories.js').Story[]} */
export const roomStories = [
  {
    id: 'room', group: rooms, title: 'A room',
    about: 'All pages in a room hear and show what anybody says there; open this one twice. With watch a page only looks on, under a name.',
    shows: ['@joined', '@desks', '@expressed'], controls: ['room', 'watch'], attributes: { room: 'examples', watch: 'Anna', lang: 'en' },
    actions: {
      say: ['Say to all', (head) => head.speak('Good morning, everybody.')],
      joy: ['Joy, for all', (head) => head.express({ joy: 0.6 })],
    },
  },
  {
    id: 'answers', group: rooms, title: 'Questions and answers',
    about: 'Offers answers to whoever is in the room; a page shows them as it likes, and gives one by its place.',
    shows: ['offer()', 'choose()', '@choices', '@chosen'], attributes: { room: 'examples', lang: 'en' },
    actions: {
      offer: ['Ask', (head) => head.offer(['Yes', 'In a minute'], { id: 'coming', question: 'Coming?' })],
      choose: ['Answer: in a minute', (head) => head.choose(1, 'coming')],
    },
  },
  {
    id: 'state', group: rooms, title: 'What the assistant does',
    about: 'Listening, thinking, muted: told to all in the room, with a look of the face.',
    shows: ['tell()', '@state'], attributes: { room: 'examples', lang: 'en' },
    actions: {
      listening: ['Listening', (head) => head.tell('listening')],
      thinking: ['Thinking', (head) => head.tell('thinking', { text: 'Let me see.', mix: { surprise: 0.2 } })],
      idle: ['Idle', (head) => head.tell('idle')],
    },
  },
  {
    id: 'consent', group: rooms, title: 'Consent to a study',
    about: 'Asks whoever listens whether a study may write down what happens; a yes can be taken back.',
    shows: ['consent()', '@consent'], attributes: { room: 'examples', lang: 'en' },
    actions: {
      ask: ['Ask', (head) => head.consent('asked', 'Your answers, for a study of lips.')],
      yes: ['Yes', (head) => head.consent('given')],
      no: ['No', (head) => head.consent('declined')],
      none: ['No more', (head) => head.consent('none')],
    },
  },
  {
    id: 'token', group: rooms, title: 'A server with tokens',
    about: 'A server that demands a token gets it as an attribute. What is wrong with one is said in the picture, and as an error. This page takes its own from ?token= of its address.',
    shows: ['@authorized'], controls: ['token'],
  },
];
