// SPDX-License-Identifier: MIT
// What is on the site: pages that are written here (FOLDER/NAME.md), pages that are texts of the repository, whole or by
// sections, and pages that build.mjs generates. Every section of a text that is divided has to be on a page: the build
// fails otherwise.

/** A heading's anchor, as code hosts make it, so that a link works there and here. @param {string} text */
export const slug = (text) => text.toLowerCase().replace(/[^\p{L}\p{N}\s_-]/gu, '').trim().replace(/\s/g, '-');

const protocol = 'protocol/README.md';

/** Texts of the repository. `sections`: only these, by their headings; null is what stands before the first. */
export const included = {
  'home/mqtt': { from: 'protocol/mqtt.md' },
  'home/wyoming': { from: 'protocol/wyoming.md' },
  'home/linux-voice-assistant': { from: 'protocol/lva.md' },
  'home/screen-readers': { from: 'protocol/speech-dispatcher.md' },
  'library/protocol': { from: 'protocol/library.md' },
  'markup/elements': { from: 'protocol/markup.md' },
  'markup/expressions': { from: 'models/expressions.md' },
  'markup/gestures': { from: 'models/gestures/README.md' },
  'markup/reading': { from: 'models/normalization/README.md' },
  'voices/plugins': { from: 'server/plugins/README.md' },
  'voices/speech-packs': { from: 'models/speech/README.md' },
  'voices/boundaries': { from: 'models/boundaries.md' },
  'heads/making': { from: 'models/README.md' },
  'heads/lips': { from: 'models/lips.md' },
  'heads/avatars': { from: 'protocol/avatars.md' },
  'heads/model': { from: 'protocol/head-model.md' },
  'heads/pictures': { from: 'protocol/pictures.md' },
  'heads/arkit': { from: 'protocol/arkit.md' },
  'heads/visemes': { from: 'protocol/visemes.md' },
  'operating/cluster': { from: 'server/packaging/cluster.md' },
  'operating/security': { from: 'SECURITY.md' },
  'start/scripting': { from: 'protocol/scripting.md' },
  'protocol/index': { from: protocol, sections: [null, 'Terms'], title: 'The protocol' },
  'protocol/websocket': { from: protocol, sections: ['WebSocket', 'Messages of the client', 'Messages of the server'], title: 'WebSocket' },
  'protocol/messages': { from: 'protocol/messages.md' },
  'protocol/control': { from: protocol, sections: ['Control', 'Text as it is written'], title: 'Control, and text as it is written' },
  'protocol/own-voice': { from: protocol, sections: ["Somebody's own voice"], title: 'A voice without a text' },
  'protocol/rooms': { from: protocol, sections: ['Rooms', 'Choices and states', 'Consent', 'Scenes', 'How words are said', 'Whose face it is', 'Recordings'], title: 'Rooms' },
  'protocol/plain-text': { from: protocol, sections: ['Plain text'], title: 'Plain text' },
  'protocol/access': { from: protocol, sections: ['Who may do what'], title: 'Tokens and rights' },
  'protocol/face': { from: protocol, sections: ['The living face'], title: 'The living face' },
  'protocol/media': { from: protocol, sections: ['Media chunks', 'Which form for whom', 'Compact chunks', 'Packed events'], title: 'Media' },
  'protocol/fapc': { from: 'protocol/fapc.md' },
  'protocol/http': { from: protocol, sections: ['HTTP', 'A text over HTTP', 'A text in a room', 'Errors and connections'], title: 'HTTP' },
  'protocol/engines': { from: protocol, sections: ['Engines'], title: 'Engines' },
  'protocol/errors': { from: protocol, sections: ['Error codes'], title: 'Error codes' },
  'protocol/limits': { from: protocol, sections: ['Limits'], title: 'Limits' },
  'protocol/rfc6455': { from: 'protocol/websocket.md' },
  'architecture/contributing': { from: 'CONTRIBUTING.md' },
  'architecture/fuzzing': { from: 'tests/fuzz/README.md' },
  'research/benchmarks': { from: 'tests/bench/README.md' },
  'research/hearing': { from: 'models/hear/README.md' },
  'research/faults': { from: 'tests/chaos/README.md' },
  'research/listening-tests': { from: 'models/stimuli/README.md' },
  changes: { from: 'CHANGELOG.md' },
};

/** The packages of npm that are in the site's scripts: the build compares. */
export const bundled = [
  '@vue/reactivity', '@vue/runtime-core', '@vue/runtime-dom', '@vue/shared', '@vueuse/core', '@vueuse/integrations', '@vueuse/shared', 'focus-trap', 'mark.js', 'minisearch', 'tabbable', 'vitepress',
];

/** Pages that build.mjs generates. */
export const generated = ['element/api', 'protocol/openapi', 'protocol/asyncapi', 'protocol/cli', 'operating/settings'];

const group = (text, ...items) => ({ text, collapsed: true, items: items.map(([name, link]) => ({ text: name, link: `/${link}` })) });

export const sidebar = [
  { ...group('Start', ['What faccia is', 'start/'], ['On a page', 'start/page'], ['In a kitchen', 'start/kitchen'], ['From a script', 'start/script'], ['In a portal', 'start/portal'],
    ['The pages', 'start/pages'], ['More scripts', 'start/scripting']), collapsed: false },
  group('The element', ['Use it', 'element/'], ['Attributes, methods, events', 'element/reference'], ['Types', 'element/api'], ['Reading the page', 'element/reading'],
    ['Voices without a text', 'element/listening'], ['Looks and captions', 'element/looks'], ['Avatars', 'element/avatars'], ['Pictures', 'element/pictures'], ['How it keeps time', 'element/time']),
  group('Frameworks', ['Plain HTML', 'frameworks/'], ['React', 'frameworks/react'], ['Vue', 'frameworks/vue'], ['Svelte', 'frameworks/svelte']),
  group('Home', ['Screens and desks', 'home/'], ['MQTT, Home Assistant', 'home/mqtt'], ['Wyoming', 'home/wyoming'], ['Linux Voice Assistant', 'home/linux-voice-assistant'], ['Screen readers', 'home/screen-readers']),
  group('Library', ['A library that speaks', 'library/'], ['Into your own site', 'library/embedding'], ['Over HTTP', 'library/protocol']),
  group('Markup', ['Mark up a text', 'markup/'], ['What each element does', 'markup/elements'], ['Expressions', 'markup/expressions'], ['Gestures', 'markup/gestures'], ['Numbers and dates', 'markup/reading'], ['Lexicons', 'markup/lexicons']),
  group('Voices', ['Choose a voice', 'voices/'], ['Plugins', 'voices/plugins'], ['Speech packs', 'voices/speech-packs'], ['Phone boundaries', 'voices/boundaries']),
  group('Heads', ['Choose a head', 'heads/'], ['Making heads', 'heads/making'], ["A speaker's own lips", 'heads/lips'], ['Heads as avatars', 'heads/avatars'], ['Head model', 'heads/model'],
    ['Sets of pictures', 'heads/pictures'], ['ARKit', 'heads/arkit'], ['Visemes', 'heads/visemes']),
  group('Operating', ['Run it', 'operating/'], ['Settings', 'operating/settings'], ['TLS', 'operating/tls'], ['Tokens', 'operating/tokens'], ['Packages', 'operating/packages'], ['Several daemons', 'operating/cluster'],
    ['Security', 'operating/security']),
  group('Protocol', ['Overview', 'protocol/'], ['WebSocket', 'protocol/websocket'], ['Members of messages', 'protocol/messages'], ['Control', 'protocol/control'], ['A voice without a text', 'protocol/own-voice'], ['Rooms', 'protocol/rooms'], ['Plain text', 'protocol/plain-text'],
    ['Tokens and rights', 'protocol/access'], ['The living face', 'protocol/face'], ['Media', 'protocol/media'], ['FAPC', 'protocol/fapc'], ['HTTP', 'protocol/http'], ['Engines', 'protocol/engines'], ['Error codes', 'protocol/errors'],
    ['Limits', 'protocol/limits'], ['RFC 6455', 'protocol/rfc6455'], ['HTTP reference (OpenAPI)', 'protocol/openapi'], ['Message reference (AsyncAPI)', 'protocol/asyncapi'], ['Command line', 'protocol/cli']),
  group('Architecture', ['The house', 'architecture/'], ['Glossary', 'architecture/glossary'], ['Contributing', 'architecture/contributing'], ['Fuzzing', 'architecture/fuzzing']),
  group('Research', ['Measured', 'research/'], ['Benchmarks', 'research/benchmarks'], ['Lips from sound', 'research/hearing'], ['Faults', 'research/faults'], ['Listening tests', 'research/listening-tests'], ['Sources and credits', 'research/credits']),
  { text: 'Changes', link: '/changes' },
];
