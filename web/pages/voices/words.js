// SPDX-License-Identifier: MIT
/** What the page of the voices says, and a sentence for them in each of its languages. */
export const words = {
  it: {
    title: 'Voci', text: 'Frase da dire', lang: 'Lingua', all: 'Tutte di seguito', stop: 'Ferma', voices: 'Voci',
    hint: 'Le registrazioni dicono soltanto il proprio testo. Esc: ferma.', female: 'donna', male: 'uomo', neutral: '',
  },
  pt: {
    title: 'Vozes', text: 'Frase a dizer', lang: 'Idioma', all: 'Todas em seguida', stop: 'Parar', voices: 'Vozes',
    hint: 'As gravações dizem só o seu próprio texto. Esc: parar.', female: 'mulher', male: 'homem', neutral: '',
  },
  tr: {
    title: 'Sesler', text: 'Söylenecek cümle', lang: 'Dil', all: 'Hepsi sırayla', stop: 'Dur', voices: 'Sesler',
    hint: 'Kayıtlar yalnızca kendi metinlerini söyler. Esc: dur.', female: 'kadın', male: 'erkek', neutral: '',
  },
  en: {
    title: 'Voices', text: 'Sentence to speak', lang: 'Language', all: 'All in turn', stop: 'Stop', voices: 'Voices',
    hint: 'Recordings say their own text only. Esc: stop.', female: 'woman', male: 'man', neutral: '',
  },
};

export const samples = {
  it: 'Nel mezzo del cammin di nostra vita mi ritrovai per una selva oscura.',
  pt: 'Amor é fogo que arde sem se ver, é ferida que dói, e não se sente.',
  tr: 'Gelin tanış olalım, işi kolay kılalım, sevelim sevilelim.',
  en: 'Shall I compare thee to a summer’s day? Thou art more lovely.',
};
