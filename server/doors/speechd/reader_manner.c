/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/doors/speechd/reader_manner.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { USUAL_RATE = 160 /* words a minute at 0 */ };

/* -100 to 100. */
static bool read_step(const char *value, double *step) {
    char *end;
    *step = strtod(value, &end);
    return end != value && !*end && *step >= -100 && *step <= 100;
}

static bool set_number(char text[16], const char *value, double middle, double factor) {
    double step;
    if (!read_step(value, &step))
        return false;
    snprintf(text, 16, "%.3f", middle * pow(factor, step / 100));
    return true;
}

/* 100 is loudest. */
static bool set_volume(char text[16], const char *value) {
    double step;
    if (!read_step(value, &step))
        return false;
    snprintf(text, 16, "%.3f", fmax(0.25, (step + 100) / 200));
    return true;
}

/* What is none, or too long to be one, is as if it had not been set: a wrong setting must not silence the
 * reader. */
static void set_text(char *text, size_t cap, const char *value) {
    bool none = !strcmp(value, "none") || !strcmp(value, "NULL") || strlen(value) >= cap;
    snprintf(text, cap, "%s", none ? "" : value);
}

/* A tag (it-IT), or the name of a locale, as $LANG has it (it_IT.UTF-8); C and POSIX are no languages. */
static void set_language(char *lang, size_t cap, const char *value) {
    char name[64];
    snprintf(name, sizeof name, "%.*s", (int)strcspn(value, ".@"), value);
    for (char *c = name; *c; c++)
        *c = *c == '_' ? '-' : *c;
    set_text(lang, cap, strcasecmp(name, "c") && strcasecmp(name, "posix") ? name : "");
}

bool manner_set(struct reader_manner *m, const char *name, const char *value) {
    if (!strcmp(name, "rate"))
        return set_number(m->rate, value, USUAL_RATE, 3);
    if (!strcmp(name, "pitch"))
        return set_number(m->pitch, value, 1, 2);
    if (!strcmp(name, "volume"))
        return set_volume(m->volume, value);
    if (!strcmp(name, "language"))
        set_language(m->lang, sizeof m->lang, value);
    if (!strcmp(name, "synthesis_voice"))
        set_text(m->voice, sizeof m->voice, value);
    if (!strcmp(name, "spelling_mode"))
        m->spells = !strcmp(value, "on");
    if (!strcmp(name, "voice") || !strcmp(name, "voice_type")) /* female1, male2, child_male... */
        set_text(m->gender, sizeof m->gender,
                 strstr(value, "female") || strstr(value, "FEMALE") ? "female"
                 : strstr(value, "male") || strstr(value, "MALE")   ? "male"
                                                                    : "");
    return true; /* punctuation and capitals are as the language has them */
}

static const char *or_none(const char *text) {
    return *text ? text : NULL;
}

void manner_members(const struct reader_manner *m, struct remote_member members[READER_MEMBERS + 1]) {
    const struct remote_member all[READER_MEMBERS + 1] = {{"markup", "ssml"},
                                                          {"voice", or_none(m->voice)},
                                                          {"lang", *m->voice ? NULL : or_none(m->lang)},
                                                          {"gender", *m->voice ? NULL : or_none(m->gender)},
                                                          {"rate", or_none(m->rate)},
                                                          {"pitch", or_none(m->pitch)},
                                                          {"volume", or_none(m->volume)},
                                                          {NULL, NULL}};
    memcpy(members, all, sizeof all);
}

static void escape(struct buf *out, const char *text) {
    for (; *text; text++) {
        const char *entity = *text == '&' ? "&amp;" : *text == '<' ? "&lt;" : *text == '"' ? "&quot;" : NULL;
        buf_add(out, entity ? entity : text, entity ? strlen(entity) : 1);
    }
}

/* What lies in the <speak> of a document, or all of it. */
static void add_inside(struct buf *out, const char *text) {
    const char *begin = !strncmp(text, "<speak", 6) ? strchr(text, '>') : NULL,
               *end = strstr(text, "</speak>");
    if (begin && end > begin)
        buf_add(out, begin + 1, (size_t)(end - begin - 1));
    else
        escape(out, text);
}

/* Is this "&amp;" or another of the references that are understood? Its length, or 0. */
static size_t reference(const char *text) {
    static const char *const known[] = {"&amp;", "&lt;", "&gt;", "&quot;", "&apos;"};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (!strncmp(text, known[i], strlen(known[i])))
            return strlen(known[i]);
    return 0;
}

char *manner_words(char *ssml) {
    struct buf out = {0};
    utf8_mend(ssml);
    buf_printf(&out, "<speak>");
    for (const char *at = ssml; *at;) {
        const char *end = *at == '<' ? strchr(at, '>') : NULL;
        size_t kept = *at == '&' ? reference(at) : *at == '<' ? 0 : 1;
        if (end)
            buf_add(&out, " ", 1);
        else if (kept)
            buf_add(&out, at, kept);
        else
            buf_printf(&out, *at == '&' ? "&amp;" : "&lt;");
        at = end ? end + 1 : at + (kept ? kept : 1);
    }
    buf_add(&out, "</speak>", 9);
    return (char *)out.data;
}

char *manner_text(const struct reader_manner *m, enum reader_kind kind, const char *text) {
    static const char spelt[] = "<say-as interpret-as=\"characters\">";
    struct buf out = {0};
    buf_printf(&out, "<speak>");
    if (kind == READER_CHAR || (kind == READER_TEXT && m->spells)) {
        buf_printf(&out, "%s", spelt);
        if (kind == READER_CHAR)
            escape(&out, strcmp(text, "space") ? text : " ");
        else
            add_inside(&out, text);
        buf_printf(&out, "</say-as>");
    } else if (kind == READER_SOUND_ICON) {
        buf_printf(&out, "<audio src=\"");
        escape(&out, text);
        buf_printf(&out, ".wav\">");
        escape(&out, text);
        buf_printf(&out, "</audio>");
    } else if (kind == READER_KEY) {
        char *words = mem_strdup(text);
        for (char *c = words; *c; c++)
            *c = *c == '_' ? ' ' : *c;
        escape(&out, words);
        free(words);
    } else {
        add_inside(&out, text);
    }
    buf_add(&out, "</speak>", 9);
    return (char *)out.data;
}
