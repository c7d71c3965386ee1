/* SPDX-License-Identifier: GPL-3.0-or-later */
/* APML: De Carolis, Pelachaud, Poggi, Steedman, "APML, a markup language for believable behavior
 * generation", in Prendinger and Ishizuka (eds.), Life-like Characters, Springer 2004, and its public DTD.
 * Documents that violate the DTD are read as far as possible. */
#include "server/markup/languages/bml.h"
#include "server/markup/languages/voqual.h"
#include "server/markup/styles.h"
#include <stdio.h>
#include <string.h>
#include <strings.h>

/* Timing attributes, which apply to all cues of an element. */
struct timing {
    struct score_time delay, duration;
    double intensity, onset, offset;
};

/* Reads seconds, or a percentage of the stretch. */
static bool read_time(const char *value, struct score_time *time) {
    struct quantity q;
    double seconds;
    if (!quantity_read(value, &q) || q.number < 0)
        return false;
    if (!strcmp(q.unit, "%")) {
        *time = (struct score_time){.share = q.number / 100};
        return q.number <= 1000;
    }
    if (!quantity_seconds(value, 1, &seconds) || seconds > READER_SECONDS)
        return false;
    *time = (struct score_time){.seconds = seconds};
    return true;
}

static void take_time(struct tag *tag, const char *attribute, struct score_time *time) {
    const char *value = tag_take(tag, attribute);
    if (value && !read_time(value, time))
        tag_bad(tag, attribute, "is neither seconds nor a percentage");
}

/* The DTD's default of 0 means that the expression decides. */
static void take_ramp(struct tag *tag, const char *attribute, double *seconds) {
    const char *value = tag_take(tag, attribute);
    double given;
    if (!value)
        return;
    if (!quantity_seconds(value, 1, &given) || given < 0 || given > READER_SECONDS)
        tag_bad(tag, attribute, "is not a time in seconds");
    else if (given > 0)
        *seconds = given;
}

static void take_intensity(struct tag *tag, double *intensity) {
    const char *value = tag_take(tag, "intensity");
    struct quantity q;
    if (!value)
        return;
    bool well = quantity_read(value, &q) && q.number >= 0;
    if (well && !strcmp(q.unit, "%"))
        q.number /= 100;
    else
        well = well && !*q.unit;
    if (!well || q.number > 1)
        tag_bad(tag, "intensity", "is not from 0 to 1");
    if (well)
        *intensity = q.number < 1 ? q.number : 1;
}

/* The DTD's default delay of 100 % can only mean no delay. Other percentages are shares of the stretch. */
static struct timing take_timing(struct tag *tag) {
    struct timing t = {.duration = {.share = 1}, .intensity = 1, .onset = -1, .offset = -1};
    take_time(tag, "duration", &t.duration);
    take_time(tag, "delay", &t.delay);
    if (t.delay.share == 1)
        t.delay.share = 0;
    take_intensity(tag, &t.intensity);
    take_ramp(tag, "onset", &t.onset);
    take_ramp(tag, "offset", &t.offset);
    return t;
}

static void set_timing(struct score_cue *cue, const struct timing *t) {
    cue->delay = t->delay;
    cue->duration = t->duration;
    cue->intensity = t->intensity;
    cue->onset = t->onset;
    cue->offset = t->offset;
}

static void cue(struct tag *tag, const char *kind, const char *name, const struct timing *t, double share) {
    struct score_cue *c = reader_cue(tag->r, tag->frame, tag->at, kind, name);
    set_timing(c, t);
    c->intensity *= share;
}

/* "complex:X_maskedby_Y": Y is shown and X leaks through. "complex:X_Y", "X_superposedto_Y": both are
 * shown. */
static void complex_affect(struct tag *tag, const char *name, const struct timing *t) {
    static const struct choice rules[] = {{"maskedby", 0.3},     {"masked-by", 0.3},    {"masked", 0.3},
                                          {"superposedto", 0.6}, {"superposedby", 0.6}, {"and", 0.6}};
    char parts[3][40] = {"", "", ""};
    int count = sscanf(name, "%39[^_]_%39[^_]_%39[^_]", parts[0], parts[1], parts[2]);
    if (count == 3) {
        const struct choice *rule = choice_find(rules, sizeof rules / sizeof *rules, parts[1]);
        bool masked = rule && rule->value == rules[0].value;
        if (!rule)
            tag_bad(tag, "affect", "joins affects with an unknown operator: both are shown");
        cue(tag, "affect", parts[0], t, masked ? rules[0].value : 0.6);
        cue(tag, "affect", parts[2], t, masked ? 1 : 0.6);
    } else if (count == 2) {
        bool inhibited = !strcasecmp(parts[1], "inhibited");
        cue(tag, "affect", parts[0], t, inhibited ? 0.3 : 0.6);
        if (!inhibited)
            cue(tag, "affect", parts[1], t, 0.6);
    } else {
        cue(tag, "affect", name, t, 1);
    }
}

/* Takes the mental state that performative, theme and rheme may express. */
static void take_mind(struct tag *tag, const struct timing *t) {
    static const char *const kinds[] = {"belief-relation", "certainty", "meta-cognitive"};
    const char *affect = tag_take(tag, "affect");
    if (affect && !strncasecmp(affect, "complex:", 8))
        complex_affect(tag, affect + 8, t);
    else if (affect && *affect)
        cue(tag, "affect", affect, t, 1);
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        const char *value = tag_take(tag, kinds[i]);
        if (value && *value)
            cue(tag, kinds[i], value, t, 1);
    }
}

static void begin_part(struct markup_reader *r, struct tag *tag) {
    (void)r;
    struct timing t = take_timing(tag);
    take_mind(tag, &t);
}

/* The APML of Festival's Italian voices (festlex-ifd, apml.dtd) has affects as elements. */
static void begin_affective(struct markup_reader *r, struct tag *tag) {
    struct timing t = take_timing(tag);
    const char *type = tag_take(tag, "type"), *level = tag_take(tag, "level");
    if (level && !quantity_plain(level, 0, 1, &t.intensity))
        tag_bad(tag, "level", "is not from 0 to 1");
    if (!type || !*type)
        score_warn(r->score, tag->at, ERROR_MISSING_ATTRIBUTE, "an affective needs a type");
    else
        cue(tag, "affect", type, &t, 1);
}

static void begin_performative(struct markup_reader *r, struct tag *tag) {
    (void)r;
    struct timing t = take_timing(tag);
    const char *type = tag_take(tag, "type");
    if (!type || !*type)
        score_warn(tag->r->score, tag->at, ERROR_MISSING_ATTRIBUTE, "a performative needs a type");
    else if (strcasecmp(type, "none") != 0)
        cue(tag, "performative", type, &t, 1);
    take_mind(tag, &t);
}

static void begin_turn(struct markup_reader *r, struct tag *tag) {
    static const struct choice types[] = {{"take", 0}, {"give", 0}};
    const char *type = tag_take(tag, "type");
    struct timing t = take_timing(tag);
    if (!type)
        score_warn(r->score, tag->at, ERROR_MISSING_ATTRIBUTE, "a turnallocation needs a type: take or give");
    else if (!choice_find(types, 2, type))
        tag_bad(tag, "type", "is neither take nor give");
    else
        cue(tag, "turn", type, &t, 1);
}

static void begin_backchannel(struct markup_reader *r, struct tag *tag) {
    (void)r;
    struct timing t = take_timing(tag);
    cue(tag, "turn", "backchannel", &t, 1);
    take_mind(tag, &t);
}

/* Without an explicit pitch accent, themes get L+H* and rhemes H* (Steedman 2000, "Information structure
 * and the syntax-phonology interface"). */
static void take_accent(struct tag *tag, const struct timing *t) {
    static const struct choice accents[] = {{"Hstar", 0},      {"Lstar", 0},      {"LplusHstar", 0},
                                            {"LstarplusH", 0}, {"HstarplusL", 0}, {"HplusLstar", 0}};
    static const struct choice types[] = {{"theme", 1}, {"rheme", 0}};
    const char *accent = tag_take(tag, "x-pitchaccent"), *type = tag_take(tag, "type");
    const struct choice *part = type ? choice_find(types, 2, type) : NULL;
    if (type && !part)
        tag_bad(tag, "type", "is neither theme nor rheme");
    if (accent && !choice_find(accents, sizeof accents / sizeof *accents, accent)) {
        tag_bad(tag, "x-pitchaccent", "is not a pitch accent");
        accent = NULL;
    }
    cue(tag, "pitch-accent", accent ? accent : part && part->value > 0 ? "LplusHstar" : "Hstar", t, 1);
}

static void begin_emphasis(struct markup_reader *r, struct tag *tag) {
    static const struct choice levels[] = {
        {"weak", EMPHASIS_WEAK}, {"medium", EMPHASIS_MEDIUM}, {"strong", EMPHASIS_STRONG}};
    static const char *const kinds[] = {"deictic", "adjectival"};
    (void)r;
    struct timing t = take_timing(tag);
    const char *given = tag_take(tag, "level");
    const struct choice *level = given ? choice_find(levels, 3, given) : &levels[1];
    if (!level) {
        tag_bad(tag, "level", "is not strong, medium or weak");
        level = &levels[1];
    }
    tag->frame->style.emphasis = (enum score_emphasis)level->value;
    cue(tag, "emphasis", level->name, &t, 1);
    take_accent(tag, &t);
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        const char *value = tag_take(tag, kinds[i]);
        if (value && *value)
            cue(tag, kinds[i], value, &t, 1);
    }
    take_mind(tag, &t);
}

/* The boundary tone applies to the last word. Two letters end an intonational phrase, heard as a short
 * silence. */
static void begin_boundary(struct markup_reader *r, struct tag *tag) {
    static const struct choice types[] = {{"L", 0},     {"H", 0},     {"LL", 0.15},
                                          {"HH", 0.15}, {"LH", 0.15}, {"HL", 0.15}};
    if (tag_has(tag, "start")) { /* SEMAINE places boundaries at sync points */
        bml_begin_boundary(r, tag);
        return;
    }
    const char *given = tag_take(tag, "type");
    struct timing t = take_timing(tag);
    const struct choice *type = given ? choice_find(types, sizeof types / sizeof *types, given) : &types[2];
    if (!type) {
        tag_bad(tag, "type", "is not a boundary tone");
        return;
    }
    struct score_cue *c = reader_last_word(r, tag->at, "boundary", type->name);
    set_timing(c, &t);
    reader_pause(tag, "type", type->value);
}

static void begin_pause(struct markup_reader *r, struct tag *tag) {
    const char *value = tag_take(tag, "sec");
    double seconds;
    (void)r;
    if (!value)
        score_warn(r->score, tag->at, ERROR_MISSING_ATTRIBUTE, "a pause needs its length in sec");
    else if (!quantity_seconds(value, 1, &seconds))
        tag_bad(tag, "sec", "is not a number of seconds");
    else
        reader_pause(tag, "sec", seconds);
}

static const struct element elements[] = {
    {.name = "affective", .begin = begin_affective},
    {.name = "apml", .flags = ELEMENT_BOUNDARY},
    {.name = "backchannel", .flags = ELEMENT_BOUNDARY, .begin = begin_backchannel, .ignored = " type "},
    {.name = "boundary", .begin = begin_boundary},
    {.name = "emphasis", .begin = begin_emphasis},
    {.name = "gesture", .begin = style_gesture},
    {.name = "pause", .begin = begin_pause},
    {.name = "performative", .flags = ELEMENT_BOUNDARY, .begin = begin_performative},
    {.name = "pitchaccent", .begin = bml_begin_accent},
    {.name = "rheme", .begin = begin_part},
    {.name = "signalctrl", .begin = voqual_begin_signal},
    {.name = "simpleSignal", .flags = ELEMENT_SILENT, .begin = bml_begin_other},
    {.name = "theme", .begin = begin_part},
    {.name = "tm", .begin = bml_begin_point},
    {.name = "turnallocation", .flags = ELEMENT_BOUNDARY, .begin = begin_turn},
    {.name = "voqual", .begin = voqual_begin},
    {.name = "vsml", .flags = ELEMENT_BOUNDARY},
};

const struct vocabulary apml_vocabulary = {.root = "apml",
                                           .elements = elements,
                                           .element_count = sizeof elements / sizeof *elements,
                                           .mark = bml_point,
                                           .open = bml_open,
                                           .finish = bml_finish,
                                           .close = bml_close};
