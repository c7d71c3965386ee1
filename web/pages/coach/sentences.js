// SPDX-License-Identifier: MIT
// Sentences to begin with, by language: short, with the sounds that differ most on the lips.
export const sentences = {
  it: ['La mamma beve un bicchiere di vino.', 'Buongiorno, vorrei un caffè, per favore.', 'Il fumo del fuoco sale piano.', 'Domani piove su tutta la pianura.'],
  en: ['My mother bought a pound of plums.', 'Good morning, I would like some coffee, please.', 'Five boys live near the river.', 'We will meet you at the station at noon.'],
  pt: ['A mamãe bebe um copo de vinho.', 'Bom dia, eu queria um café, por favor.', 'O fogo da fogueira sobe devagar.', 'Amanhã vai fazer sol na praia.'],
  tr: ['Annem bir bardak süt içiyor.', 'Günaydın, bir kahve istiyorum lütfen.', 'Babam pazardan elma ve üzüm aldı.', 'Yarın bütün gün yağmur yağacak.'],
  es: ['Mi madre bebe un vaso de vino.', 'Buenos días, quisiera un café, por favor.'],
  fr: ['Ma mère boit un verre d’eau.', 'Bonjour, je voudrais un café, s’il vous plaît.'],
  de: ['Meine Mutter trinkt ein Glas Wasser.', 'Guten Morgen, ich hätte gern einen Kaffee.'],
};

/** @param {string} tag BCP 47 @returns {string[]} */
export const sentencesOf = (tag) => sentences[tag.split('-')[0]] ?? [];
