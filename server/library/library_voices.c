/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/library_voices.h"
#include "server/base/mem.h"
#include "server/library/library_files.h"
#include "server/library/work.h"
#include <errno.h>
#include <jansson.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* What is spoken of the sections, one after the other: what a passage says is a stretch of it. */
static int on_section(void *ctx, const struct section *section) {
    struct buf *text = ctx;
    for (size_t i = 0; i < section->count; i++) {
        const struct block *b = &section->blocks[i];
        if (b->kind == BLOCK_HEAD || b->kind == BLOCK_PARAGRAPH || b->kind == BLOCK_VERSE) {
            buf_add(text, b->text.data, b->text.size);
            buf_add(text, "\n\n", 2);
        }
    }
    return 0;
}

static void on_problem(void *ctx, const struct error *e, bool serious) {
    (void)ctx;
    (void)e;
    (void)serious;
}

static int keep(const char *path, const void *data, size_t size, struct error *e) {
    FILE *file = fopen(path, "wb");
    bool well = file && fwrite(data, 1, size, file) == size;
    if (file && fclose(file))
        well = false;
    return well ? 0 : error_set(e, ERROR_BAD_INDEX, "%.150s: %.80s", path, strerror(errno));
}

static bool is_newer(const char *made, const char *source) {
    struct stat a, b;
    return !stat(made, &a) && !stat(source, &b) &&
           (a.st_mtim.tv_sec > b.st_mtim.tv_sec ||
            (a.st_mtim.tv_sec == b.st_mtim.tv_sec && a.st_mtim.tv_nsec > b.st_mtim.tv_nsec));
}

static int describe(const char *path, const struct work_meta *meta, const char *title, struct error *e) {
    json_t *object =
        json_pack("{ss ss}", "name", meta->title && *meta->title ? meta->title : title, "lang", meta->lang);
    char *text = object ? json_dumps(object, JSON_COMPACT) : NULL;
    int result = text ? keep(path, text, strlen(text), e) : 0;
    free(text);
    json_decref(object);
    return result;
}

/* One work: 1 when it has a voice now, 0 when not. */
static int prepare(const char *library, const char *path, const char *folder, const char *lang,
                   struct error *e) {
    char name[64], sound[PATH_MAX], base[PATH_MAX - 16], file[PATH_MAX];
    char *full = library_file_path(library, path);
    struct work_meta meta = {.lang = mem_strdup(lang)};
    struct buf text = {0};
    const struct work_sink sink = {&text, on_section, on_problem};
    struct error ignored;
    int result = 0;
    library_file_name(path, false, name);
    if (library_file_sound(full, sound) &&
        snprintf(base, sizeof base, "%s/%s", folder, name) < (int)sizeof base) {
        snprintf(file, sizeof file, "%s%s", base, strrchr(sound, '.'));
        unlink(file);
        result =
            symlink(sound, file) ? error_set(e, ERROR_BAD_INDEX, "%.150s: %.80s", file, strerror(errno)) : 1;
        snprintf(file, sizeof file, "%s.txt", base);
        if (result > 0 && !is_newer(file, full) && !work_read(full, &meta, &sink, &ignored)) {
            result = keep(file, text.data, text.size, e) ? -1 : 1;
            snprintf(file, sizeof file, "%s.json", base);
            if (result > 0 && describe(file, &meta, name, e))
                result = -1;
        }
    }
    work_meta_free(&meta);
    buf_free(&text);
    free(full);
    return result;
}

int library_voices_prepare(const char *library, const char *folder, const char *lang, struct error *e) {
    struct library_files files = {0};
    int count = 0, result = library_files_list(&files, library, e);
    if (!result && mkdir(folder, 0700) && errno != EEXIST)
        result = error_set(e, ERROR_BAD_INDEX, "%.150s: %.80s", folder, strerror(errno));
    for (size_t i = 0; !result && i < files.count; i++) {
        int one = prepare(library, files.list[i].path, folder, lang, e);
        result = one < 0 ? -1 : 0;
        count += one > 0;
    }
    library_files_free(&files);
    return result ? -1 : count;
}
