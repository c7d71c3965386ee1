/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The score: output of the markup stage. It is a list of items in reading order, divided into sentences;
 * every item knows which bytes of the input it came from. Later stages never change this document. They
 * write their findings (how an expression changes the voice, a date in words, who can speak what) to a
 * script, a second score, which is the one spoken. A score owns its strings. */
#ifndef FACCIA_MARKUP_SCORE_H
#define FACCIA_MARKUP_SCORE_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include "server/base/utf8.h"
#include <stdbool.h>
#include <stddef.h>

enum score_kind {
    SCORE_TEXT,  /* text spoken in one style */
    SCORE_BREAK, /* a pause of `seconds` */
    SCORE_MARK,  /* a name to report when it is reached */
    SCORE_AUDIO, /* a sound file to play */
};

enum score_emphasis { EMPHASIS_NONE, EMPHASIS_REDUCED, EMPHASIS_WEAK, EMPHASIS_MEDIUM, EMPHASIS_STRONG };

/* An emotion that the voice itself may be able to render (FACCIA_VOICE_EMOTION). */
struct score_emotion {
    const char *name; /* affect of the expressions file; NULL = neutral */
    double intensity; /* 0..1 */
};

/* Departure of a voice from its own quality, imposed on its samples (voice/voice_quality.h); all 0 = none. */
struct score_quality {
    double tilt;       /* dB per octave; negative: softer, positive: tenser */
    double aspiration; /* 0..1: share of breath in the energy of voiced sounds; 1 = a whisper */
    double jitter;     /* mean difference of successive periods, as a share of a period */
    double shimmer;    /* mean difference of successive peaks, dB */
    double flutter;    /* slow movement of the pitch, as a share of it */
    double tremor;     /* the same of the amplitude */
};

/* Greatest values that a text or an expression may ask for. */
#define QUALITY_TILT_MAX 6
#define QUALITY_JITTER_MAX 0.05
#define QUALITY_SHIMMER_MAX 3
#define QUALITY_FLUTTER_MAX 0.04
#define QUALITY_TREMOR_MAX 0.5

/* Adds share times more to *quality, within these limits. */
void score_quality_add(struct score_quality *quality, const struct score_quality *more, double share);
bool score_quality_equal(const struct score_quality *a, const struct score_quality *b);

/* How to say a stretch. Factors multiply the voice's own values; 1 = unchanged.
 *
 * say_as has one form for all markups, CLASS or CLASS:FORMAT:
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
    const char *lang;   /* BCP 47; NULL = the request's */
    const char *voice;  /* NULL = the request's; a name or several, by preference, space-separated */
    const char *gender; /* NULL = any, "male", "female", "neutral" */
    double rate, pitch, range, volume;
    enum score_emphasis emphasis;
    const char *say_as;   /* NULL = as usual */
    const char *phonemes; /* IPA that replaces the text, or NULL */
    const char *lexicons; /* names of lexicons to look words up in first (SSML's lookup), each followed by a
                             line end, by precedence; NULL = none */
    struct score_emotion emotion;
    struct score_quality quality;
};

/* Something to show, and hear in the voice, over a stretch: an affect, a performative, an emphasis... The
 * expressions file (models/expressions.json) defines how each looks and sounds. */
struct score_cue {
    const char
        *kind;          /* "affect", "performative", "certainty", "meta-cognitive", "belief-relation", "turn",
                           "emphasis", "pitch-accent", "boundary", "deictic", "adjectival", "signal", "gesture" */
    const char *name;   /* "joy", "warn", "lplushstar"...: as the author wrote it, in lower case */
    size_t first, last; /* items [first, last); first == last: the point before item first */
    size_t around;      /* 1 + index of the nearest earlier cue that ends later; 0 = none */
    size_t at;          /* position of its markup in the input, in bytes */
    double intensity;   /* 0..1 */
    double weight;      /* share of the expression in the mouth, 0..1; negative: unset (omega of the Turkish
                           thesis) */
    /* Timing. The cue begins `delay` after the start of the stretch, rises during `onset`, and lasts
     * `duration`, of which the last `offset` seconds are its fall. Delay and duration are `seconds`, which
     * may be negative, plus `share` times the length of the stretch. A negative onset or offset is unset:
     * the expression's own applies. */
    struct score_time {
        double seconds, share;
    } delay, duration;
    double onset, offset; /* s */
    double clock;         /* of score.timed: beginning, s from the start of the utterance */
};

/* A part of a text that the script rewords: a range of the new words, and the input that they replace. */
struct score_part {
    size_t offset, bytes; /* in the item's text */
    size_t start, end;    /* bytes of the input */
    bool verbatim;        /* the words are exactly input[start..end) */
    bool guess;           /* the author may have meant something else */
};

struct score_item {
    enum score_kind kind;
    size_t start, end;              /* bytes of the input */
    const char *text;               /* SCORE_TEXT: UTF-8; SCORE_MARK: its name; SCORE_AUDIO: src as written */
    bool verbatim;                  /* text is exactly input[start..end): offsets map one to one */
    bool given;                     /* the author wrote what to say in place of the text (sub) */
    const struct score_part *parts; /* of a script's text: cover it, in order; NULL: start to end */
    size_t part_count;
    double seconds;  /* SCORE_BREAK */
    size_t fallback; /* SCORE_AUDIO: number of items after it, in its sentence, that are its alternate
                        content: skipped if the sound plays, spoken if it cannot */
    const struct score_style *style; /* never NULL */
};

/* Items first..first+count of a score: one sentence, the unit that passes through the stages. */
struct score_sentence {
    size_t first, count;
    size_t start, end; /* bytes of the input */
    bool in_words;     /* of a script: its numbers and signs have been put into words */
};

struct score {
    struct score_item *items;
    size_t item_count, item_cap;
    struct score_sentence *sentences;
    size_t sentence_count, sentence_cap;
    struct score_cue *cues; /* sorted by beginning; they may overlap and nest */
    size_t cue_count, cue_cap;
    struct score_cue *timed; /* cues at times instead of items, sorted by clock; for the face only */
    size_t timed_count, timed_cap;
    struct error *warnings; /* input without effect, with line and column */
    size_t warning_count, warning_cap;
    const char *input; /* the text that was read, for placing warnings; borrowed; NULL = unknown */
    size_t input_size;
    struct lines lines;         /* of the input */
    struct score_block *blocks; /* owns strings and styles */
};

/* The default style. */
extern const struct score_style score_plain_style;

struct score *score_new(void);
void score_free(struct score *score);

/* Creates a script that begins as a copy of the document. It shares the document's strings and styles, so
 * the document must outlive it. */
struct score *score_script(const struct score *document);

/* Return copies that live as long as the score. */
const char *score_strndup(struct score *score, const char *s, size_t n);
const struct score_style *score_keep_style(struct score *score, const struct score_style *style);

const struct score_part *score_keep_parts(struct score *score, const struct score_part *parts, size_t count);

struct score_item *score_add(struct score *score, enum score_kind kind, size_t start, size_t end);

/* Adds an empty cue before the next item, with intensity 1 and the duration of its stretch; all else is
 * unset. kind must be static; name is copied. */
struct score_cue *score_add_cue(struct score *score, const char *kind, const char *name, size_t at);

/* Adds a cue at a time of the utterance instead. NULL if there are SCORE_TIMED already. */
enum { SCORE_TIMED = 1000 };
struct score_cue *score_add_timed(struct score *score, const char *kind, const char *name, size_t at,
                                  double clock, double seconds);

/* Sorts the cues by beginning, drops those beyond SCORE_CUES in a sentence, with a warning, and links them
 * (`around`). Call it when all sentences and cues have been added. After removing cues, call
 * score_link_cues alone. */
enum { SCORE_CUES = 512 };
void score_order_cues(struct score *score);
void score_link_cues(struct score *score);

/* Index of the first cue that begins at or after that item. */
size_t score_cues_from(const struct score *score, size_t item);

/* Warns that the input at byte `at` has no effect, or not the intended one. Keeps at most SCORE_WARNINGS;
 * the last one then says that there were more ("more-warnings"). score->input must still be valid. */
enum { SCORE_WARNINGS = 1000 };
void score_warn(struct score *score, size_t at, enum error_code code, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Shortens pauses that exceed SCORE_PAUSE_SENTENCE seconds in a sentence or, added to `paused` seconds
 * earlier in the text, SCORE_PAUSE_TEXT seconds. Warns once for each sentence concerned. */
enum { SCORE_PAUSE_SENTENCE = 120, SCORE_PAUSE_TEXT = 3600 };
void score_bound_pauses(struct score *score, double paused);
double score_pauses(const struct score *score); /* total length, s */

/* Appends copies of the items, sentences and cues of another score. place converts a byte of that score's
 * input to a byte of this one's. */
void score_append(struct score *to, const struct score *from, size_t (*place)(const void *ctx, size_t byte),
                  const void *ctx);

/* Offsets at which an item's text is split. */
struct score_cut {
    size_t item, at;
};

/* Cuts texts of a script in parts that become items of their own. Sentences, cues and what stands in for a
 * sound keep their stretch. cuts: ascending, none twice or at an end of its text. Returns the old index of
 * each new item; the caller frees it. */
size_t *score_cut(struct score *script, const struct score_cut *cuts, size_t count);

/* Ends the sentence that began after the previous one. Does nothing if it has no items. */
void score_end_sentence(struct score *score);

/* Prints a score for people, to show what a reader understood: a line for each sentence, its items indented
 * below it, then the cues. Positions are bytes of the input. Default values are omitted. score_dump.c */
void score_dump(const struct score *score, struct buf *out);

#endif
