/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/api/library/cast_offer.h"
#include "server/api/api_internal.h"
#include "server/base/mem.h"
#include <jansson.h>
#include <stdlib.h>
#include <string.h>

/* The lists and their strings are one block each. */
struct owned {
    struct cast_offer offer;
    struct cast_voice *voices;
    struct cast_head *heads;
    struct buf texts;
};

/* Offsets in `texts` until it has stopped growing. */
static const char *keep(struct buf *texts, const char *text) {
    size_t at = texts->size;
    text = text ? text : "";
    buf_add(texts, text, strlen(text) + 1);
    return (const char *)at;
}

static const char *placed(const struct buf *texts, const char *offset) {
    return (const char *)texts->data + (size_t)offset;
}

static void add_heads(struct owned *o, const struct heads *heads) {
    o->heads = mem_alloc((heads->count + 1) * sizeof *o->heads);
    o->offer.head_count = heads->count;
    for (size_t i = 0; i < heads->count; i++) {
        json_t *voice = heads->list[i].voice ? json_loads(heads->list[i].voice, 0, NULL) : NULL;
        o->heads[i] = (struct cast_head){keep(&o->texts, heads->list[i].name),
                                         keep(&o->texts, json_string_value(json_object_get(voice, "gender"))),
                                         keep(&o->texts, json_string_value(json_object_get(voice, "age")))};
        json_decref(voice);
    }
}

static void add_voices(struct owned *o, const struct offer *from) {
    o->voices = mem_alloc((from->voice_count + 1) * sizeof *o->voices);
    o->offer.voice_count = from->voice_count;
    for (size_t i = 0; i < from->voice_count; i++) {
        const struct offer_voice *v = &from->voices[i];
        o->voices[i] = (struct cast_voice){keep(&o->texts, v->id), keep(&o->texts, v->lang),
                                           keep(&o->texts, v->gender), keep(&o->texts, v->quality)};
    }
}

struct cast_offer *cast_offer_new(const struct api *api) {
    struct owned *o = mem_alloc(sizeof *o);
    add_heads(o, &api->heads);
    add_voices(o, api->offer.now(api->offer.ctx));
    for (size_t i = 0; i < o->offer.head_count; i++)
        o->heads[i] =
            (struct cast_head){placed(&o->texts, o->heads[i].name), placed(&o->texts, o->heads[i].gender),
                               placed(&o->texts, o->heads[i].age)};
    for (size_t i = 0; i < o->offer.voice_count; i++)
        o->voices[i] = (struct cast_voice){
            placed(&o->texts, o->voices[i].id), placed(&o->texts, o->voices[i].lang),
            placed(&o->texts, o->voices[i].gender), placed(&o->texts, o->voices[i].quality)};
    o->offer.voices = o->voices;
    o->offer.heads = o->heads;
    return &o->offer;
}

void cast_offer_free(struct cast_offer *offer) {
    struct owned *o = (struct owned *)offer;
    if (!o)
        return;
    free(o->voices);
    free(o->heads);
    buf_free(&o->texts);
    free(o);
}
