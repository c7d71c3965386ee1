// SPDX-License-Identifier: GPL-3.0-or-later
// Sentences in each language for measuring lips. Written for this and used nowhere else, so that no table was tuned to them.
export const sentences = {
  it: [
    'Bruno ha perso il berretto in piazza.', 'Mia nonna impastava il pane ogni mattina.', 'Il vapore appanna i vetri della finestra.', 'Pochi bambini amano le verdure bollite.',
    'La barca affondò davanti al porto vecchio.', 'Vorrei un bicchiere di vino e un po\' di formaggio.', 'Prima di partire, chiudi bene la valigia.', 'Le farfalle volano sopra i fiori bianchi.',
    'Mamma mia, quanto pepe hai messo!', 'Il fabbro batte il ferro finché è caldo.', 'Un lampo illuminò la campagna per un attimo.', 'Beppe compra sempre le stesse scarpe.',
    'Febbraio è il mese più breve dell\'anno.', 'Possiamo fermarci a bere qualcosa?', 'Il profumo del basilico invade la cucina.', 'Quella penna blu non funziona più.',
    'Abbiamo aspettato l\'autobus per mezz\'ora.', 'La pioggia improvvisa rovinò la festa.', 'Ambra viveva in un palazzo del Settecento.', 'Provaci ancora, prima o poi vincerai.',
    'Il vento soffia forte tra i pini.', 'Ho imparato a suonare il violino da piccolo.', 'Ma perché piangi, bambina?', 'Fabio guidava piano sulla neve fresca.', 'Bevi il tuo tè prima che si raffreddi.',
  ],
  'pt-BR': [
    'Pedro bebeu um copo de água de coco.', 'A menina pulou a poça sem se molhar.', 'Minha mãe prepara o bolo para a festa.', 'O vento forte fechou a porta da varanda.',
    'Falamos baixo para não acordar o bebê.', 'Meu primo vive em Fortaleza há muito tempo.', 'O barco partiu antes do amanhecer.', 'Você pode abrir a janela, por favor?',
    'Bons amigos valem mais do que dinheiro.', 'A vaca e o bezerro pastam no campo.', 'Comprei pão, manteiga e um pouco de mel.', 'O filme acabou bem depois da meia-noite.',
    'Paulo perdeu o ônibus por um minuto.', 'Vamos embora, que a chuva vem aí.', 'A avó fez um vestido amarelo para Bia.', 'Nunca provei pimenta tão forte.',
    'Febre e tosse são sintomas comuns.', 'O pintor mistura o azul com o branco.', 'Bateram palmas até o fim da peça.', 'Muitas famílias moram perto do rio.',
    'Meu vizinho fala cinco idiomas.', 'Ela prefere viajar de trem.', 'A fábrica produz sapatos e bolsas.', 'Um passarinho pousou na minha mão.', 'Bebo café sem açúcar pela manhã.',
  ],
  tr: [
    'Babam pazardan bol bol meyve aldı.', 'Bu pencere bir türlü kapanmıyor.', 'Annem mutfakta börek pişiriyor.', 'Vapur iskeleden tam vaktinde ayrıldı.',
    'Küçük kız pembe bir balon istiyor.', 'Fırtına bütün gece devam etti.', 'Mavi boyayı duvara sürdüm.', 'Bize biraz peynir ve ekmek ver.',
    'Kitabımı otobüste unutmuşum.', 'Pembe ev yokuşun başında.', 'Yağmur birden bastırınca ıslandık.', 'Fevzi futbol oynamayı çok sever.',
    'Bebek mışıl mışıl uyuyor.', 'Her sabah parkta yürüyüş yaparım.', 'Müdür bey toplantıya geç kaldı.', 'Vişne reçeli kavanozda kalmamış.',
    'Köpekler kapının önünde havladı.', 'Bana bir bardak su verir misin?', 'Ablam üniversitede fizik okuyor.', 'Bahçedeki armutlar olgunlaştı mı?',
    'Film bitince hep birlikte çıktık.', 'Pamuk gibi bulutlar gökyüzünü kapladı.', 'Mevsimler ne kadar çabuk değişiyor.', 'Bu defa biz kazanacağız.', 'Kübra piyano dersi alıyor.',
  ],
  en: [
    'Bob spilled a pint of milk on the carpet.', 'My mother plants beans in the spring.', 'The ferry left before we arrived.', 'Five brave firemen climbed the tower.',
    'Put the blue map back on the shelf.', 'A warm breeze moved the curtains.', 'We never found the missing button.', 'Please pass me the apple pie.',
    'The farmer bought a pair of mules.', 'Fog covered the valley at dawn.', 'Both of them live above the pub.', 'The baby laughed at the funny puppet.',
    'Maybe the plumber can fix the pump.', 'He gave me a bunch of purple flowers.', 'Vivid dreams often vanish by morning.', 'The drummer kept a perfect beat.',
    'Bring your umbrella, it may rain.', 'I prefer black pepper on my potatoes.', 'The bus stopped at every village.', 'From the roof you can see the river.',
    'Move over and make some room.', 'They painted the fence last summer.', 'An old map hung above the sofa.', 'The problem seems simple enough.', 'Nobody believed the boy at first.',
  ],
};
