/* SPDX-License-Identifier: GPL-3.0-or-later */
/* BML and FML: behaviours timed by sync points of the speech, by other behaviours or in seconds.
 * Behaviours and sync points are collected while the document is read. Once all text is in the score,
 * references are resolved and the behaviours become cues. */
#ifndef FACCIA_MARKUP_BML_H
#define FACCIA_MARKUP_BML_H

#include "server/markup/markup_reader.h"

/* A moment: `seconds` after an item of the score, or after the start of the utterance. */
struct bml_place {
    enum { BML_NOWHERE, BML_ITEM, BML_CLOCK } kind;
    size_t item;
    double seconds;
};

struct bml_sync { /* sync point of a speech */
    const char *speech, *name;
    size_t cue;   /* placeholder cue in the score, which tracks the position while the text is read */
    double clock; /* s from the start of the utterance; negative: at the cue */
};

/* Something to show; kind NULL: nothing. */
struct bml_sign {
    const char *kind, *name;
    double intensity;
};

enum { BML_SIGNS = 4 };
struct bml_behaviour {
    const char *id;
    size_t at;
    const char *start, *end; /* as written; NULL: not given */
    size_t start_at, end_at; /* bytes of the input, for warnings */
    struct bml_sign signs[BML_SIGNS];
    size_t sign_count;
    double intensity, usual; /* usual: length without an end, s; 0: until the text ends */
    bool is_boundary, is_speech;
    enum { BML_OPEN, BML_BUSY, BML_DONE } state;
    struct bml_place from, to;
};

struct bml_speech {     /* a speech element, from the outline */
    size_t at;          /* byte of its start tag */
    size_t description; /* byte of the description spoken instead of its text; 0: none */
    bool has_text;
};

struct bml {
    struct bml_sync *syncs;
    size_t sync_count, sync_cap;
    struct bml_behaviour *behaviours;
    size_t behaviour_count, behaviour_cap;
    struct bml_speech *speeches;
    size_t speech_count, speech_cap, next_speech;
    size_t *by_id; /* indices of the behaviours that have an id, sorted by it */
    size_t by_id_count;
    const char *speech; /* id of the open speech; NULL: none */
    bool spoke;         /* a speech has begun */
    size_t spoken;      /* byte of the description being spoken; 0: none */
};

/* Hooks for vocabularies with behaviours or sync points. */
void bml_open(struct markup_reader *r, size_t root);
void bml_finish(struct markup_reader *r);
void bml_close(struct markup_reader *r);

/* Adds a sync point at this place in the text. */
void bml_point(struct markup_reader *r, size_t at, const char *name);
void bml_begin_point(struct markup_reader *r, struct tag *tag); /* elements tm, sync and mark */

/* Adds a behaviour for the element and reads its times. The pointer is valid until the next call. */
struct bml_behaviour *bml_add(struct tag *tag, double usual);

/* bml_behaviour.c: elements shared with APML. */
void bml_begin_accent(struct markup_reader *r, struct tag *tag);
void bml_begin_boundary(struct markup_reader *r, struct tag *tag);
void bml_begin_other(struct markup_reader *r, struct tag *tag);
void bml_begin_gesture(struct markup_reader *r, struct tag *tag);

/* Elements of BML and FML only. */
void bml_begin_face(struct markup_reader *r, struct tag *tag);
void bml_begin_lexeme(struct markup_reader *r, struct tag *tag);
void bml_begin_facs(struct markup_reader *r, struct tag *tag);
void bml_begin_head(struct markup_reader *r, struct tag *tag);
void bml_begin_gaze(struct markup_reader *r, struct tag *tag);
void bml_begin_function(struct markup_reader *r, struct tag *tag);
void bml_begin_world(struct markup_reader *r, struct tag *tag);
void bml_end_reference(struct markup_reader *r, struct frame *frame);
void bml_end_intensity(struct markup_reader *r, struct frame *frame);

/* bml.c: determines the spoken text of each speech, which may be known only at its end. */
void bml_outline(struct markup_reader *r, size_t root);
/* Vocabulary for a description's type; NULL if that type cannot be spoken. */
const struct vocabulary *bml_description(const char *type);

/* bml_names.c: resolves names, ignoring case and treating "_" as "-". */
enum { BML_NAME = 64 };
void bml_show(struct bml_behaviour *behaviour, const char *kind, const char *name, double intensity);
void bml_plain_name(const char *name, char out[BML_NAME]);
void bml_show_lexeme(struct bml_behaviour *b, struct markup_reader *r, const char *name); /* of the face */
bool bml_show_gaze(struct bml_behaviour *b, const char *name); /* false: unknown target */
void bml_show_affect(struct bml_behaviour *b, struct markup_reader *r, const char *name);

#endif
