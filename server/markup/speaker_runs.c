/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/markup/speaker_runs.h"
#include "server/base/json/json_place.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include <ctype.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int read_text(const struct json_place *up, const char *key, char **out) {
    const struct json_place at = json_place_key(up, key);
    const char *text;
    if (!at.json)
        return 0;
    if (json_place_text(&at, &text))
        return -1;
    *out = mem_strdup(text);
    return 0;
}

/* The id, which is empty for the narrator. */
static int read_id(const struct json_place *up, char **out) {
    const struct json_place at = json_place_key(up, "id");
    if (!json_is_string(at.json))
        return json_place_fail(&at, "must be a string");
    *out = mem_strdup(json_string_value(at.json));
    return 0;
}

static int read_factor(const struct json_place *up, const char *key, double *out) {
    const struct json_place at = json_place_key(up, key);
    return at.json ? json_place_real(&at, 0.25, 4.8, out) : 0;
}

/* Ranges as in language_runs.h, without a language. They are in UTF-16 units until place_runs. */
static int read_ranges(struct speaker_runs *runs, const struct json_place *up, size_t speaker) {
    const struct json_place at = json_place_key(up, "at");
    const char *written;
    if (json_place_text(&at, &written))
        return -1;
    for (const char *c = written + strspn(written, " "); *c; c += strspn(c, " ")) {
        unsigned long start, end;
        int length = 0;
        if (!isdigit((unsigned char)*c) || sscanf(c, "%10lu-%10lu%n", &start, &end, &length) != 2 ||
            start >= end || (c[length] && c[length] != ' '))
            return json_place_fail(&at, "must be ranges \"START-END\" of the text, separated by spaces");
        runs->list = mem_grow(runs->list, &runs->cap, runs->count + 1, sizeof *runs->list);
        runs->list[runs->count++] = (struct speaker_run){start, end, speaker};
        c += length;
    }
    return 0;
}

static int read_speaker(struct speaker_runs *runs, const struct json_place *at) {
    static const char *const known[] = {"id",   "name", "voice",  "gender", "pitch",
                                        "rate", "at",   "affect", NULL};
    static const char *const genders[] = {"female", "male", NULL};
    struct speaker *s = &runs->speakers[runs->speaker_count];
    const struct json_place gender = json_place_key(at, "gender");
    size_t choice;
    *s = (struct speaker){.pitch = 1, .rate = 1};
    runs->speaker_count++;
    if (json_place_keys(at, known) || read_id(at, &s->id) || read_text(at, "name", &s->name) ||
        read_text(at, "voice", &s->voice) || read_text(at, "affect", &s->affect) ||
        read_factor(at, "pitch", &s->pitch) || read_factor(at, "rate", &s->rate))
        return -1;
    if (gender.json && json_place_choice(&gender, genders, &choice))
        return -1;
    s->gender = gender.json ? mem_strdup(genders[choice]) : NULL;
    s->name = s->name ? s->name : mem_strdup(s->id);
    return read_ranges(runs, at, runs->speaker_count - 1);
}

static int compare(const void *a, const void *b) {
    const struct speaker_run *x = a, *y = b;
    return x->from < y->from ? -1 : x->from > y->from;
}

/* Sorts the runs, and turns their UTF-16 units into bytes. -1: two of them overlap. */
static int place_runs(struct speaker_runs *runs, const char *text, size_t size) {
    struct utf16_counter at = {0};
    size_t kept = 0;
    if (runs->count)
        qsort(runs->list, runs->count, sizeof *runs->list, compare);
    for (size_t i = 0; i < runs->count; i++)
        if (i && runs->list[i].from < runs->list[i - 1].to)
            return -1;
    for (size_t i = 0; i < runs->count; i++) {
        struct speaker_run run = runs->list[i];
        run.from = utf16_byte(&at, text, size, run.from);
        run.to = utf16_byte(&at, text, size, run.to);
        if (run.from < run.to)
            runs->list[kept++] = run;
    }
    runs->count = kept;
    return 0;
}

static int read_all(struct speaker_runs *runs, const struct json_place *root, const char *text, size_t size) {
    if (json_place_array(root))
        return -1;
    const size_t count = json_array_size(root->json);
    if (count > SPEAKERS_MAX)
        return json_place_fail(root, "there may be at most %d speakers", SPEAKERS_MAX);
    runs->speakers = mem_alloc((count + 1) * sizeof *runs->speakers);
    for (size_t i = 0; i < count; i++) {
        const struct json_place at = json_place_item(root, i);
        if (read_speaker(runs, &at))
            return -1;
    }
    return place_runs(runs, text, size) ? json_place_fail(root, "two speakers have the same part of the text")
                                        : 0;
}

int speaker_runs_read(struct speaker_runs *runs, const char *written, const char *text, size_t size,
                      struct error *e) {
    struct json_place root;
    struct error why;
    char said[sizeof why.message + sizeof why.field];
    *runs = (struct speaker_runs){0};
    int result = json_place_parse(written, strlen(written), ERROR_BAD_FIELD, &root, &why);
    result = result || read_all(runs, &root, text, size) ? -1 : 0;
    json_decref(root.json);
    if (!result)
        return 0;
    speaker_runs_free(runs);
    return error_in_field(e, ERROR_BAD_FIELD, "speakers", "%.250s", error_text(&why, said, sizeof said));
}

void speaker_runs_free(struct speaker_runs *runs) {
    for (size_t i = 0; i < runs->speaker_count; i++) {
        const struct speaker *s = &runs->speakers[i];
        char *const texts[] = {s->id, s->name, s->voice, s->gender, s->affect};
        for (size_t k = 0; k < sizeof texts / sizeof *texts; k++)
            free(texts[k]);
    }
    free(runs->speakers);
    free(runs->list);
    *runs = (struct speaker_runs){0};
}

const struct speaker *speaker_runs_at(const struct speaker_runs *runs, size_t byte, size_t *edge) {
    size_t low = 0, high = runs ? runs->count : 0;
    while (low < high) { /* the first run that ends behind the byte */
        size_t middle = (low + high) / 2;
        if (runs->list[middle].to <= byte)
            low = middle + 1;
        else
            high = middle;
    }
    const struct speaker_run *run = runs && low < runs->count ? &runs->list[low] : NULL;
    const bool inside = run && run->from <= byte;
    if (edge)
        *edge = !run ? SIZE_MAX : inside ? run->to : run->from;
    return inside ? &runs->speakers[run->speaker] : NULL;
}
