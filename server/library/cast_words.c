/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sex and age by the words of a name or a description, without case and accents as words.h folds them. */
#include "server/library/cast.h"
#include "server/library/words.h"
#include <string.h>

/* Words in Italian, English, Portuguese, Turkish, French, German and Spanish, separated by spaces. */
static const char female[] =
    " donna donne dama signora signorina contessa marchesa duchessa principessa regina imperatrice "
    "locandiera ostessa "
    "serva cameriera fantesca balia moglie figlia sorella madre mamma zia nonna suocera nuora cognata vedova "
    "nipotina fanciulla ragazza bambina vecchia sposa monaca suora badessa strega dea ninfa pastora "
    "pastorella "
    "contadina padrona comica ballerina cantante lavandaia sarta fata comare madama cuoca prima "
    "lady queen empress mrs miss madam mistress duchess countess princess wife daughter sister mother aunt "
    "grandmother widow woman women girl maid nurse hostess gentlewoman witch goddess nymph shepherdess "
    "abbess nun "
    "dona senhora rainha condessa duquesa princesa mulher esposa filha irma mae tia avo viuva moca menina "
    "criada "
    "ama freira "
    "hanim hanimefendi kadin kiz kizi karisi annesi anne ablasi abla teyze hala nine gelin kralice prenses "
    "madame mademoiselle mme mlle reine femme fille soeur mere tante veuve suivante servante comtesse "
    "marquise "
    "duchesse "
    "frau fraulein konigin grafin herzogin prinzessin tochter schwester mutter witwe magd gattin "
    "senora reina hija hermana madre mujer viuda ";
static const char male[] =
    " don signor signore sior uomo conte marchese duca principe re imperatore servo servitore cameriere "
    "marito "
    "figlio fratello padre babbo zio nonno suocero genero cognato vedovo fanciullo ragazzo bambino vecchio "
    "sposo cavaliere capitano dottore mercante oste avvocato soldato messo frate sacerdote notaio garzone "
    "gondoliere barcaiolo padrone maestro pastore contadino calzolaio barbiere cuoco guardiano dio mago "
    "lord king emperor sir mr duke earl prince husband son brother father uncle grandfather man boy knight "
    "gentleman steward captain soldier friar bishop cardinal archbishop butler "
    "senhor rei conde duque principe marido filho irmao pai tio homem menino criado frei capitao "
    "bey efendi pasa aga adam oglan oglu kocasi babasi baba amca dayi dede usta kral sehzade "
    "monsieur roi comte marquis duc mari fils frere pere oncle valet chevalier "
    "herr konig kaiser graf herzog prinz sohn bruder vater onkel knecht diener hauptmann ritter mann "
    "senor rey hijo hermano hombre caballero ";
static const char old[] =
    " vecchio vecchia anziano anziana nonno nonna old aged grandfather grandmother velho velha "
    "idoso idosa avo yasli ihtiyar dede nine vieux vieille alt alter alte viejo vieja ";
static const char child[] =
    " bambino bambina fanciullino fanciullina bimbo bimba child boy girl page crianca menino "
    "menina cocuk enfant kind knabe nino nina ";

/* Given names in -a of men, and in -o or -e of women, whose ending would deceive. */
static const char men_in_a[] =
    " andrea luca nicola battista mattia elia gianluca tobia isaia geremia barnaba "
    "enea agrippa silla cinna galba seneca catilina giuda papa poeta duca ";
static const char women_in_o[] = " saffo dido calipso ero erato clio ino ";

static bool has(const char *list, const char *word) {
    const size_t size = strlen(word);
    for (const char *at = list; size && (at = strstr(at, word)); at += size)
        if (at[-1] == ' ' && at[size] == ' ')
            return true;
    return false;
}

enum person_sex cast_sex_of_words(const char *text) {
    struct word word;
    for (size_t at = 0; text && words_next(text, strlen(text), false, &at, &word);) {
        if (has(female, word.folded))
            return SEX_FEMALE;
        if (has(male, word.folded))
            return SEX_MALE;
    }
    return SEX_UNKNOWN;
}

enum person_sex cast_sex_of_name(const char *name, const char *lang) {
    struct word word, more;
    size_t at = 0;
    bool ends = !strncmp(lang, "it", 2) || !strncmp(lang, "pt", 2) || !strncmp(lang, "es", 2);
    if (!ends || !words_next(name, strlen(name), false, &at, &word) ||
        words_next(name, strlen(name), false, &at, &more) || strlen(word.folded) < 3)
        return SEX_UNKNOWN;
    const char last = word.folded[strlen(word.folded) - 1];
    if (has(men_in_a, word.folded))
        return SEX_MALE;
    if (has(women_in_o, word.folded))
        return SEX_FEMALE;
    return last == 'a' ? SEX_FEMALE : last == 'o' ? SEX_MALE : SEX_UNKNOWN;
}

enum cast_age cast_age_of_words(const char *text) {
    struct word word;
    for (size_t at = 0; text && words_next(text, strlen(text), false, &at, &word);) {
        if (has(old, word.folded))
            return AGE_OLD;
        if (has(child, word.folded))
            return AGE_CHILD;
    }
    return AGE_ADULT;
}
