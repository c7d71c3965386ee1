// SPDX-License-Identifier: MIT
/** What the Face Player says. */
export const words = {
  it: {
    title: 'Face Player', text: 'Testo', lang: 'Lingua', speakIt: 'Fallo dire', files: 'Apri .fap o .fapc, con suono e tempi',
    plots: 'Onda, spettro, suoni e curve', play: 'Avvia', pause: 'Pausa', frameBack: 'Un fotogramma indietro', frameOn: 'Un fotogramma avanti',
    loop: 'Ripeti', frame: 'Fotogramma', group: 'Gruppo di FAP', curve: 'Curva da modificare', value: 'Valore a questo fotogramma',
    editHint: 'Si trascinano i punti della curva; un doppio clic ne aggiunge o ne toglie uno; con Maiusc si disegna.', setKey: 'Metti il punto', dropKey: 'Togli il punto',
    smooth: 'Liscia', factor: 'Fattore', scale: 'Scala', mirror: 'Specchia', copyCurve: 'Copia la curva', pasteCurve: 'Incolla', undo: 'Annulla', redo: 'Rifai',
    save: 'Salva .fap',
    gestureTitle: 'Un gesto con un nome', gestureHint: 'Portate il fotogramma all’inizio e alla fine del tratto. Il file va nella cartella di facciad --gestures; il server lo salva dove è permesso (--editing).',
    stretchFrom: 'Qui comincia', stretchTo: 'Qui finisce', stretchIs: 'Fotogrammi {from}–{to}, {seconds} s', gestureGroups: 'Che cosa si muove',
    gestureName: 'Nome (a–z, 0–9, -)', gestureSave: 'Salva il gesto', gestureKeep: 'Salva sul server', gestureKept: 'Il gesto è sul server: i testi lo possono chiedere subito.', gestureMade: 'Il gesto è salvato.', noGesture: 'Il tratto è vuoto, troppo corto (3 fotogrammi) o troppo lungo (10 s).', nothingSpoken: 'Qui non è ancora stato detto nulla.', opened: '{name}: {n} fotogrammi, {fps} al secondo.',
    groups: ['', '', 'Mascella e labbra interne', 'Occhi', 'Sopracciglia', 'Guance', 'Lingua', 'Testa', 'Labbra esterne', 'Naso', 'Orecchie'],
  },
  pt: {
    title: 'Face Player', text: 'Texto', lang: 'Idioma', speakIt: 'Falar', files: 'Abrir .fap ou .fapc, com som e tempos',
    plots: 'Onda, espectro, sons e curvas', play: 'Iniciar', pause: 'Pausar', frameBack: 'Um quadro atrás', frameOn: 'Um quadro adiante',
    loop: 'Repetir', frame: 'Quadro', group: 'Grupo de FAPs', curve: 'Curva a editar', value: 'Valor neste quadro',
    editHint: 'Arraste os pontos da curva; um clique duplo põe ou tira um; com Shift desenha-se.', setKey: 'Pôr o ponto', dropKey: 'Tirar o ponto',
    smooth: 'Suavizar', factor: 'Fator', scale: 'Escalar', mirror: 'Espelhar', copyCurve: 'Copiar a curva', pasteCurve: 'Colar', undo: 'Desfazer', redo: 'Refazer',
    save: 'Salvar .fap',
    gestureTitle: 'Um gesto com nome', gestureHint: 'Leve o quadro ao começo e ao fim do trecho. O arquivo vai na pasta de facciad --gestures; o servidor o salva onde é permitido (--editing).',
    stretchFrom: 'Aqui começa', stretchTo: 'Aqui termina', stretchIs: 'Quadros {from}–{to}, {seconds} s', gestureGroups: 'O que se move',
    gestureName: 'Nome (a–z, 0–9, -)', gestureSave: 'Salvar o gesto', gestureKeep: 'Salvar no servidor', gestureKept: 'O gesto está no servidor: os textos já o podem pedir.', gestureMade: 'O gesto foi salvo.', noGesture: 'O trecho é vazio, curto demais (3 quadros) ou longo demais (10 s).', nothingSpoken: 'Nada foi dito aqui ainda.', opened: '{name}: {n} quadros, {fps} por segundo.',
    groups: ['', '', 'Mandíbula e lábios internos', 'Olhos', 'Sobrancelhas', 'Bochechas', 'Língua', 'Cabeça', 'Lábios externos', 'Nariz', 'Orelhas'],
  },
  tr: {
    title: 'Face Player', text: 'Metin', lang: 'Dil', speakIt: 'Söylet', files: '.fap ya da .fapc aç, ses ve sürelerle',
    plots: 'Dalga, tayf, sesler ve eğriler', play: 'Başlat', pause: 'Duraklat', frameBack: 'Bir kare geri', frameOn: 'Bir kare ileri',
    loop: 'Yinele', frame: 'Kare', group: 'FAP öbeği', curve: 'Düzenlenecek eğri', value: 'Bu karedeki değer',
    editHint: 'Eğrinin noktaları sürüklenir; çift tıklama bir nokta koyar ya da kaldırır; Shift ile eğri çizilir.', setKey: 'Noktayı koy', dropKey: 'Noktayı kaldır',
    smooth: 'Yumuşat', factor: 'Çarpan', scale: 'Ölçekle', mirror: 'Aynala', copyCurve: 'Eğriyi kopyala', pasteCurve: 'Yapıştır', undo: 'Geri al', redo: 'Yinele',
    save: '.fap kaydet',
    gestureTitle: 'Adı olan bir jest', gestureHint: 'Kareyi bölümün başına ve sonuna getirin. Dosya facciad --gestures klasörüne konur; izin verilen yerde (--editing) sunucu kaydeder.',
    stretchFrom: 'Burada başlar', stretchTo: 'Burada biter', stretchIs: 'Kareler {from}–{to}, {seconds} s', gestureGroups: 'Ne kımıldar',
    gestureName: 'Ad (a–z, 0–9, -)', gestureSave: 'Jesti kaydet', gestureKeep: 'Sunucuya kaydet', gestureKept: 'Jest sunucuda: metinler onu hemen isteyebilir.', gestureMade: 'Jest kaydedildi.', noGesture: 'Bölüm boş, çok kısa (3 kare) ya da çok uzun (10 s).', nothingSpoken: 'Burada henüz bir şey söylenmedi.', opened: '{name}: {n} kare, saniyede {fps}.',
    groups: ['', '', 'Çene ve iç dudaklar', 'Gözler', 'Kaşlar', 'Yanaklar', 'Dil', 'Baş', 'Dış dudaklar', 'Burun', 'Kulaklar'],
  },
  en: {
    title: 'Face Player', text: 'Text', lang: 'Language', speakIt: 'Have it said', files: 'Open .fap or .fapc, with sound and times',
    plots: 'Wave, spectrum, sounds and curves', play: 'Play', pause: 'Pause', frameBack: 'One frame back', frameOn: 'One frame on',
    loop: 'Loop', frame: 'Frame', group: 'Group of FAPs', curve: 'Curve to edit', value: 'Value at this frame',
    editHint: 'Drag the points of the curve; a double click puts one, or takes one away; with Shift it is drawn.', setKey: 'Put the point', dropKey: 'Take the point away',
    smooth: 'Smooth', factor: 'Factor', scale: 'Scale', mirror: 'Mirror', copyCurve: 'Copy the curve', pasteCurve: 'Paste', undo: 'Undo', redo: 'Redo',
    save: 'Save .fap',
    gestureTitle: 'A gesture with a name', gestureHint: 'Bring the frame to the beginning and to the end of the stretch. The file goes into the folder of facciad --gestures; the server saves it where that is allowed (--editing).',
    stretchFrom: 'It begins here', stretchTo: 'It ends here', stretchIs: 'Frames {from}–{to}, {seconds} s', gestureGroups: 'What moves',
    gestureName: 'Name (a–z, 0–9, -)', gestureSave: 'Save the gesture', gestureKeep: 'Save on the server', gestureKept: 'The gesture is on the server: texts can ask for it at once.', gestureMade: 'The gesture is saved.', noGesture: 'The stretch is empty, too short (3 frames) or too long (10 s).', nothingSpoken: 'Nothing has been spoken here yet.', opened: '{name}: {n} frames, {fps} a second.',
    groups: ['', '', 'Jaw and inner lips', 'Eyes', 'Brows', 'Cheeks', 'Tongue', 'Head', 'Outer lips', 'Nose', 'Ears'],
  },
};

export const sample = { it: 'La mamma parla piano.', pt: 'A mamãe fala baixinho.', tr: 'Annem yavaşça konuşuyor.', en: 'My mother speaks softly.' };
