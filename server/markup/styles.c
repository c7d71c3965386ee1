/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/markup/styles.h"
#include "server/base/sampa.h"
#include "server/markup/sayas.h"
#include <string.h>

void style_take_gender(struct tag *tag) {
    static const struct choice genders[] = {{"male", 0}, {"female", 0}, {"neutral", 0}};
    const char *gender = tag_take(tag, "gender");
    const struct choice *known = gender && *gender ? choice_find(genders, 3, gender) : NULL;
    if (known)
        tag->frame->style.gender = known->name;
    else if (gender && *gender)
        tag_bad(tag, "gender", "is not male, female or neutral");
}

void style_say_as(struct tag *tag, const char *attribute, const char *class_name, const char *format) {
    char form[SAYAS_BYTES];
    bool fits;
    if (!sayas_form(class_name, format, form, &fits)) {
        tag_bad(tag, attribute, "is no way of reading: the text is read as usual");
        return;
    }
    tag->frame->style.say_as = reader_keep(tag->r, form);
    if (!fits)
        tag_bad(tag, format ? "format" : attribute, "has a format that is not known");
}

bool style_is_ipa(const char *ipa) {
    char sampa[256];
    return !sampa_from_ipa(ipa, sampa, sizeof sampa);
}

void style_ipa(struct tag *tag, const char *attribute, const char *ipa) {
    if (strlen(ipa) > READER_PHONES_BYTES) {
        tag_bad(tag, attribute, "is too long: the text is read instead");
        return;
    }
    if (!style_is_ipa(ipa))
        tag_warn(tag, attribute, ERROR_BAD_VALUE, "not all of \"%.60s\" is IPA", ipa);
    if (*ipa)
        tag->frame->style.phonemes = reader_keep(tag->r, ipa);
}

void style_emphasis(struct markup_reader *r, struct tag *tag) {
    static const struct choice levels[] = {{"strong", EMPHASIS_STRONG},
                                           {"moderate", EMPHASIS_MEDIUM},
                                           {"reduced", EMPHASIS_REDUCED},
                                           {"none", EMPHASIS_NONE}};
    static const char *const names[] = {
        [EMPHASIS_STRONG] = "strong", [EMPHASIS_MEDIUM] = "medium", [EMPHASIS_REDUCED] = "reduced"};
    const char *given = tag_take(tag, "level");
    const struct choice *level = given ? choice_find(levels, 4, given) : &levels[1];
    if (!level) {
        tag_bad(tag, "level", "is not strong, moderate, none or reduced");
        level = &levels[1];
    }
    enum score_emphasis emphasis = (enum score_emphasis)level->value;
    tag->frame->style.emphasis = emphasis;
    if (emphasis != EMPHASIS_NONE)
        reader_cue(r, tag->frame, tag->at, "emphasis", names[emphasis]);
}

void style_gesture(struct markup_reader *r, struct tag *tag) {
    const char *name = tag_take(tag, "name"), *given = tag_take(tag, "intensity");
    double intensity = 1;
    if (given && !quantity_plain(given, 0, 1, &intensity))
        tag_bad(tag, "intensity", "is not from 0 to 1");
    if (name && *name)
        reader_cue(r, tag->frame, tag->at, "gesture", name)->intensity = intensity;
    else
        score_warn(r->score, tag->at, ERROR_MISSING_ATTRIBUTE, "a gesture has a name");
}

bool style_take_pause(struct tag *tag, const char *attribute, double unit) {
    const char *value = tag_take(tag, attribute);
    double seconds;
    if (!value)
        return false;
    if (!quantity_seconds(value, unit, &seconds)) {
        tag_bad(tag, attribute, "is no time");
        return false;
    }
    reader_pause(tag, attribute, seconds);
    return true;
}

void style_take_pause_word(struct tag *tag, const char *attribute, const struct choice *words, size_t count,
                           const struct choice *usual) {
    const char *value = tag_take(tag, attribute);
    const struct choice *known = value ? choice_find(words, count, value) : usual;
    if (!known)
        tag_bad(tag, attribute, "is no length of a pause");
    reader_pause(tag, attribute, known ? known->value : usual->value);
}

void style_end_capture(struct markup_reader *r, struct frame *frame) {
    if (!frame->captures)
        return;
    const char *text = reader_captured(r, frame);
    if (!*text && !frame->value && frame->style.phonemes)
        text = frame->style.phonemes;
    reader_say(r, frame, frame->value ? frame->value : text, frame->kept);
}
