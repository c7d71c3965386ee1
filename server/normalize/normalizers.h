/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Puts numbers, dates, signs and abbreviations into words before a voice reads them. Text that its author
 * marked (say-as) follows the files of models/normalization; all other text follows those of
 * models/normalization/text. */
#ifndef FACCIA_NORMALIZE_NORMALIZERS_H
#define FACCIA_NORMALIZE_NORMALIZERS_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include "server/markup/score.h"
#include <jansson.h>

struct normalizer;
struct text_rules;
struct normalizers {
    struct normalizer **list;
    size_t count, cap;
    struct language_rules *rules; /* for running text */
    size_t rule_count, rule_cap;
};

/* Loads every *.json file of the folder; a missing folder counts as empty. Returns -1 with *e
 * ("bad-normalization") if a file is invalid; the message names the file. */
int normalizers_load(struct normalizers *normalizers, const char *folder, struct error *e);
void normalizers_free(struct normalizers *normalizers);

/* Reads a single file; release it with json_decref. Returns NULL with *e, whose field is the path of the
 * invalid value. */
json_t *normalizer_read(const char *path, struct error *e);

/* Finds the normalizer for the language of a BCP 47 tag, ignoring regions; NULL if there is none. */
const struct normalizer *normalizers_find(const struct normalizers *normalizers, const char *lang);

/* Appends the text in words of the language. way: a say_as of struct score_style. Returns false and
 * appends nothing if the text does not fit `way` or the language has no words for it. normalizer NULL: a
 * language without a file; succeeds only for texts that need none of its words. */
bool normalizer_words(const struct normalizer *normalizer, const char *way, const char *text,
                      struct buf *out);

/* Replaces the text of a script's item with say_as by words of lang, its voice's language. Letters to be
 * spelled stay, as voices know their names. If the text does not fit its say_as, it stays for the voice to
 * try, with a warning ("bad-value"). */
void normalizers_apply(const struct normalizers *normalizers, struct score *script, size_t item,
                       const char *lang);

/* Returns the rules for running text of a language (BCP 47), preferring those of its region. NULL: no
 * file; the text's letters are only composed. */
struct text_rules *normalizers_rules(const struct normalizers *normalizers, const char *lang);

/* Returns the abbreviations whose dot does not end a sentence in that language
 * (markup_rules.abbreviations). NULL: no file. */
const char *const *normalizers_abbreviations(const struct normalizers *normalizers, const char *lang);

/* Returns the words that tell where lines of verse run on (markup_rules.line_words). NULL: none. */
const char *const *normalizers_line_words(const struct normalizers *normalizers, const char *lang);

/* Puts a sentence's numbers, signs and abbreviations into words, in any markup. A second call does nothing.
 * Each item records which bytes of the input its words stand for (score_item.parts). langs: language of each
 * item of the sentence, from its first. voices: voice of each, because texts of different voices are
 * normalised separately; NULL: one voice speaks all. */
void normalize_sentence(const struct normalizers *normalizers, struct score *script, size_t sentence,
                        const char *const *langs, const void *const *voices);

/* What has been reported of a text that arrives in pieces. Begins zeroed. */
struct unspoken_told {
    bool characters, directions, marks;
    uint8_t scripts[64]; /* bits by script (script_runs.h) */
};

/* Warns once ("unspoken") of the characters of a script that the stage leaves out although they may have
 * meant something (characters_unspoken), once of directional controls, and once of combining marks beyond
 * CHARACTERS_MARKS on a letter, with their number, at the first of them. told: the script is a piece of a
 * text; reports each kind only in its first piece, without the number. NULL: it is the whole text. */
void normalize_warn_unspoken(struct score *script, struct unspoken_told *told);

/* Normalises all sentences, spoken by one voice. langs: language of each item of the script. */
void normalize_script(const struct normalizers *normalizers, struct score *script, const char *const *langs);

#endif
