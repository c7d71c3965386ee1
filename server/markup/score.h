/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The score: what the markup stage hands on. It is the document, which no later stage changes; what they find
 * out (what an expression does to the voice, the words of a date, who can speak what) goes into a script,
 * which stands beside it and is the score that is spoken. A list of items in reading order, cut into
 * sentences; every item knows which bytes of the input it came from. All strings belong to the score. */
#ifndef FACCIA_MARKUP_SCORE_H
#define FACCIA_MARKUP_SCORE_H

#include "server/base/error.h"
#include "server/base/lines.h"
#include <stdbool.h>
#include <stddef.h>

enum score_kind {
    SCORE_TEXT,  /* text to be spoken in one style */
    SCORE_BREAK, /* a pause of `seconds` */
    SCORE_MARK,  /* a name to be reported when it is reached */
    SCORE_AUDIO, /* a sound file to be heard here */
};

enum score_emphasis { EMPHASIS_NONE, EMPHASIS_REDUCED, EMPHASIS_WEAK, EMPHASIS_MEDIUM, EMPHASIS_STRONG };

/* An emotion that the voice itself may know how to play (FACCIA_VOICE_EMOTION). */
struct score_emotion {
    const char *name; /* an affect of the expressions file; NULL = neutral */
    double intensity; /* 0..1 */
};

/* How a stretch is to be said. Factors multiply the voice's own value; 1 = unchanged.
 *
 * say_as is in one form for all markups, CLASS or CLASS:FORMAT, always one of these:
 *   characters                 letter by letter
 *   digits                     digit by digit
 *   cardinal, ordinal          a number, or its ordinal
 *   fraction                   "3/4"
 *   date, date:FORMAT          FORMAT: the order of d m y, as dmy mdy ymd ydm ym my md dm d m y
 *   time, time:FORMAT          FORMAT: hms hm h hms12 hms24
 *   duration                   "1:20" as a length of time
 *   telephone, currency, measure, name, address
 *   net:email, net:url */
struct score_style {
    const char *lang;  /* BCP 47; NULL = the request's */
    const char *voice; /* NULL = the request's; else as written: one name, or several by preference, spaced */
    const char *gender; /* of the voice: NULL = any, "male", "female", "neutral" */
    double rate, pitch, range, volume;
    enum score_emphasis emphasis;
    const char *say_as;   /* NULL, or how to read it */
    const char *phonemes; /* NULL, or IPA that replaces the text */
    struct score_emotion emotion;
};

/* What is to be shown, and heard in the voice, over a stretch: an affect, a performative, an emphasis... The
 * expressions file (models/expressions.json) tells how each looks and sounds. */
struct score_cue {
    const char
        *kind;          /* "affect", "performative", "certainty", "meta-cognitive", "belief-relation", "turn",
                           "emphasis", "pitch-accent", "boundary", "deictic", "adjectival", "signal", "gesture" */
    const char *name;   /* "joy", "warn", "LplusHstar"...: as the author wrote it, in lower case */
    size_t first, last; /* items [first, last); first == last: at the point before item first */
    size_t around;      /* the nearest cue before it that ends later, counted from 1; 0 = none */
    size_t at;          /* byte of the input where the author asked for it */
    double intensity;   /* 0..1 */
    double
        weight; /* the face's share in the mouth (omega of the Turkish thesis), 0..1; negative = not given */
    /* Its time: begins delay after the stretch, rises for onset, lasts duration in all, falls for offset at
     * its end. Delay and duration are seconds + share * (length of the stretch); seconds may be negative.
     * An onset or offset that is negative = not given: the expression's own. */
    struct score_time {
        double seconds, share;
    } delay, duration;
    double onset, offset; /* s */
    double clock;         /* of score.timed: when it begins, s from the beginning of the utterance */
};

/* A part of a text that a script says in other words: bytes of the words, and of the input that they stand
 * for. */
struct score_part {
    size_t offset, bytes; /* in the item's text */
    size_t start, end;    /* bytes of the input */
    bool verbatim;        /* the words are exactly input[start..end) */
    bool guess;           /* it may have been meant otherwise */
};

struct score_item {
    enum score_kind kind;
    size_t start, end; /* bytes of the input */
    const char *text; /* SCORE_TEXT: UTF-8; SCORE_MARK: the name; SCORE_AUDIO: what the author wrote as src */
    bool verbatim;    /* text is exactly input[start..end), so offsets inside it map one to one */
    const struct score_part *parts; /* SCORE_TEXT of a script: they cover the text, in order; NULL = all of it
                                       is one, from start to end */
    size_t part_count;
    double seconds;  /* SCORE_BREAK */
    size_t fallback; /* SCORE_AUDIO: so many items that follow it, in its sentence, are its alternate content:
                        left out when the sound is played, spoken when it cannot be */
    const struct score_style *style; /* never NULL */
};

/* Items first..first+count of a score: one sentence, the unit that flows through the stages. */
struct score_sentence {
    size_t first, count;
    size_t start, end; /* bytes of the input */
};

struct score {
    struct score_item *items;
    size_t item_count, item_cap;
    struct score_sentence *sentences;
    size_t sentence_count, sentence_cap;
    struct score_cue *cues; /* in the order of their beginnings; they may overlap and nest */
    size_t cue_count, cue_cap;
    struct score_cue *timed; /* cues at times instead of places, by their clocks: for the face alone */
    size_t timed_count, timed_cap;
    struct error *warnings; /* what was not acted on, with its line and column */
    size_t warning_count, warning_cap;
    const char *input; /* what was read, for the places of warnings: borrowed; NULL = not known */
    size_t input_size;
    struct lines lines;         /* of the input */
    struct score_block *blocks; /* owns strings and styles */
};

/* The style that changes nothing. */
extern const struct score_style score_plain_style;

struct score *score_new(void);
void score_free(struct score *score);

/* A score beside the document, the same at first, to be changed by those who find out more. Its strings and
 * styles that are as they were stay the document's, which has to outlive it. */
struct score *score_script(const struct score *document);

/* Copies that live as long as the score. */
const char *score_strndup(struct score *score, const char *s, size_t n);
const struct score_style *score_keep_style(struct score *score, const struct score_style *style);

const struct score_part *score_keep_parts(struct score *score, const struct score_part *parts, size_t count);

struct score_item *score_add(struct score *score, enum score_kind kind, size_t start, size_t end);

/* A cue with intensity 1, the whole stretch for its time, and nothing else given. kind is static; name is
 * copied. It begins at the item that is added next, and is empty. */
struct score_cue *score_add_cue(struct score *score, const char *kind, const char *name, size_t at);

/* The same at a time of the utterance; for `seconds`. NULL when there are SCORE_TIMED already. */
enum { SCORE_TIMED = 1000 };
struct score_cue *score_add_timed(struct score *score, const char *kind, const char *name, size_t at,
                                  double clock, double seconds);

/* Puts the cues in the order of their beginnings, leaves out, with a warning, what exceeds SCORE_CUES in a
 * sentence, and links them. To be called when all sentences and cues are there; and the linking alone when
 * some were taken out afterwards. */
enum { SCORE_CUES = 512 };
void score_order_cues(struct score *score);
void score_link_cues(struct score *score);

/* Index of the first cue that begins at that item or behind it. */
size_t score_cues_from(const struct score *score, size_t item);

/* What stands at that byte of the input is not acted on (or not as it was meant). code is static. At most
 * SCORE_WARNINGS are kept; the last then says that there were more ("more-warnings"). The input must still be
 * there. */
enum { SCORE_WARNINGS = 1000 };
void score_warn(struct score *score, size_t at, enum error_code code, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Shortens the pauses that go beyond SCORE_PAUSE_SENTENCE in a sentence, or beyond SCORE_PAUSE_TEXT together
 * with those that there were in the text before (paused), s; warns of each sentence where it does. */
enum { SCORE_PAUSE_SENTENCE = 120, SCORE_PAUSE_TEXT = 3600 };
void score_bound_pauses(struct score *score, double paused);
double score_pauses(const struct score *score); /* how long they are together, s */

/* Adds copies of the items, sentences and cues of another score, behind what is there. place tells where in
 * the input of this one a byte of the other's stands. */
void score_append(struct score *to, const struct score *from, size_t (*place)(const void *ctx, size_t byte),
                  const void *ctx);

/* Closes the sentence that began after the last closed one. Does nothing when it has no items. */
void score_end_sentence(struct score *score);

#endif
