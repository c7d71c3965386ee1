/* SPDX-License-Identifier: GPL-3.0-or-later */
/* JSML: the Java Speech Markup Language, Sun Microsystems, versions 0.5 (1997) and 0.6 (1999; W3C Note of
 * 5 June 2000), with the emotion elements of E. Akagunduz, "Talking head with expressions" (METU, 2004).
 * Element and attribute names are case-insensitive; a document needs no root. */
#include "server/markup/styles.h"
#include <string.h>
#include <strings.h>

static const struct prosody_dialect numbers = {PROSODY_WPM, 1};

static void take_common(struct markup_reader *r, struct tag *tag) {
    reader_language(tag, "lang");
    const char *mark = strcasecmp(tag->frame->element->name, "marker") ? tag_take(tag, "mark") : NULL;
    if (mark && *mark)
        reader_mark(r, tag->at, mark);
}

static void begin_div(struct markup_reader *r, struct tag *tag) {
    static const struct choice types[] = {{"paragraph", 0}, {"para", 0}, {"sentence", 1}, {"sent", 1}};
    const char *type = tag_take(tag, "type");
    const struct choice *known = type ? choice_find(types, sizeof types / sizeof *types, type) : &types[0];
    if (!known)
        tag_bad(tag, "type", "is neither paragraph nor sentence");
    r->passage.whole = known && known->value > 0;
}

static void begin_voice(struct markup_reader *r, struct tag *tag) {
    const char *voice = tag_take(tag, "voice"), *name = tag_take(tag, "name");
    if (voice || name)
        tag->frame->style.voice = reader_keep(r, voice ? voice : name);
    style_take_gender(tag);
}

static void begin_sayas(struct markup_reader *r, struct tag *tag) {
    const char *class_name = tag_take(tag, "class"), *sub = tag_take(tag, "sub"),
               *phones = tag_take(tag, "phon");
    if (!class_name && !sub && !phones)
        score_warn(r->score, tag->at, ERROR_MISSING_ATTRIBUTE, "sayas needs a class, sub or phon");
    if (class_name)
        style_say_as(tag, "class", class_name, NULL);
    if (phones)
        style_ipa(tag, "phon", phones);
    if (reader_capture(r, tag->frame))
        tag->frame->value = sub ? reader_keep(r, sub) : NULL;
}

static void begin_phoneme(struct markup_reader *r, struct tag *tag) {
    const char *original = tag_take(tag, "original");
    if (reader_capture(r, tag->frame))
        tag->frame->value = original ? reader_keep(r, original) : NULL;
}

/* The element's content is the phones. */
static void end_phoneme(struct markup_reader *r, struct frame *frame) {
    if (!frame->captures)
        return;
    struct score_style style = frame->style;
    style.phonemes = reader_keep(r, reader_captured(r, frame));
    if (strlen(style.phonemes) > READER_PHONES_BYTES) {
        score_warn(r->score, frame->inside, ERROR_BAD_VALUE,
                   "more than %d bytes of phones: the text is read instead", READER_PHONES_BYTES);
        const char *text = frame->value ? frame->value : style.phonemes;
        style.phonemes = NULL;
        reader_say(r, frame, text, score_keep_style(r->score, &style));
        return;
    }
    if (!style_is_ipa(style.phonemes))
        score_warn(r->score, frame->inside, ERROR_BAD_VALUE, "not all of \"%.60s\" is IPA", style.phonemes);
    reader_say(r, frame, frame->value ? frame->value : style.phonemes, score_keep_style(r->score, &style));
}

static void begin_break(struct markup_reader *r, struct tag *tag) {
    static const struct choice sizes[] = {{"none", 0}, {"small", 0.15}, {"medium", 0.4}, {"large", 1}};
    (void)r;
    if (!style_take_pause(tag, "msecs", 0.001) && !style_take_pause(tag, "time", 0.001))
        style_take_pause_word(tag, "size", sizes, 4, &sizes[2]);
}

static void begin_prosody(struct markup_reader *r, struct tag *tag) {
    struct score_style *style = &tag->frame->style;
    (void)r;
    prosody_take(tag, "rate", PROSODY_RATE, &numbers, &style->rate);
    prosody_take(tag, "vol", PROSODY_VOLUME, &numbers, &style->volume);
    prosody_take(tag, "volume", PROSODY_VOLUME, &numbers, &style->volume);
    prosody_take(tag, "pitch", PROSODY_PITCH, &numbers, &style->pitch);
    prosody_take(tag, "range", PROSODY_RANGE, &numbers, &style->range);
}

static void begin_marker(struct markup_reader *r, struct tag *tag) {
    const char *mark = tag_take(tag, "mark");
    if (mark && *mark)
        reader_mark(r, tag->at, mark);
    else
        score_warn(r->score, tag->at, ERROR_MISSING_ATTRIBUTE, "a marker needs its name in mark");
}

static void begin_engine(struct markup_reader *r, struct tag *tag) {
    (void)tag_take(tag, "name");
    (void)tag_take(tag, "data");
    score_warn(r->score, tag->at, ERROR_IGNORED,
               "data for a speech engine is ignored: the text is read instead");
}

/* The thesis's weight is the share of the emotion in the face. If the attribute is absent in a text shown
 * by weights, the face stage uses 0.2. */
static void begin_emotion(struct markup_reader *r, struct tag *tag) {
    const char *weight = tag_take(tag, "weight");
    double share = -1;
    if (weight && !quantity_plain(weight, 0, 1, &share))
        tag_bad(tag, "weight", "is not from 0 to 1");
    reader_cue(r, tag->frame, tag->at, "affect", reader_affect(r, tag->frame->element->name))->weight = share;
}

static const struct element elements[] = {
    {.name = "afraid", .begin = begin_emotion},
    {.name = "anger", .begin = begin_emotion},
    {.name = "angry", .begin = begin_emotion},
    {.name = "break", .begin = begin_break},
    {.name = "disgusted", .begin = begin_emotion},
    {.name = "div", .flags = ELEMENT_BOUNDARY, .begin = begin_div},
    {.name = "emp", .begin = style_emphasis},
    {.name = "emphasis", .begin = style_emphasis},
    {.name = "engine", .begin = begin_engine},
    {.name = "gesture", .begin = style_gesture},
    {.name = "happy", .begin = begin_emotion},
    {.name = "jsml", .flags = ELEMENT_BOUNDARY},
    {.name = "marker", .begin = begin_marker},
    {.name = "para", .flags = ELEMENT_BOUNDARY},
    {.name = "phoneme", .begin = begin_phoneme, .end = end_phoneme},
    {.name = "pros", .begin = begin_prosody},
    {.name = "prosody", .begin = begin_prosody},
    {.name = "sad", .begin = begin_emotion},
    {.name = "sayas", .begin = begin_sayas, .end = style_end_capture},
    {.name = "sent", .flags = ELEMENT_SENTENCE},
    {.name = "surprised", .begin = begin_emotion},
    {.name = "voice", .begin = begin_voice, .ignored = " age variant "},
};

const struct vocabulary jsml_vocabulary = {.root = "jsml",
                                           .elements = elements,
                                           .element_count = sizeof elements / sizeof *elements,
                                           .rootless = true,
                                           .common = take_common};
