/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The JSON export: {"lang","voice","engine","fps","rate","duration","phones","words","marks","warnings"};
 * times in seconds. */
#include "server/stream/export.h"
#include <jansson.h>

static int append(const char *text, size_t size, void *buf) {
    buf_add(buf, text, size);
    return 0;
}

/* Adds the object as the next member of a list, and drops it. */
static void add_member(struct buf *list, json_t *object) {
    if (list->size)
        buf_add(list, ",\n  ", 4);
    json_dump_callback(object, append, list, JSON_COMPACT | JSON_REAL_PRECISION(7));
    json_decref(object);
}

void export_json_scene(struct export *x, const struct scene *scene) {
    const struct utterance *u = scene->utterance;
    const char *text = speech_request(x->speech)->text;
    double start = scene->start, rate = u->sample_rate;
    for (size_t i = 0; i < u->phone_count; i++) {
        const struct phone *p = &u->phones[i];
        add_member(&x->phones,
                   json_pack("{ss ss sf sf si}", "ipa", p->ipa, "sampa", p->sampa, "start",
                             (start + p->start) / rate, "end", (start + p->end) / rate, "stress", p->stress));
    }
    for (size_t i = 0; i < u->word_count; i++) {
        const struct word *w = &u->words[i];
        size_t utf16_start = utf16_offset(&x->utf16, text, w->from);
        add_member(&x->words, json_pack("{ss% sf sf sI sI sI sI}", "text", text + w->from, w->to - w->from,
                                        "start", (start + w->start) / rate, "end", (start + w->end) / rate,
                                        "byte_start", (json_int_t)w->from, "byte_end", (json_int_t)w->to,
                                        "utf16_start", (json_int_t)utf16_start, "utf16_end",
                                        (json_int_t)utf16_offset(&x->utf16, text, w->to)));
    }
    for (size_t i = 0; i < u->mark_count; i++)
        add_member(&x->marks,
                   json_pack("{ss sf}", "name", u->marks[i].name, "time", (start + u->marks[i].at) / rate));
}

void export_warning(struct export *x, const struct error *e) {
    char text[400];
    add_member(&x->warnings,
               json_pack("{ss ss}", "code", e->code, "message", error_text(e, text, sizeof text)));
}

static void add_list(struct buf *out, const char *name, const struct buf *members) {
    buf_printf(out, ",\n \"%s\":[", name);
    if (members->size) {
        buf_add(out, "\n  ", 3);
        buf_add(out, members->data, members->size);
    }
    buf_add(out, "]", 1);
}

void export_json_end(struct export *x) {
    json_t *head =
        json_pack("{ss ss ss sf si sf}", "lang", speech_lang(x->speech), "voice", speech_voice(x->speech)->id,
                  "engine", speech_engine(x->speech), "fps", x->fps, "rate", (int)x->sample_rate, "duration",
                  x->sample_rate ? (double)x->samples / x->sample_rate : 0.0);
    json_dump_callback(head, append, &x->out, JSON_COMPACT | JSON_REAL_PRECISION(7));
    json_decref(head);
    x->out.size--; /* the object goes on */
    add_list(&x->out, "phones", &x->phones);
    add_list(&x->out, "words", &x->words);
    add_list(&x->out, "marks", &x->marks);
    add_list(&x->out, "warnings", &x->warnings);
    buf_add(&x->out, "}\n", 2);
}
