/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What programs are told, and what they answer. */
#include "server/base/mem.h"
#include "server/plugins/command/speaking.h"
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define RATE_USUAL 170

/* What a placeholder stands for, into out, or NULL when it is none. */
static const char *value_of(const struct cm_speaking *s, const struct faccia_span *span, const char *name,
                            size_t length, char out[32]) {
    const struct faccia_voice_info *info = &s->voice->info;
    double own = info->rate ? info->rate : RATE_USUAL, rate = span->rate > 0 ? span->rate : own;
    const struct {
        const char *name;
        const char *text;
        double number;
    } known[] = {
        {"text", span->text, 0},      {"lang", info->lang, 0},      {"voice", info->id, 0},
        {"output", s->output, 0},     {"times", s->times, 0},       {"plugins", s->beside, 0},
        {"rate", NULL, round(rate)},  {"speed", NULL, rate / own},  {"stretch", NULL, own / rate},
        {"pitch", NULL, span->pitch}, {"range", NULL, span->range}, {"volume", NULL, span->volume},
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        if (strlen(known[i].name) != length || memcmp(known[i].name, name, length) != 0)
            continue;
        snprintf(out, 32, "%.4g", known[i].number);
        return known[i].text ? known[i].text : out;
    }
    return NULL;
}

/* A word of argv with its placeholders filled in. The caller frees it. */
static char *fill_in(const struct cm_speaking *s, const struct faccia_span *span, const char *word) {
    struct buf b = {0};
    char number[32];
    for (const char *end; *word; word = end) {
        const char *value = NULL;
        end = word + 1;
        if (*word == '{' && (end = strchr(word, '}')) != NULL)
            value = value_of(s, span, word + 1, (size_t)(end - word) - 1, number);
        end = value ? end + 1 : word + 1;
        buf_add(&b, value ? value : word, value ? strlen(value) : 1);
    }
    buf_add(&b, "", 1);
    return (char *)b.data;
}

enum cm_result cm_ask(const struct cm_speaking *s, const json_t *words, const struct faccia_span *span,
                      struct buf *out) {
    size_t count = json_array_size(words);
    char **argv = mem_alloc((count + 1) * sizeof *argv);
    for (size_t i = 0; i < count; i++)
        argv[i] = fill_in(s, span, json_string_value(json_array_get(words, i)));
    const struct cm_run setup = {argv, s->voice->feed ? span->text : NULL, s->voice->seconds,
                                 s->voice->bytes};
    enum cm_result result = cm_run(&setup, s->stop, out, s->message, s->cap);
    for (size_t i = 0; i < count; i++)
        free(argv[i]);
    free(argv);
    return result;
}

int cm_take_file(const struct cm_speaking *s, const char *path, struct buf *out) {
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    struct stat info;
    ssize_t n = fd < 0 || fstat(fd, &info) < 0 || !S_ISREG(info.st_mode) ? -1 : 1;
    while (n > 0 && out->size <= s->voice->bytes) {
        n = read(fd, buf_reserve(out, 65536), 65536);
        out->size += n > 0 ? (size_t)n : 0;
    }
    if (fd >= 0)
        close(fd);
    unlink(path);
    if (n >= 0 && out->size <= s->voice->bytes)
        return 0;
    snprintf(s->message, s->cap, "\"%.60s\" %s", json_string_value(json_array_get(s->voice->argv, 0)),
             n < 0 ? "did not write its file" : "wrote too much");
    return -1;
}
