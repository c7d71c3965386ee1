// SPDX-License-Identifier: MIT
/** What the first page says, and a text to begin with in each of its languages. */
export const words = {
  it: {
    title: 'Una testa che parla', loading: 'Si carica la testa…', text: 'Testo da dire', lang: 'Lingua del testo', voice: 'Voce', automatic: 'Automatica',
    rate: 'Velocità', unit: '({n} parole al minuto)', speak: 'Parla', pause: 'Pausa', resume: 'Continua', stop: 'Ferma', repeat: 'Ripeti',
    hint: 'Ctrl + Invio: parla. Esc: ferma.', more: 'Altre scelte', markup: 'Tipo di testo', auto: 'Riconosciuto dal testo', plain: 'Testo semplice',
    room: 'Stanza', roomHint: 'Ciò che si dice in una stanza è visto e udito da tutti quelli che vi sono.', copyLink: 'Copia il link',
    linkCopied: 'Il link è stato copiato.', linkHere: 'Il link',
    transcript: 'Trascrizione', transcriptHint: 'Qui resta ciò che è stato detto. Premere una frase per riascoltarla.', toPlayer: 'Apri nel Face Player', copyText: 'Copia il testo', save: 'Scarica', clear: 'Svuota',
    who: 'Chi parla', male: 'uomo', female: 'donna',
    notHandedOn: 'Questo browser non conserva nulla per questa pagina: si può usare il Face Player con il testo.',
  },
  pt: {
    title: 'Uma cabeça que fala', loading: 'Carregando a cabeça…', text: 'Texto a dizer', lang: 'Idioma do texto', voice: 'Voz', automatic: 'Automática',
    rate: 'Velocidade', unit: '({n} palavras por minuto)', speak: 'Falar', pause: 'Pausar', resume: 'Continuar', stop: 'Parar', repeat: 'Repetir',
    hint: 'Ctrl + Enter: falar. Esc: parar.', more: 'Mais opções', markup: 'Tipo de texto', auto: 'Reconhecido pelo texto', plain: 'Texto simples',
    room: 'Sala', roomHint: 'O que se diz em uma sala é visto e ouvido por todos os que estão nela.', copyLink: 'Copiar o link',
    linkCopied: 'O link foi copiado.', linkHere: 'O link',
    transcript: 'Transcrição', transcriptHint: 'Aqui fica o que foi dito. Pressione uma frase para ouvi-la de novo.', toPlayer: 'Abrir no Face Player', copyText: 'Copiar o texto', save: 'Baixar', clear: 'Limpar',
    who: 'Quem fala', male: 'homem', female: 'mulher',
    notHandedOn: 'Este navegador não guarda nada para esta página: use o Face Player com o texto.',
  },
  tr: {
    title: 'Konuşan bir baş', loading: 'Baş yükleniyor…', text: 'Söylenecek metin', lang: 'Metnin dili', voice: 'Ses', automatic: 'Otomatik',
    rate: 'Hız', unit: '(dakikada {n} sözcük)', speak: 'Konuş', pause: 'Duraklat', resume: 'Devam et', stop: 'Dur', repeat: 'Tekrarla',
    hint: 'Ctrl + Enter: konuş. Esc: dur.', more: 'Diğer seçenekler', markup: 'Metnin türü', auto: 'Metinden anlaşılır', plain: 'Düz metin',
    room: 'Oda', roomHint: 'Bir odada söylenen, odadaki herkesçe görülür ve duyulur.', copyLink: 'Bağlantıyı kopyala',
    linkCopied: 'Bağlantı kopyalandı.', linkHere: 'Bağlantı',
    transcript: 'Döküm', transcriptHint: 'Söylenenler burada kalır. Yeniden duymak için bir cümleye basın.', toPlayer: 'Face Player’da aç', copyText: 'Metni kopyala', save: 'İndir', clear: 'Temizle',
    who: 'Kim konuşsun', male: 'erkek', female: 'kadın',
    notHandedOn: 'Bu tarayıcı bu sayfa için bir şey saklamıyor: Face Player metinle kullanılabilir.',
  },
  en: {
    title: 'A head that speaks', loading: 'Loading the head…', text: 'Text to speak', lang: 'Language of the text', voice: 'Voice', automatic: 'Automatic',
    rate: 'Speed', unit: '({n} words a minute)', speak: 'Speak', pause: 'Pause', resume: 'Go on', stop: 'Stop', repeat: 'Repeat',
    hint: 'Ctrl + Enter: speak. Esc: stop.', more: 'More choices', markup: 'Kind of text', auto: 'Known from the text', plain: 'Plain text',
    room: 'Room', roomHint: 'What is said in a room is seen and heard by all who are in it.', copyLink: 'Copy the link',
    linkCopied: 'The link was copied.', linkHere: 'The link',
    transcript: 'Transcript', transcriptHint: 'What was said stays here. Press a sentence to hear it again.', toPlayer: 'Open in the Face Player', copyText: 'Copy the text', save: 'Download', clear: 'Clear',
    who: 'Who speaks', male: 'man', female: 'woman',
    notHandedOn: 'This browser keeps nothing for this page: give the Face Player the text.',
  },
};

export const samples = {
  it: 'Nel mezzo del cammin di nostra vita mi ritrovai per una selva oscura, ché la diritta via era smarrita.',
  pt: 'Amor é fogo que arde sem se ver, é ferida que dói, e não se sente; é um contentamento descontente.',
  tr: 'Gelin tanış olalım, işi kolay kılalım, sevelim sevilelim, dünya kimseye kalmaz.',
  en: 'Shall I compare thee to a summer’s day? Thou art more lovely and more temperate.',
};
