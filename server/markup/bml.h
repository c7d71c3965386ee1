/* SPDX-License-Identifier: GPL-3.0-or-later */
/* BML and FML: behaviours whose times are given by the sync points of speech, by other behaviours or in
 * seconds. Behaviours and points are collected while the document is read; when all text is in the score, the
 * times are found and the behaviours become cues. */
#ifndef FACCIA_MARKUP_BML_H
#define FACCIA_MARKUP_BML_H

#include "server/markup/markup_reader.h"

/* A moment: at an item of the score, or on the utterance's clock; and so many seconds later. */
struct bml_place {
    enum { BML_NOWHERE, BML_ITEM, BML_CLOCK } kind;
    size_t item;
    double seconds;
};

struct bml_sync { /* a sync point of a speech */
    const char *speech, *name;
    size_t cue;   /* the score's cue that holds its place while the text is read */
    double clock; /* if that is 0 or more it is at that time instead */
};

/* A name that is shown: kind NULL = nothing. */
struct bml_sign {
    const char *kind, *name;
    double intensity;
};

enum { BML_SIGNS = 4 };
struct bml_behaviour {
    const char *id;
    size_t at;
    const char *start, *end; /* as written; NULL = not given */
    size_t start_at, end_at; /* where */
    struct bml_sign signs[BML_SIGNS];
    size_t sign_count;
    double intensity, usual; /* usual: its length when no end is given, s; 0 = until the text ends */
    bool is_boundary, is_speech;
    enum { BML_OPEN, BML_BUSY, BML_DONE } state;
    struct bml_place from, to;
};

struct bml_speech {     /* what the outline knows of a speech element */
    size_t at;          /* of its start tag */
    size_t description; /* of the description that is spoken instead of the text; 0 = none */
    bool has_text;
};

struct bml {
    struct bml_sync *syncs;
    size_t sync_count, sync_cap;
    struct bml_behaviour *behaviours;
    size_t behaviour_count, behaviour_cap;
    struct bml_speech *speeches;
    size_t speech_count, speech_cap, next_speech;
    size_t *by_id; /* behaviours, by their ids */
    size_t by_id_count;
    const char *speech; /* id of the one that is open; NULL = none */
    bool spoke;         /* a speech has begun */
    size_t spoken;      /* the description that is spoken; 0 = none */
};

/* Hooks of a vocabulary that has any of this. */
void bml_open(struct markup_reader *r, size_t root);
void bml_finish(struct markup_reader *r);
void bml_close(struct markup_reader *r);

/* A sync point here. */
void bml_point(struct markup_reader *r, size_t at, const char *name);
void bml_begin_point(struct markup_reader *r, struct tag *tag); /* the element tm or sync */

/* A behaviour of that element, with its times; the pointer is good until the next one. */
struct bml_behaviour *bml_add(struct tag *tag, double usual);

/* bml_behaviour.c: elements that APML has, too. */
void bml_begin_accent(struct markup_reader *r, struct tag *tag);
void bml_begin_boundary(struct markup_reader *r, struct tag *tag);
void bml_begin_other(struct markup_reader *r, struct tag *tag);
void bml_begin_gesture(struct markup_reader *r, struct tag *tag);

/* Further ones of BML and FML. */
void bml_begin_face(struct markup_reader *r, struct tag *tag);
void bml_begin_lexeme(struct markup_reader *r, struct tag *tag);
void bml_begin_facs(struct markup_reader *r, struct tag *tag);
void bml_begin_head(struct markup_reader *r, struct tag *tag);
void bml_begin_gaze(struct markup_reader *r, struct tag *tag);
void bml_begin_function(struct markup_reader *r, struct tag *tag);
void bml_begin_world(struct markup_reader *r, struct tag *tag);
void bml_end_reference(struct markup_reader *r, struct frame *frame);
void bml_end_intensity(struct markup_reader *r, struct frame *frame);

/* bml_outline.c: what of each speech is spoken, which may be known at its end only. */
void bml_outline(struct markup_reader *r, size_t root);
/* The vocabulary that a description's type stands for; NULL when it is none that is spoken. */
const struct vocabulary *bml_description(const char *type);

/* bml_names.c: what a name means. Written in any case, with "_" or "-". */
enum { BML_NAME = 64 };
void bml_show(struct bml_behaviour *behaviour, const char *kind, const char *name, double intensity);
void bml_plain_name(const char *name, char out[BML_NAME]);
void bml_show_lexeme(struct bml_behaviour *b, struct markup_reader *r, const char *name); /* of a face */
bool bml_show_gaze(struct bml_behaviour *b, const char *name); /* false when nobody knows where that is */
void bml_show_affect(struct bml_behaviour *b, struct markup_reader *r, const char *name);

#endif
