/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/plugins/festival/festival_voices.h"
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static int read_language(const json_t *languages, const char *lang, struct fe_language *out,
                         json_error_t *why) {
    char tag[16];
    snprintf(tag, sizeof tag, "%.*s", (int)strcspn(lang, "-"), lang);
    return json_unpack_ex(json_object_get(languages, tag), why, 0, "{s:s s:s s:o s:o}", "letters",
                          &out->letters, "punctuation", &out->punctuation, "symbols", &out->symbols, "phones",
                          &out->phones);
}

static int read_voice(json_t *object, const json_t *languages, struct fe_voice *v, const char **data,
                      json_error_t *why) {
    const char *engine = "";
    int sample_rate = 0, rate = 0;
    if (json_unpack_ex(object, why, JSON_STRICT, "{s:s s:s s:s s:s s:s s:s s:i s:i s:s s:s s:s s:F s:F}",
                       "id", &v->info.id, "name", &v->info.name, "lang", &v->info.lang, "gender",
                       &v->info.gender, "quality", &v->info.quality, "licence", &v->info.licence,
                       "sample_rate", &sample_rate, "rate", &rate, "festival", &v->festival, "data", data,
                       "engine", &engine, "units", &v->units, "gain", &v->gain))
        return -1;
    v->info.sample_rate = (uint32_t)sample_rate;
    v->info.rate = (uint32_t)rate;
    v->hts = !strcmp(engine, "hts");
    return read_language(languages, v->info.lang, &v->language, why);
}

int fe_voices_load(struct fe_voices *voices, const char *path, const char *datadir, char *message,
                   size_t cap) {
    json_error_t why;
    json_t *languages, *list, *object;
    size_t i;
    *voices = (struct fe_voices){.root = json_load_file(path, 0, &why)};
    if (!voices->root || json_unpack_ex(voices->root, &why, JSON_STRICT, "{s:o s:o}", "languages", &languages,
                                        "voices", &list)) {
        snprintf(message, cap, "%s: line %d: %s", path, why.line, why.text);
        return -1;
    }
    json_array_foreach(list, i, object) {
        struct fe_voice v = {.units = 1};
        const char *data = "";
        char folder[1024];
        if (read_voice(object, languages, &v, &data, &why)) {
            snprintf(message, cap, "%s: voices[%zu]: %s", path, i, why.text);
            return -1;
        }
        snprintf(folder, sizeof folder, "%s/%s", datadir, data);
        if (access(folder, R_OK) == 0 && voices->count < FE_VOICES_MAX)
            voices->list[voices->count++] = v;
    }
    if (voices->count)
        return 0;
    snprintf(message, cap, "none of Festival's voices is installed under %s (Debian: festvox-italp16k)",
             datadir);
    return 1;
}

void fe_voices_free(struct fe_voices *voices) {
    json_decref(voices->root);
    *voices = (struct fe_voices){0};
}

const struct fe_voice *fe_voices_find(const struct fe_voices *voices, const char *id) {
    for (size_t i = 0; i < voices->count; i++)
        if (!strcmp(voices->list[i].info.id, id))
            return &voices->list[i];
    return NULL;
}
