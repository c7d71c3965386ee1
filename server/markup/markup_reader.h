/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inside of the markup stage: what the readers of XML vocabularies share. A vocabulary is a table of
 * elements; xml.c walks through the document and calls what the table says. */
#ifndef FACCIA_MARKUP_MARKUP_READER_H
#define FACCIA_MARKUP_MARKUP_READER_H

#include "server/base/buf.h"
#include "server/markup/markup_rules.h"
#include "server/markup/passage.h"
#include <stdint.h>

enum {
    READER_DEPTH = 64,      /* elements inside each other */
    READER_ATTRIBUTES = 64, /* of one element */
    READER_BYTES = 16 << 20,
    READER_SECONDS = 60, /* the longest pause */
    READER_ONE_BYTES =
        1000, /* what stands for something else and is longer is cut into sentences as any text is */
    READER_PHONES_BYTES = 500, /* of one phoneme element */
};

struct markup_reader;
struct frame;
struct tag;

/* What an element does besides calling its functions. */
enum {
    ELEMENT_BOUNDARY = 1, /* sentences end before and after it */
    ELEMENT_SENTENCE = 2, /* it is one sentence, whatever marks it holds; implies ELEMENT_BOUNDARY */
    ELEMENT_SILENT = 4,   /* its content is about the document, and neither read nor spoken */
};

struct element {
    const char *name; /* lower case; compared without regard to case */
    unsigned flags;
    void (*begin)(struct markup_reader *r, struct tag *tag); /* may be NULL */
    void (*end)(struct markup_reader *r, struct frame *frame);
    const char *ignored; /* attributes that are known and not acted on: " a b ", may be NULL */
    const char *quiet;   /* attributes that need no action: " id version ", may be NULL */
};

struct vocabulary {
    const char *root;               /* its root element; NULL = of a part of documents */
    const struct element *elements; /* sorted by name */
    size_t element_count;
    bool rootless;                   /* a document may be several elements, and text, without a root */
    bool mute;                       /* what is spoken stands inside elements that say so */
    bool quiet;                      /* unknown elements are passed over without a warning */
    const struct vocabulary *spoken; /* of what else may stand where text is spoken; may be NULL */
    void (*common)(struct markup_reader *r,
                   struct tag *tag); /* attributes that any element may have; may be NULL */
    void (*mark)(struct markup_reader *r, size_t at, const char *name); /* one is read; may be NULL */
    /* Before the first element; when all text is in the score, and before its cues are put in order; at the
     * end in any case. May be NULL. */
    void (*open)(struct markup_reader *r, size_t root);
    void (*finish)(struct markup_reader *r);
    void (*close)(struct markup_reader *r);
};

extern const struct vocabulary apml_vocabulary, jsml_vocabulary, ssml_vocabulary, emotionml_vocabulary,
    bml_vocabulary, fml_vocabulary;

/* An open element. */
struct frame {
    const struct element *element; /* NULL = not known */
    size_t at, inside;             /* bytes of the input: the start tag, and its end */
    struct score_style style;
    const struct score_style *kept;      /* the same, in the score */
    size_t style_depth;                  /* of the element that set it */
    const struct vocabulary *vocabulary; /* of what stands inside */
    bool silent;
    bool mute;             /* its text is not spoken; what stands inside is acted on */
    bool captures;         /* its text goes to the reader's capture */
    const char *value;     /* free for the element's functions; belongs to the score */
    size_t piece, flushes; /* of the passage: what comes inside begins here */
    struct emotion {       /* EmotionML, while an emotion is open */
        double activation, evaluation, intensity;
        bool is_placed; /* on the disc */
        struct score_time duration, delay;
    } emotion;
};

/* A start tag, while its functions are called. */
struct tag {
    struct markup_reader *r;
    struct frame *frame;
    size_t at, bytes;        /* of the tag in the input */
    const char **attributes; /* name, value... */
    size_t count;
    uint64_t taken;
};

struct markup_reader {
    struct score *score;
    const char *text;
    size_t size;
    const struct markup_rules *rules;
    const struct vocabulary *vocabulary;
    struct passage passage;
    struct frame frames[READER_DEPTH + 1]; /* frames[0] is the document */
    size_t depth;
    struct buf capture;
    size_t end; /* byte of the input: the end tag, in an element's end function */
    bool capturing;
    struct bml *bml; /* sync points and behaviours; NULL = the vocabulary has none */
    size_t audio;    /* depth of the outermost open audio element, 0 = none: no sentence ends in it */
};

/* The element of that name, with or without a namespace's prefix; NULL = not known. Where text is spoken
 * (mute = false), those of the vocabulary that may stand there count, too. */
const struct element *vocabulary_find(const struct vocabulary *vocabulary, bool mute, const char *name);

/* Errors: "bad-xml", "too-deep", "too-many-attributes" (line and column), "text-too-long". */
int xml_read(struct score *score, const char *text, size_t size, const struct vocabulary *vocabulary,
             const struct markup_rules *rules, struct error *e);

bool tag_has(const struct tag *tag, const char *name);

/* The value of an attribute, which counts as acted on from then; NULL when there is none of that name. */
const char *tag_take(struct tag *tag, const char *name);
/* Warns at the place of that attribute: its value cannot be acted on. why: "is no number". */
void tag_bad(struct tag *tag, const char *name, const char *why);
void tag_warn(struct tag *tag, const char *name, enum error_code code, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* The byte of the input where that attribute begins; the tag's when it is not there. */
size_t tag_place(const struct tag *tag, const char *name);

/* Warn of attributes that were not taken, and of references to entities, which vanish in the parser. */
void tag_check_attributes(struct tag *tag);
void tag_check_references(struct tag *tag);

/* The attributes of any vocabulary: xml:lang and its like. */
void reader_language(struct tag *tag, const char *attribute);

/* A cue over the element of the frame. The name is taken in lower case, without white space around it. The
 * pointer is good until the next cue. */
struct score_cue *reader_cue(struct markup_reader *r, struct frame *frame, size_t at, const char *kind,
                             const char *name);
/* The affect that the name means among those that the text can name; the name itself when there is none. */
const char *reader_affect(const struct markup_reader *r, const char *name);
/* A cue at this point of the text. */
struct score_cue *reader_point(struct markup_reader *r, size_t at, const char *kind, const char *name);

/* A cue over the last word before this point. */
struct score_cue *reader_last_word(struct markup_reader *r, size_t at, const char *kind, const char *name);

/* Closes the present sentence. */
void reader_boundary(struct markup_reader *r);

/* A pause; what is negative or longer than READER_SECONDS gets a warning at the attribute. */
void reader_pause(struct tag *tag, const char *attribute, double seconds);

void reader_mark(struct markup_reader *r, size_t at, const char *name);

/* The text inside the frame is collected instead of spoken. False when it already is. */
bool reader_capture(struct markup_reader *r, struct frame *frame);
/* Ends that, in the frame's end function. The text, ended by a NUL, until the next capture. */
const char *reader_captured(struct markup_reader *r, struct frame *frame);
/* Speaks text in place of what the frame, which ends, has inside. */
void reader_say(struct markup_reader *r, const struct frame *frame, const char *text,
                const struct score_style *style);

/* A copy that lives as long as the score. */
const char *reader_keep(struct markup_reader *r, const char *s);

/* The value in the table, without regard to case and to white space around it; NULL when it is not there. */
struct choice {
    const char *name;
    double value;
};
const struct choice *choice_find(const struct choice *choices, size_t count, const char *name);

/* A number with its unit ("+10%", "1.5s", "-2st"). False when it is none. */
struct quantity {
    double number;
    bool relative; /* has a sign */
    char unit[8];  /* lower case, "" = none */
};
bool quantity_read(const char *text, struct quantity *q);
/* A length of time: "1.5s", "500ms", or a number alone in `unit` seconds. */
bool quantity_seconds(const char *text, double unit, double *seconds);
/* A number from min to max, nothing else. */
bool quantity_plain(const char *text, double min, double max, double *number);

#endif
