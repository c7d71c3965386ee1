/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of the TEI reader share. */
#ifndef FACCIA_LIBRARY_TEI_INTERNAL_H
#define FACCIA_LIBRARY_TEI_INTERNAL_H

#include "server/library/readers.h"
#include "server/library/xml_walk.h"

enum tei_act {
    ACT_PASS, /* it is its content */
    ACT_UNKNOWN,
    ACT_SKIP,
    ACT_ROOT,
    ACT_HEADER,
    ACT_BODY,
    ACT_DIV,
    ACT_HEAD,
    ACT_PARAGRAPH,
    ACT_ITEM,
    ACT_GROUP,
    ACT_LINE,
    ACT_SPEECH,
    ACT_SPEAKER,
    ACT_STAGE,
    ACT_NOTE,
    ACT_EMPHASIS,
    ACT_FOREIGN,
    ACT_NAME,
    ACT_PAGE,
    ACT_COLUMN, /* and others that are no white space */
    ACT_BREAK,
    ACT_SPACE,
    ACT_GAP,
    ACT_CHOICE, /* one of its children is read */
    ACT_EXPANSION,
    ACT_SIGN, /* of an abbreviation: not read where it is expanded */
    ACT_WORD,
    ACT_POINT, /* punctuation */
    ACT_REFERENCE,
    ACT_FIGURE,
};

struct tei_frame {
    enum tei_act act;
    bool opened;            /* what it began is to be ended */
    bool foreign;           /* so is a stretch in another language */
    bool aside;             /* a stage direction in the line of a speech */
    unsigned child, chosen; /* CHOICE: children so far; the one that is read */
    size_t from;            /* REFERENCE: bytes of the block when it began */
    char lang[36];
};

enum { UNKNOWN_MAX = 32 };

/* What has to be known before the text is read: which child of each CHOICE, in their order, and which ids are
 * those of notes (sorted). */
struct tei_outline {
    unsigned *choices;
    size_t count, cap;
    char **notes;
    size_t note_count, note_cap;
};

struct tei {
    struct tei_frame frames[WORK_DEPTH_MAX + 1];
    struct builder *b;
    struct work_meta *meta;
    struct tei_outline outline;
    size_t choice;       /* so many have begun */
    struct buf capture;  /* of the header */
    char **wanted;       /* the meta that is being captured */
    unsigned capture_at; /* depth at which it began */
    unsigned names;      /* in it; one is taken */
    unsigned left_out;   /* of it: how many are open */
    char *first_date;    /* of the publication, where the source has none */
    unsigned skip, header, title_stmt, publication, source, bodies, divs; /* how many are open */
    unsigned asides, expansions, figures;                                 /* likewise */
    enum { AFTER_TEXT, AFTER_WORD, AFTER_POINT } after;                   /* what ended just now */
    bool joins;     /* it says that what follows joins it */
    bool text_lang; /* the work's language is that of its text */
    bool line;      /* a line of verse is open */
    bool told_reading;
    char *unknown[UNKNOWN_MAX];
    size_t unknown_count;
    bool is_tei;
};

/* tei_elements.c */
enum tei_act tei_act_of(const char *name);

/* tei_outline.c. What is wrong in the document the reading itself tells. */
void tei_outline_read(struct tei_outline *outline, const char *data, size_t size);
void tei_outline_free(struct tei_outline *outline);
bool tei_outline_has_note(const struct tei_outline *outline, const char *id);

/* tei_header.c */
void tei_header_start(struct tei *tei, const struct xml_walk *walk, const char *name,
                      const char **attributes);
void tei_header_text(struct tei *tei, const char *text, size_t size);
void tei_header_end(struct tei *tei, const struct xml_walk *walk, const char *name);

#endif
