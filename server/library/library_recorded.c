/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which works have a recording: looked for again whenever any file has changed. */
#include "server/base/mem.h"
#include "server/library/library_internal.h"
#include <string.h>

/* FNV-1a over all that is known of the files. */
static uint64_t sign(uint64_t hash, const struct library_file *files, size_t count) {
    for (size_t i = 0; i < count; i++) {
        for (const char *c = files[i].path; *c; c++)
            hash = (hash ^ (unsigned char)*c) * 1099511628211u;
        hash = (hash ^ (uint64_t)files[i].size) * 1099511628211u;
        hash = (hash ^ (uint64_t)files[i].modified) * 1099511628211u;
    }
    return hash * 1099511628211u;
}

static const struct library_file *file_of(const struct library_files *files, const char *path) {
    size_t low = 0, high = files->count;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (strcmp(files->list[middle].path, path) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low < files->count && !strcmp(files->list[low].path, path) ? &files->list[low] : NULL;
}

/* Of two works of one name only one has the voice: library_voices.h. */
static void add(struct recorded_works *works, const char *name, const struct library_file *file,
                const struct library_file *sound) {
    char plain[64];
    library_file_name(file->path, false, plain);
    if (strcmp(plain, name) != 0)
        return;
    works->list = mem_grow(works->list, &works->cap, works->count + 1, sizeof *works->list);
    struct recorded_work *w = &works->list[works->count++];
    *w = (struct recorded_work){.path = mem_strdup(file->path),
                                .sound = mem_strdup(sound->path),
                                .size = file->size,
                                .modified = file->modified,
                                .sound_size = sound->size,
                                .sound_modified = sound->modified};
    snprintf(w->work, sizeof w->work, "%s", name);
}

static int set_flag(struct index_writer *w, const char *name, struct error *e) {
    sqlite3_stmt *s = NULL;
    if (index_begin(w, e))
        return -1;
    sqlite3_prepare_v2(w->sql, "UPDATE work SET recording = NOT recording WHERE name = ?", -1, &s, NULL);
    sqlite3_bind_text(s, 1, name, -1, SQLITE_STATIC);
    int result = index_step(w, s, e);
    sqlite3_finalize(s);
    return result < 0 ? -1 : 0;
}

int library_recorded(struct library *l, struct index_writer *w, const struct library_files *files,
                     struct error *e) {
    uint64_t signature = sign(14695981039346656037u, files->list, files->count);
    signature = sign(signature, files->sounds, files->sound_count);
    if (signature == l->signature)
        return 0;
    struct recorded_works works = {0};
    struct buf wrong = {0}; /* names of works of which the index does not know what they have */
    sqlite3_stmt *s = NULL;
    int result = 0;
    if (sqlite3_prepare_v2(w->sql, "SELECT name, path, recording FROM work", -1, &s, NULL) != SQLITE_OK)
        return error_set(e, ERROR_BAD_INDEX, "the index: %.200s", sqlite3_errmsg(w->sql));
    while (sqlite3_step(s) == SQLITE_ROW) {
        const char *name = (const char *)sqlite3_column_text(s, 0);
        const char *path = (const char *)sqlite3_column_text(s, 1);
        const struct library_file *file = name && path ? file_of(files, path) : NULL;
        const struct library_file *sound = file ? library_files_sound(files, path) : NULL;
        if (sound)
            add(&works, name, file, sound);
        if (file && !sound == !!sqlite3_column_int(s, 2))
            buf_add(&wrong, name, strlen(name) + 1);
    }
    sqlite3_finalize(s);
    for (size_t at = 0; at < wrong.size && !result; at += strlen((char *)wrong.data + at) + 1)
        result = set_flag(w, (char *)wrong.data + at, e);
    buf_free(&wrong);
    alignments_see(l->alignments, &works);
    pthread_mutex_lock(&l->mutex);
    if (!result)
        l->signature = signature;
    pthread_mutex_unlock(&l->mutex);
    return result;
}
