// SPDX-License-Identifier: MIT
// Shows a message in a browser that is too old for the page, instead of a dark screen. Written for any browser (ECMAScript 5).
(function (old) {
  if (!old) return;
  document.querySelector('#sign .text').textContent = {
    it: 'Questo browser è troppo vecchio per il volto. Serve Chrome 94, Firefox 93 o Safari 16.4, o uno più recente.',
    pt: 'Este navegador é antigo demais para o rosto. É preciso Chrome 94, Firefox 93 ou Safari 16.4, ou mais novo.',
    tr: 'Bu tarayıcı yüz için çok eski. Chrome 94, Firefox 93, Safari 16.4 ya da daha yenisi gerekir.',
    en: 'This browser is too old for the face. It takes Chrome 94, Firefox 93 or Safari 16.4, or a later one.'
  }[/^(it|pt|tr)/.test(navigator.language) ? navigator.language.slice(0, 2) : 'en'];
})(!(Array.prototype.at && Object.hasOwn && self.queueMicrotask && self.WebSocket && Element.prototype.replaceChildren));
