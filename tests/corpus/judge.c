/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs the readers on files: each line of standard input has a kind and a path; each line of standard output
 * is "ok", or code, position and message separated by tabs. */
#include "server/api/api_internal.h"
#include "server/base/mem.h"
#include "server/daemon/settings_internal.h"
#include "server/expression/gestures.h"
#include "server/face/packs/context_table.h"
#include "server/face/packs/speech_pack_internal.h"
#include "server/face/packs/spelling.h"
#include "server/library/align/times.h"
#include "server/normalize/normalizers.h"
#include "server/plugins/command/command_internal.h"
#include "server/voice/assembly.h"
#include <libgen.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct speech_packs packs;

static const struct speech_pack *whole(const char *lang) {
    struct error e;
    if (!packs.count && speech_packs_load(&packs, SOURCE_ROOT "/models/speech", &e)) {
        fprintf(stderr, "judge: %s\n", e.message);
        exit(2);
    }
    return speech_packs_find(&packs, lang);
}

static bool pack(const char *path, struct error *e) {
    struct speech_pack *loaded = speech_pack_load(path, e);
    speech_pack_free(loaded);
    return loaded;
}

static bool alphabets(const char *path, struct error *e) {
    struct alphabet *loaded = alphabet_load(path, e);
    alphabet_free(loaded);
    return loaded;
}

static bool visemes(const char *path, struct error *e) {
    struct context_table *loaded = context_table_load(path, whole("pt-BR"), e);
    context_table_free(loaded);
    return loaded;
}

static bool letters(const char *path, struct error *e) {
    struct spelling *loaded = spelling_load(path, whole("tr"), e);
    spelling_free(loaded);
    return loaded;
}

static bool expressions(const char *path, struct error *e) {
    struct expressions *loaded = expressions_load(path, e);
    if (loaded)
        expressions_free(loaded);
    return loaded;
}

static bool gesture(const char *path, struct error *e) {
    struct expressions *all = expressions_load(SOURCE_ROOT "/models/expressions.json", e);
    bool good = all && !gesture_load(all, path, e);
    expressions_free(all);
    return good;
}

static bool normalization(const char *path, struct error *e) {
    json_t *loaded = normalizer_read(path, e);
    json_decref(loaded);
    return loaded;
}

static bool boundaries(const char *path, struct error *e) {
    struct boundary_table *loaded = boundary_table_load(path, e);
    boundary_table_free(loaded);
    return loaded;
}

/* All of a file, with a NUL behind it; size is without that. */
static char *content(const char *path, size_t *size) {
    enum { MOST = 1 << 24 };
    FILE *file = fopen(path, "rb");
    char *text = mem_alloc(MOST);
    *size = file ? fread(text, 1, MOST - 1, file) : 0;
    if (file)
        fclose(file);
    return text;
}

static bool timed(const char *path, struct error *e) {
    struct times_options options = {.format = TIMES_JSON};
    struct times times;
    size_t size;
    char *text = content(path, &size);
    bool good = !times_read(&times, &options, text, size, e);
    times_free(&times);
    free(text);
    return good;
}

/* As the daemon reads the file of --config. */
static bool settings(const char *path, struct error *e) {
    struct settings read = {0};
    bool good = !settings_from_file(&read, PROGRAM_DAEMON, path, e);
    settings_free(&read);
    if (e->place == PLACE_FIELD && !strcmp(e->field, "--config"))
        e->place = PLACE_NONE;
    return good;
}

/* The part of the plugin "command"; none at all is right, too. */
static bool voices(const char *path, struct error *e) {
    struct cm_voices read;
    char message[256] = "", *text;
    size_t size;
    bool good = cm_config_read(&read, text = content(path, &size), message, sizeof message) >= 0;
    char *what = strstr(message, ": ");
    if (!good && what) {
        *what = '\0';
        error_in_field(e, ERROR_BAD_VOICE_CONFIG, message, "%s", what + 2);
    } else if (!good) {
        error_set(e, ERROR_BAD_VOICE_CONFIG, "%s", message);
    }
    cm_config_free(&read);
    free(text);
    return good;
}

/* As the daemon serves it under the name of the file. */
static bool head(const char *path, struct error *e) {
    char name[300], *copy = mem_strdup(path), *base = basename(copy);
    snprintf(name, sizeof name, "%.*s", (int)strcspn(base, "."), base);
    struct model model = {0};
    size_t size;
    char *text = content(path, &size);
    bool good = !model_split(&model, name, text, size, base, e);
    model_free(&model);
    free(text);
    free(copy);
    return good;
}

static const struct kind {
    const char *name;
    bool (*read)(const char *path, struct error *e);
} kinds[] = {{"pack", pack},
             {"alphabets", alphabets},
             {"visemes", visemes},
             {"letters", letters},
             {"expressions", expressions},
             {"gesture", gesture},
             {"normalization", normalization},
             {"boundaries", boundaries},
             {"head", head},
             {"timed", timed},
             {"settings", settings},
             {"voices", voices}};

static bool judge(const struct kind *kind, const char *path) {
    struct error e = {0};
    char place[64] = "";
    bool good = kind->read(path, &e);
    if (e.place == PLACE_LINE)
        snprintf(place, sizeof place, "%zu:%zu", e.line, e.column);
    if (good)
        puts("ok");
    else
        printf("%s\t%s\t%s\n", error_name(e.code), e.place == PLACE_FIELD ? e.field : place, e.message);
    return !fflush(stdout);
}

int main(void) {
    char line[5000];
    while (fgets(line, sizeof line, stdin)) {
        char *path = strchr(line, ' ');
        size_t i = 0, count = sizeof kinds / sizeof *kinds;
        line[strcspn(line, "\n")] = '\0';
        if (path)
            *path++ = '\0';
        while (i < count && strcmp(kinds[i].name, line) != 0)
            i++;
        if (!path || i == count || !judge(&kinds[i], path)) {
            fprintf(stderr, "judge: not a kind and a path: %s\n", line);
            return 2;
        }
    }
    speech_packs_free(&packs);
    return 0;
}
