/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/plugins/kokoro/kokoro_voices.h"
#include "server/base/mem.h"
#include "server/plugins/kokoro/kokoro_timing.h"
#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SUFFIX ".bin"

static const char *text_of(const json_t *object, const char *key) {
    return json_string_value(json_object_get(object, key));
}

/* The file NAME.bin, if kokoro.json knows its letters. */
static void add(struct ko_voices *voices, const char *folder, const char *file) {
    size_t length = strlen(file) - strlen(SUFFIX);
    const char language[2] = {file[0]}, gender[2] = {file[1]};
    const json_t *entry = json_object_get(json_object_get(voices->table, "languages"), language);
    const char *sex = text_of(json_object_get(voices->table, "genders"), gender);
    const char *lang = text_of(entry, "lang"), *espeak = text_of(entry, "espeak");
    if (!lang || !espeak || !sex || length < 4 || file[2] != '_')
        return;
    voices->list = mem_grow(voices->list, &voices->cap, voices->count + 1, sizeof *voices->list);
    struct ko_voice *v = &voices->list[voices->count++];
    *v = (struct ko_voice){.espeak = espeak,
                           .alphabet = {voices->vocabulary, json_object_get(entry, "phones")}};
    snprintf(v->id, sizeof v->id, "%.*s", (int)length, file);
    snprintf(v->name, sizeof v->name, "Kokoro %.*s", (int)length - 3, file + 3);
    v->name[7] = (char)toupper((unsigned char)v->name[7]);
    double gain = json_number_value(json_object_get(json_object_get(voices->table, "gains"), v->id));
    v->gain = gain > 0 ? gain : 1;
    size_t size = strlen(folder) + strlen(file) + 2;
    v->file = mem_alloc(size);
    snprintf(v->file, size, "%s/%s", folder, file);
    v->info = (struct faccia_voice_info){.lang = lang,
                                         .gender = sex,
                                         .quality = "neural",
                                         .licence = "Apache-2.0",
                                         .sample_rate = KO_RATE,
                                         .rate = KO_WORDS_PER_MINUTE};
}

static int by_id(const void *a, const void *b) {
    return strcmp(((const struct ko_voice *)a)->id, ((const struct ko_voice *)b)->id);
}

static int read_folder(struct ko_voices *voices, const char *folder, char *message, size_t cap) {
    DIR *dir = opendir(folder);
    if (!dir) {
        snprintf(message, cap, "the voices in %s cannot be read: %s", folder, strerror(errno));
        return -1;
    }
    for (const struct dirent *entry; (entry = readdir(dir)) != NULL;) {
        size_t length = strlen(entry->d_name);
        if (length > strlen(SUFFIX) && !strcmp(entry->d_name + length - strlen(SUFFIX), SUFFIX))
            add(voices, folder, entry->d_name);
    }
    closedir(dir);
    if (!voices->count) {
        snprintf(message, cap, "there are no voices in %s", folder);
        return -1;
    }
    qsort(voices->list, voices->count, sizeof *voices->list, by_id);
    for (size_t i = 0; i < voices->count; i++) {
        voices->list[i].info.id = voices->list[i].id;
        voices->list[i].info.name = voices->list[i].name;
    }
    return 0;
}

int ko_voices_load(struct ko_voices *voices, const char *table, const char *vocabulary, const char *folder,
                   char *message, size_t cap) {
    json_error_t error;
    const char *file = table;
    voices->table = json_load_file(table, 0, &error);
    json_t *tokenizer = NULL;
    if (voices->table)
        tokenizer = json_load_file(file = vocabulary, 0, &error);
    if (!tokenizer) {
        snprintf(message, cap, "%s, line %d: %s", file, error.line, error.text);
        return -1;
    }
    voices->vocabulary = json_incref(json_object_get(json_object_get(tokenizer, "model"), "vocab"));
    json_decref(tokenizer);
    if (!json_object_size(voices->vocabulary)) {
        snprintf(message, cap, "%s has no vocabulary", vocabulary);
        return -1;
    }
    return read_folder(voices, folder, message, cap);
}

void ko_voices_free(struct ko_voices *voices) {
    for (size_t i = 0; i < voices->count; i++)
        free(voices->list[i].file);
    free(voices->list);
    json_decref(voices->table);
    json_decref(voices->vocabulary);
    *voices = (struct ko_voices){0};
}

const struct ko_voice *ko_voices_find(const struct ko_voices *voices, const char *id) {
    for (size_t i = 0; i < voices->count; i++)
        if (!strcmp(voices->list[i].id, id))
            return &voices->list[i];
    return NULL;
}

bool ko_voice_style(const struct ko_voice *voice, size_t tokens, float style[KO_STYLE], char *message,
                    size_t cap) {
    FILE *file = fopen(voice->file, "rb");
    bool read = file && fseek(file, (long)(tokens * KO_STYLE * sizeof *style), SEEK_SET) == 0 &&
                fread(style, sizeof *style, KO_STYLE, file) == KO_STYLE;
    if (file)
        fclose(file);
    if (!read)
        snprintf(message, cap, "the voice %s has no style for %zu tokens", voice->file, tokens);
    return read;
}
