/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is known of an aligned recording, handed out: as audio with its times, and as a file. */
#include "server/align/aligned_recording.h"
#include "server/base/mem.h"
#include "server/base/sampa.h"
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { HEAD_BYTES = 256 };
#define JSON_FLAGS (JSON_COMPACT | JSON_REAL_PRECISION(9))

static uint32_t clip(double seconds, const struct aligned_recording *r, uint64_t from, uint64_t to) {
    double sample = seconds * r->sound->rate;
    return sample <= (double)from ? 0
           : sample >= (double)to ? (uint32_t)(to - from)
                                  : (uint32_t)(sample - (double)from);
}

static void put_phone(struct sentence_audio *u, const char *ipa, uint8_t stress, uint32_t end) {
    uint32_t start = u->phone_count ? u->phones[u->phone_count - 1].end : 0;
    struct phone *p = &u->phones[u->phone_count];
    if (end <= start)
        return;
    *p = (struct phone){.start = start, .end = end, .stress = stress};
    snprintf(p->ipa, sizeof p->ipa, "%s", ipa);
    snprintf(p->symbol, sizeof p->symbol, "%s", ipa);
    sampa_from_ipa(ipa, p->sampa, sizeof p->sampa);
    u->phone_count++;
}

static void put_phones(const struct aligned_recording *r, uint64_t from, uint64_t to,
                       struct sentence_audio *u) {
    double rate = r->sound->rate;
    size_t first = 0, high = r->phone_count;
    while (first < high) {
        size_t middle = (first + high) / 2;
        if (r->phones[middle].end * rate <= (double)from)
            first = middle + 1;
        else
            high = middle;
    }
    size_t last = first;
    while (last < r->phone_count && r->phones[last].start * rate < (double)to)
        last++;
    u->phones = mem_alloc((2 * (last - first) + 1) * sizeof *u->phones);
    for (size_t i = first; i < last; i++) {
        const struct aligned_recording_phone *p = &r->phones[i];
        put_phone(u, "", 0, clip(p->start, r, from, to));
        put_phone(u, p->ipa, p->stress, clip(p->end, r, from, to));
    }
    put_phone(u, "", 0, u->samples);
}

static void put_words(const struct aligned_recording *r, uint64_t from, uint64_t to,
                      struct sentence_audio *u) {
    double rate = r->sound->rate;
    size_t first = 0, high = r->tokens.count;
    while (first < high) {
        size_t middle = (first + high) / 2;
        if (r->words[middle].known && r->words[middle].start * rate < (double)from)
            first = middle + 1;
        else
            high = middle;
    }
    size_t last = first;
    while (last < r->tokens.count && r->words[last].known && r->words[last].start * rate < (double)to)
        last++;
    u->words = mem_alloc((last - first + 1) * sizeof *u->words);
    for (size_t i = first; i < last; i++) {
        const struct text_word *t = &r->tokens.list[i];
        u->words[u->word_count++] = (struct word){.start = clip(r->words[i].start, r, from, to),
                                                  .end = clip(r->words[i].end, r, from, to),
                                                  .from = t->from,
                                                  .to = t->to,
                                                  .text = mem_strndup(r->text + t->from, t->to - t->from),
                                                  .doubt = (float)(1 - r->words[i].confidence)};
    }
}

struct sentence_audio *aligned_recording_audio(const struct aligned_recording *r, uint64_t from,
                                               uint64_t to) {
    struct sentence_audio *u = mem_alloc(sizeof *u);
    size_t count = (size_t)(to - from);
    u->sample_rate = r->sound->rate;
    u->pcm = mem_alloc(count * sizeof *u->pcm);
    r->sound->read(r->sound->ctx, from, u->pcm, count); /* what cannot be read stays silent */
    u->samples = (uint32_t)count;
    snprintf(u->lang, sizeof u->lang, "%s", r->lang);
    put_phones(r, from, to, u);
    put_words(r, from, to, u);
    if (u->word_count) {
        u->from = u->words[0].from;
        u->to = u->words[u->word_count - 1].to;
    }
    return u;
}

static uint64_t hash_of(const char *text, size_t size) {
    uint64_t hash = 14695981039346656037u;
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ (uint8_t)text[i]) * 1099511628211u;
    return hash;
}

static void put(FILE *file, bool first, json_t *object) {
    fputs(first ? "\n  " : ",\n  ", file);
    json_dumpf(object, file, JSON_FLAGS);
    json_decref(object);
}

json_t *aligned_recording_sentence_json(const struct aligned_recording_sentence *s) {
    return json_pack("{sI sI sf sf sf sf}", "byte_start", (json_int_t)s->from, "byte_end", (json_int_t)s->to,
                     "start", s->start, "end", s->end, "confidence", round(100 * s->confidence) / 100,
                     "passed", round(100 * s->passed) / 100);
}

static void write_all(const struct aligned_recording *r, FILE *file) {
    fprintf(file, "{\"lang\":\"%s\",\"samples\":%llu,\"rate\":%u,\"text\":\"%016llx\",\n \"phones\":[",
            r->lang, (unsigned long long)r->sound->samples, r->sound->rate,
            (unsigned long long)hash_of(r->text, r->text_size));
    for (size_t i = 0; i < r->phone_count; i++) {
        const struct aligned_recording_phone *p = &r->phones[i];
        put(file, !i,
            json_pack("{ss sf sf si}", "ipa", p->ipa, "start", p->start, "end", p->end, "stress", p->stress));
    }
    fputs("],\n \"words\":[", file);
    for (size_t i = 0; i < r->tokens.count; i++) {
        const struct text_word *t = &r->tokens.list[i];
        put(file, !i,
            json_pack("{ss% sf sf sf}", "text", r->text + t->from, t->to - t->from, "start",
                      r->words[i].start, "end", r->words[i].end, "confidence",
                      round(100 * r->words[i].confidence) / 100));
    }
    fputs("],\n \"sentences\":[", file);
    for (size_t i = 0; i < r->sentence_count; i++)
        put(file, !i, aligned_recording_sentence_json(&r->sentences[i]));
    fputs("]}\n", file);
}

int aligned_recording_save(const struct aligned_recording *r, const char *path, struct error *e) {
    char *part = mem_alloc(strlen(path) + 32);
    sprintf(part, "%s.%ld.part", path, (long)getpid()); /* others may align the same */
    FILE *file = fopen(part, "wx");
    bool well = file != NULL;
    if (file) {
        write_all(r, file);
        well = !ferror(file);
        well = !fclose(file) && well;
    }
    well = well && !rename(part, path);
    if (!well) {
        error_set(e, ERROR_BAD_TIMES, "%.150s: %s", path, strerror(errno));
        remove(part);
    }
    free(part);
    return well ? 0 : -1;
}

/* The members before the lists, which may be long, if all that is asked for is among them. */
static json_t *head_of(const char *json, size_t size) {
    const char *list = memchr(json, '[', size < HEAD_BYTES ? size : HEAD_BYTES);
    char head[HEAD_BYTES + 4];
    int length = list ? snprintf(head, sizeof head, "%.*s[]}", (int)(list - json), json) : 0;
    json_t *root = length ? json_loadb(head, (size_t)length, 0, NULL) : NULL;
    if (json_object_get(root, "samples") && json_object_get(root, "text"))
        return root;
    json_decref(root);
    return json_loadb(json, size, 0, NULL);
}

bool aligned_recording_is_of(const char *json, size_t size, const char *text, size_t text_size,
                             uint64_t samples) {
    json_t *root = head_of(json, size);
    const json_t *made_of = json_object_get(root, "samples");
    const char *made_for = json_string_value(json_object_get(root, "text"));
    char hash[24];
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)hash_of(text, text_size));
    bool well = (!made_of || (uint64_t)json_integer_value(made_of) == samples) &&
                (!made_for || !strcmp(made_for, hash));
    json_decref(root);
    return well;
}
