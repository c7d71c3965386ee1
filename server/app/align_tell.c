/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What faccia align says of a recording that is not what its text says. */
#include "server/app/align_write.h"
#include "server/base/utf8.h"
#include <math.h>

/* Shorter than this, s, may be a breath. */
#define PASSED_LEAST 0.8
enum { SHOWN_CHARACTERS = 40 };

/* Goes on to that byte of the text, counting lines. */
static void go_to(struct align *a, size_t byte) {
    const char *text = a->reading->text;
    for (; a->told < byte; a->told++) {
        a->column += (text[a->told] & 0xC0) != 0x80;
        if (text[a->told] == '\n') {
            a->line++;
            a->column = 0;
        }
    }
}

/* The length of the head of a sentence, as it is shown. */
static int shown(const char *text, size_t size) {
    size_t at = 0;
    uint32_t cp;
    for (int i = 0; i < SHOWN_CHARACTERS && at < size && text[at] != '\n'; i++)
        at += utf8_next(text + at, size - at, &cp);
    while (at && text[at - 1] == ' ')
        at--;
    return (int)at;
}

static void tell(struct align *a, const struct aligned_recording_sentence *s) {
    const char *text = a->reading->text;
    size_t from = s->from;
    int minutes = (int)(s->start / 60);
    while (from < s->to && (text[from] == ' ' || text[from] == '\n' || text[from] == '\r'))
        from++;
    go_to(a, from);
    if (s->passed >= PASSED_LEAST)
        cli_complain("warning: before %d:%04.1f %.1f s are heard that are not in the text", minutes,
                     s->start - 60 * minutes, s->passed);
    if (!s->found)
        cli_complain("warning: %s:%zu:%zu: is not read: \"%.*s\"", a->text, a->line + 1, a->column + 1,
                     shown(text + from, s->to - from), text + from);
    else if (s->confidence < ALIGN_UNSURE)
        cli_complain(
            "warning: %s:%zu:%zu: is perhaps not what is read at %d:%04.1f (confidence %.2f): \"%.*s\"",
            a->text, a->line + 1, a->column + 1, minutes, s->start - 60 * minutes, s->confidence,
            shown(text + from, s->to - from), text + from);
}

void align_tell(struct align *a) {
    for (; a->sentence < a->reading->sentence_count; a->sentence++) {
        const struct aligned_recording_sentence *s = &a->reading->sentences[a->sentence];
        tell(a, s);
        if (a->outputs[JSON].path)
            export_json_sentence(&a->outputs[JSON].export, aligned_recording_sentence_json(s));
    }
}
