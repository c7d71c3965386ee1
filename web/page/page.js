// SPDX-License-Identifier: MIT
const words = {
  it: {
    face: 'La testa', loading: 'Si carica la testa…', text: 'Testo da dire', lang: 'Lingua', rate: 'Velocità', speak: 'Parla',
    stop: 'Ferma', captions: 'Sottotitoli', hint: 'Ctrl + Invio: parla. Esc: ferma.', unit: '({n} parole al minuto)', emotions: 'Disco delle emozioni', voices: 'Confronto delle voci',
    connecting: 'Connessione…', open: 'Connesso', waiting: 'Non connesso, si riprova', closed: 'Non connesso',
    head: 'Testa: {title}. {credits}',
    'no-connection': 'Non c’è connessione con il server.', 'connection-lost': 'La connessione si è interrotta.',
    'empty-text': 'Non c’è nulla da dire.',
  },
  pt: {
    face: 'A cabeça', loading: 'Carregando a cabeça…', text: 'Texto a dizer', lang: 'Idioma', rate: 'Velocidade', speak: 'Falar',
    stop: 'Parar', captions: 'Legendas', hint: 'Ctrl + Enter: falar. Esc: parar.', unit: '({n} palavras por minuto)', emotions: 'Disco das emoções', voices: 'Comparação das vozes',
    connecting: 'Conectando…', open: 'Conectado', waiting: 'Sem conexão, nova tentativa', closed: 'Sem conexão',
    head: 'Cabeça: {title}. {credits}',
    'no-connection': 'Não há conexão com o servidor.', 'connection-lost': 'A conexão foi interrompida.',
    'empty-text': 'Não há nada a dizer.',
  },
  tr: {
    face: 'Baş', loading: 'Baş yükleniyor…', text: 'Söylenecek metin', lang: 'Dil', rate: 'Hız', speak: 'Konuş',
    stop: 'Dur', captions: 'Altyazılar', hint: 'Ctrl + Enter: konuş. Esc: dur.', unit: '(dakikada {n} sözcük)', emotions: 'Duygu çarkı', voices: 'Sesleri karşılaştır',
    connecting: 'Bağlanıyor…', open: 'Bağlı', waiting: 'Bağlantı yok, yeniden deneniyor', closed: 'Bağlantı yok',
    head: 'Baş: {title}. {credits}',
    'no-connection': 'Sunucuyla bağlantı yok.', 'connection-lost': 'Bağlantı kesildi.',
    'empty-text': 'Söylenecek bir şey yok.',
  },
  en: {
    face: 'The head', loading: 'Loading the head…', text: 'Text to speak', lang: 'Language', rate: 'Speed', speak: 'Speak',
    stop: 'Stop', captions: 'Captions', hint: 'Ctrl + Enter: speak. Esc: stop.', unit: '({n} words a minute)', emotions: 'Emotion disc', voices: 'Compare the voices',
    connecting: 'Connecting…', open: 'Connected', waiting: 'Not connected, trying again', closed: 'Not connected',
    head: 'Head: {title}. {credits}',
    'no-connection': 'There is no connection to the server.', 'connection-lost': 'The connection was lost.',
    'empty-text': 'There is nothing to say.',
  },
};

const samples = {
  it: 'Nel mezzo del cammin di nostra vita mi ritrovai per una selva oscura, ché la diritta via era smarrita.',
  pt: 'Amor é fogo que arde sem se ver, é ferida que dói, e não se sente; é um contentamento descontente.',
  tr: 'Gelin tanış olalım, işi kolay kılalım, sevelim sevilelim, dünya kimseye kalmaz.',
  en: 'Shall I compare thee to a summer’s day? Thou art more lovely and more temperate.',
};

const $ = (id) => document.getElementById(id);
const [head, form, text, lang, rate] = ['head', 'form', 'text', 'lang', 'rate'].map($);
let state = 'connecting';
let shown = null;

const primary = (tag) => tag.slice(0, 2);
const table = () => words[primary(lang.value)] ?? words.en;
const say = (name, values = {}) => table()[name].replace(/\{(\w+)\}/g, (_, key) => values[key]);

const nameOf = (tag) => {
  try {
    return new Intl.DisplayNames([tag, 'en'], { type: 'language' }).of(tag);
  } catch {
    return tag; // not of BCP 47
  }
};

function offer(languages, usual) {
  const chosen = lang.value || usual;
  lang.replaceChildren(...languages.map(({ tag, name }) => new Option(name, tag)));
  if (languages.some(({ tag }) => tag === chosen)) lang.value = chosen;
}

function translate() {
  document.documentElement.lang = text.lang = head.lang = lang.value;
  for (const element of document.querySelectorAll('[data-text]')) element.textContent = say(element.dataset.text);
  if (Object.values(samples).includes(text.value) || !text.value.trim()) text.value = samples[primary(lang.value)] ?? '';
  $('rate-value').value = say('unit', { n: rate.value });
  $('connection').dataset.state = state;
  $('connection').querySelector('.text').textContent = say(state);
  if (shown) $('credits').textContent = say('head', { title: shown.title, credits: shown.credits.join(' ') });
}

function speak() {
  $('problem').textContent = '';
  head.stop();
  head.speak(text.value, { lang: lang.value, rate: Number(rate.value) });
}

head.addEventListener('hello', ({ detail }) => {
  const more = (detail.more_languages ?? []).map((tag) => ({ tag, name: nameOf(tag) }));
  offer([...detail.languages, ...more.sort((a, b) => a.name.localeCompare(b.name))], detail.lang);
  translate();
});
head.addEventListener('connection', ({ detail }) => {
  state = detail.state;
  translate();
});
head.addEventListener('progress', ({ detail }) => {
  if (detail.ratio === null) $('progress').removeAttribute('value');
  else $('progress').value = detail.ratio;
});
head.addEventListener('ready', ({ detail }) => {
  $('loading').hidden = true;
  shown = detail;
  translate();
});
head.addEventListener('error', ({ detail }) => ($('problem').textContent = table()[detail.code] ?? detail.message));
head.addEventListener('begin', () => ($('problem').textContent = ''));

form.addEventListener('submit', (event) => {
  event.preventDefault();
  speak();
});
$('stop').addEventListener('click', () => head.stop());
$('captions').addEventListener('change', ({ target }) => (head.captions = target.checked));
lang.addEventListener('change', translate);
rate.addEventListener('input', translate);
document.addEventListener('keydown', (event) => {
  if (event.key === 'Escape') head.stop();
  if (event.key === 'Enter' && (event.ctrlKey || event.metaKey)) speak();
});

offer([
  { tag: 'it', name: 'Italiano' }, { tag: 'pt-BR', name: 'Português (Brasil)' }, { tag: 'tr', name: 'Türkçe' },
  { tag: 'en', name: 'English' },
]);
translate();
