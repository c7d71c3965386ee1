/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/recordings/library_voices.h"
#include "server/base/files.h"
#include "server/base/mem.h"
#include "server/library/library_files.h"
#include "server/library/works/work.h"
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <jansson.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

static int fail(const char *path, struct error *e) {
    return error_set(e, ERROR_BAD_INDEX, "%.150s: %.80s", path, strerror(errno));
}

static int path_of(char path[PATH_MAX], const char *folder, const char *work, const char *ending,
                   struct error *e) {
    errno = ENAMETOOLONG;
    return snprintf(path, PATH_MAX - 32, "%s/%s%s", folder, work, ending) < PATH_MAX - 32 ? 0
                                                                                          : fail(folder, e);
}

static bool holds(const char *path, const void *data, size_t size) {
    struct stat info;
    if (stat(path, &info) || (size_t)info.st_size != size)
        return false;
    FILE *file = fopen(path, "rb");
    char *now = mem_alloc(size + 1);
    bool same = file && fread(now, 1, size, file) == size && (!size || !memcmp(now, data, size));
    free(now);
    if (file)
        fclose(file);
    return same;
}

/* Writes the file unless it already has that content. -1 with *e: "bad-index". */
static int kept_set(const char *folder, const char *work, const char *ending, const void *data, size_t size,
                    struct error *e) {
    char path[PATH_MAX], part[PATH_MAX];
    if (path_of(path, folder, work, ending, e))
        return -1;
    if (holds(path, data, size))
        return 0;
    snprintf(part, sizeof part, "%.*s.%ld.part", PATH_MAX - 32, path, (long)getpid());
    FILE *file = fopen(part, "wb");
    bool well = file && fwrite(data, 1, size, file) == size && !fflush(file) && !fsync(fileno(file));
    if (file && fclose(file))
        well = false;
    if (well && !rename(part, path))
        return 0;
    fail(path, e);
    unlink(part);
    return -1;
}

int kept_set_json(const char *folder, const char *work, const char *ending, const json_t *value,
                  struct error *e) {
    char *text = json_dumps(value, JSON_COMPACT | JSON_REAL_PRECISION(9));
    int result = kept_set(folder, work, ending, text, strlen(text), e);
    free(text);
    return result;
}

json_t *kept_json(const char *folder, const char *work, const char *ending) {
    char path[PATH_MAX];
    struct error e;
    return path_of(path, folder, work, ending, &e) ? NULL : json_load_file(path, 0, NULL);
}

int64_t kept_time(const struct stat *file) {
    return (int64_t)file->st_mtim.tv_sec * 1000000000 + file->st_mtim.tv_nsec;
}

static const char *const times_endings[] = {".TextGrid", ".textgrid", ".lab", ".mlf", ".times", NULL};

/* The spoken text of all sections, and where each passage starts in it. */
struct spoken {
    struct buf text;
    json_t *places;
    const atomic_bool *stop;
};

static int on_section(void *ctx, const struct section *section) {
    struct spoken *s = ctx;
    for (size_t i = 0; i < section->count; i++) {
        const struct block *b = &section->blocks[i];
        if (b->kind != BLOCK_HEAD && b->kind != BLOCK_PARAGRAPH && b->kind != BLOCK_VERSE)
            continue;
        json_array_append_new(s->places, json_pack("[Io]", (json_int_t)s->text.size,
                                                   json_sprintf("%u:%s", section->number, b->name)));
        block_spoken(b, &s->text);
        buf_add(&s->text, "\n\n", 2);
    }
    return s->stop && atomic_load(s->stop);
}

static void on_problem(void *ctx, const struct error *e, bool serious) {
    (void)ctx;
    (void)e;
    (void)serious;
}

/* Makes the link point to `to`, or removes it if `to` is NULL. A correct link stays, as another process
 * may be about to open it. */
static int set_link(const char *folder, const char *work, const char *ending, const char *to,
                    struct error *e) {
    char path[PATH_MAX], now[PATH_MAX];
    if (snprintf(path, sizeof path, "%s/%s%s", folder, work, ending) >= (int)sizeof path)
        return error_set(e, ERROR_BAD_INDEX, "%.150s: %.80s", folder, strerror(ENAMETOOLONG));
    ssize_t length = readlink(path, now, sizeof now - 1);
    now[length < 0 ? 0 : length] = '\0';
    if (to && length >= 0 && !strcmp(now, to))
        return 0;
    if (length >= 0)
        unlink(path);
    return to && symlink(to, path) ? error_set(e, ERROR_BAD_INDEX, "%.150s: %.80s", path, strerror(errno))
                                   : 0;
}

static int link_times(const char *library, const char *file, const char *work, const char *folder,
                      struct error *e) {
    int result = 0;
    for (const char *const *ending = times_endings; *ending && !result; ending++) {
        char real[PATH_MAX];
        bool there = library_file_beside(library, file, *ending, real);
        result = set_link(folder, work, *ending, there ? real : NULL, e);
    }
    return result;
}

bool library_voice_has_times(const char *folder, const char *work) {
    char path[PATH_MAX];
    for (const char *const *ending = times_endings; *ending; ending++)
        if (snprintf(path, sizeof path, "%s/%s%s", folder, work, *ending) < (int)sizeof path &&
            !access(path, R_OK))
            return true;
    return false;
}

/* True when the text was made from the current file. */
static bool is_current(const char *folder, const char *work, const char *lang, const struct stat *file) {
    json_t *places = kept_json(folder, work, ".places");
    const char *made_for = json_string_value(json_object_get(places, "lang"));
    char path[PATH_MAX];
    snprintf(path, sizeof path, "%s/%s.txt", folder, work);
    bool current = json_integer_value(json_object_get(places, "size")) == file->st_size &&
                   json_integer_value(json_object_get(places, "modified")) == kept_time(file) && made_for &&
                   !strcmp(made_for, lang) && !access(path, R_OK);
    json_decref(places);
    return current;
}

static int describe(const char *folder, const char *work, const struct work_meta *meta, struct error *e) {
    json_t *object =
        json_pack("{ss ss}", "name", meta->title && *meta->title ? meta->title : work, "lang", meta->lang);
    int result = object ? kept_set_json(folder, work, ".json", object, e) : 0;
    json_decref(object);
    return result;
}

/* Writes the places last: they prove that the text is complete. */
static int write_text(const char *library, const char *file, const char *work, const char *folder,
                      const char *lang, const struct stat *info, const struct reader *reader,
                      const atomic_bool *stop, struct error *e) {
    struct work_meta meta = {.lang = mem_strdup(lang)};
    struct spoken spoken = {.places = json_array(), .stop = stop};
    const struct work_sink sink = {&spoken, on_section, on_problem};
    struct error ignored;
    bool whole =
        !work_read_apart(reader, library, file, &meta, &sink, stop, &ignored) && !(stop && atomic_load(stop));
    json_t *places = json_pack("{sI sI ss sO}", "size", (json_int_t)info->st_size, "modified",
                               (json_int_t)kept_time(info), "lang", lang, "places", spoken.places);
    int result = 0;
    if (whole) {
        result = describe(folder, work, &meta, e) ||
                         kept_set(folder, work, ".txt", spoken.text.data, spoken.text.size, e) ||
                         kept_set_json(folder, work, ".places", places, e)
                     ? -1
                     : 1;
    }
    json_decref(places);
    json_decref(spoken.places);
    buf_free(&spoken.text);
    work_meta_free(&meta);
    return result;
}

int library_voice_prepare(const char *library, const char *file, const char *work, const char *folder,
                          const char *lang, const struct reader *reader, const atomic_bool *stop,
                          struct error *e) {
    char sound[PATH_MAX];
    struct stat info;
    int fd = library_file_sound(library, file, sound) ? open_below(library, file, O_RDONLY) : -1;
    bool there = fd >= 0 && !fstat(fd, &info);
    if (fd >= 0)
        close(fd);
    if (!there)
        return 0;
    bool book = !strcasecmp(strrchr(sound, '.'), ".epub");
    if ((!book && set_link(folder, work, ".epub", NULL, e)) ||
        set_link(folder, work, strrchr(sound, '.'), sound, e) || link_times(library, file, work, folder, e))
        return -1;
    return is_current(folder, work, lang, &info)
               ? 1
               : write_text(library, file, work, folder, lang, &info, reader, stop, e);
}

static void tidy(const char *folder) {
    DIR *dir = opendir(folder);
    for (struct dirent *entry; dir && (entry = readdir(dir));) {
        const char *dot = strrchr(entry->d_name, '.');
        char path[PATH_MAX];
        if (dot && !strcmp(dot, ".part") &&
            snprintf(path, sizeof path, "%s/%s", folder, entry->d_name) < (int)sizeof path)
            unlink(path);
    }
    if (dir)
        closedir(dir);
}

int library_voices_prepare(const char *library, const char *folder, const char *lang,
                           const struct reader *reader, struct error *e) {
    struct library_files files = {0};
    int count = 0, result = library_files_list(&files, library, e);
    json_t *names = json_object(); /* only the first of several files with the same name owns the recording */
    if (!result && mkdir(folder, 0700) && errno != EEXIST)
        result = error_set(e, ERROR_BAD_INDEX, "%.150s: %.80s", folder, strerror(errno));
    if (!result)
        tidy(folder);
    for (size_t i = 0; !result && i < files.count; i++) {
        char work[64];
        const char *path = files.list[i].path;
        library_file_name(path, false, work);
        if (!json_object_get(names, work) && library_file_has_sound(library, path)) {
            int one = library_voice_prepare(library, path, work, folder, lang, reader, NULL, e);
            result = one < 0 ? -1 : 0;
            count += one > 0;
            json_object_set_new(names, work, json_true());
        }
    }
    json_decref(names);
    library_files_free(&files);
    return result ? -1 : count;
}
