/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include "server/library/library_internal.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct library *library_open(const struct library_options *options, struct error *e) {
    struct index_writer writer;
    struct stat info;
    if (stat(options->folder, &info) || !S_ISDIR(info.st_mode)) {
        error_in_field(e, ERROR_BAD_WORK, "--library", "%.150s: %.80s", options->folder,
                       strerror(stat(options->folder, &info) ? errno : ENOTDIR));
        return NULL;
    }
    if (index_open(&writer, options->index, e)) /* it is there, and whole, before anybody reads it */
        return NULL;
    index_close(&writer);
    struct library *l = mem_alloc(sizeof *l);
    l->folder = mem_strdup(options->folder);
    l->index = mem_strdup(options->index);
    l->voices = options->voices ? mem_strdup(options->voices) : NULL;
    l->lang = mem_strdup(options->lang);
    l->reader = (struct reader){options->reader.program ? mem_strdup(options->reader.program) : NULL,
                                options->reader.unconfined};
    l->indexing = true;
    if (l->voices)
        l->alignments = alignments_open(l->folder, l->voices, l->lang, &options->aligner, &l->reader);
    pthread_mutex_init(&l->mutex, NULL);
    pthread_cond_init(&l->wake, NULL);
    if (!pthread_create(&l->thread, NULL, library_scan, l))
        return l;
    error_set(e, ERROR_BAD_INDEX, "no thread can be started");
    l->thread = 0;
    library_close(l);
    return NULL;
}

static void close_reader(struct index_reader *r) {
    sqlite3_close(r->sql);
    stems_close(r->stems);
    free(r);
}

void library_close(struct library *l) {
    if (!l)
        return;
    atomic_store(&l->stop, true);
    pthread_mutex_lock(&l->mutex);
    l->closing = true;
    pthread_cond_broadcast(&l->wake);
    pthread_mutex_unlock(&l->mutex);
    if (l->thread)
        pthread_join(l->thread, NULL);
    alignments_close(l->alignments);
    for (unsigned i = 0; i < l->idle_count; i++)
        close_reader(l->idle[i]);
    pthread_mutex_destroy(&l->mutex);
    pthread_cond_destroy(&l->wake);
    free(l->folder);
    free(l->index);
    free(l->lang);
    free(l->voices);
    free((char *)l->reader.program);
    free(l);
}

struct index_reader *library_reader(struct library *l, struct error *e) {
    struct index_reader *r = NULL;
    pthread_mutex_lock(&l->mutex);
    if (l->idle_count)
        r = l->idle[--l->idle_count];
    const unsigned generation = l->generation;
    pthread_mutex_unlock(&l->mutex);
    if (r && r->generation == generation)
        return r;
    if (r)
        close_reader(r);
    sqlite3 *sql = index_open_reader(l->index);
    if (!sql) {
        error_plain(e, ERROR_BAD_INDEX);
        return NULL;
    }
    r = mem_alloc(sizeof *r);
    *r = (struct index_reader){sql, stems_open(), generation, false};
    return r;
}

void library_reader_done(struct library *l, struct index_reader *r) {
    pthread_mutex_lock(&l->mutex);
    bool current = r->generation == l->generation;
    bool kept = l->idle_count < READERS_MAX && current && !r->damaged;
    if (r->damaged && current) {
        atomic_store(&l->damaged, true);
        pthread_cond_broadcast(&l->wake);
    }
    if (kept)
        l->idle[l->idle_count++] = r;
    pthread_mutex_unlock(&l->mutex);
    if (!kept)
        close_reader(r);
}

/* The voice that the work's recording is; NULL: it has none. To be freed. */
static char *voice_of(const struct library *l, const char *work) {
    struct buf path = {0};
    if (!l->voices)
        return NULL;
    buf_printf(&path, "%s/%s.txt", l->voices, work);
    buf_add(&path, "", 1);
    bool there = !access((char *)path.data, R_OK);
    path.size = 0;
    buf_printf(&path, "recording:%s", work);
    buf_add(&path, "", 1);
    if (!there)
        buf_free(&path);
    return (char *)path.data;
}

/* Keeps the places of the rest: so many units at the beginning are spaces. */
static int blank(struct buf *text, double units, struct error *e) {
    struct buf out = {0};
    size_t at = 0;
    double done = 0;
    while (at < text->size && done < units) {
        uint32_t cp;
        size_t n = utf8_next((char *)text->data + at, text->size - at, &cp);
        at += n ? n : 1;
        buf_add(&out, "  ", n == 4 ? 2 : 1);
        done += n == 4 ? 2 : 1;
    }
    if (done < units || at == text->size) {
        buf_free(&out);
        return error_in_field(e, ERROR_BAD_FIELD, "from", "must be a place in the passage's text");
    }
    buf_add(&out, text->data + at, text->size - at);
    buf_free(text);
    *text = out;
    return 0;
}

/* White space in place of what is not spoken: as many bytes and units. Returns the languages of the rest. */
static char *direct(struct found_passage *p) {
    struct buf languages = {0};
    struct utf16_counter at = {0};
    for (size_t i = 0; i < p->run_count; i++) {
        const struct found_run *run = &p->runs[i];
        if (*run->lang) {
            buf_printf(&languages, "%s%zu-%zu:%s", languages.size ? " " : "", run->start, run->end,
                       run->lang);
        } else {
            size_t from = utf16_byte(&at, (char *)p->text.data, p->text.size, run->start);
            size_t to = utf16_byte(&at, (char *)p->text.data, p->text.size, run->end);
            utf8_blank((char *)p->text.data + from, to - from);
        }
    }
    if (languages.size)
        buf_add(&languages, "", 1);
    return (char *)languages.data;
}

int library_passage(struct library *l, const char *id, double from, size_t most, struct library_passage *out,
                    struct error *e) {
    static const char *const markups[] = {"apml", "jsml", "ssml", NULL};
    struct found_passage found;
    *out = (struct library_passage){.markup = "plain"};
    struct index_reader *r = library_reader(l, e);
    int result = r ? library_find(r, id, most, &found, e) : -1;
    if (r)
        library_reader_look(r);
    if (r && r->damaged && result)
        error_plain(e, ERROR_BAD_INDEX);
    if (r)
        library_reader_done(l, r);
    if (result)
        return -1;
    bool whole = found.source.size && from <= 0;
    struct buf *text = whole ? &found.source : &found.text;
    out->languages = whole || !found.text.size ? NULL : direct(&found);
    if (from > 0)
        result = blank(text, from, e);
    if (result) {
        free(out->languages);
        out->languages = NULL;
    } else {
        out->text = mem_strndup(text->size ? (char *)text->data : "", text->size);
        out->lang = mem_strdup(found.lang);
        out->voice = voice_of(l, found.work);
        for (const char *const *m = markups; whole && *m; m++)
            if (!strcmp(*m, found.markup))
                out->markup = *m;
    }
    found_passage_free(&found);
    return result;
}

void library_passage_free(struct library_passage *p) {
    free(p->text);
    free(p->lang);
    free(p->languages);
    free(p->voice);
    *p = (struct library_passage){0};
}
