// SPDX-License-Identifier: MIT
// Examples of how the element looks: the face, its mood and pose, other faces, its parts, the captions.

const face = 'The face';
const looks = 'Looks';

/** @type {import('./stories.js').Story[]} */
export const lookStories = [
  {
    id: 'who', group: face, title: 'Who, and how near',
    about: 'Model names one of the server’s heads; it may be changed while she speaks. The picture of the head stands in until it has come.',
    shows: ['@progress', '@ready', '@connection', '@hello'], controls: ['model', 'view', 'quality', 'poster', 'label', 'src'],
    attributes: { view: 'bust' },
  },
  {
    id: 'mood', group: face, title: 'Mood and life',
    about: 'A mood holds until the next one, speaking or not. Life is how strongly she blinks and moves while nobody speaks; still leaves the lips alone.',
    shows: ['express()'], controls: ['expression', 'life', 'still'],
    actions: {
      joy: ['Joy', (head) => head.express({ joy: 0.7 })],
      mixed: ['Anger and disgust', (head) => head.express({ anger: 0.5, disgust: 0.4 }, { ease: 1 })],
      none: ['Neutral', (head) => head.express()],
    },
  },
  {
    id: 'pose', group: face, title: 'A pose, by FAPs',
    about: 'Holds the face by the numbers of MPEG-4; faps tells what is drawn at this moment.',
    shows: ['pose()', '.faps'],
    actions: {
      open: ['Open the mouth', (head) => head.pose({ 3: 300, 12: 120, 13: 120 }, { ease: true })],
      rest: ['Let go', (head) => head.pose(null)],
      tell: ['Tell the FAPs', (head) => console.log(head.faps)],
    },
  },
  {
    id: 'turn', group: face, title: 'Turned by the user',
    about: 'Drag the picture, or use the arrow keys on the slider that shows while it has the focus.',
    shows: ['::turn'], controls: ['turn'], attributes: { turn: 'on' }, css: 'talking-head::part(turn) { accent-color: #963a30; }',
  },
  {
    id: 'other-head', group: face, title: 'A head of your own',
    about: 'Avatar is the address of a GLB or VRM, with a file that says which shape is which where their names do not; pictures that of a set of photographs; showHead takes a head that the page has.',
    shows: ['showHead()'], controls: ['avatar', 'avatar-map', 'pictures', 'quality'],
    actions: {
      show: ['Show a head of the page', async (head) => head.showHead(await (await fetch('v1/models/bruno')).json())],
      missing: ['An avatar that is not there', (head) => head.setAttribute('avatar', 'missing.glb')],
    },
  },
  {
    id: 'calibrate', group: face, title: 'The shape of somebody',
    about: 'The head takes feature points by MPEG-4’s numbers, in mm, for this page or for all who hear the stream, and goes on speaking with that face.',
    shows: ['calibrate()', 'calibrateAll()', '@calibrated'],
    actions: {
      wide: ['A wider mouth', (head) => head.calibrate({ featurePointsCoord: { 8.3: [30, -62, 18], 8.4: [-30, -62, 18] } })],
      all: ['For all', (head) => head.calibrateAll({ featurePointsCoord: { 8.3: [30, -62, 18], 8.4: [-30, -62, 18] } })],
      own: ['Her own', (head) => head.calibrate(null)],
      ownForAll: ['Her own, for all', (head) => head.calibrateAll(null)],
    },
  },
  {
    id: 'captions', group: looks, title: 'Captions',
    about: 'Word by word on the clock of the sound, in colours whose contrast is enough. The button CC switches them.',
    shows: ['::captions', '::captions-empty', '::said', '::word', '::rest', '::captions-button'],
    controls: ['captions', 'caption-size', 'caption-colours'], attributes: { lang: 'it' },
    css: `talking-head::part(captions) { letter-spacing: 0.02em; }
talking-head::part(captions-empty) { min-block-size: 3em; }
talking-head::part(said) { font-style: italic; }
talking-head::part(word) { border-radius: 0.2em; }
talking-head::part(rest) { font-weight: 600; }
talking-head::part(captions-button) { border-radius: 0.5em; }`,
    actions: { speak: ['Speak', (head) => head.speak('Le parole si leggono mentre si sentono.')] },
  },
  {
    id: 'caption-colours', group: looks, title: 'Captions in your colours',
    about: 'Custom properties of the captions. Mind the contrast: 4.5 : 1 is wanted by WCAG.',
    shows: [], attributes: { lang: 'it' },
    controls: ['--talking-head-caption-size', '--talking-head-caption-background', '--talking-head-caption-color',
      '--talking-head-word-background', '--talking-head-word-color', '--talking-head-said-strength'],
    actions: { speak: ['Speak', (head) => head.speak('Le parole si leggono mentre si sentono.')] },
  },
  {
    id: 'parts', group: looks, title: 'The parts of the picture',
    about: 'Stage, picture, what is wrong in words, the button that asks for a tap before there may be sound: each can be styled.',
    shows: ['::stage', '::canvas', '::poster', '::message', '::sound-button', '@sound'], attributes: { lang: 'it' },
    css: `talking-head::part(stage) { background: linear-gradient(#dde6ec, #a9bac6); }
talking-head::part(canvas) { filter: saturate(0.6); }
talking-head::part(poster) { filter: sepia(0.4); }
talking-head::part(message) { border: 2px solid #fff; }
talking-head::part(sound-button) { border-radius: 0.5em; }`,
    actions: { speak: ['Speak', (head) => head.speak('Ecco la mia voce.')] },
  },
  {
    id: 'slot', group: looks, title: 'Before the script has come',
    about: 'The content of the element is shown only as long as the script has not come, or where there is none.',
    shows: ['slot'], content: 'The face needs JavaScript.',
  },
];
