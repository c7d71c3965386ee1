/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Options of a reader, set by its caller. */
#ifndef FACCIA_MARKUP_MARKUP_RULES_H
#define FACCIA_MARKUP_MARKUP_RULES_H

#include "server/base/error.h"
#include "server/base/work/work_limit.h"
#include "server/markup/affects.h"
#include <stdbool.h>
#include <stddef.h>

/* How a text is cut into sentences and interpreted. */
struct markup_rules {
    /* Abbreviations of the language, without the final dot, lower case, NULL-terminated; may be NULL.
     * "?ecc" ends a sentence if a capital follows, "^ed" if one follows that is no initial; "+no" ends
     * none if a number follows; "#" means that numbers with a dot are ordinals. */
    const char *const *abbreviations;
    /* Words at the ends of lines of verse, lower case, NULL-terminated; may be NULL. A line runs on that ends
     * in "the", or before a line that begins with ">of"; before "|and" it pauses; "~ous": runs on if its last
     * word ends so and the next line begins with a word that is not listed; "=": or if the two words agree.
     */
    const char *const *line_words;
    const char *lang; /* language of the request (BCP 47); styles in it leave `lang` unset; may be NULL */
    size_t sentence_bytes; /* longer sentences are cut at , ; or : (0: PLAIN_SENTENCE_BYTES) */
    bool more;             /* the text is unfinished: more may follow (plain.h) */
    bool markdown;         /* recognise Markdown headings, list items and marked words */
    bool wrapped;          /* a line break is white space like any other, as in XML */
    bool markdown_out;     /* remove Markdown marks and emoji first; for complete plain texts */
    /* Returns the bytes of a sign at the beginning of s[0..n) that a lexicon says, so that it is not removed
     * with Markdown; 0 = none. NULL: none are kept. */
    size_t (*sign_said)(const void *lexicons, const char *lang, const char *s, size_t n);
    const void *sign_lexicons; /* its first argument */
    bool verse_pauses;         /* a line of verse without punctuation has a pause, if line_words ask for it */
    const struct affects *affects;       /* known affects; NULL: names stay unchanged */
    const struct speaker_runs *speakers; /* who speaks which part of a plain text; may be NULL */
    const struct language_runs *runs;    /* parts of a plain text in other languages; may be NULL */
    const char *const
        *lexicons; /* names that a text may give (SSML's lexicon), NULL-terminated; NULL: none */
    bool lenient;  /* no kind was stated: tags of a malformed document are left out, not an error */
    double paused; /* length of all pauses earlier in the text, s */
    void *context; /* for the functions of a caller's own vocabulary (pls.c) */
    struct work_limit *limit; /* ends reading with "cancelled" or "text-too-long"; may be NULL */
};

static inline bool markup_given_up(const struct markup_rules *rules) {
    return rules && work_limit_over(rules->limit);
}

/* Why reading was aborted: the code and a message. */
static inline const char *markup_why_given_up(const struct markup_rules *rules, enum error_code *code) {
    *code = rules->limit->late ? ERROR_TEXT_TOO_LONG : ERROR_CANCELLED;
    return rules->limit->late ? "reading it takes too long" : "it was cancelled";
}

#endif
