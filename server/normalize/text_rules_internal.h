/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The parts of a language's rules: how they are kept, and how a template becomes words. */
#ifndef FACCIA_NORMALIZE_TEXT_RULES_INTERNAL_H
#define FACCIA_NORMALIZE_TEXT_RULES_INTERNAL_H

#include "server/normalize/characters.h"
#include "server/normalize/spellout.h"
#include "server/normalize/text_rules.h"
#include <jansson.h>
#include <stdint.h>
#include <unicode/uregex.h>
#include <unicode/uset.h>
#include <uv.h>

enum {
    RULES_MAX = 1000,      /* in a file */
    RULE_WINDOW = 300,     /* UTF-16 units that a rule looks at */
    RULE_FIRST = 0x400,    /* units below have a list of rules each */
    RULE_GROUPS = 24,      /* in an expression, with the whole */
    RULE_DEPTH = 3,        /* templates that read what they matched again */
    RULE_TIME_LIMIT = 100, /* steps of ICU's matcher, each of some 10000 operations */
};

struct text_rule {
    URegularExpression *match; /* NULL until it is first tried, as making it takes long */
    UChar *pattern;            /* of it; NULL when it has been made */
    int32_t pattern_size;
    bool any_case;
    USet *at;        /* what it begins with */
    USet *then;      /* what follows the letters that it begins with; NULL = anything */
    const char *say; /* template */
    bool joined;     /* its words belong to the word beside them */
    bool inside;     /* it may begin between a letter and a digit */
    bool guess;
    uint64_t text; /* number of the text that the expression was given last */
};

struct text_rules {
    json_t *root;
    const char *locale;
    const json_t *tables;
    char **abbreviations; /* NULL-terminated */
    struct spellout *spellout;
    struct text_rule *rules;
    size_t rule_count;
    uint16_t *first[RULE_FIRST], *others; /* indexes of rules, ended by UINT16_MAX */
    uv_mutex_t lock;                      /* matchers and number formats keep a state */
    uint64_t texts;
};

/* A match whose template is filled. What its groups matched is copied, as the expression may match again
 * while the template reads a part of it. */
struct filling {
    struct text_rules *rules;
    struct text_rule *rule;
    int depth;
    /* says a part of the match again, by the rules; under the lock already */
    bool (*again)(struct text_rules *rules, const char *stretch, size_t size, int depth, struct said *said);
    char *groups[RULE_GROUPS];
};

/* rule_words.c: adds the words of a rule that has matched. False when a function of its template does not
 * apply, which leaves the text as it is. */
bool rule_words(struct filling *filling, struct buf *out);

/* text_rules.c: makes the expression from its pattern. False with a sentence in message (cap bytes). */
bool rule_compile(struct text_rule *rule, char *message, size_t cap);
void rules_make_lists(struct text_rules *rules); /* first, others */

/* In a table of the file: by the key as it is, in lower case, without a final dot. NULL when it is not there.
 * A value that is the name of another key stands for that one's. */
const json_t *rules_look_up(const struct text_rules *rules, const char *table, const char *key);

/* A text in lower case, as the language has it. */
char *rules_lower(const struct text_rules *rules, const char *text);

#endif
