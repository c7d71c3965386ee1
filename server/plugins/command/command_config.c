/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/plugins/command/command_internal.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SECONDS_USUAL 60
#define BYTES_USUAL (64 << 20)

enum { VOICES_MAX = 256, WORDS_MAX = 64 };

/* Destination of error messages. */
struct check {
    size_t voice;
    char *message;
    size_t cap;
};

static int wrong(const struct check *c, const char *field, const char *what) {
    snprintf(c->message, c->cap, "voices[%zu]%s%s: %s", c->voice, *field ? "." : "", field, what);
    return -1;
}

/* Reads a string, required unless there is a default. Returns NULL after an error. */
static const char *text(const struct check *c, const json_t *object, const char *key, const char *otherwise) {
    const json_t *value = json_object_get(object, key);
    if (!value && otherwise)
        return otherwise;
    if (!json_string_length(value)) {
        wrong(c, key, "must be a string");
        return NULL;
    }
    return json_string_value(value);
}

/* Reads a number in its range. Returns false after an error. */
static bool number(const struct check *c, const json_t *object, const char *key, double otherwise, double min,
                   double max, double *out) {
    const json_t *value = json_object_get(object, key);
    char what[80];
    *out = value ? json_number_value(value) : otherwise;
    if (!value || (json_is_number(value) && *out >= min && *out <= max))
        return true;
    snprintf(what, sizeof what, "must be a number from %.15g to %.15g", min, max);
    wrong(c, key, what);
    return false;
}

static bool is_one_of(const char *key, const char *const *known) {
    while (*known && strcmp(*known, key) != 0)
        known++;
    return *known;
}

static int check_keys(const struct check *c, const json_t *object) {
    static const char *const known[] = {"id",      "name",    "lang",  "gender", "quality",
                                        "licence", "rate",    "argv",  "feed",   "sound",
                                        "raw",     "seconds", "bytes", "times",  NULL};
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)object, key, value) {
        if (!is_one_of(key, known))
            return wrong(c, key, "unknown setting");
    }
    return 0;
}

/* Tells whether a word contains the placeholder. */
static bool mentions(const json_t *argv, const char *placeholder) {
    for (size_t i = 0; i < json_array_size(argv); i++)
        if (strstr(json_string_value(json_array_get(argv, i)), placeholder))
            return true;
    return false;
}

static int read_argv(const struct check *c, const json_t *object, struct cm_voice *v) {
    const json_t *feed = json_object_get(object, "feed"), *sound = json_object_get(object, "sound");
    v->argv = json_object_get(object, "argv");
    size_t count = json_array_size(v->argv);
    if (!count || count > WORDS_MAX)
        return wrong(c, "argv", "must be a list of strings, the program and its arguments");
    for (size_t i = 0; i < count; i++)
        if (!json_is_string(json_array_get(v->argv, i)))
            return wrong(c, "argv", "must be a list of strings, the program and its arguments");
    if (feed && !json_is_boolean(feed))
        return wrong(c, "feed", "must be true or false");
    v->feed = json_is_true(feed);
    if (!v->feed && !mentions(v->argv, "{text}"))
        return wrong(c, "argv", "the program is not given the text: \"{text}\" in argv, or \"feed\": true");
    v->file = sound && json_is_string(sound) && !strcmp(json_string_value(sound), "file");
    if (sound && !v->file && (!json_is_string(sound) || strcmp(json_string_value(sound), "stdout") != 0))
        return wrong(c, "sound", "must be \"stdout\" or \"file\"");
    if (v->file && !mentions(v->argv, "{output}"))
        return wrong(c, "argv", "the program is not given the sound's file, \"{output}\"");
    return 0;
}

/* Reads the setting "times". Returns -1 with the invalid field and the reason. */
static int read_times(struct cm_timing *timing, const json_t *setting, const char **field,
                      const char **what) {
    const char *format = json_string_value(json_object_get(setting, "format")), *name;
    size_t i = 0, k;
    json_t *value;
    *timing = (struct cm_timing){.given = true, .argv = json_object_get(setting, "argv")};
    timing->options.tier = json_string_value(json_object_get(setting, "tier"));
    timing->options.names = json_object_get(setting, "names");
    *field = "";
    *what = "must be an object";
    if (!json_is_object(setting))
        return -1;
    *field = ".format";
    *what = "must be \"lab\", \"htk\", \"textgrid\" or \"json\"";
    while (i < TIMES_OFFSETS && (!format || strcmp(format, times_format_names[i]) != 0))
        i++;
    if (i == TIMES_OFFSETS)
        return -1;
    timing->options.format = (enum times_format)i;
    *field = ".tier";
    *what = "must be a string";
    if (json_object_get(setting, "tier") && !timing->options.tier)
        return -1;
    *field = ".argv";
    *what = "must be a list of strings, the program and its arguments";
    if (timing->argv && !json_array_size(timing->argv))
        return -1;
    json_array_foreach(timing->argv, k, value) if (!json_is_string(value)) return -1;
    *field = ".names";
    *what = "must be an object with an IPA string for each of the program's names";
    if (timing->options.names && !json_is_object(timing->options.names))
        return -1;
    json_object_foreach((json_t *)timing->options.names, name, value) if (!json_is_string(value)) return -1;
    return 0;
}

static int read_timing(const struct check *c, const json_t *object, struct cm_voice *v) {
    const json_t *times = json_object_get(object, "times");
    const char *field, *what;
    if (!times)
        return 0;
    if (read_times(&v->timing, times, &field, &what)) {
        char full[32];
        snprintf(full, sizeof full, "times%s", field);
        return wrong(c, full, what);
    }
    if (!v->timing.argv && !mentions(v->argv, "{times}"))
        return wrong(c, "argv", "the program is not given the file for its times, \"{times}\"");
    return 0;
}

static int read_voice(const struct check *c, const json_t *object, struct cm_voice *v) {
    double rate, raw, seconds, bytes;
    if (!json_is_object(object))
        return wrong(c, "", "must be an object");
    if (check_keys(c, object) < 0 || !(v->info.id = text(c, object, "id", NULL)) ||
        !(v->info.name = text(c, object, "name", v->info.id)) ||
        !(v->info.lang = text(c, object, "lang", NULL)) ||
        !(v->info.gender = text(c, object, "gender", "neutral")) ||
        !(v->info.quality = text(c, object, "quality", "unknown")) ||
        !(v->info.licence = text(c, object, "licence", "LicenseRef-unknown")) ||
        !number(c, object, "rate", 0, 20, 1000, &rate) || !number(c, object, "raw", 0, 8000, 192000, &raw) ||
        !number(c, object, "seconds", SECONDS_USUAL, 0.1, 3600, &seconds) ||
        !number(c, object, "bytes", BYTES_USUAL, 1024, 1 << 30, &bytes))
        return -1;
    v->info.rate = (uint32_t)rate;
    v->raw = (uint32_t)raw;
    v->info.sample_rate = v->raw;
    v->seconds = seconds;
    v->bytes = (size_t)bytes;
    return read_argv(c, object, v) < 0 ? -1 : read_timing(c, object, v);
}

int cm_config_read(struct cm_voices *voices, const char *config, char *message, size_t cap) {
    json_error_t why;
    const json_t *list;
    const char *key;
    json_t *value;
    *voices = (struct cm_voices){.root = json_loads(config, 0, &why)};
    if (!json_is_object(voices->root)) {
        snprintf(message, cap, "must be an object");
        return -1;
    }
    json_object_foreach(voices->root, key, value) {
        if (strcmp(key, "voices") != 0) {
            snprintf(message, cap, "%s: unknown setting", key);
            return -1;
        }
    }
    list = json_object_get(voices->root, "voices");
    if (list && (!json_is_array(list) || json_array_size(list) > VOICES_MAX)) {
        snprintf(message, cap, "voices: must be a list of at most %d voices", VOICES_MAX);
        return -1;
    }
    size_t count = json_array_size(list);
    if (!count) {
        snprintf(message, cap, "no programs are configured as voices");
        return 1;
    }
    voices->list = mem_alloc(count * sizeof *voices->list);
    for (; voices->count < count; voices->count++) {
        const struct check c = {voices->count, message, cap};
        struct cm_voice v = {0};
        if (read_voice(&c, json_array_get(list, voices->count), &v) < 0)
            return -1;
        if (cm_voices_find(voices, v.info.id))
            return wrong(&c, "id", "another voice has it");
        voices->list[voices->count] = v;
    }
    return 0;
}

void cm_config_free(struct cm_voices *voices) {
    free(voices->list);
    json_decref(voices->root);
    *voices = (struct cm_voices){0};
}

const struct cm_voice *cm_voices_find(const struct cm_voices *voices, const char *id) {
    for (size_t i = 0; i < voices->count; i++)
        if (!strcmp(voices->list[i].info.id, id))
            return &voices->list[i];
    return NULL;
}
