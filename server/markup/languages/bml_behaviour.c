/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Maps the behaviours of BML and the functions of FML to expressions, gestures and movements. */
#include "server/base/mem.h"
#include "server/markup/languages/bml.h"
#include <stdio.h>
#include <string.h>
#include <strings.h>

/* Default length of a behaviour, s. */
#define SHORT 1.0

static void take_intensity(struct tag *tag, double *intensity) {
    static const char *const names[] = {"importance", "amount", "intensity"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const char *value = tag_take(tag, names[i]);
        if (value && !quantity_plain(value, 0, 1, intensity))
            tag_bad(tag, names[i], "is not from 0 to 1");
    }
}

struct bml_behaviour *bml_add(struct tag *tag, double usual) {
    struct bml *b = tag->r->bml;
    const char *id = tag_take(tag, "id"), *start = tag_take(tag, "start"), *end = tag_take(tag, "end");
    b->behaviours = mem_grow(b->behaviours, &b->behaviour_cap, b->behaviour_count + 1, sizeof *b->behaviours);
    struct bml_behaviour *behaviour = &b->behaviours[b->behaviour_count++];
    *behaviour = (struct bml_behaviour){.id = id ? reader_keep(tag->r, id) : "",
                                        .at = tag->at,
                                        .start = start ? reader_keep(tag->r, start) : NULL,
                                        .end = end ? reader_keep(tag->r, end) : NULL,
                                        .start_at = tag_place(tag, "start"),
                                        .end_at = tag_place(tag, "end"),
                                        .intensity = 1,
                                        .usual = usual};
    take_intensity(tag, &behaviour->intensity);
    return behaviour;
}

static void missing(struct tag *tag, const char *what) {
    score_warn(tag->r->score, tag->at, ERROR_MISSING_ATTRIBUTE, "<%s> has %s", tag->frame->element->name,
               what);
}

/* In the draft the element itself says what to show; in BML 1.0 its children do. */
void bml_begin_face(struct markup_reader *r, struct tag *tag) {
    struct bml_behaviour *b = bml_add(tag, SHORT);
    const char *lexeme = tag_take(tag, "lexeme"), *shape = tag_take(tag, "shape"), *au = tag_take(tag, "au");
    if (lexeme || shape)
        bml_show_lexeme(b, r, lexeme ? lexeme : shape);
    if (au) {
        char name[16] = "au";
        strncat(name, au, sizeof name - 3);
        bml_show_lexeme(b, r, name);
    }
}

/* Returns the enclosing face, or else adds a behaviour. */
static struct bml_behaviour *own_or_outer(struct tag *tag) {
    struct bml *b = tag->r->bml;
    const struct frame *outer = tag->frame - 1;
    bool part = outer->element && outer->element->begin == bml_begin_face && b->behaviour_count;
    return part ? &b->behaviours[b->behaviour_count - 1] : bml_add(tag, SHORT);
}

static void scale(struct tag *tag, struct bml_behaviour *b) {
    double amount = 1;
    take_intensity(tag, &amount);
    if (b->sign_count)
        b->signs[b->sign_count - 1].intensity *= amount;
}

void bml_begin_lexeme(struct markup_reader *r, struct tag *tag) {
    struct bml_behaviour *b = own_or_outer(tag);
    const char *lexeme = tag_take(tag, "lexeme");
    if (!lexeme) {
        missing(tag, "a lexeme");
        return;
    }
    bml_show_lexeme(b, r, lexeme);
    if (b->at != tag->at)
        scale(tag, b);
}

void bml_begin_facs(struct markup_reader *r, struct tag *tag) {
    struct bml_behaviour *b = own_or_outer(tag);
    const char *au = tag_take(tag, "au");
    double number;
    char name[16];
    if (!au || !quantity_plain(au, 1, 99, &number)) {
        missing(tag, "the number of an action unit in au");
        return;
    }
    snprintf(name, sizeof name, "au%d", (int)number);
    bml_show_lexeme(b, r, name);
    if (b->at != tag->at)
        scale(tag, b);
}

/* BML 1.0 uses a lexeme; the draft uses a type and a direction. */
void bml_begin_head(struct markup_reader *r, struct tag *tag) {
    struct bml_behaviour *b = bml_add(tag, SHORT);
    const char *lexeme = tag_take(tag, "lexeme"), *type = tag_take(tag, "type"),
               *direction = tag_take(tag, "direction"), *target = tag_take(tag, "target");
    char name[BML_NAME], whole[BML_NAME + 8];
    const char *what = lexeme ? lexeme : type;
    if (!what && !direction && target) {
        if (!bml_show_gaze(b, target))
            tag_bad(tag, "target", "is not something with a known position");
        return;
    }
    if (!what && !direction)
        return; /* a description may follow */
    bml_plain_name(what ? what : "orient", name);
    bool turns = !strcmp(name, "orient") || !strcmp(name, "rotate") || !strcmp(name, "direction");
    if (direction && (turns || !strcmp(name, "tilt"))) {
        char to[BML_NAME];
        bml_plain_name(direction, to);
        snprintf(whole, sizeof whole, "%s-%s", turns ? "head" : "tilt", to);
        bml_show(b, "signal", reader_keep(r, whole), 1);
    } else {
        bml_show(b, "signal", reader_keep(r, name), 1);
    }
}

void bml_begin_gaze(struct markup_reader *r, struct tag *tag) {
    (void)r;
    struct bml_behaviour *b = bml_add(tag, SHORT);
    const char *to = tag_take(tag, "offsetdirection"), *direction = tag_take(tag, "direction"),
               *target = tag_take(tag, "target");
    const char *where = to ? to : direction ? direction : target;
    if (where && !bml_show_gaze(b, where)) {
        b->sign_count = 0;
        tag_warn(tag,
                 to          ? "offsetdirection"
                 : direction ? "direction"
                             : "target",
                 ERROR_IGNORED, "unknown position '%.40s'", where);
    }
}

void bml_begin_function(struct markup_reader *r, struct tag *tag) {
    static const char *const kinds[][3] = {{"adjectival", "adjectival", "type"},
                                           {"backchannel", "turn", NULL},
                                           {"belief-relation", "belief-relation", "type"},
                                           {"certainty", "certainty", "type"},
                                           {"cognitive", "meta-cognitive", "type"},
                                           {"deictic", "deictic", "type"},
                                           {"meta-cognitive", "meta-cognitive", "type"},
                                           {"performative", "performative", "type"},
                                           {"turn", "turn", "type"},
                                           {"turnallocation", "turn", "type"}};
    const char *element = tag->frame->element->name, *affect = tag_take(tag, "affect");
    struct bml_behaviour *b = bml_add(tag, 0);
    const char *type = tag_take(tag, "type");
    if (!strcmp(element, "emotion")) {
        const char *name = type ? type : tag_take(tag, "name");
        if (name && *name)
            bml_show_affect(b, r, name);
        else
            missing(tag, "a type");
    }
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        if (strcmp(element, kinds[i][0]) != 0)
            continue;
        if (!kinds[i][2])
            bml_show(b, kinds[i][1], "backchannel", 1);
        else if (type && *type)
            bml_show(b, kinds[i][1], reader_keep(r, type), 1);
        else
            missing(tag, "a type");
    }
    if (affect && *affect)
        bml_show_affect(b, r, affect);
}

/* A reference to something in the world: the head points at it with its gaze. */
void bml_begin_world(struct markup_reader *r, struct tag *tag) {
    struct bml_behaviour *b = bml_add(tag, 0);
    const char *id = tag_take(tag, "ref_id");
    (void)tag_take(tag, "ref_type");
    if (id && *id)
        bml_show(b, "deictic", reader_keep(r, id), 1);
    else
        missing(tag, "the object it refers to in ref_id");
}

void bml_begin_accent(struct markup_reader *r, struct tag *tag) {
    struct bml_behaviour *b = bml_add(tag, 0.5);
    const char *type = tag_take(tag, "type"), *level = tag_take(tag, "level");
    bml_show(b, "pitch-accent", type && *type ? reader_keep(r, type) : "Hstar", 1);
    if (level && *level)
        bml_show(b, "emphasis", reader_keep(r, level), 1);
}

void bml_begin_boundary(struct markup_reader *r, struct tag *tag) {
    struct bml_behaviour *b = bml_add(tag, SHORT);
    const char *type = tag_take(tag, "type");
    bml_show(b, "boundary", type && *type ? reader_keep(r, type) : "LL", 1);
    b->is_boundary = true;
}

void bml_begin_other(struct markup_reader *r, struct tag *tag) {
    bml_add(tag, SHORT);
    score_warn(r->score, tag->at, ERROR_IGNORED, "<%s> is ignored: there is no body, only a head",
               tag->frame->element->name);
    tag->count = 0;
}

/* A gesture needs a lexeme, which the expressions file may know; the head has no hands to show others. */
void bml_begin_gesture(struct markup_reader *r, struct tag *tag) {
    const char *lexeme = tag_take(tag, "lexeme");
    char name[BML_NAME];
    if (!lexeme || !*lexeme) {
        bml_begin_other(r, tag);
        return;
    }
    bml_plain_name(lexeme, name);
    bml_show(bml_add(tag, SHORT), "gesture", reader_keep(r, name), 1);
}

/* Reads Greta's "affect=anger", "head=head_up" or "look_at", which replaces what the enclosing behaviour
 * shows. */
void bml_end_reference(struct markup_reader *r, struct frame *frame) {
    static const char *const kinds[] = {"performative", "certainty", "deictic", "adjectival", "emphasis"};
    if (!frame->captures)
        return;
    const char *text = reader_captured(r, frame), *equals = strchr(text, '='),
               *name = equals ? equals + 1 : text;
    struct bml_behaviour *b =
        r->bml->behaviour_count ? &r->bml->behaviours[r->bml->behaviour_count - 1] : NULL;
    size_t n = equals ? (size_t)(equals - text) : 0;
    if (!b || !*name)
        return;
    b->sign_count = 0;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (strlen(kinds[i]) == n && !strncasecmp(kinds[i], text, n)) {
            bool accent = !strcmp(kinds[i], "emphasis") && strcasestr(name, "star");
            char plain[BML_NAME];
            bml_plain_name(name, plain);
            bml_show(b, accent ? "pitch-accent" : kinds[i], reader_keep(r, plain), 1);
            return;
        }
    if (n == 6 && !strncasecmp(text, "affect", 6))
        bml_show_affect(b, r, name);
    else if ((n != 4 || strncasecmp(text, "gaze", 4) != 0) && strncasecmp(name, "look_", 5) != 0)
        bml_show_lexeme(b, r, name);
    else if (!bml_show_gaze(b, name))
        score_warn(r->score, frame->inside, ERROR_IGNORED, "unknown position '%.40s'", name);
}

void bml_end_intensity(struct markup_reader *r, struct frame *frame) {
    double intensity;
    if (!frame->captures)
        return;
    const char *text = reader_captured(r, frame);
    if (r->bml->behaviour_count && quantity_plain(text, 0, 1, &intensity))
        r->bml->behaviours[r->bml->behaviour_count - 1].intensity = intensity;
}
