/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Internals of a language's rules: their storage, and how templates become words. */
#ifndef FACCIA_NORMALIZE_TEXT_RULES_INTERNAL_H
#define FACCIA_NORMALIZE_TEXT_RULES_INTERNAL_H

#include "server/base/buf.h"
#include "server/normalize/normalizers_internal.h"
#include "server/normalize/text_rules.h"

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>
#include <unicode/uregex.h>
#include <unicode/uset.h>
#include <uv.h>

enum {
    RULES_MAX = 1000,      /* per file */
    RULE_WINDOW = 300,     /* UTF-16 units that a rule may look at */
    RULE_FIRST = 0x400,    /* each unit below has a list of rules */
    RULE_GROUPS = 24,      /* per expression, including the whole match */
    RULE_DEPTH = 3,        /* nesting of templates that reread their match */
    RULE_TIME_LIMIT = 100, /* steps of ICU's matcher, each some 10,000 operations */
};

struct text_rule {
    URegularExpression *match; /* compiled when first tried, as that is slow; NULL before */
    UChar *pattern;            /* its source; NULL once compiled */
    int32_t pattern_size;
    bool any_case;
    USet *at;        /* possible first characters */
    USet *then;      /* possible characters after its initial letters; NULL = any */
    const char *say; /* template */
    bool joined;     /* its words attach to the adjacent word */
    bool inside;     /* may begin between a letter and a digit */
    bool guess;
    uint64_t text; /* number of the text last given to the expression */
};

struct text_rules {
    json_t *root;
    const char *locale;
    const json_t *tables;
    char **abbreviations, **line_words; /* NULL-terminated; the latter may be NULL */
    struct spellout *spellout;
    struct text_rule *rules;
    size_t rule_count;
    uint16_t *first[RULE_FIRST], *others; /* indices of rules, ended by UINT16_MAX */
    uv_mutex_t lock;                      /* matchers and number formats have state */
    uint64_t texts;
};

/* A matched rule whose template is being filled. Copies what its groups matched, as the expression may
 * match again when the template rereads a part. */
struct filling {
    struct text_rules *rules;
    struct text_rule *rule;
    int depth;
    /* applies the rules to a part of the match; the lock is held already */
    bool (*again)(struct text_rules *rules, const char *stretch, size_t size, int depth, struct said *said);
    char *groups[RULE_GROUPS];
};

/* rule_words.c: appends the words of a matched rule. False if a function of its template does not apply;
 * the text stays unchanged then. */
bool rule_words(struct filling *filling, struct buf *out);

/* text_rules.c: compiles the expression. False with a sentence in message (cap bytes). */
bool rule_compile(struct text_rule *rule, char *message, size_t cap);
void rules_make_lists(struct text_rules *rules); /* fills first and others */

/* Looks up a key in a table of the file: as it is, in lower case, then without its final dot. NULL if it
 * is missing. If the value is the key of an array in the table, that array is returned. */
const json_t *rules_look_up(const struct text_rules *rules, const char *table, const char *key);

/* Converts to lower case by the language's rules; freed by the caller. */
char *rules_lower(const struct text_rules *rules, const char *text);

/* Spells numbers in words, by ICU's rules for a language (CLDR) or by rules of the language's file. */

/* Not thread-safe: the owner must lock it. */
struct spellout;

/* Takes the member "spellout" of a language's file, which must outlive it. Returns NULL with a sentence in
 * message (cap bytes) if ICU rejects it. */
struct spellout *spellout_new(const json_t *spellout, char *message, size_t cap);
void spellout_free(struct spellout *spellout);

/* Appends a whole number (digits only) in words of a form: "cardinal", "cardinal-f", "ordinal"... False if
 * the form does not exist or the number is too large. */
bool spellout_whole(struct spellout *spellout, const char *form, const char *digits, struct buf *out);

/* Appends the name of each digit, separated by spaces. */
void spellout_digits(struct spellout *spellout, const char *digits, struct buf *out);

#endif
