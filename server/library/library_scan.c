/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/etag.h"
#include "server/base/files.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/library/cast.h"
#include "server/library/library_files.h"
#include "server/library/library_internal.h"
#include "server/library/work_lexicons.h"
#include "server/library/works/work.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

/* ---- recordings: checked again whenever a file has changed ---- */

/* Hash of the list of files, chained from `hash`. */
static uint64_t sign(uint64_t hash, const struct library_file *files, size_t count) {
    for (size_t i = 0; i < count; i++) {
        hash = hash_add(hash, files[i].path, strlen(files[i].path) + 1);
        hash = hash_add(hash, &files[i].size, sizeof files[i].size);
        hash = hash_add(hash, &files[i].modified, sizeof files[i].modified);
    }
    return hash_add(hash, "", 1); /* ends the list */
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

/* Only one of several works with the same name owns the voice, see library_voices.h. */
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

/* Passes the works with recordings to the alignments, and updates the index. -1 with *e. */
static int library_recorded(struct library *l, struct index_writer *w, const struct library_files *files,
                            struct error *e) {
    uint64_t signature = sign(HASH_BEGIN, files->list, files->count);
    signature = sign(signature, files->sounds, files->sound_count);
    signature = sign(signature, files->lexicons, files->lexicon_count);
    if (signature == l->signature)
        return 0;
    struct recorded_works works = {0};
    struct buf wrong = {0}; /* names of works whose `recording` is out of date */
    sqlite3_stmt *s = NULL;
    int result = 0;
    if (sqlite3_prepare_v2(w->sql, "SELECT name, path, recording FROM work", -1, &s, NULL) != SQLITE_OK)
        return error_set(e, ERROR_BAD_INDEX, "the index: %.200s", sqlite3_errmsg(w->sql));
    while (sqlite3_step(s) == SQLITE_ROW) {
        const char *name = (const char *)sqlite3_column_text(s, 0);
        const char *path = (const char *)sqlite3_column_text(s, 1);
        const struct library_file *file = name && path ? file_of(files, path) : NULL;
        const struct library_file *sound = file ? library_files_sound(files, path) : NULL;
        if (file && !sound && library_file_speaks(l->folder, path))
            sound = file; /* the book has its own recording */
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
    work_lexicons_scan(l, w, files);
    pthread_mutex_lock(&l->mutex);
    if (!result)
        l->signature = signature;
    pthread_mutex_unlock(&l->mutex);
    return result;
}

/* ---- the scanning thread: rereads what has changed in the folder ---- */

enum {
    LOOK_SECONDS = 3,
    COMMIT_CHARACTERS = 8 << 20, /* approximate size of a transaction */
    NICE = 10,
};

struct pass {
    struct library *library;
    struct index_writer writer;
};

struct taking {
    struct pass *pass;
    const char *path, *name;
    struct work_meta meta;
    struct cast_tally tally, dialogue;
    struct error error;
    bool failed;
};

static int on_section(void *ctx, const struct section *section) {
    struct taking *t = ctx;
    struct library *l = t->pass->library;
    cast_tally_section(&t->tally, section);
    if (!t->tally.count) /* in a play quotation marks are no dialogue */
        cast_dialogue_section(&t->dialogue, section, t->meta.lang ? t->meta.lang : l->lang);
    t->failed = t->failed || index_add_section(&t->pass->writer, t->name,
                                               t->meta.lang ? t->meta.lang : l->lang, section, &t->error);
    return t->failed || atomic_load(&l->stop);
}

static void on_problem(void *ctx, const struct error *problem, bool serious) {
    struct taking *t = ctx;
    t->failed = t->failed || index_add_problem(&t->pass->writer, t->path, problem, serious, &t->error);
}

static bool name_is_free(struct index_writer *w, const char *name) {
    sqlite3_stmt *s = NULL;
    sqlite3_prepare_v2(w->sql, "SELECT 1 FROM work WHERE name = ?", -1, &s, NULL);
    sqlite3_bind_text(s, 1, name, -1, SQLITE_STATIC);
    bool is_free = sqlite3_step(s) != SQLITE_ROW;
    sqlite3_finalize(s);
    return is_free;
}

/* Chooses the work's id: its file name; with the ending when that name is taken. Returns false in this case.
 */
static bool choose_name(struct index_writer *w, const char *path, char name[80]) {
    char plain[64], whole[64];
    library_file_name(path, false, plain);
    library_file_name(path, true, whole);
    snprintf(name, 80, "%s", plain);
    if (!name_is_free(w, name))
        snprintf(name, 80, "%s", whole);
    for (int i = 2; !name_is_free(w, name); i++)
        snprintf(name, 80, "%s-%d", whole, i);
    return !strcmp(name, plain);
}

/* Reads a file into the index. -1 with *e: the index cannot be written. */
static int take(struct pass *p, const char *path, struct index_file *file, struct error *e) {
    struct library *l = p->library;
    struct taking t = {.pass = p, .path = path, .name = file->work, .meta = {.lang = mem_strdup(l->lang)}};
    const struct work_sink sink = {&t, on_section, on_problem};
    struct error why;
    if (index_remove(&p->writer, path, e))
        t.failed = true;
    bool own_name = choose_name(&p->writer, path, file->work);
    int64_t first = p->writer.next;
    int result = t.failed ? -1 : work_read_apart(&l->reader, l->folder, path, &t.meta, &sink, &l->stop, &why);
    bool some = p->writer.next > first;
    struct cast cast = {0};
    cast.told = !t.tally.count;
    cast_tally_take(cast.told ? &t.dialogue : &t.tally, &t.meta, &cast);
    cast_tally_free(&t.dialogue);
    if (!t.failed && result)
        t.failed = index_add_problem(&p->writer, path, &why, true, &t.error);
    if (!t.failed && some) {
        char title[64];
        library_file_name(path, false, title);
        work_meta_set(&t.meta.title, title);
        t.failed = index_add_work(&p->writer, file->work, path, file->hash, &t.meta, first,
                                  library_file_has_sound(l->folder, path), &t.error) ||
                   index_add_cast(&p->writer, file->work, &cast, &t.error);
    }
    if (!t.failed && some && !own_name) {
        char plain[64];
        library_file_name(path, false, plain);
        error_set(&why, ERROR_BAD_WORK, "another file has the id %s already, so the id of this one is %s",
                  plain, file->work);
        t.failed = index_add_problem(&p->writer, path, &why, false, &t.error);
    }
    if (!some)
        file->work[0] = '\0';
    if (!t.failed && !atomic_load(&l->stop))
        t.failed = index_file_set(&p->writer, path, file, &t.error);
    if (t.failed)
        *e = t.error;
    cast_free(&cast);
    work_meta_free(&t.meta);
    return t.failed ? -1 : 0;
}

/* Reports a link that leads out of the folder, without reading it. */
static int refuse(struct pass *p, const char *path, struct index_file *file, struct error *e) {
    struct error why;
    error_set(&why, ERROR_BAD_WORK, "%s", WORK_OUTSIDE);
    file->work[0] = '\0';
    return index_remove(&p->writer, path, e) || index_add_problem(&p->writer, path, &why, true, e) ||
                   index_file_set(&p->writer, path, file, e)
               ? -1
               : 0;
}

/* Reports what is wrong with a cast, which is read again whenever it is asked for. */
static int take_cast(struct pass *p, const char *path, struct index_file *file, struct error *e) {
    struct buf text = {0};
    struct error why;
    FILE *in = open_file_below(p->library->folder, path);
    int bad = in ? buf_add_stream(&text, in, CAST_FILE_BYTES) : errno;
    bool well = !bad && !cast_check(text.data, text.size, &why);
    if (bad)
        error_set(&why, ERROR_BAD_CAST, "%s", strerror(bad));
    else if (!well && why.place == PLACE_FIELD) { /* the table of problems knows lines only */
        struct error in_field = why;
        char said[sizeof why.message + sizeof why.field];
        error_set(&why, why.code, "%.250s", error_text(&in_field, said, sizeof said));
    }
    if (in)
        fclose(in);
    buf_free(&text);
    file->work[0] = '\0';
    return index_remove(&p->writer, path, e) ||
                   (!well && index_add_problem(&p->writer, path, &why, true, e)) ||
                   index_file_set(&p->writer, path, file, e)
               ? -1
               : 0;
}

/* Hashes a file only if its size or time changed, and reads it only if the hash changed. */
static int look(struct pass *p, const struct library_file *f, struct error *e) {
    struct index_file known;
    char hash[65];
    bool there = index_file_get(&p->writer, f->path, &known);
    if (there && known.size == f->size && known.modified == f->modified)
        return 0;
    bool hashed = !f->outside && library_file_hash(p->library->folder, f->path, hash);
    bool same = there && hashed && !strcmp(hash, known.hash);
    known.size = f->size;
    known.modified = f->modified;
    snprintf(known.hash, sizeof known.hash, "%s", hashed ? hash : "");
    if (index_begin(&p->writer, e))
        return -1;
    if (cast_file_is(f->path) && !same)
        return take_cast(p, f->path, &known, e);
    if (f->outside)
        return refuse(p, f->path, &known, e);
    return same ? index_file_set(&p->writer, f->path, &known, e) : take(p, f->path, &known, e);
}

static int forget_missing(struct pass *p, const struct library_files *files, struct error *e) {
    sqlite3_stmt *s = NULL;
    struct buf gone = {0};
    if (sqlite3_prepare_v2(p->writer.sql, "SELECT path FROM file", -1, &s, NULL) != SQLITE_OK)
        return error_set(e, ERROR_BAD_INDEX, "the index: %.200s", sqlite3_errmsg(p->writer.sql));
    while (sqlite3_step(s) == SQLITE_ROW) {
        const char *path = (const char *)sqlite3_column_text(s, 0);
        if (path && !library_files_has(files, path))
            buf_add(&gone, path, strlen(path) + 1);
    }
    sqlite3_finalize(s);
    int result = 0;
    for (size_t at = 0; at < gone.size && !result; at += strlen((char *)gone.data + at) + 1)
        result = index_begin(&p->writer, e) || index_add_former(&p->writer, (char *)gone.data + at, e) ||
                 index_remove(&p->writer, (char *)gone.data + at, e);
    buf_free(&gone);
    return result;
}

static void progress(struct library *l, size_t done, size_t of, bool indexing) {
    pthread_mutex_lock(&l->mutex);
    l->done = done;
    l->of = of;
    l->indexing = indexing;
    pthread_mutex_unlock(&l->mutex);
}

/* A pass that adds at least one row in so many merges the index: each merge writes it anew. */
enum { MERGED_SHARE = 4 };

static int read_all(struct pass *p, struct error *e) {
    struct library *l = p->library;
    struct library_files files = {0};
    const int64_t first = p->writer.next;
    int result = library_files_list(&files, l->folder, e) || forget_missing(p, &files, e);
    bool was_indexing = l->indexing;
    for (size_t i = 0; !result && i < files.count && !atomic_load(&l->stop); i++) {
        progress(l, i, files.count, was_indexing);
        result = look(p, &files.list[i], e);
        if (!result && p->writer.characters > COMMIT_CHARACTERS)
            result = index_commit(&p->writer, e);
    }
    for (size_t i = 0; !result && i < files.cast_count && !atomic_load(&l->stop); i++)
        result = look(p, &files.casts[i], e);
    if (!result && !atomic_load(&l->stop))
        result = library_recorded(l, &p->writer, &files, e);
    if (atomic_load(&l->stop))
        index_roll_back(&p->writer);
    else if (!result)
        result = index_commit(&p->writer, e);
    if (!result)
        progress(l, files.count, files.count, false);
    if (!result && (p->writer.next - first) * MERGED_SHARE > p->writer.next)
        index_merge(&p->writer, &l->stop);
    library_files_free(&files);
    return result;
}

/* Reads the rows of the common words again, if the index has changed. */
static void read_common(struct pass *p) {
    struct library *l = p->library;
    if (common_rows_are_of(l->common, index_changes(&p->writer)))
        return;
    struct common_rows *fresh = common_rows_make(&p->writer, &l->stop), *former;
    if (!fresh)
        return;
    pthread_mutex_lock(&l->mutex);
    former = l->common;
    l->common = fresh;
    pthread_mutex_unlock(&l->mutex);
    common_rows_release(former);
}

static void rest(struct library *l) {
    struct timespec until;
    clock_gettime(CLOCK_REALTIME, &until);
    until.tv_sec += LOOK_SECONDS;
    pthread_mutex_lock(&l->mutex);
    while (!l->closing && !l->look && !atomic_load(&l->damaged) &&
           pthread_cond_timedwait(&l->wake, &l->mutex, &until) != ETIMEDOUT)
        ;
    l->look = false;
    pthread_mutex_unlock(&l->mutex);
}

/* Recreates the index. Open readers keep the old file until their next query. */
static void begin_anew(struct pass *p) {
    struct library *l = p->library;
    if (p->writer.sql)
        index_close(&p->writer);
    p->writer.damaged = false;
    index_discard(l->index);
    pthread_mutex_lock(&l->mutex);
    l->generation++;
    l->indexing = true;
    struct common_rows *former = l->common;
    l->common = NULL; /* changes are counted from 0 again */
    pthread_mutex_unlock(&l->mutex);
    common_rows_release(former);
}

void *library_scan(void *library) {
    struct pass p = {.library = library};
    struct error e;
    char text[512];
    setpriority(PRIO_PROCESS, (id_t)syscall(SYS_gettid), NICE); /* for this thread only */
    while (!atomic_load(&p.library->stop)) {
        if (p.writer.damaged || atomic_exchange(&p.library->damaged, false))
            begin_anew(&p);
        if ((!p.writer.sql && index_open(&p.writer, p.library->index, &p.library->rules, &e)) ||
            read_all(&p, &e)) {
            log_warn("library: %s", error_text(&e, text, sizeof text));
            bool damaged = p.writer.damaged;
            index_close(&p.writer);
            p.writer.damaged = damaged;
        }
        if (p.writer.sql)
            read_common(&p);
        rest(p.library);
    }
    if (p.writer.sql)
        index_close(&p.writer);
    return NULL;
}
