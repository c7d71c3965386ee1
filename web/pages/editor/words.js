// SPDX-License-Identifier: MIT
/** What the markup editor says, and a text for it in each of its languages. */
export const words = {
  it: {
    title: 'Editor', text: 'Testo', hint: 'Selezionate delle parole, scegliete che cosa vale per esse. Ctrl + Invio: ascolta la selezione. Esc: ferma.',
    kind: 'Segno', value: 'Quale', put: 'Metti', lang: 'Lingua', hear: 'Ascolta la selezione', hearAll: 'Ascolta tutto', stop: 'Ferma',
    atOnce: 'Fa sentire subito ogni segno', marks: 'Segni', remove: 'Togli: {kind} {value}, «{words}»', codeTitle: 'Il testo marcato', markup: 'Linguaggio',
    save: 'Salva', file: 'Apri un testo', good: 'Il server capisce tutto.', warned: 'Il server segnala: {n}', unsaid: '{markup} non può dire: {what}.',
    workName: 'Nome nella biblioteca', workSave: 'Salva nella biblioteca', workOpen: 'Apri dalla biblioteca', workSaved: '{file} è nella biblioteca.',
    lost: 'Non conservati: {what}.', nothing: 'Selezionate prima delle parole.', affect: 'Affetto', emphasis: 'Enfasi', gaze: 'Sguardo', voice: 'Voce',
    pause: 'Pausa', gesture: 'Gesto', strong: 'forte', moderate: 'media', reduced: 'debole', left: 'a sinistra', right: 'a destra', up: 'in alto', down: 'in basso',
  },
  pt: {
    title: 'Editor', text: 'Texto', hint: 'Selecione palavras e escolha o que vale para elas. Ctrl + Enter: ouvir a seleção. Esc: parar.',
    kind: 'Marca', value: 'Qual', put: 'Pôr', lang: 'Idioma', hear: 'Ouvir a seleção', hearAll: 'Ouvir tudo', stop: 'Parar',
    atOnce: 'Ouvir logo cada marca', marks: 'Marcas', remove: 'Tirar: {kind} {value}, «{words}»', codeTitle: 'O texto marcado', markup: 'Linguagem',
    save: 'Salvar', file: 'Abrir um texto', good: 'O servidor entende tudo.', warned: 'O servidor avisa: {n}', unsaid: '{markup} não pode dizer: {what}.',
    workName: 'Nome na biblioteca', workSave: 'Salvar na biblioteca', workOpen: 'Abrir da biblioteca', workSaved: '{file} está na biblioteca.',
    lost: 'Não conservados: {what}.', nothing: 'Selecione primeiro algumas palavras.', affect: 'Afeto', emphasis: 'Ênfase', gaze: 'Olhar', voice: 'Voz',
    pause: 'Pausa', gesture: 'Gesto', strong: 'forte', moderate: 'média', reduced: 'fraca', left: 'à esquerda', right: 'à direita', up: 'para cima', down: 'para baixo',
  },
  tr: {
    title: 'Düzenleyici', text: 'Metin', hint: 'Sözcükleri seçin, onlar için ne geçerli olacağını belirtin. Ctrl + Enter: seçimi dinle. Esc: dur.',
    kind: 'İşaret', value: 'Hangisi', put: 'Koy', lang: 'Dil', hear: 'Seçimi dinle', hearAll: 'Hepsini dinle', stop: 'Dur',
    atOnce: 'Her işareti hemen dinlet', marks: 'İşaretler', remove: 'Kaldır: {kind} {value}, «{words}»', codeTitle: 'İşaretli metin', markup: 'İşaretleme dili',
    save: 'Kaydet', file: 'Metin aç', good: 'Sunucu her şeyi anlıyor.', warned: 'Sunucunun uyarıları: {n}', unsaid: '{markup} şunu söyleyemez: {what}.',
    workName: 'Kitaplıktaki adı', workSave: 'Kitaplığa kaydet', workOpen: 'Kitaplıktan aç', workSaved: '{file} kitaplıkta.',
    lost: 'Saklanmayanlar: {what}.', nothing: 'Önce sözcük seçin.', affect: 'Duygu', emphasis: 'Vurgu', gaze: 'Bakış', voice: 'Ses',
    pause: 'Duraklama', gesture: 'Jest', strong: 'güçlü', moderate: 'orta', reduced: 'zayıf', left: 'sola', right: 'sağa', up: 'yukarı', down: 'aşağı',
  },
  en: {
    title: 'Editor', text: 'Text', hint: 'Select words and choose what holds for them. Ctrl + Enter: hear the selection. Esc: stop.',
    kind: 'Mark', value: 'Which', put: 'Put', lang: 'Language', hear: 'Hear the selection', hearAll: 'Hear all', stop: 'Stop',
    atOnce: 'Hear each mark at once', marks: 'Marks', remove: 'Take away: {kind} {value}, “{words}”', codeTitle: 'The marked text', markup: 'Markup',
    save: 'Save', file: 'Open a text', good: 'The server understands all of it.', warned: 'The server warns: {n}', unsaid: '{markup} cannot say: {what}.',
    workName: 'Name in the library', workSave: 'Save into the library', workOpen: 'Open from the library', workSaved: '{file} is in the library.',
    lost: 'Not kept: {what}.', nothing: 'Select words first.', affect: 'Affect', emphasis: 'Emphasis', gaze: 'Gaze', voice: 'Voice',
    pause: 'Pause', gesture: 'Gesture', strong: 'strong', moderate: 'moderate', reduced: 'reduced', left: 'left', right: 'right', up: 'up', down: 'down',
  },
};

export const samples = {
  it: 'Buongiorno! Che bella sorpresa. Non me lo aspettavo davvero.',
  pt: 'Bom dia! Que bela surpresa. Eu não esperava mesmo.',
  tr: 'Günaydın! Ne güzel bir sürpriz. Gerçekten beklemiyordum.',
  en: 'Good morning! What a lovely surprise. I really did not expect it.',
};
