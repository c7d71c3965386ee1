// SPDX-License-Identifier: MIT
/** What the page says, by language. Affects that a language lacks are shown by their own name. */
export const words = {
  it: {
    title: 'Emozioni', text: 'Testo da dire', lang: 'Lingua', speak: 'Parla', stop: 'Ferma', emotion: 'Disco delle emozioni',
    affect: 'Una sola emozione', mixed: 'Mescolate', intensity: 'Intensità', neutral: 'Neutra', markup: 'Come scriverla', copy: 'Copia',
    faps: 'Valori FAP del volto', name: 'Nome', value: 'Valore', slider: 'punto sul disco',
    hint: 'Trascinare il punto, o spostarlo con le frecce (Maiusc: a passi piccoli; Inizio: al centro). La direzione è l’emozione, la distanza dal centro l’intensità.',
    sample: 'Che cosa mi racconti oggi? Non me lo sarei mai aspettato.',
    affects: {
      joy: 'gioia', anger: 'rabbia', sadness: 'tristezza', fear: 'paura', disgust: 'disgusto', surprise: 'sorpresa', distress: 'angoscia',
      embarrassment: 'imbarazzo', 'happy-for': 'contentezza per altri', gloating: 'gongolare', resentment: 'risentimento', relief: 'sollievo',
      jealousy: 'gelosia', envy: 'invidia', 'sorry-for': 'dispiacere per altri', hope: 'speranza', satisfaction: 'soddisfazione',
      'fear-confirmed': 'timore avverato', disappointment: 'delusione', pride: 'orgoglio', shame: 'vergogna', reproach: 'rimprovero',
      liking: 'simpatia', disliking: 'antipatia', gratitude: 'gratitudine', gratification: 'compiacimento', remorse: 'rimorso', love: 'amore',
      hate: 'odio',
    },
  },
  en: {
    title: 'Emotions', text: 'Text to speak', lang: 'Language', speak: 'Speak', stop: 'Stop', emotion: 'Emotion disc',
    affect: 'One emotion alone', mixed: 'Mixed', intensity: 'Intensity', neutral: 'Neutral', markup: 'How to write it', copy: 'Copy',
    faps: 'FAP values of the face', name: 'Name', value: 'Value', slider: 'point on the disc',
    hint: 'Drag the point, or move it with the arrow keys (Shift: small steps; Home: to the middle). The direction is the emotion, the distance from the middle its intensity.',
    sample: 'What do you have to tell me today? I would never have expected that.',
    affects: { 'happy-for': 'happy for others', 'sorry-for': 'sorry for others', 'fear-confirmed': 'fear confirmed' },
  },
  pt: {
    title: 'Emoções', text: 'Texto a dizer', lang: 'Idioma', speak: 'Falar', stop: 'Parar', emotion: 'Disco das emoções',
    affect: 'Uma só emoção', mixed: 'Misturadas', intensity: 'Intensidade', neutral: 'Neutra', markup: 'Como escrevê-la', copy: 'Copiar',
    faps: 'Valores FAP do rosto', name: 'Nome', value: 'Valor', slider: 'ponto no disco',
    hint: 'Arraste o ponto, ou mova-o com as setas (Shift: passos pequenos; Home: ao centro). A direção é a emoção, a distância do centro a intensidade.',
    sample: 'O que você me conta hoje? Eu nunca teria esperado isso.',
    affects: {
      joy: 'alegria', anger: 'raiva', sadness: 'tristeza', fear: 'medo', disgust: 'nojo', surprise: 'surpresa', distress: 'aflição',
      embarrassment: 'embaraço', 'happy-for': 'contente por outros', gloating: 'regozijo', resentment: 'ressentimento', relief: 'alívio',
      jealousy: 'ciúme', envy: 'inveja', 'sorry-for': 'pena de outros', hope: 'esperança', satisfaction: 'satisfação',
      'fear-confirmed': 'temor confirmado', disappointment: 'decepção', pride: 'orgulho', shame: 'vergonha', reproach: 'reprovação',
      liking: 'simpatia', disliking: 'antipatia', gratitude: 'gratidão', gratification: 'contentamento', remorse: 'remorso', love: 'amor',
      hate: 'ódio',
    },
  },
  tr: {
    title: 'Duygular', text: 'Söylenecek metin', lang: 'Dil', speak: 'Konuş', stop: 'Dur', emotion: 'Duygu çarkı',
    affect: 'Tek bir duygu', mixed: 'Karışık', intensity: 'Şiddet', neutral: 'Nötr', markup: 'Nasıl yazılır', copy: 'Kopyala',
    faps: 'Yüzün FAP değerleri', name: 'Ad', value: 'Değer', slider: 'çark üzerindeki nokta',
    hint: 'Noktayı sürükleyin ya da ok tuşlarıyla taşıyın (Shift: küçük adımlar; Home: ortaya). Yön duygudur, ortadan uzaklık şiddetidir.',
    sample: 'Bugün bana ne anlatacaksın? Bunu hiç beklemezdim.',
    affects: {
      joy: 'sevinç', anger: 'öfke', sadness: 'üzüntü', fear: 'korku', disgust: 'iğrenme', surprise: 'şaşkınlık', distress: 'sıkıntı',
      embarrassment: 'utangaçlık', 'happy-for': 'başkası için sevinme', gloating: 'kıs kıs gülme', resentment: 'gücenme', relief: 'rahatlama',
      jealousy: 'kıskançlık', envy: 'haset', 'sorry-for': 'başkasına üzülme', hope: 'umut', satisfaction: 'tatmin',
      'fear-confirmed': 'gerçekleşen korku', disappointment: 'hayal kırıklığı', pride: 'gurur', shame: 'utanç', reproach: 'sitem',
      liking: 'hoşlanma', disliking: 'hoşlanmama', gratitude: 'minnet', gratification: 'hoşnutluk', remorse: 'pişmanlık', love: 'sevgi',
      hate: 'nefret',
    },
  },
};
