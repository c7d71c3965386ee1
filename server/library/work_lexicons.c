/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/library/work_lexicons.h"
#include "server/base/files.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/library/library_files.h"
#include "server/library/library_internal.h"
#include "server/normalize/lexicon.h"
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A file as it was when it was read. */
struct lexicon_file {
    char *path; /* relative to the library's folder */
    int64_t size, modified;
    struct lexicon *lexicon; /* NULL: it is faulty */
};

struct work_lexicon {
    char work[80];
    struct lexicon *lexicon; /* borrowed from its file */
};

/* Replaced as a whole by the scanning thread, under the library's mutex. */
struct work_lexicons {
    struct lexicon_file *files; /* sorted by path */
    size_t file_count;
    struct work_lexicon *works; /* sorted by work */
    size_t work_count, work_cap;
    struct lexicon *all; /* the library's own; borrowed, NULL = none */
};

bool library_lexicon_is(const char *path) {
    const char *dot = strrchr(path, '.');
    return dot && !strcmp(dot, ".pls");
}

static void free_all(struct work_lexicons *l) {
    for (size_t i = 0; l && i < l->file_count; i++) {
        free(l->files[i].path);
        lexicon_free(l->files[i].lexicon);
    }
    if (l) {
        free(l->files);
        free(l->works);
    }
    free(l);
}

static int by_path(const void *a, const void *b) {
    return strcmp(((const struct lexicon_file *)a)->path, ((const struct lexicon_file *)b)->path);
}

static int by_work(const void *a, const void *b) {
    return strcmp(((const struct work_lexicon *)a)->work, ((const struct work_lexicon *)b)->work);
}

static const struct lexicon_file *file_of(const struct work_lexicons *l, const char *path) {
    const struct lexicon_file key = {.path = (char *)path};
    return l && l->file_count ? bsearch(&key, l->files, l->file_count, sizeof key, by_path) : NULL;
}

static struct lexicon *read_below(const char *folder, const char *path, struct error *e) {
    FILE *file = open_file_below(folder, path);
    if (file)
        return lexicon_load_file(file, path, e);
    error_set(e, ERROR_BAD_LEXICON, "%.150s: %.80s", path, strerror(errno));
    return NULL;
}

/* Logs the faults of a lexicon; a client that saves one over HTTP gets them in the answer. */
static struct lexicon *read_anew(const char *folder, const char *path) {
    struct error e;
    char text[400];
    size_t count = 0;
    struct lexicon *lexicon = read_below(folder, path, &e);
    if (!lexicon) {
        log_warn("library: %s", error_text(&e, text, sizeof text));
        return NULL;
    }
    const struct error *faults = lexicon_warnings(lexicon, &count);
    for (size_t i = 0; i < count; i++)
        log_warn("library: %s:%s", path, error_text(&faults[i], text, sizeof text));
    return lexicon;
}

static void add_file(struct work_lexicons *l, const struct work_lexicons *before, const char *folder,
                     const struct library_file *file) {
    const struct lexicon_file *known = file_of(before, file->path);
    bool same = known && known->size == file->size && known->modified == file->modified;
    struct lexicon *lexicon = same && known->lexicon ? lexicon_share(known->lexicon)
                              : same                 ? NULL
                                                     : read_anew(folder, file->path);
    l->files[l->file_count++] =
        (struct lexicon_file){mem_strdup(file->path), file->size, file->modified, lexicon};
}

/* The path of the lexicon beside a work; NULL: the work's name has no ending. Free it. */
static char *beside(const char *path) {
    const char *dot = strrchr(path, '.'), *slash = strrchr(path, '/');
    struct buf out = {0};
    if (!dot || (slash && dot < slash))
        return NULL;
    buf_printf(&out, "%.*s.pls", (int)(dot - path), path);
    buf_add(&out, "", 1);
    return (char *)out.data;
}

static void add_work(struct work_lexicons *l, const char *name, const char *path) {
    char *place = beside(path);
    const struct lexicon_file *file = place ? file_of(l, place) : NULL;
    free(place);
    if (!file || !file->lexicon || !strcmp(file->path, LIBRARY_LEXICON))
        return;
    l->works = mem_grow(l->works, &l->work_cap, l->work_count + 1, sizeof *l->works);
    struct work_lexicon *work = &l->works[l->work_count++];
    work->lexicon = file->lexicon;
    snprintf(work->work, sizeof work->work, "%s", name);
}

static void add_works(struct work_lexicons *l, struct index_writer *writer) {
    sqlite3_stmt *s = NULL;
    if (sqlite3_prepare_v2(writer->sql, "SELECT name, path FROM work", -1, &s, NULL) != SQLITE_OK)
        return;
    while (sqlite3_step(s) == SQLITE_ROW) {
        const char *name = (const char *)sqlite3_column_text(s, 0);
        const char *path = (const char *)sqlite3_column_text(s, 1);
        if (name && path)
            add_work(l, name, path);
    }
    sqlite3_finalize(s);
    if (l->work_count)
        qsort(l->works, l->work_count, sizeof *l->works, by_work);
}

void work_lexicons_scan(struct library *library, struct index_writer *writer,
                        const struct library_files *files) {
    struct work_lexicons *l = mem_alloc(sizeof *l), *before = library->lexicons;
    size_t count = files->lexicon_count < LIBRARY_LEXICONS_MAX ? files->lexicon_count : LIBRARY_LEXICONS_MAX;
    if (count < files->lexicon_count)
        log_warn("library: reading only the first %d lexicons", LIBRARY_LEXICONS_MAX);
    l->files = mem_alloc((count + 1) * sizeof *l->files);
    for (size_t i = 0; i < count && !atomic_load(&library->stop); i++)
        add_file(l, before, library->folder, &files->lexicons[i]);
    if (count)
        add_works(l, writer);
    const struct lexicon_file *all = file_of(l, LIBRARY_LEXICON);
    l->all = all ? all->lexicon : NULL;
    pthread_mutex_lock(&library->mutex);
    library->lexicons = l;
    pthread_mutex_unlock(&library->mutex);
    free_all(before);
}

void work_lexicons_free(struct library *library) {
    free_all(library->lexicons);
    library->lexicons = NULL;
}

void library_lexicons(struct library *library, const char *passage, struct lexicons *to) {
    struct work_lexicon key;
    snprintf(key.work, sizeof key.work, "%.*s", (int)strcspn(passage, ":"), passage);
    pthread_mutex_lock(&library->mutex);
    const struct work_lexicons *l = library->lexicons;
    const struct work_lexicon *own =
        l && l->work_count ? bsearch(&key, l->works, l->work_count, sizeof key, by_work) : NULL;
    if (own)
        lexicons_add(to, lexicon_share(own->lexicon));
    if (l && l->all)
        lexicons_add(to, lexicon_share(l->all));
    pthread_mutex_unlock(&library->mutex);
}

static int add_beside(const char *folder, const char *path, struct lexicons *to, struct error *e) {
    int fd = open_below(folder, path, O_RDONLY);
    if (fd < 0 && errno == ENOENT)
        return 0;
    if (fd >= 0)
        close(fd);
    struct lexicon *lexicon = read_below(folder, path, e);
    if (!lexicon)
        return -1;
    lexicons_add(to, lexicon);
    return 0;
}

int library_lexicons_beside(const char *folder, const char *path, struct lexicons *to, struct error *e) {
    char *place = beside(path);
    int result = place && strcmp(place, LIBRARY_LEXICON) ? add_beside(folder, place, to, e) : 0;
    free(place);
    return result || add_beside(folder, LIBRARY_LEXICON, to, e) ? -1 : 0;
}

int library_lexicon_check(const void *data, size_t size, struct error *e) {
    size_t count = 0;
    struct lexicon *lexicon = lexicon_read(size ? data : "", size, e);
    if (!lexicon)
        return -1;
    const struct error *faults = lexicon_warnings(lexicon, &count);
    bool faulty = lexicon_left_out(lexicon) && count;
    if (faulty) {
        *e = faults[0];
        e->code = ERROR_BAD_LEXICON;
    }
    lexicon_free(lexicon);
    return faulty ? -1 : 0;
}
