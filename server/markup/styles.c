/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/markup/styles.h"
#include "server/base/sampa.h"
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

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
        tag_bad(tag, attribute, "is not a known way of reading: the text is read as usual");
        return;
    }
    tag->frame->style.say_as = reader_keep(tag->r, form);
    if (!fits)
        tag_bad(tag, format ? "format" : attribute, "has an unknown format");
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
        score_warn(r->score, tag->at, ERROR_MISSING_ATTRIBUTE, "a gesture needs a name");
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
        tag_bad(tag, attribute, "is not the length of a pause");
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

static const char dates[] = " dmy mdy ymd ydm my ym md dm d m y ", times[] = " hms hm h hms12 hms24 ";

/* Name in a markup, canonical name, allowed formats. */
static const struct {
    const char *from, *to, *formats;
} forms[] = {
    {"characters", "characters", NULL},
    {"character", "characters", NULL},
    {"letters", "characters", NULL},
    {"spell", "characters", NULL},
    {"spell-out", "characters", NULL},
    {"verbatim", "characters", NULL},
    {"literal", "characters", NULL},
    {"acronym", "characters", NULL},
    {"digits", "digits", NULL},
    {"digit", "digits", NULL},
    {"number:digits", "digits", NULL},
    {"vxml:digits", "digits", NULL},
    {"number", "cardinal", NULL},
    {"number:cardinal", "cardinal", NULL},
    {"cardinal", "cardinal", NULL},
    {"vxml:number", "cardinal", NULL},
    {"number:ordinal", "ordinal", NULL},
    {"ordinal", "ordinal", NULL},
    {"fraction", "fraction", NULL},
    {"date", "date", dates},
    {"vxml:date", "date", dates},
    {"time", "time", times},
    {"vxml:time", "time", times},
    {"duration", "duration", NULL},
    {"telephone", "telephone", NULL},
    {"phone", "telephone", NULL},
    {"number:telephone", "telephone", NULL},
    {"vxml:phone", "telephone", NULL},
    {"currency", "currency", NULL},
    {"vxml:currency", "currency", NULL},
    {"measure", "measure", NULL},
    {"unit", "measure", NULL},
    {"name", "name", NULL},
    {"address", "address", NULL},
    {"net:email", "net:email", NULL},
    {"email", "net:email", NULL},
    {"net:url", "net:url", NULL},
    {"net:uri", "net:url", NULL},
    {"net", "net:url", NULL},
    {"url", "net:url", NULL},
    {"uri", "net:url", NULL},
};

static bool listed(const char *list, const char *word, size_t length) {
    for (const char *at = list; at && *at; at += strcspn(at, " ")) {
        at += strspn(at, " ");
        if (length && strcspn(at, " ") == length && !strncasecmp(at, word, length))
            return true;
    }
    return false;
}

static size_t find(const char *name, size_t length) {
    size_t i = 0, count = sizeof forms / sizeof *forms;
    while (i < count && (strlen(forms[i].from) != length || strncasecmp(forms[i].from, name, length) != 0))
        i++;
    return i;
}

/* "number" with the format "ordinal" is the class "number:ordinal". */
static bool joined(const char *class_name, const char *format, char out[SAYAS_BYTES]) {
    char both[64];
    size_t length = (size_t)snprintf(both, sizeof both, "%s:%s", class_name, format);
    size_t i = length < sizeof both ? find(both, length) : sizeof forms;
    if (i >= sizeof forms / sizeof *forms)
        return false;
    snprintf(out, SAYAS_BYTES, "%s", forms[i].to);
    return true;
}

bool sayas_form(const char *class_name, const char *format, char out[SAYAS_BYTES], bool *format_fits) {
    size_t length = strlen(class_name), count = sizeof forms / sizeof *forms, i = find(class_name, length);
    const char *colon = strchr(class_name, ':');
    *format_fits = true;
    if (format && *format && joined(class_name, format, out))
        return true;
    if (i == count && colon) {
        format = colon + 1;
        i = find(class_name, (size_t)(colon - class_name));
    }
    if (i == count)
        return false;
    snprintf(out, SAYAS_BYTES, "%s", forms[i].to);
    if (!format || !*format)
        return true;
    *format_fits = listed(forms[i].formats, format, strlen(format));
    if (*format_fits) {
        size_t at = strlen(out);
        snprintf(out + at, SAYAS_BYTES - at, ":%s", format);
        for (char *c = out + at; *c; c++)
            *c = *c >= 'A' && *c <= 'Z' ? (char)(*c | 32) : *c;
    }
    return true;
}

static const struct choice rates[] = {{"x-slow", 0.5}, {"slow", 0.75},   {"medium", 1}, {"default", 1},
                                      {"fast", 1.35},  {"x-fast", 1.75}, {"reset", 1}};
static const struct choice pitches[] = {{"x-low", 0.7}, {"low", 0.85},   {"medium", 1}, {"default", 1},
                                        {"high", 1.2},  {"x-high", 1.4}, {"reset", 1}};
static const struct choice ranges[] = {{"x-low", 0.25}, {"low", 0.6},  {"medium", 1}, {"default", 1},
                                       {"high", 1.5},   {"x-high", 2}, {"reset", 1}};
static const struct choice volumes[] = {{"silent", 0},  {"x-soft", 0.35}, {"soft", 0.6}, {"medium", 1},
                                        {"default", 1}, {"loud", 1.4},    {"x-loud", 2}, {"reset", 1}};

static const struct {
    const struct choice *words;
    size_t count;
    double min, max;
} kinds[] = {
    [PROSODY_RATE] = {rates, sizeof rates / sizeof *rates, 0.2, 5},
    [PROSODY_PITCH] = {pitches, sizeof pitches / sizeof *pitches, 0.25, 4},
    [PROSODY_RANGE] = {ranges, sizeof ranges / sizeof *ranges, 0, 4},
    [PROSODY_VOLUME] = {volumes, sizeof volumes / sizeof *volumes, 0, 4},
};

/* Number that means a factor of 1 in that unit; 0 = unit of another kind. */
static double unit_of(enum prosody_kind kind, const struct prosody_dialect *d, const char *unit) {
    bool bare = !*unit, hertz = !strcmp(unit, "hz");
    switch (kind) {
    case PROSODY_RATE:
        return bare ? d->rate : !strcmp(unit, "wpm") ? PROSODY_WPM : 0;
    case PROSODY_VOLUME:
        return bare ? d->volume : 0;
    case PROSODY_PITCH:
        return bare || hertz ? PROSODY_HZ : 0;
    default:
        return bare || hertz ? PROSODY_RANGE_HZ : 0;
    }
}

static bool apply(enum prosody_kind kind, const struct prosody_dialect *d, const char *value,
                  double *factor) {
    struct quantity q;
    const struct choice *word = choice_find(kinds[kind].words, kinds[kind].count, value);
    if (word) {
        *factor = word->value;
        return true;
    }
    if (!quantity_read(value, &q))
        return false;
    if (!strcmp(q.unit, "%")) {
        *factor *= q.relative ? 1 + q.number / 100 : q.number / 100;
        return true;
    }
    if (!strcmp(q.unit, "st") && (kind == PROSODY_PITCH || kind == PROSODY_RANGE)) {
        *factor *= exp2(q.number / 12);
        return true;
    }
    if (!strcmp(q.unit, "db") && kind == PROSODY_VOLUME) {
        *factor *= pow(10, q.number / 20);
        return true;
    }
    double unit = unit_of(kind, d, q.unit);
    if (unit == 0)
        return false;
    *factor = q.relative ? *factor + q.number / unit : q.number / unit;
    return true;
}

void prosody_take(struct tag *tag, const char *attribute, enum prosody_kind kind,
                  const struct prosody_dialect *dialect, double *factor) {
    const char *value = tag_take(tag, attribute);
    double changed = *factor;
    if (!value)
        return;
    if (!apply(kind, dialect, value, &changed)) {
        tag_bad(tag, attribute, "is not a valid value");
        return;
    }
    *factor = fmin(fmax(changed, kinds[kind].min), kinds[kind].max);
    if (*factor != changed)
        tag_bad(tag, attribute, "is out of range: the nearest possible value is used");
}

void prosody_take_contour(struct tag *tag, const char *attribute, double *factor) {
    static const struct prosody_dialect dialect = {1, 100};
    const char *value = tag_take(tag, attribute);
    double sum = 0;
    size_t count = 0;
    for (const char *at = value; at && (at = strchr(at, '(')); count++) {
        char pitch[24] = "";
        const char *comma = at + strcspn(at, ",)");
        size_t length = *comma == ',' ? strcspn(comma + 1, ")") : 0;
        double one = *factor;
        if (length && length < sizeof pitch)
            memcpy(pitch, comma + 1, length);
        if (!apply(PROSODY_PITCH, &dialect, pitch, &one)) {
            tag_bad(tag, attribute, "is not a pitch contour");
            return;
        }
        sum += one;
        at = comma;
    }
    if (count)
        *factor = fmin(fmax(sum / (double)count, kinds[PROSODY_PITCH].min), kinds[PROSODY_PITCH].max);
    if (value)
        tag_warn(tag, attribute, count ? ERROR_IGNORED : ERROR_BAD_VALUE,
                 count ? "only the mean of a pitch contour is used" : "this is not a pitch contour");
}
