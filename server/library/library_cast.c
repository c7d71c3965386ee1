/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The cast of a work of the index, and of a file. */
#include "server/base/files.h"
#include "server/base/mem.h"
#include "server/library/cast.h"
#include "server/library/library_internal.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* The path of the cast beside a work; NULL: the work's name has no ending. Free it. */
static char *beside(const char *path) {
    const char *dot = strrchr(path, '.'), *slash = strrchr(path, '/');
    struct buf out = {0};
    if (!dot || (slash && dot < slash))
        return NULL;
    buf_printf(&out, "%.*s" CAST_FILE_ENDING, (int)(dot - path), path);
    buf_add(&out, "", 1);
    return (char *)out.data;
}

int library_cast_beside(const char *folder, const char *path, struct cast *cast, struct error *e) {
    char *place = beside(path);
    FILE *file = place ? open_file_below(folder, place) : NULL;
    const int why = errno;
    struct buf text = {0};
    int result = 0;
    if (!file && (!place || why == ENOENT)) {
        free(place);
        return 0;
    }
    cast->file = place;
    int bad = file ? buf_add_stream(&text, file, CAST_FILE_BYTES) : why;
    if (bad == EFBIG)
        result = error_set(e, ERROR_BAD_CAST, "a cast may have at most %d bytes", CAST_FILE_BYTES);
    else if (bad)
        result = error_set(e, ERROR_BAD_CAST, "%s", strerror(bad));
    else
        result = cast_read(cast, text.data, text.size, e);
    buf_free(&text);
    if (file)
        fclose(file);
    return result;
}

/* Reads the members of a work from the index. */
static int read_members(struct index_reader *r, const char *work, struct cast *cast, struct error *e) {
    sqlite3_stmt *s =
        library_prepare(r,
                        "SELECT id, name, about, sex, age, sex_from, passages, characters, told, said FROM "
                        "person WHERE work = ? ORDER BY place",
                        e);
    if (!s)
        return -1;
    sqlite3_bind_text(s, 1, work, -1, SQLITE_STATIC);
    while (cast->count < CAST_MOST && sqlite3_step(s) == SQLITE_ROW) {
        struct cast_member *m = cast_add(cast, index_text(s, 0), index_text(s, 1));
        m->about = *index_text(s, 2) ? mem_strdup(index_text(s, 2)) : NULL;
        m->sex = (enum person_sex)sqlite3_column_int(s, 3);
        m->age = (enum cast_age)sqlite3_column_int(s, 4);
        m->sex_from = (enum cast_source)sqlite3_column_int(s, 5);
        m->passages = (size_t)sqlite3_column_int64(s, 6);
        m->characters = (size_t)sqlite3_column_int64(s, 7);
        cast->told = sqlite3_column_int(s, 8);
        m->first = *index_text(s, 9) ? mem_strdup(index_text(s, 9)) : NULL;
    }
    sqlite3_finalize(s);
    return 0;
}

int library_cast_of(struct library *l, struct index_reader *r, const char *work,
                    const struct cast_offer *offer, struct cast *cast, struct error *e) {
    sqlite3_stmt *s = library_prepare(r, "SELECT path, lang FROM work WHERE name = ?", e);
    char *path = NULL, *lang = NULL;
    struct error bad;
    *cast = (struct cast){0};
    if (!s)
        return -1;
    sqlite3_bind_text(s, 1, work, -1, SQLITE_STATIC);
    if (sqlite3_step(s) == SQLITE_ROW) {
        path = mem_strdup(index_text(s, 0));
        lang = mem_strdup(index_text(s, 1));
    }
    sqlite3_finalize(s);
    int result = path ? read_members(r, work, cast, e)
                      : error_in_field(e, ERROR_UNKNOWN_WORK, "work", "unknown work '%.80s'", work);
    if (!result && library_cast_beside(l->folder, path, cast, &bad)) {
        struct cast partly = *cast;
        *cast = (struct cast){.file = partly.file ? mem_strdup(partly.file) : NULL};
        cast_free(&partly);
        result = read_members(r, work, cast, e);
        cast->problems[cast->problem_count++] = bad;
    }
    if (!result)
        cast_choose(cast, lang, offer);
    free(path);
    free(lang);
    return result;
}

int library_cast(struct library *l, const char *passage, const struct cast_offer *offer, struct cast *cast,
                 struct error *e) {
    struct index_reader *r = library_reader(l, e);
    if (!r)
        return -1;
    char *work = library_current(r, passage);
    work[strcspn(work, ":")] = '\0';
    int result = library_cast_of(l, r, work, offer, cast, e);
    free(work);
    library_reader_look(r);
    if (r->damaged && result)
        error_plain(e, ERROR_BAD_INDEX);
    library_reader_done(l, r);
    return result;
}
