// SPDX-License-Identifier: MIT
/** What the form for pronunciations says, on each page that has it. */
export const sayingsWords = {
  it: {
    sayings: 'Pronuncia di una parola', word: 'Parola', wordHint: 'Selezionatela nel testo, o scrivetela qui.', way: 'Pronunciala come', asText: 'un altro testo', asIpa: 'fonemi (IPA)',
    said: 'Come si dice', hearIt: 'Ascolta', place: 'Dove', inWork: 'in quest’opera', inLibrary: 'in tutta la biblioteca', inFile: 'in un file da scaricare', save: 'Dilla così',
    saved: '«{word}» si pronuncia così da adesso: {file}.', downloaded: 'Il file {file} è stato scaricato.', noWord: 'Indicate la parola.', noSaid: 'Scrivete come si dice.',
    badEntry: 'Così non si può dire: {message}', otherLang: 'Il lessico {file} è per un’altra lingua: {lang}.', brokenFile: 'Il lessico {file} non si può leggere.',
    report: 'Segnala come letta male', reported: 'Grazie: la segnalazione è arrivata.', noReports: 'Qui non si raccolgono segnalazioni.', tooMany: 'Troppe segnalazioni: riprovate fra un minuto.',
    reports: 'Segnalate dai lettori', noneReported: 'Nessuna segnalazione.', take: 'Correggi «{word}»', dismiss: 'Scarta la segnalazione di «{word}»', drop: 'Scarta',
  },
  pt: {
    sayings: 'Pronúncia de uma palavra', word: 'Palavra', wordHint: 'Selecione-a no texto ou escreva-a aqui.', way: 'Pronunciar como', asText: 'outro texto', asIpa: 'fonemas (IPA)',
    said: 'Como se diz', hearIt: 'Ouvir', place: 'Onde', inWork: 'nesta obra', inLibrary: 'em toda a biblioteca', inFile: 'em um arquivo para baixar', save: 'Dizer assim',
    saved: 'A partir de agora, «{word}» é dita assim: {file}.', downloaded: 'O arquivo {file} foi baixado.', noWord: 'Indique a palavra.', noSaid: 'Escreva como se diz.',
    badEntry: 'Assim não dá para dizer: {message}', otherLang: 'O léxico {file} é de outro idioma: {lang}.', brokenFile: 'O léxico {file} não pode ser lido.',
    report: 'Avisar que foi lida errado', reported: 'Obrigado: o aviso chegou.', noReports: 'Aqui não se recebem avisos.', tooMany: 'Avisos demais: tente de novo daqui a um minuto.',
    reports: 'Avisos dos leitores', noneReported: 'Nenhum aviso.', take: 'Corrigir «{word}»', dismiss: 'Descartar o aviso sobre «{word}»', drop: 'Descartar',
  },
  tr: {
    sayings: 'Bir sözcüğün söylenişi', word: 'Sözcük', wordHint: 'Metinde seçin ya da buraya yazın.', way: 'Şöyle söyle', asText: 'başka bir yazı', asIpa: 'sesbirimler (IPA)',
    said: 'Söylenişi', hearIt: 'Dinle', place: 'Nerede', inWork: 'bu eserde', inLibrary: 'bütün kitaplıkta', inFile: 'indirilecek bir dosyada', save: 'Böyle söyle',
    saved: '«{word}» artık böyle söyleniyor: {file}.', downloaded: '{file} dosyası indirildi.', noWord: 'Sözcüğü belirtin.', noSaid: 'Nasıl söylendiğini yazın.',
    badEntry: 'Böyle söylenemez: {message}', otherLang: '{file} sözlüğü başka bir dil için: {lang}.', brokenFile: '{file} sözlüğü okunamıyor.',
    report: 'Yanlış okunduğunu bildir', reported: 'Teşekkürler, bildiriminiz ulaştı.', noReports: 'Burada bildirim alınmıyor.', tooMany: 'Çok fazla bildirim oldu: bir dakika sonra yeniden deneyin.',
    reports: 'Okurların bildirdikleri', noneReported: 'Bildirim yok.', take: '«{word}» sözcüğünü düzelt', dismiss: '«{word}» bildirimini sil', drop: 'Sil',
  },
  en: {
    sayings: 'How a word is said', word: 'Word', wordHint: 'Select it in the text, or type it here.', way: 'Say it as', asText: 'another text', asIpa: 'phones (IPA)',
    said: 'How it is said', hearIt: 'Hear it', place: 'Where', inWork: 'in this work', inLibrary: 'in the whole library', inFile: 'in a file to download', save: 'Say it like this',
    saved: '“{word}” is said like this from now on: {file}.', downloaded: 'The file {file} was downloaded.', noWord: 'Name the word first.', noSaid: 'Type how it is said.',
    badEntry: 'It cannot be said like this: {message}', otherLang: 'The lexicon {file} is for another language: {lang}.', brokenFile: 'The lexicon {file} cannot be read.',
    report: 'Report it as misread', reported: 'Thank you: your report has arrived.', noReports: 'No reports are taken here.', tooMany: 'Too many reports: try again in a minute.',
    reports: 'Reported by readers', noneReported: 'Nothing has been reported.', take: 'Correct “{word}”', dismiss: 'Dismiss the report of “{word}”', drop: 'Dismiss',
  },
};
