// SPDX-License-Identifier: MIT
/** What the operator's page says. */
export const words = {
  it: {
    title: 'Tavolo dell’operatore', room: 'Stanza', enter: 'Entra', kiosk: 'Apri il volto della stanza', said: 'Ciò che accade nella stanza',
    followers: 'Nella stanza: {n}', desks: 'Altri che operano: {n}', nobody: 'Nessuna stanza scelta', text: 'Testo da dire', speak: 'Di’', interrupt: 'Subito', later: 'In attesa', preview: 'Ascolta prima', stop: 'Ferma',
    choices: 'Domanda e risposte', choicesHint: 'Ha fame? | Sì | No: la domanda, poi le risposte, divise da |', offer: 'Offri', withdraw: 'Ritira',
    lang: 'Lingua', mood: 'Umore', neutral: 'neutro', state: 'Segno', repeat: 'Ripeti', slower: 'Più piano', faster: 'Più svelto', louder: 'Più forte', softer: 'Meno forte', globally: 'Per tutto ciò che segue',
    keys: 'Ctrl + Invio: di’. Esc: ferma. Fuori dai campi: R ripeti, S più piano, L più forte, 1–9 le battute.', queue: 'In attesa', queueHint: 'Qui aspetta ciò che si dirà dopo; si può ancora cambiare.',
    waits: 'Testo in attesa', up: 'Prima', down: 'Dopo', cancel: 'Togli', scene: 'Scena', edit: 'Cambia la scena', sceneText: 'Scena (JSON o CSV)', take: 'Prendi', openFile: 'Apri un file',
    saveCsv: 'Salva CSV', saveJson: 'Salva JSON', sceneHint: 'CSV: colonne id, text, variants (divise da |), mood, choices (testo > id, divise da |), next.', sceneTaken: 'La scena è stata presa.',
    badScene: 'La scena ha un errore: {place}', logCsv: 'Registro CSV', logJson: 'Registro JSON', idle: 'pronta', listening: 'ascolta', thinking: 'pensa', muted: 'microfono spento',
    sentence: '', chosen: 'Scelto:', chose: 'Offerto:', stated: 'Segno:', stopped: 'Fermata', refused: 'Rifiutato:', heard: '',
  },
  pt: {
    title: 'Mesa do operador', room: 'Sala', enter: 'Entrar', kiosk: 'Abrir o rosto da sala', said: 'O que acontece na sala',
    followers: 'Na sala: {n}', desks: 'Outros que operam: {n}', nobody: 'Nenhuma sala escolhida', text: 'Texto a dizer', speak: 'Dizer', interrupt: 'Já', later: 'Em espera', preview: 'Ouvir antes', stop: 'Parar',
    choices: 'Pergunta e respostas', choicesHint: 'Tem fome? | Sim | Não: a pergunta, depois as respostas, separadas por |', offer: 'Oferecer', withdraw: 'Retirar',
    lang: 'Idioma', mood: 'Humor', neutral: 'neutro', state: 'Sinal', repeat: 'Repetir', slower: 'Mais devagar', faster: 'Mais rápido', louder: 'Mais alto', softer: 'Mais baixo', globally: 'Para tudo o que segue',
    keys: 'Ctrl + Enter: dizer. Esc: parar. Fora dos campos: R repetir, S mais devagar, L mais alto, 1–9 as falas.', queue: 'Em espera', queueHint: 'Aqui espera o que será dito depois; ainda pode ser mudado.',
    waits: 'Texto em espera', up: 'Antes', down: 'Depois', cancel: 'Tirar', scene: 'Cena', edit: 'Mudar a cena', sceneText: 'Cena (JSON ou CSV)', take: 'Usar', openFile: 'Abrir um arquivo',
    saveCsv: 'Salvar CSV', saveJson: 'Salvar JSON', sceneHint: 'CSV: colunas id, text, variants (separadas por |), mood, choices (texto > id, separadas por |), next.', sceneTaken: 'A cena foi lida.',
    badScene: 'A cena tem um erro: {place}', logCsv: 'Registro CSV', logJson: 'Registro JSON', idle: 'pronta', listening: 'ouvindo', thinking: 'pensando', muted: 'microfone desligado',
    sentence: '', chosen: 'Escolhido:', chose: 'Oferecido:', stated: 'Sinal:', stopped: 'Parada', refused: 'Recusado:', heard: '',
  },
  tr: {
    title: 'Operatör masası', room: 'Oda', enter: 'Gir', kiosk: 'Odanın yüzünü aç', said: 'Odada olanlar',
    followers: 'Odada: {n}', desks: 'Diğer operatörler: {n}', nobody: 'Oda seçilmedi', text: 'Söylenecek metin', speak: 'Söyle', interrupt: 'Hemen', later: 'Beklet', preview: 'Önce dinle', stop: 'Dur',
    choices: 'Soru ve yanıtlar', choicesHint: 'Aç mısın? | Evet | Hayır: soru, sonra yanıtlar, | ile ayrılmış', offer: 'Sun', withdraw: 'Geri al',
    lang: 'Dil', mood: 'Duygu', neutral: 'yansız', state: 'İşaret', repeat: 'Tekrarla', slower: 'Daha yavaş', faster: 'Daha hızlı', louder: 'Daha yüksek', softer: 'Daha alçak', globally: 'Bundan sonrası için',
    keys: 'Ctrl + Enter: söyle. Esc: dur. Alanların dışında: R tekrarla, S daha yavaş, L daha yüksek, 1–9 replikler.', queue: 'Bekleyenler', queueHint: 'Sonra söylenecekler burada bekler; hâlâ değiştirilebilir.',
    waits: 'Bekleyen metin', up: 'Öne', down: 'Arkaya', cancel: 'Çıkar', scene: 'Sahne', edit: 'Sahneyi değiştir', sceneText: 'Sahne (JSON veya CSV)', take: 'Al', openFile: 'Dosya aç',
    saveCsv: 'CSV kaydet', saveJson: 'JSON kaydet', sceneHint: 'CSV: sütunlar id, text, variants (| ile ayrılmış), mood, choices (metin > id, | ile ayrılmış), next.', sceneTaken: 'Sahne alındı.',
    badScene: 'Sahnede hata var: {place}', logCsv: 'Kayıt CSV', logJson: 'Kayıt JSON', idle: 'hazır', listening: 'dinliyor', thinking: 'düşünüyor', muted: 'mikrofon kapalı',
    sentence: '', chosen: 'Seçilen:', chose: 'Sunulan:', stated: 'İşaret:', stopped: 'Durduruldu', refused: 'Reddedildi:', heard: '',
  },
  en: {
    title: 'Operator’s desk', room: 'Room', enter: 'Enter', kiosk: 'Open the face of the room', said: 'What happens in the room',
    followers: 'In the room: {n}', desks: 'Other operators: {n}', nobody: 'No room chosen', text: 'Text to say', speak: 'Say', interrupt: 'At once', later: 'Let it wait', preview: 'Hear it first', stop: 'Stop',
    choices: 'Question and answers', choicesHint: 'Are you hungry? | Yes | No: the question, then the answers, divided by |', offer: 'Offer', withdraw: 'Withdraw',
    lang: 'Language', mood: 'Mood', neutral: 'neutral', state: 'Sign', repeat: 'Repeat', slower: 'Slower', faster: 'Faster', louder: 'Louder', softer: 'Softer', globally: 'For all that follows',
    keys: 'Ctrl + Enter: say. Esc: stop. Outside the fields: R repeat, S slower, L louder, 1–9 the lines.', queue: 'Waiting', queueHint: 'What is said next waits here, and can still be changed.',
    waits: 'Text that waits', up: 'Earlier', down: 'Later', cancel: 'Take away', scene: 'Scene', edit: 'Change the scene', sceneText: 'Scene (JSON or CSV)', take: 'Take it', openFile: 'Open a file',
    saveCsv: 'Save CSV', saveJson: 'Save JSON', sceneHint: 'CSV: columns id, text, variants (divided by |), mood, choices (text > id, divided by |), next.', sceneTaken: 'The scene was taken.',
    badScene: 'The scene has an error: {place}', logCsv: 'Log CSV', logJson: 'Log JSON', idle: 'ready', listening: 'listening', thinking: 'thinking', muted: 'microphone off',
    sentence: '', chosen: 'Chosen:', chose: 'Offered:', stated: 'Sign:', stopped: 'Stopped', refused: 'Refused:', heard: '',
  },
};

export const scenes = {
  it: [['1', 'Buongiorno! Come va oggi?', 'Buongiorno! Ha dormito bene?', 'joy 0.5', 'Bene > 2 | Non tanto > 3'], ['2', 'Sono contenta di sentirlo.', '', 'joy 0.7', ''], ['3', 'Mi dispiace. Vuole che chiami qualcuno?', '', 'sorry-for 0.6', 'Sì | No, grazie']],
  pt: [['1', 'Bom dia! Como vai hoje?', 'Bom dia! Dormiu bem?', 'joy 0.5', 'Bem > 2 | Nem tanto > 3'], ['2', 'Fico feliz em saber.', '', 'joy 0.7', ''], ['3', 'Sinto muito. Quer que eu chame alguém?', '', 'sorry-for 0.6', 'Sim | Não, obrigado']],
  tr: [['1', 'Günaydın! Bugün nasılsınız?', 'Günaydın! İyi uyudunuz mu?', 'joy 0.5', 'İyiyim > 2 | Pek değil > 3'], ['2', 'Bunu duyduğuma sevindim.', '', 'joy 0.7', ''], ['3', 'Üzüldüm. Birini çağırayım mı?', '', 'sorry-for 0.6', 'Evet | Hayır, teşekkürler']],
  en: [['1', 'Good morning! How are you today?', 'Good morning! Did you sleep well?', 'joy 0.5', 'Well > 2 | Not so well > 3'], ['2', 'I am glad to hear it.', '', 'joy 0.7', ''], ['3', 'I am sorry. Shall I call somebody?', '', 'sorry-for 0.6', 'Yes | No, thank you']],
};
