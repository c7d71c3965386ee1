/* SPDX-License-Identifier: GPL-3.0-or-later */
/* EmotionML 1.0 (W3C Recommendation, 22 May 2014). An emotion applies to the text inside it; without text,
 * to the rest of the enclosing element. */
#include "server/markup/languages/emotionml.h"
#include <math.h>

/* Reads a time in milliseconds. */
static void take_time(struct tag *tag, const char *attribute, struct score_time *time) {
    const char *value = tag_take(tag, attribute);
    double ms;
    if (!value)
        return;
    if (quantity_plain(value, 0, READER_SECONDS * 1000.0, &ms))
        *time = (struct score_time){.seconds = ms / 1000};
    else
        tag_bad(tag, attribute, "is not a valid time in milliseconds");
}

void emotionml_begin_emotion(struct markup_reader *r, struct tag *tag) {
    struct emotion *emotion = &tag->frame->emotion;
    (void)r;
    *emotion = (struct emotion){.intensity = 1, .duration = {.share = 1}};
    take_time(tag, "duration", &emotion->duration);
    take_time(tag, "offset-to-start", &emotion->delay);
}

/* Adds a cue that begins where the emotion begins. */
static void add_cue(struct markup_reader *r, struct frame *frame, size_t at, const char *name,
                    double intensity) {
    struct score_cue *cue = reader_cue(r, frame, at, "affect", name);
    cue->intensity = intensity;
    cue->duration = frame->emotion.duration;
    cue->delay = frame->emotion.delay;
    if (frame->flushes == r->passage.flushes)
        passage_from(&r->passage, frame->piece);
}

/* Returns the enclosing emotion, or NULL with a warning. */
static struct frame *emotion_around(struct markup_reader *r, const struct tag *tag) {
    struct frame *outer = tag->frame - 1;
    if (outer->element && outer->element->begin == emotionml_begin_emotion)
        return outer;
    score_warn(r->score, tag->at, ERROR_IGNORED, "this is outside an emotion");
    return NULL;
}

static double take_value(struct tag *tag, double usual) {
    const char *value = tag_take(tag, "value");
    double number = usual;
    if (value && !quantity_plain(value, 0, 1, &number))
        tag_bad(tag, "value", "is not from 0 to 1");
    return number;
}

void emotionml_begin_category(struct markup_reader *r, struct tag *tag) {
    struct frame *frame = emotion_around(r, tag);
    const char *name = tag_take(tag, "name");
    double intensity = take_value(tag, 1);
    if (!name)
        score_warn(r->score, tag->at, ERROR_MISSING_ATTRIBUTE, "a category needs a name");
    else if (frame)
        add_cue(r, frame, tag->at, reader_affect(r, name), intensity);
}

/* 0.5 is neutral. */
void emotionml_begin_dimension(struct markup_reader *r, struct tag *tag) {
    enum { ACTIVATION, EVALUATION, INTENSITY };
    static const struct choice names[] = {{"arousal", ACTIVATION},    {"activation", ACTIVATION},
                                          {"valence", EVALUATION},    {"pleasure", EVALUATION},
                                          {"evaluation", EVALUATION}, {"intensity", INTENSITY}};
    struct frame *frame = emotion_around(r, tag);
    const char *name = tag_take(tag, "name");
    double value = take_value(tag, 0.5);
    const struct choice *known = name ? choice_find(names, sizeof names / sizeof *names, name) : NULL;
    if (!name)
        score_warn(r->score, tag->at, ERROR_MISSING_ATTRIBUTE, "a dimension needs a name");
    else if (!known)
        tag_warn(tag, "name", ERROR_IGNORED, "the dimension '%.40s' is ignored", name);
    if (!known || !frame)
        return;
    if (known->value == INTENSITY) {
        frame->emotion.intensity = value;
        return;
    }
    frame->emotion.is_placed = true;
    *(known->value == ACTIVATION ? &frame->emotion.activation : &frame->emotion.evaluation) = 2 * value - 1;
}

void emotionml_begin_unused(struct markup_reader *r, struct tag *tag) {
    score_warn(r->score, tag->at, ERROR_IGNORED, "<%s> is ignored", tag->frame->element->name);
}

void emotionml_end_emotion(struct markup_reader *r, struct frame *frame) {
    const struct emotion *emotion = &frame->emotion;
    double intensity;
    const char *name = emotion->is_placed && r->rules ? affect_at(r->rules->affects, emotion->activation,
                                                                  emotion->evaluation, &intensity)
                                                      : NULL;
    if (name)
        add_cue(r, frame, frame->at, name, intensity * emotion->intensity);
    if (frame->flushes == r->passage.flushes && frame->piece == r->passage.piece_count)
        passage_lift(&r->passage, r->depth);
}

static const struct element elements[] = {
    EMOTIONML_UNUSED("action-tendency"),
    EMOTIONML_UNUSED("appraisal"),
    EMOTIONML_CATEGORY,
    EMOTIONML_DIMENSION,
    EMOTIONML_EMOTION,
    {.name = "emotionml",
     .flags = ELEMENT_BOUNDARY,
     .quiet = " category-set dimension-set appraisal-set action-tendency-set "},
    EMOTIONML_ABOUT("info"),
    EMOTIONML_ABOUT("item"),
    EMOTIONML_ABOUT("reference"),
    EMOTIONML_UNUSED("trace"),
    EMOTIONML_ABOUT("vocabulary"),
};

const struct vocabulary emotionml_vocabulary = {
    .root = "emotionml", .elements = elements, .element_count = sizeof elements / sizeof *elements};
