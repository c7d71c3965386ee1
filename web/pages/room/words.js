// SPDX-License-Identifier: MIT
/** What the page of a room says. */
export const words = {
  it: {
    title: 'Il volto della stanza', full: 'Schermo intero', answers: 'Risposte', wake: 'Dorme. Toccare per svegliarla', stopHint: 'Toccare lo schermo per fermarla',
    offline: 'Non connessa', idle: 'Pronta', listening: 'Ascolta', thinking: 'Pensa', speaking: 'Parla', muted: 'Microfono spento', asleep: 'Dorme',
    blocked: 'Toccare lo schermo per sentire la voce', chosen: 'Risposta: {text}', noRoom: 'L’indirizzo deve nominare una stanza: room.html?room=cucina',
    consentTitle: 'Possiamo prendere appunti?', consentWhat: 'È uno studio. Si annota che cosa si dice qui e quali risposte sceglie.', consentFree: 'Può dire di no: tutto funziona lo stesso. Può cambiare idea quando vuole. Questo schermo non registra né voci né immagini.',
    consentYes: 'Sì, va bene', consentNo: 'No, grazie', noted: 'Si prendono appunti.', consentStop: 'Non più', declined: 'Va bene: di lei non si annota nulla.',
  },
  pt: {
    title: 'O rosto da sala', full: 'Tela cheia', answers: 'Respostas', wake: 'Dormindo. Toque para acordar', stopHint: 'Toque na tela para parar',
    offline: 'Sem conexão', idle: 'Pronta', listening: 'Ouvindo', thinking: 'Pensando', speaking: 'Falando', muted: 'Microfone desligado', asleep: 'Dormindo',
    blocked: 'Toque na tela para ouvir a voz', chosen: 'Resposta: {text}', noRoom: 'O endereço deve nomear uma sala: room.html?room=cozinha',
    consentTitle: 'Podemos tomar notas?', consentWhat: 'É um estudo. Anota-se o que se diz aqui e que respostas a pessoa escolhe.', consentFree: 'Pode dizer que não: tudo funciona igual. Pode mudar de ideia quando quiser. Esta tela não grava voz nem imagem.',
    consentYes: 'Sim, concordo', consentNo: 'Não, obrigado', noted: 'Estão sendo tomadas notas.', consentStop: 'Parar', declined: 'Tudo bem: nada sobre você é anotado.',
  },
  tr: {
    title: 'Odanın yüzü', full: 'Tam ekran', answers: 'Yanıtlar', wake: 'Uyuyor. Uyandırmak için dokunun', stopHint: 'Durdurmak için ekrana dokunun',
    offline: 'Bağlantı yok', idle: 'Hazır', listening: 'Dinliyor', thinking: 'Düşünüyor', speaking: 'Konuşuyor', muted: 'Mikrofon kapalı', asleep: 'Uyuyor',
    blocked: 'Sesi duymak için ekrana dokunun', chosen: 'Yanıt: {text}', noRoom: 'Adres bir oda söylemelidir: room.html?room=mutfak',
    consentTitle: 'Not alabilir miyiz?', consentWhat: 'Bu bir araştırma. Burada söylenenler ve seçtiğiniz yanıtlar yazılır.', consentFree: 'Hayır diyebilirsiniz: her şey aynı şekilde çalışır. Fikrinizi istediğiniz zaman değiştirebilirsiniz. Bu ekran ses ya da görüntü kaydetmez.',
    consentYes: 'Evet, olur', consentNo: 'Hayır, teşekkürler', noted: 'Not alınıyor.', consentStop: 'Artık alınmasın', declined: 'Peki: sizinle ilgili hiçbir şey yazılmıyor.',
  },
  en: {
    title: 'The face of the room', full: 'Full screen', answers: 'Answers', wake: 'Asleep. Touch to wake her', stopHint: 'Touch the screen to stop her',
    offline: 'Not connected', idle: 'Ready', listening: 'Listening', thinking: 'Thinking', speaking: 'Speaking', muted: 'Microphone off', asleep: 'Asleep',
    blocked: 'Touch the screen to hear the voice', chosen: 'Answer: {text}', noRoom: 'The address must name a room: room.html?room=kitchen',
    consentTitle: 'May we take notes?', consentWhat: 'This is a study. It is written down what is said here, and which answers you choose.', consentFree: 'You may say no: everything works just the same. You may change your mind at any time. This screen records neither voices nor pictures.',
    consentYes: 'Yes, I agree', consentNo: 'No, thank you', noted: 'Notes are taken.', consentStop: 'No more', declined: 'All right: nothing about you is written down.',
  },
};
