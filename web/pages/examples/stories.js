// SPDX-License-Identifier: MIT
// The examples of the element, with the functions of their buttons. The page shows the source of these functions, so each one
// is complete in itself. It needs no page: tests read it.

/**
 * @typedef {object} Story
 * @property {string} id fragment of the page's address
 * @property {string} group @property {string} title @property {string} about
 * @property {string[]} shows members of custom-elements.json that it demonstrates besides its controls: `speak()`, `@word`,
 *   `.faps`, `::canvas`, `slot`
 * @property {string[]} [controls] attributes and custom properties with a field
 * @property {Record<string, string>} [attributes] initial values @property {string} [content] content of the element
 * @property {string} [css]
 * @property {[string, object, string][]} [beside] elements next to it: name, attributes, text
 * @property {Record<string, [string, Function]>} [actions] by name: label of the button, and its action on the element
 */

const speaking = 'Speaking';
const reading = 'Reading and listening';

/** @type {Story[]} */
const speechStories = [
  {
    id: 'speak', group: speaking, title: 'Speak a text',
    about: 'She speaks the text. Texts that come meanwhile wait in a queue. Events arrive when they are heard.',
    shows: ['speak()', 'stop()', '@begin', '@sentence', '@word', '@end'],
    controls: ['lang', 'voice', 'rate'], attributes: { lang: 'it' },
    actions: {
      speak: ['Speak', (head) => head.speak('Nel mezzo del cammin di nostra vita mi ritrovai per una selva oscura.')],
      atOnce: ['Speak at once', (head) => head.speak('Buongiorno!', { mode: 'replace' })],
      stop: ['Stop', (head) => head.stop()],
    },
  },
  {
    id: 'pause', group: speaking, title: 'Pause and resume',
    about: 'She stops within a few milliseconds, keeps blinking and breathing, and continues where she was.',
    shows: ['pause()', 'resume()', '@paused', '@resumed'], attributes: { lang: 'en' },
    actions: {
      speak: ['Speak', (head) => head.speak('One, two, three, four, five, six, seven, eight, nine, ten.')],
      pause: ['Pause', (head) => head.pause()],
      resume: ['Continue', (head) => head.resume()],
    },
  },
  {
    id: 'recording', group: speaking, title: 'A recording, without a server',
    about: 'She speaks a file that faccia say --bundle has written. On a static site src is the address of that file; here the server makes one.',
    shows: ['play()', 'seek()', '.currentTime', '.duration', '@seeked', '::play-button'], controls: ['src', 'audio', 'autoplay', 'model'],
    attributes: { src: 'v1/speech?format=bundle&lang=en&text=This+was+recorded.+It+needs+no+server.', model: 'v1/models/mara' },
    css: 'talking-head::part(play-button) { background: #123f8c; }',
    actions: {
      play: ['Play', (head) => head.play()],
      back: ['Back a second', (head) => head.seek(head.currentTime - 1)],
      half: ['From the middle', (head) => head.seek(head.duration / 2)],
    },
  },
  {
    id: 'markup', group: speaking, title: 'Markup, marks and jumps',
    about: 'SSML, APML, JSML, EmotionML, BML and FML are recognised, or named by markup. Events tell when a mark is heard, and you can jump to a mark.',
    shows: ['jump()', '@mark', '@jumped'], controls: ['markup'], attributes: { lang: 'en' },
    actions: {
      speak: ['Speak', (head) => head.speak('<speak>First this. <mark name="middle"/> Then that. <mark name="last"/> And here it ends.</speak>')],
      jump: ['Jump to the last mark', (head) => head.jump('last')],
    },
  },
  {
    id: 'numbers', group: speaking, title: 'Numbers and signs',
    about: 'Numbers, signs and abbreviations are put into words by the rules of the language before the voice reads them. With normalization="off" the voice reads them as it can.',
    shows: [], controls: ['normalization'], attributes: { lang: 'en' },
    actions: { speak: ['Speak', (head) => head.speak('On 3 May 1994 Dr Smith paid $1,250.50, i.e. 12% more.')] },
  },
  {
    id: 'verse', group: speaking, title: 'Lines of a poem',
    about: 'Lines that end without punctuation run on, following the sense. With verse="pause" each line ends with a pause as long as a comma’s.',
    shows: [], controls: ['verse'], attributes: { lang: 'en' },
    actions: { speak: ['Speak', (head) => head.speak('The sea is grey tonight\nand softly it goes home\nto where the boats are light.')] },
  },
  {
    id: 'open', group: speaking, title: 'A text while it is written',
    about: 'She speaks what a language model writes, sentence by sentence, while it is still writing. You can also pass the stream of a response.',
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
    id: 'details', group: speaking, title: 'Phones and media',
    about: 'With phones, events tell each sound and its time. With media, events bring the frames and the sound themselves before they are heard.',
    shows: ['@phone', '@media'], controls: ['contacts', 'blend'], attributes: { lang: 'it' },
    actions: { speak: ['Speak', (head) => head.speak('La mamma parla piano.', { phones: true })] },
  },
  {
    id: 'dialogue', group: speaking, title: 'A dialogue',
    about: 'Each person has a voice of its own. The event tells who speaks, and so do the captions.',
    shows: ['@speaker', '::who'], attributes: { lang: 'it' },
    css: 'talking-head::part(who) { font-variant: small-caps; }',
    actions: { speak: ['Speak', (head) => head.speak('Chi è? Sono io.', {
      speakers: JSON.stringify([{ id: 'anna', name: 'Anna', gender: 'female', at: '0-6' }, { id: 'ugo', name: 'Ugo', gender: 'male', at: '7-15' }]),
    })] },
  },
  {
    id: 'wrong', group: speaking, title: 'Errors',
    about: 'Markup that claims to be SSML but is not gives an error with its place. Text that cannot be spoken gives a warning. The face stays alive.',
    shows: ['@error', '@warning'], attributes: { lang: 'en' },
    actions: {
      error: ['Markup that does not end', (head) => head.speak('<speak>Good morning.</spaek>', { markup: 'ssml' })],
      warning: ['An element that is not known', (head) => head.speak('<speak>Good <blink>morning</blink>.</speak>')],
    },
  },
  {
    id: 'turns', group: speaking, title: 'Taking turns',
    about: 'Heads on one page wait for each other. With polite="off" a head speaks at once.',
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
    id: 'scene', group: speaking, title: 'Two who talk',
    about: 'Two heads show one speech: partner names the head that speaks, persona the speakers whom a head shows. The other one looks at who speaks, and nods.',
    shows: [], controls: ['partner', 'persona'], attributes: { lang: 'en', partner: 'lead', persona: 'tom', model: 'bruno' },
    beside: [['talking-head', { id: 'lead', persona: 'ann', lang: 'en', label: 'The head that speaks' }, '']],
    actions: {
      scene: ['Play the scene', () => document.querySelector('#lead').speak('Who is there? It is me.', {
        speakers: JSON.stringify([{ id: 'ann', name: 'Ann', gender: 'female', at: '0-13' }, { id: 'tom', name: 'Tom', gender: 'male', at: '14-23' }]),
      })],
    },
  },
  {
    id: 'capture', group: speaking, title: 'Her picture and sound as a stream',
    about: 'captureStream() gives a MediaStream for a call, a recording or another element. Here a video shows it.',
    shows: ['captureStream()'], attributes: { lang: 'en' },
    beside: [['video', { id: 'copy', width: '160', autoplay: '', 'aria-hidden': 'true' }, '']],
    actions: {
      copy: ['Speak, and show a copy', (head) => {
        const copy = document.querySelector('#copy');
        copy.srcObject = head.captureStream(25);
        copy.muted = true;
        return head.speak('One picture here, and the same one there.');
      }],
    },
  },
  {
    id: 'read', group: reading, title: 'Read the page',
    about: 'She reads the element that for names. Its words are marked as they are heard, and can be clicked.',
    shows: ['read()', '@reading', '@read'], controls: ['for'], attributes: { for: '#poem', lang: 'it' },
    beside: [['p', { id: 'poem', lang: 'it' }, 'Nel mezzo del cammin di nostra vita mi ritrovai per una selva oscura.']],
    actions: { read: ['Read', (head) => head.read()], stop: ['Stop', (head) => head.stop()] },
  },
  {
    id: 'listen', group: reading, title: 'Your own voice',
    about: 'Her lips follow the microphone, or the stream of a call, without a text. The browser asks for the microphone; nothing is stored.',
    shows: ['listen()'], attributes: { lang: 'en' },
    actions: {
      listen: ['Listen to the microphone', (head) => head.listen(null, { sound: false })],
      stop: ['Stop', (head) => head.stop()],
    },
  },
  {
    id: 'follow', group: reading, title: 'A sound on the page',
    about: 'Whenever the audio plays, she speaks along with it. The attribute for does the same without a script.',
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

// The look of the element: the face, its mood and pose, other faces, its parts, the captions.

const face = 'The face';
const looks = 'Looks';

/** @type {Story[]} */
const lookStories = [
  {
    id: 'who', group: face, title: 'Heads and views',
    about: 'Model names one of the server’s heads, and may change while she speaks. A picture of the head is shown until the head has loaded.',
    shows: ['@progress', '@ready', '@connection', '@hello'], controls: ['model', 'view', 'quality', 'poster', 'label', 'src'],
    attributes: { view: 'bust' },
  },
  {
    id: 'mood', group: face, title: 'Mood and life',
    about: 'A mood lasts until the next one, whether she speaks or not. Life is how strongly she blinks and moves while nobody speaks; still moves the lips alone.',
    shows: ['express()'], controls: ['expression', 'life', 'still'],
    actions: {
      joy: ['Joy', (head) => head.express({ joy: 0.7 })],
      mixed: ['Anger and disgust', (head) => head.express({ anger: 0.5, disgust: 0.4 }, { ease: 1 })],
      none: ['Neutral', (head) => head.express()],
    },
  },
  {
    id: 'pose', group: face, title: 'A pose by FAPs',
    about: 'Sets the face by the parameters of MPEG-4; faps tells what is drawn at the moment.',
    shows: ['pose()', '.faps'],
    actions: {
      open: ['Open the mouth', (head) => head.pose({ 3: 300, 12: 120, 13: 120 }, { ease: true })],
      rest: ['Let go', (head) => head.pose(null)],
      tell: ['Tell the FAPs', (head) => console.log(head.faps)],
    },
  },
  {
    id: 'turn', group: face, title: 'Turned by the user',
    about: 'Drag the picture, or use the arrow keys on the slider that appears when it has the focus.',
    shows: ['::turn'], controls: ['turn'], attributes: { turn: 'on' }, css: 'talking-head::part(turn) { accent-color: #963a30; }',
  },
  {
    id: 'other-head', group: face, title: 'A head of your own',
    about: 'Avatar is the address of a GLB or VRM file, with a file that maps its shapes if their names are not known. Pictures is the address of a set of photographs. showHead takes a head that the page has loaded.',
    shows: ['showHead()'], controls: ['avatar', 'avatar-map', 'pictures', 'quality'],
    actions: {
      show: ['Show a head of the page', async (head) => head.showHead(await (await fetch('v1/models/bruno')).json())],
      missing: ['An avatar that is not there', (head) => head.setAttribute('avatar', 'missing.glb')],
    },
  },
  {
    id: 'calibrate', group: face, title: 'The shape of a person',
    about: 'The head takes feature points by their MPEG-4 numbers, in mm, for this page or for all who hear the stream, and speaks on with that face.',
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
    about: 'Word by word with the sound, in colours with enough contrast. The button CC switches them.',
    shows: ['::captions', '::captions-empty', '::said', '::word', '::rest', '::captions-button', '::mouth-button'],
    controls: ['captions', 'caption-size', 'caption-colours'], attributes: { lang: 'it' },
    css: `talking-head::part(captions) { letter-spacing: 0.02em; }
talking-head::part(captions-empty) { min-block-size: 3em; }
talking-head::part(said) { font-style: italic; }
talking-head::part(word) { border-radius: 0.2em; }
talking-head::part(rest) { font-weight: 600; }
talking-head::part(captions-button) { border-radius: 0.5em; }
talking-head::part(mouth-button) { border-radius: 0.5em; }`,
    actions: { speak: ['Speak', (head) => head.speak('Le parole si leggono mentre si sentono.')] },
  },
  {
    id: 'caption-colours', group: looks, title: 'Captions in your colours',
    about: 'Custom properties of the captions. Keep the contrast: WCAG asks for 4.5 : 1.',
    shows: [], attributes: { lang: 'it' },
    controls: ['--talking-head-caption-size', '--talking-head-caption-background', '--talking-head-caption-color',
      '--talking-head-word-background', '--talking-head-word-color', '--talking-head-said-strength'],
    actions: { speak: ['Speak', (head) => head.speak('Le parole si leggono mentre si sentono.')] },
  },
  {
    id: 'parts', group: looks, title: 'The parts of the picture',
    about: 'Stage, picture, error message, the button that asks for a tap before there may be sound: each can be styled.',
    shows: ['::stage', '::canvas', '::poster', '::message', '::sound-button', '@sound'], attributes: { lang: 'it' },
    css: `talking-head::part(stage) { background: linear-gradient(#dde6ec, #a9bac6); }
talking-head::part(canvas) { filter: saturate(0.6); }
talking-head::part(poster) { filter: sepia(0.4); }
talking-head::part(message) { border: 2px solid #fff; }
talking-head::part(sound-button) { border-radius: 0.5em; }`,
    actions: { speak: ['Speak', (head) => head.speak('Ecco la mia voce.')] },
  },
  {
    id: 'room-backdrop', group: looks, title: 'In a room',
    about: 'A warm wall out of focus, with the light of the window that lights the face. Nothing is loaded.',
    shows: ['backdrop'], attributes: { lang: 'it', backdrop: 'room' },
    actions: { speak: ['Speak', (head) => head.speak('Da questa parte viene la luce.')] },
  },
  {
    id: 'slot', group: looks, title: 'Before the script has loaded',
    about: 'The content of the element is shown until the script has loaded, and where there is no script.',
    shows: ['slot'], content: 'The face needs JavaScript.',
  },
];

// Examples of rooms: many listeners of one stream, answers, states, consent, tokens.

const rooms = 'Rooms and servers';

/** @type {Story[]} */
const roomStories = [
  {
    id: 'room', group: rooms, title: 'A room',
    about: 'All pages in a room hear and show what anybody says there; open this page twice. With watch a page only observes, under a name.',
    shows: ['@joined', '@observers', '@expressed'], controls: ['room', 'watch'], attributes: { room: 'examples', watch: 'Anna', lang: 'en' },
    actions: {
      say: ['Say to all', (head) => head.speak('Good morning, everybody.')],
      joy: ['Joy, for all', (head) => head.express({ joy: 0.6 })],
    },
  },
  {
    id: 'answers', group: rooms, title: 'Questions and answers',
    about: 'Offers answers to everybody in the room. A page shows them as it likes, and gives an answer by its number.',
    shows: ['offer()', 'choose()', '@choices', '@chosen'], attributes: { room: 'examples', lang: 'en' },
    actions: {
      offer: ['Ask', (head) => head.offer(['Yes', 'In a minute'], { id: 'coming', question: 'Coming?' })],
      choose: ['Answer: in a minute', (head) => head.choose(1, 'coming')],
    },
  },
  {
    id: 'hear', group: rooms, title: 'Words of a listener',
    about: 'The microphone is heard by the server, if it has a recogniser (facciad --recogniser). The words come back, and answer a question of the room. Neither sound nor words are stored.',
    shows: ['hear()', '@hearing', '@heard', '@asked', '@answered'], attributes: { room: 'examples', lang: 'en' },
    actions: {
      hear: ['Speak to her', (head) => head.hear({ lang: 'en' }).stopAtSilence()],
      stop: ['Stop', (head) => head.stop()],
    },
  },
  {
    id: 'ask', group: rooms, title: 'A question',
    about: 'She asks, offers answers, and waits. An answer is a touch, words that the page has recognised itself, or words that are typed.',
    shows: ['ask()', 'said()', '@asked', '@answered'], attributes: { room: 'examples', lang: 'en' },
    actions: {
      ask: ['Ask', (head) => head.ask('Tea or coffee?', { choices: ['Tea', 'Coffee'], seconds: 30 })],
      said: ['“The second one”', (head) => head.said('the second one', { lang: 'en' })],
    },
  },
  {
    id: 'overhear', group: rooms, title: 'To hear the room',
    about: 'An observer who may speak hears what is said in the room, while its listener consents to a study.',
    shows: ['overhear()', '@overheard'], attributes: { room: 'examples', lang: 'en', watch: 'Anna' },
    actions: {
      hear: ['Hear the room', (head) => head.overhear()],
      no: ['No more', (head) => head.overhear(false)],
    },
  },
  {
    id: 'drive', group: rooms, title: 'A face that is driven',
    about: 'Frames of FAPs, such as those of a camera, move the face of the room while nothing is said, and all but the mouth while something is.',
    shows: ['drive()', '@driven'], attributes: { room: 'examples', lang: 'en' },
    actions: {
      drive: ['Raise the brows', (head) => {
        const brows = (up) => ({ 31: up, 32: up, 33: up, 34: up });
        const frame = (i) => ({ time: performance.now() / 1000, faps: brows(200 * Math.sin(i / 10) ** 2) });
        for (let i = 0; i < 60; i++) setTimeout(() => head.drive([frame(i)]), 33 * i);
        setTimeout(() => head.drive(null), 2000);
      }],
    },
  },
  {
    id: 'manner', group: rooms, title: 'Slower, please',
    about: 'The person in the room decides how everything is spoken there.',
    shows: ['setManner()'], attributes: { room: 'examples', lang: 'en' },
    actions: {
      slower: ['Slower and louder', (head) => head.setManner({ speed: 0.8, volume: 1.2 })],
      usual: ['As usual', (head) => head.setManner()],
      speak: ['Speak', (head) => head.speak('Like this?')],
    },
  },
  {
    id: 'backdrop', group: rooms, title: 'A picture behind her',
    about: 'A picture or a film, of the page, or shown to everybody in the room.',
    shows: ['backdrop', 'showBackdrop()', '@backdrop', '::backdrop'], attributes: { room: 'examples', lang: 'en', backdrop: 'icon-512.png' },
    css: 'talking-head::part(backdrop) { filter: blur(4px); }',
    actions: {
      show: ['Show all', (head) => head.showBackdrop('icon-512.png')],
      none: ['None', (head) => head.showBackdrop('')],
    },
  },
  {
    id: 'state', group: rooms, title: 'What the assistant does',
    about: 'Listening, thinking, muted: sent to everybody in the room, with an expression of the face.',
    shows: ['tell()', '@state'], attributes: { room: 'examples', lang: 'en' },
    actions: {
      listening: ['Listening', (head) => head.tell('listening')],
      thinking: ['Thinking', (head) => head.tell('thinking', { text: 'Let me see.', mix: { surprise: 0.2 } })],
      idle: ['Idle', (head) => head.tell('idle')],
    },
  },
  {
    id: 'head', group: rooms, title: 'Another head for everybody',
    about: 'Names a head to all who look at the room, and who come later. A page that wants to show it sets its model.',
    shows: ['showHeadAll()', '@head'], attributes: { room: 'examples', lang: 'en' },
    actions: {
      mara: ['Mara', (head) => head.showHeadAll('mara')],
      own: ['Each its own', (head) => head.showHeadAll('')],
    },
  },
  {
    id: 'consent', group: rooms, title: 'Consent to a study',
    about: 'Asks the listener whether a study may record what happens. The listener can take a yes back.',
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
    about: 'Pass the token as an attribute. What is wrong with it is shown in the picture, and reported as an error. This page takes its own token from ?token= of its address.',
    shows: ['@authorized'], controls: ['token'],
  },
];

export const stories = [...speechStories, ...lookStories, ...roomStories];
