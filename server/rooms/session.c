/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/rooms/session.h"
#include "server/base/buf.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/rooms/session_export.h"
#include <errno.h>
#include <sndfile.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { PAD_MS = 1000, SAME_SECOND = 20 };

static const char SOUND[] = "room.flac", JOURNAL[] = "events.jsonl", WHOLE[] = "session.json",
                  GRID[] = "session.TextGrid", TABLE[] = "session.csv";

struct session {
    uv_loop_t *loop;
    uv_timer_t *timer; /* keeps the sound as long as the session */
    char *folder;
    char began[32], room[80];
    uint64_t from; /* loop time, ms */
    SNDFILE *sound;
    uint64_t samples;  /* written */
    unsigned speaking; /* utterances being heard */
    FILE *journal;     /* the events, a line each: what is left if the daemon is killed */
    unsigned events;
    bool full;      /* a limit was reached */
    uv_work_t work; /* of another thread, after the end: writes what is made of all events */
    bool working;
    bool closed, deleted; /* is to be freed; and its folder deleted */
};

static double now(const struct session *s) {
    return (double)(uv_now(s->loop) - s->from) / 1000;
}

/* Returns the path of a file; the caller frees it. */
static char *in(const char *folder, const char *name) {
    struct buf path = {0};
    buf_printf(&path, "%s/%s", folder, name);
    buf_add(&path, "", 1);
    return (char *)path.data;
}

/* ---- the sound ---- */

static void write_samples(struct session *s, const int16_t *samples, size_t count) {
    const uint64_t most = (uint64_t)SESSION_SECONDS * SESSION_RATE;
    if (s->samples + count > most)
        count = (size_t)(most - s->samples);
    if (s->sound && count)
        sf_write_short(s->sound, samples, (sf_count_t)count);
    s->samples += count;
}

/* Writes silence up to now, so that speech lies at its time. */
static void pad(struct session *s) {
    static const int16_t silence[SESSION_RATE];
    const uint64_t wanted = (uv_now(s->loop) - s->from) * SESSION_RATE / 1000;
    while (s->samples < wanted && s->samples < (uint64_t)SESSION_SECONDS * SESSION_RATE) {
        const uint64_t left = wanted - s->samples;
        write_samples(s, silence, left < SESSION_RATE ? (size_t)left : SESSION_RATE);
    }
}

static void on_timer(uv_timer_t *timer) {
    struct session *s = timer->data;
    if (!s->speaking)
        pad(s);
}

void session_sound(struct session *s, const int16_t *samples, size_t count) {
    write_samples(s, samples, count);
}

/* ---- the events ---- */

static void append(struct session *s, json_t *event) {
    if (s->events >= SESSION_EVENTS || now(s) > SESSION_SECONDS) {
        if (!s->full)
            log_warn("session %s is full: later events are not recorded", s->folder);
        s->full = true;
    } else if (s->journal && !json_dumpf(event, s->journal, JSON_COMPACT | JSON_REAL_PRECISION(9))) {
        fputc('\n', s->journal);
        fflush(s->journal);
        s->events++;
    }
    json_decref(event);
}

/* The event begins with its time; `time` of a word or a sentence, in its utterance, becomes `at`. */
void session_event(struct session *s, const json_t *message) {
    static const char *const skipped[] = {"overheard", "calibrated", "lexicon", "observers", "phone"};
    const char *type = json_string_value(json_object_get(message, "type")), *key;
    json_t *event = json_pack("{sf}", "time", now(s)), *value;
    for (size_t i = 0; i < sizeof skipped / sizeof *skipped; i++)
        if (!type || !strcmp(type, skipped[i])) {
            json_decref(event);
            return;
        }
    json_object_foreach((json_t *)message, key, value) {
        if (strcmp(key, "stream") != 0)
            json_object_set(event, strcmp(key, "time") ? key : "at", value);
    }
    append(s, event);
}

void session_hearing(struct session *s, const char *id, double seconds) {
    const bool begins = seconds < 0;
    if (begins && !s->speaking)
        pad(s);
    if (begins)
        s->speaking++;
    else if (s->speaking)
        s->speaking--;
    json_t *event = json_pack("{sf ss ss}", "time", now(s), "type", "hearing", "id", id);
    if (!begins)
        json_object_set_new(event, "seconds", json_real(seconds));
    append(s, event);
}

/* ---- the folder ---- */

static void stamp(char *text, size_t size, const char *format) {
    time_t seconds = time(NULL);
    struct tm utc;
    gmtime_r(&seconds, &utc);
    strftime(text, size, format, &utc);
}

/* Makes a folder of a new name; the caller frees it. NULL: it cannot be made. */
static char *make_folder(const char *folder, const char *room) {
    char when[32];
    stamp(when, sizeof when, "%Y%m%dT%H%M%SZ");
    for (int i = 1; i <= SAME_SECOND; i++) {
        struct buf path = {0};
        buf_printf(&path, "%s/%s-%s", folder, room, when);
        if (i > 1)
            buf_printf(&path, "-%d", i);
        buf_add(&path, "", 1);
        if (!mkdir((char *)path.data, 0700))
            return (char *)path.data;
        buf_free(&path);
        if (errno != EEXIST)
            return NULL;
    }
    return NULL;
}

static void open_files(struct session *s) {
    SF_INFO format = {.samplerate = SESSION_RATE, .channels = 1, .format = SF_FORMAT_FLAC | SF_FORMAT_PCM_16};
    char *sound = in(s->folder, SOUND), *journal = in(s->folder, JOURNAL);
    s->sound = sf_open(sound, SFM_WRITE, &format);
    s->journal = fopen(journal, "we");
    if (!s->sound || !s->journal)
        log_warn("session %s: cannot write %s", s->folder, s->sound ? JOURNAL : SOUND);
    free(sound);
    free(journal);
}

struct session *session_open(uv_loop_t *loop, const char *folder, const char *room, struct error *e) {
    char *own = make_folder(folder, room);
    if (!own) {
        error_set(e, ERROR_CANNOT_KEEP, "cannot make a folder for a session in %.200s: %s", folder,
                  strerror(errno));
        return NULL;
    }
    struct session *s = mem_alloc(sizeof *s);
    *s = (struct session){.loop = loop, .folder = own, .from = uv_now(loop)};
    snprintf(s->room, sizeof s->room, "%s", room);
    stamp(s->began, sizeof s->began, "%Y-%m-%dT%H:%M:%SZ");
    open_files(s);
    s->timer = mem_alloc(sizeof *s->timer);
    uv_timer_init(loop, s->timer);
    s->timer->data = s;
    uv_timer_start(s->timer, on_timer, PAD_MS, PAD_MS);
    uv_unref((uv_handle_t *)s->timer);
    return s;
}

static void free_timer(uv_handle_t *timer) {
    free(timer);
}

/* Writes a text; false: it could not be. */
static bool save(const char *folder, const char *name, const void *data, size_t size) {
    char *path = in(folder, name);
    FILE *file = fopen(path, "we");
    bool good = file && fwrite(data, 1, size, file) == size;
    good = file && !fclose(file) && good;
    if (!good)
        log_warn("cannot write %s", path);
    free(path);
    return good;
}

/* Reads the journal. */
static json_t *read_events(const struct session *s) {
    char *path = in(s->folder, JOURNAL), *line = NULL;
    FILE *file = fopen(path, "re");
    json_t *events = json_array();
    size_t room = 0;
    while (file && getline(&line, &room, file) > 0) {
        json_t *event = json_loads(line, 0, NULL);
        if (event)
            json_array_append_new(events, event);
    }
    if (file)
        fclose(file);
    free(line);
    free(path);
    return events;
}

static void export(const struct session *s, double seconds) {
    struct buf grid = {0}, table = {0};
    json_t *events = read_events(s);
    json_t *whole = json_pack("{ss ss sf ss so}", "room", s->room, "began", s->began, "seconds", seconds,
                              "sound", SOUND, "events", events);
    char *text = json_dumps(whole, JSON_INDENT(1) | JSON_REAL_PRECISION(9));
    session_grid(&grid, events, seconds);
    session_table(&table, events);
    save(s->folder, GRID, grid.data, grid.size);
    save(s->folder, TABLE, table.data, table.size);
    if (text && save(s->folder, WHOLE, text, strlen(text))) {
        char *journal = in(s->folder, JOURNAL);
        unlink(journal);
        free(journal);
    }
    free(text);
    json_decref(whole);
    buf_free(&grid);
    buf_free(&table);
}

static void delete_folder(const char *folder) {
    const char *const names[] = {SOUND, JOURNAL, WHOLE, GRID, TABLE};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char *path = in(folder, names[i]);
        if (unlink(path) && errno != ENOENT)
            log_warn("cannot delete %s: %s", path, strerror(errno));
        free(path);
    }
    if (rmdir(folder))
        log_warn("cannot delete %s: %s", folder, strerror(errno));
    else
        log_info("session %s was deleted: its consent was withdrawn", folder);
}

static void free_closed(struct session *s) {
    if (!s->closed || s->working)
        return;
    if (s->deleted)
        delete_folder(s->folder);
    free(s->folder);
    free(s);
}

static void write_exports(uv_work_t *work) {
    const struct session *s = work->data;
    export(s, (double)s->samples / SESSION_RATE);
}

static void after_exports(uv_work_t *work, int status) {
    struct session *s = work->data;
    s->working = false;
    if (!status)
        log_info("session recorded in %s", s->folder);
    free_closed(s);
}

void session_end(struct session *s) {
    pad(s);
    uv_close((uv_handle_t *)s->timer, free_timer);
    if (s->sound)
        sf_close(s->sound);
    if (s->journal)
        fclose(s->journal);
    s->work.data = s;
    s->working = !uv_queue_work(s->loop, &s->work, write_exports, after_exports);
}

void session_close(struct session *s, bool delete) {
    s->closed = true;
    s->deleted = delete;
    free_closed(s);
}
