/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Internals of the markup stage, shared by the readers of XML vocabularies. A vocabulary is a table of
 * elements; xml.c walks the document and calls the functions in the table. */
#ifndef FACCIA_MARKUP_MARKUP_READER_H
#define FACCIA_MARKUP_MARKUP_READER_H

#include "server/base/buf.h"
#include "server/markup/markup_rules.h"
#include "server/markup/passage.h"
#include <stdint.h>

enum {
    READER_DEPTH = 64,      /* nested elements */
    READER_ATTRIBUTES = 64, /* per element */
    READER_BYTES = 16 << 20,
    READER_SECONDS = 60,       /* longest pause, s */
    READER_ONE_BYTES = 1000,   /* longer replacement texts are cut into sentences */
    READER_PHONES_BYTES = 500, /* in one phoneme element */
};

struct markup_reader;
struct frame;
struct tag;

/* Properties of an element. */
enum {
    ELEMENT_BOUNDARY = 1, /* ends the sentence before it and after it */
    ELEMENT_SENTENCE = 2, /* one sentence, whatever punctuation it contains; implies ELEMENT_BOUNDARY */
    ELEMENT_SILENT = 4,   /* its content is metadata, neither read nor spoken */
};

struct element {
    const char *name; /* lower case; compared ignoring case */
    unsigned flags;
    void (*begin)(struct markup_reader *r, struct tag *tag); /* may be NULL */
    void (*end)(struct markup_reader *r, struct frame *frame);
    const char *ignored; /* known but without effect, which causes a warning: " a b "; may be NULL */
    const char *quiet;   /* need no action: " id version "; may be NULL */
};

struct vocabulary {
    const char *root;               /* root element; NULL: not a document of its own */
    const struct element *elements; /* sorted by name */
    size_t element_count;
    bool rootless;                   /* a document may consist of several elements and text, without a root */
    bool mute;                       /* text is spoken only inside elements that unmute it */
    bool quiet;                      /* unknown elements cause no warning */
    const struct vocabulary *spoken; /* its elements are allowed in spoken text, too; may be NULL */
    void (*common)(struct markup_reader *r,
                   struct tag *tag); /* reads attributes that any element may have; may be NULL */
    void (*mark)(struct markup_reader *r, size_t at,
                 const char *name); /* called for each mark; may be NULL */
    /* Called before the first element; when the score has all text, but its cues are unsorted; and at the
     * end, also after an error. May be NULL. */
    void (*open)(struct markup_reader *r, size_t root);
    void (*finish)(struct markup_reader *r);
    void (*close)(struct markup_reader *r);
};

extern const struct vocabulary apml_vocabulary, jsml_vocabulary, ssml_vocabulary, emotionml_vocabulary,
    bml_vocabulary, fml_vocabulary;

/* An open element. */
struct frame {
    const struct element *element; /* NULL = unknown */
    size_t at, inside;             /* bytes of the input: its start tag, and the end of that tag */
    struct score_style style;
    const struct score_style *kept;      /* copy of `style` in the score */
    size_t style_depth;                  /* depth of the element that set the style */
    const struct vocabulary *vocabulary; /* for its content */
    bool silent;
    bool mute;             /* its text is not spoken, but its elements are processed */
    bool captures;         /* its text is collected in the reader's `capture` */
    const char *value;     /* for the element's own functions; belongs to the score */
    size_t piece, flushes; /* of the passage, where its content begins */
    struct emotion {       /* for EmotionML's emotion */
        double activation, evaluation, intensity;
        bool is_placed; /* has coordinates */
        struct score_time duration, delay;
    } emotion;
};

/* A start tag; exists while its functions are called. */
struct tag {
    struct markup_reader *r;
    struct frame *frame;
    size_t at, bytes;        /* bytes of the input */
    const char **attributes; /* pairs of name and value */
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
    struct frame frames[READER_DEPTH + 1]; /* frames[0] stands for the document */
    size_t depth;
    struct buf capture;
    size_t end; /* byte of the end tag, while the element's end function runs */
    bool capturing;
    struct bml *bml; /* sync points and behaviours; NULL: the vocabulary has none */
    size_t audio;    /* depth of the outermost open audio element, in which no sentence ends; 0 = none */
};

/* Finds an element by name, with or without a namespace prefix; NULL if unknown. Where text is spoken
 * (mute = false), elements of the `spoken` vocabulary are known, too. */
const struct element *vocabulary_find(const struct vocabulary *vocabulary, bool mute, const char *name);

/* Errors: "bad-xml", "too-deep", "too-many-attributes" (line and column), "text-too-long". */
int xml_read(struct score *score, const char *text, size_t size, const struct vocabulary *vocabulary,
             const struct markup_rules *rules, struct error *e);

bool tag_has(const struct tag *tag, const char *name);

/* Returns an attribute's value and marks it as used; NULL if it is absent. */
const char *tag_take(struct tag *tag, const char *name);
/* Warns that the value of an attribute is invalid. why: a predicate such as "is not a number". */
void tag_bad(struct tag *tag, const char *name, const char *why);
void tag_warn(struct tag *tag, const char *name, enum error_code code, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Byte of the input where the attribute begins; if it is absent, where the tag begins. */
size_t tag_place(const struct tag *tag, const char *name);

/* Warn of unused attributes, and of entity references, which the parser drops. */
void tag_check_attributes(struct tag *tag);
void tag_check_references(struct tag *tag);

/* Takes the language from an attribute such as xml:lang. */
void reader_language(struct tag *tag, const char *attribute);

/* Adds a cue that spans the frame's element. The name is trimmed and converted to lower case. The pointer
 * is valid until the next cue is added. */
struct score_cue *reader_cue(struct markup_reader *r, struct frame *frame, size_t at, const char *kind,
                             const char *name);
/* Canonical name of an affect; an unknown name is returned unchanged. */
const char *reader_affect(const struct markup_reader *r, const char *name);
/* Adds a cue at this point of the text. */
struct score_cue *reader_point(struct markup_reader *r, size_t at, const char *kind, const char *name);

/* Adds a cue over the last word before this point. */
struct score_cue *reader_last_word(struct markup_reader *r, size_t at, const char *kind, const char *name);

/* Ends the current sentence. */
void reader_boundary(struct markup_reader *r);

/* Adds a pause. Warns at the attribute if it is negative or longer than READER_SECONDS. */
void reader_pause(struct tag *tag, const char *attribute, double seconds);

void reader_mark(struct markup_reader *r, size_t at, const char *name);

/* Collects the text inside the frame instead of speaking it. False if text is being collected already. */
bool reader_capture(struct markup_reader *r, struct frame *frame);
/* Ends the collection; call it in the frame's end function. The returned string is valid until the next
 * one. */
const char *reader_captured(struct markup_reader *r, struct frame *frame);
/* Speaks text in place of the content of a frame, at its end. */
void reader_say(struct markup_reader *r, const struct frame *frame, const char *text,
                const struct score_style *style);

/* Returns a copy that lives as long as the score. */
const char *reader_keep(struct markup_reader *r, const char *s);

/* Finds a name in the table, ignoring case and surrounding white space; NULL if it is absent. */
struct choice {
    const char *name;
    double value;
};
const struct choice *choice_find(const struct choice *choices, size_t count, const char *name);

/* Reads a number with a unit ("+10%", "1.5s", "-2st"). False if it is malformed. */
struct quantity {
    double number;
    bool relative; /* has a sign */
    char unit[8];  /* lower case; "" = none */
};
bool quantity_read(const char *text, struct quantity *q);
/* Reads a duration: "1.5s", "500ms", or a bare number, counted in units of `unit` seconds. */
bool quantity_seconds(const char *text, double unit, double *seconds);
/* Reads a bare number from min to max. */
bool quantity_plain(const char *text, double min, double max, double *number);

#endif
