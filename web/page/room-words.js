// SPDX-License-Identifier: MIT
/** What the page of a room says. */
export const words = {
  it: {
    title: 'Il volto della stanza', full: 'Schermo intero', answers: 'Risposte', wake: 'Dorme. Toccare per svegliarla', stopHint: 'Toccare lo schermo per fermarla',
    offline: 'Non connessa', idle: 'Pronta', listening: 'Ascolta', thinking: 'Pensa', speaking: 'Parla', muted: 'Microfono spento',
    blocked: 'Toccare lo schermo per sentire la voce', chosen: 'Risposta: {text}', noRoom: 'L’indirizzo deve nominare una stanza: room.html?room=cucina',
  },
  pt: {
    title: 'O rosto da sala', full: 'Tela cheia', answers: 'Respostas', wake: 'Dormindo. Toque para acordar', stopHint: 'Toque na tela para parar',
    offline: 'Sem conexão', idle: 'Pronta', listening: 'Ouvindo', thinking: 'Pensando', speaking: 'Falando', muted: 'Microfone desligado',
    blocked: 'Toque na tela para ouvir a voz', chosen: 'Resposta: {text}', noRoom: 'O endereço deve nomear uma sala: room.html?room=cozinha',
  },
  tr: {
    title: 'Odanın yüzü', full: 'Tam ekran', answers: 'Yanıtlar', wake: 'Uyuyor. Uyandırmak için dokunun', stopHint: 'Durdurmak için ekrana dokunun',
    offline: 'Bağlantı yok', idle: 'Hazır', listening: 'Dinliyor', thinking: 'Düşünüyor', speaking: 'Konuşuyor', muted: 'Mikrofon kapalı',
    blocked: 'Sesi duymak için ekrana dokunun', chosen: 'Yanıt: {text}', noRoom: 'Adres bir oda söylemelidir: room.html?room=mutfak',
  },
  en: {
    title: 'The face of the room', full: 'Full screen', answers: 'Answers', wake: 'Asleep. Touch to wake her', stopHint: 'Touch the screen to stop her',
    offline: 'Not connected', idle: 'Ready', listening: 'Listening', thinking: 'Thinking', speaking: 'Speaking', muted: 'Microphone off',
    blocked: 'Touch the screen to hear the voice', chosen: 'Answer: {text}', noRoom: 'The address must name a room: room.html?room=kitchen',
  },
};
