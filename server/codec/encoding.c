/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/codec/encoding.h"
#include "protocol/chunk.h"
#include "protocol/compact.h"
#include "server/base/suggest.h"
#include <stdlib.h>
#include <string.h>

enum { KILOBITS_LEAST = 6, KILOBITS_MOST = 64 };

struct codec {
    const char *name;
    int codec;
};

static const struct codec audio_names[] = {{"none", CHUNK_AUDIO_SILENCE},
                                           {"pcm_s16le", CHUNK_AUDIO_PCM_S16LE},
                                           {"pcm", CHUNK_AUDIO_PCM_S16LE},
                                           {"opus", CHUNK_AUDIO_OPUS},
                                           {0}},
                          fap_names[] = {{"none", CHUNK_FAP_NONE},
                                         {"plain", CHUNK_FAP_PLAIN},
                                         {"fapc", CHUNK_FAP_FAPC},
                                         {0}};

const struct encoding encoding_default = {CHUNK_AUDIO_OPUS, CHUNK_FAP_FAPC, 0, false};
const struct encoding encoding_none = {CHUNK_AUDIO_SILENCE, CHUNK_FAP_NONE, 0, false};

static int find(const struct codec *list, const char *name, const char *field, struct error *e) {
    struct suggestions near = suggestions_for(name);
    char text[SUGGESTIONS_TEXT];
    for (; list->name; list++) {
        if (!strcmp(list->name, name))
            return list->codec;
        suggest_name(&near, list->name, list->name);
    }
    return error_in_field(e, ERROR_UNKNOWN_CODEC, field, "no %s codec '%.80s'%s", field, name,
                          suggestions_text(&near, text));
}

int encoding_audio(const char *name, struct error *e) {
    return find(audio_names, name, "audio", e);
}

int encoding_fap(const char *name, struct error *e) {
    return find(fap_names, name, "fap", e);
}

int encoding_kilobits(const char *number) {
    char *end;
    long value = strtol(number, &end, 10);
    return *number && !*end && value >= KILOBITS_LEAST && value <= KILOBITS_MOST ? (int)value : -1;
}

int encoding_events(const char *name) {
    return !strcmp(name, "packed") ? 1 : !strcmp(name, "text") ? 0 : -1;
}

bool encoding_same(const struct encoding *a, const struct encoding *b) {
    return a->audio == b->audio && a->fap == b->fap && a->kilobits == b->kilobits && a->packed == b->packed;
}

bool encoding_possible(const struct encoding *e) {
    return e->audio != CHUNK_AUDIO_OPUS || e->fap != CHUNK_FAP_PLAIN;
}

bool encoding_is_compact(const struct encoding *e) {
    return e->audio == CHUNK_AUDIO_OPUS || e->fap == CHUNK_FAP_FAPC;
}

bool encoding_packs(const struct encoding *e, enum stream_event_kind kind) {
    return e->packed && encoding_is_compact(e) &&
           (kind == STREAM_SENTENCE || kind == STREAM_WORD || kind == STREAM_MARK || kind == STREAM_PHONE);
}
