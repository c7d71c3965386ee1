/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a text does not write in words becomes words, before any voice sees it: what its author marked
 * (say-as), by the files of models/normalization, and all else by those of models/normalization/text. */
#ifndef FACCIA_NORMALIZE_NORMALIZERS_H
#define FACCIA_NORMALIZE_NORMALIZERS_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include "server/base/work_limit.h"
#include "server/markup/score.h"
#include <jansson.h>

struct normalizer;
struct text_rules;
struct normalizers {
    struct normalizer **list;
    size_t count, cap;
    struct language_rules *rules; /* of running text */
    size_t rule_count, rule_cap;
};

/* Loads every *.json of the folder; without a folder there are none. -1 with *e ("bad-normalization") when
 * one is broken; the message names the file. */
int normalizers_load(struct normalizers *normalizers, const char *folder, struct error *e);
void normalizers_free(struct normalizers *normalizers);

/* One such file, to be released with json_decref. NULL with *e, whose field is the place in it. */
json_t *normalizer_read(const char *path, struct error *e);

/* For a BCP 47 tag: the same language, whatever its region; else NULL. */
const struct normalizer *normalizers_find(const struct normalizers *normalizers, const char *lang);

/* Text in the words of the language. way is a say_as of struct score_style. False when the text is not of
 * that kind, or the language has no words for it; then nothing is added. normalizer NULL = a language without
 * a file: what needs no words of it can be read. */
bool normalizer_words(const struct normalizer *normalizer, const char *way, const char *text,
                      struct buf *out);

/* Rewrites an item of a script, whose voice speaks lang. Letters to be spelled stay as they are: voices know
 * their names. What is not of the kind that its author says gets a warning ("bad-value"), and stays too, for
 * the voice to try. */
void normalizers_apply(const struct normalizers *normalizers, struct score *script, size_t item,
                       const char *lang);

/* How running text of that language (BCP 47) is read: of its region where that has rules of its own. NULL =
 * there is no file: its letters are composed, no more. */
struct text_rules *normalizers_rules(const struct normalizers *normalizers, const char *lang);

/* The short forms behind whose dot a sentence of that language goes on (markup_rules.abbreviations). NULL =
 * there is no file. */
const char *const *normalizers_abbreviations(const struct normalizers *normalizers, const char *lang);

/* The stage: says in words, whatever markup a text came in, what its author did not write in words. Each item
 * keeps the bytes of the input that each of its words stands for (score_item.parts). langs: of each item, the
 * language that it is spoken in; voices: who speaks each item, as texts of two voices are read apart; NULL =
 * the same voice speaks all. limit: ends it; may be NULL. */
void normalize_script(const struct normalizers *normalizers, struct score *script, const char *const *langs,
                      const void *const *voices, struct work_limit *limit);

#endif
