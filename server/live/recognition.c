/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/live/recognition.h"
#include "server/base/mem.h"
#include "server/base/utf8.h"
#include <errno.h>
#include <fcntl.h>
#include <jansson.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    PROCESSOR_SECONDS = 600, /* of one utterance */
    COMPLAINT_BYTES = 160,   /* of the last line of errors */
    OUTPUT_MOST = 1 << 20,
    LINGER_MS = 500 /* for the output of a process that has exited: a child of it may hold the pipe */
};

/* ---- the output ---- */

/* Makes the words fit to be shown: one line, RECOGNITION_TEXT bytes, cut between characters. */
static size_t tidy(char *text) {
    size_t size = strlen(text), from = strspn(text, " ");
    if (size > RECOGNITION_TEXT)
        for (size = RECOGNITION_TEXT; size && ((unsigned char)text[size] & 0xC0) == 0x80; size--)
            ;
    text[size] = '\0';
    utf8_mend(text);
    size = strlen(text);
    while (size > from && text[size - 1] == ' ')
        size--;
    memmove(text, text + from, size - from);
    text[size - from] = '\0';
    return size - from;
}

static const char *said(const struct heard_lines *lines) {
    return lines->said.size ? (const char *)lines->said.data : "";
}

/* Continues the final words. */
static void say(struct heard_lines *lines, const char *text) {
    struct buf *to = &lines->said;
    if (!*text || to->size > RECOGNITION_TEXT)
        return;
    if (to->size)
        ((char *)to->data)[to->size - 1] = ' '; /* instead of the NUL */
    buf_add(to, text, strlen(text) + 1);
    to->size = tidy((char *)to->data) + 1;
}

static void rate(struct heard_lines *lines, const json_t *confidence) {
    double value = json_number_value(confidence);
    if (!json_is_number(confidence) || value < 0 || value > 1)
        return;
    lines->confidence = lines->rated && lines->confidence < value ? lines->confidence : value;
    lines->rated = true;
}

/* Takes a whole line, which ends with NUL. */
static void take_line(struct heard_lines *lines, char *line, size_t size,
                      void (*words)(void *ctx, const struct heard_words *words), void *ctx) {
    json_t *object = *line == '{' ? json_loadb(line, size, 0, NULL) : NULL;
    const char *text = json_string_value(json_object_get(object, "text"));
    const bool preview = json_is_false(json_object_get(object, "final"));
    char *own = mem_strdup(text ? text : object ? "" : line);
    tidy(own);
    if (preview) {
        struct buf all = {0};
        buf_printf(&all, "%s%s%s", said(lines), lines->said.size && *own ? " " : "", own);
        buf_add(&all, "", 1); /* both may be empty */
        tidy((char *)all.data);
        words(ctx, &(struct heard_words){(char *)all.data, false, -1});
        buf_free(&all);
    } else {
        rate(lines, json_object_get(object, "confidence"));
        say(lines, own);
        words(ctx, &(struct heard_words){said(lines), false, -1});
    }
    free(own);
    json_decref(object);
}

bool heard_lines_take(struct heard_lines *lines, const char *bytes, size_t size,
                      void (*words)(void *ctx, const struct heard_words *words), void *ctx) {
    for (size_t i = 0; i < size; i++) {
        if (bytes[i] != '\n') {
            if (lines->line.size >= RECOGNITION_LINE)
                return false;
            buf_add(&lines->line, bytes[i] ? &bytes[i] : " ", 1);
            continue;
        }
        buf_add(&lines->line, "", 1);
        take_line(lines, (char *)lines->line.data, lines->line.size - 1, words, ctx);
        lines->line.size = 0;
    }
    return true;
}

static void ignore_words(void *ctx, const struct heard_words *words) {
    (void)ctx, (void)words;
}

struct heard_words heard_lines_end(struct heard_lines *lines) {
    if (lines->line.size)
        heard_lines_take(lines, "\n", 1, ignore_words, NULL);
    return (struct heard_words){said(lines), true, lines->rated ? lines->confidence : -1};
}

void heard_lines_free(struct heard_lines *lines) {
    buf_free(&lines->line);
    buf_free(&lines->said);
    *lines = (struct heard_lines){0};
}

/* ---- the process ---- */

enum { IN, OUT, COMPLAINTS, PIPES };

struct recognition {
    uv_process_t child;
    uv_pipe_t pipes[PIPES];
    uv_timer_t timer;
    unsigned handles; /* not closed yet */
    bool exited, over, ended;
    int64_t status;
    int signal;
    unsigned seconds; /* to finish after the end of the sound */
    unsigned open;    /* of its two outputs */
    const struct recognition_calls *calls;
    void *ctx;
    struct heard_lines lines;
    size_t output;
    char complaint[COMPLAINT_BYTES]; /* last line of errors */
    size_t complaint_size;
    bool complaint_whole; /* the next byte begins another line */
    char room[8192];
};

static void on_closed(uv_handle_t *handle) {
    struct recognition *r = handle->data;
    if (--r->handles)
        return;
    heard_lines_free(&r->lines);
    free(r);
}

static void close_handle(uv_handle_t *handle) {
    if (!uv_is_closing(handle))
        uv_close(handle, on_closed);
}

/* Ends the process and its children. Its handle is closed once it has exited, so that no zombie is left. */
static void shut(struct recognition *r) {
    r->over = true;
    if (r->child.pid > 0)
        uv_kill(-r->child.pid, SIGKILL);
    for (int i = 0; i < PIPES; i++)
        close_handle((uv_handle_t *)&r->pipes[i]);
    close_handle((uv_handle_t *)&r->timer);
    if (r->exited && r->child.type == UV_PROCESS)
        close_handle((uv_handle_t *)&r->child);
}

static void fail(struct recognition *r, const char *why) {
    struct error e;
    utf8_mend(r->complaint);
    error_set(&e, ERROR_RECOGNISER_FAILED, "the recogniser %s%s%s", why, *r->complaint ? ": " : "",
              r->complaint);
    shut(r);
    r->calls->done(r->ctx, NULL, &e);
}

/* The process has exited, and its output has been read. */
static void finish(struct recognition *r) {
    char how[64];
    if (r->signal == SIGXCPU)
        snprintf(how, sizeof how, "took too much processor time");
    else if (r->signal)
        snprintf(how, sizeof how, "was killed by signal %d", r->signal);
    else
        snprintf(how, sizeof how, "exited with status %d", (int)r->status);
    if (r->signal || r->status) {
        fail(r, how);
        return;
    }
    const struct heard_words words = heard_lines_end(&r->lines);
    char *text = mem_strdup(words.text); /* `done` may free r */
    shut(r);
    r->calls->done(r->ctx, &(struct heard_words){text, true, words.confidence}, NULL);
    free(text);
}

static void on_time(uv_timer_t *timer) {
    struct recognition *r = timer->data;
    char why[64];
    snprintf(why, sizeof why, "took more than %u s", r->seconds);
    if (r->exited)
        finish(r);
    else
        fail(r, why);
}

static void check_end(struct recognition *r) {
    if (r->over || !r->exited)
        return;
    if (!r->open)
        finish(r);
    else
        uv_timer_start(&r->timer, on_time, LINGER_MS, 0);
}

static void on_exited(uv_process_t *child, int64_t status, int signal) {
    struct recognition *r = child->data;
    r->exited = true;
    r->status = status;
    r->signal = signal;
    if (r->over)
        close_handle((uv_handle_t *)child);
    check_end(r);
}

static void on_room(uv_handle_t *handle, size_t wanted, uv_buf_t *room) {
    struct recognition *r = handle->data;
    (void)wanted;
    *room = uv_buf_init(r->room, sizeof r->room);
}

static void take_complaint(struct recognition *r, const char *bytes, size_t size) {
    for (size_t i = 0; i < size; i++) {
        if (bytes[i] == '\n') {
            r->complaint_whole = true;
            continue;
        }
        if (r->complaint_whole)
            r->complaint_size = 0;
        r->complaint_whole = false;
        if (r->complaint_size + 1 < sizeof r->complaint)
            r->complaint[r->complaint_size++] = bytes[i] ? bytes[i] : ' ';
        r->complaint[r->complaint_size] = '\0';
    }
}

static void tell_words(void *ctx, const struct heard_words *words) {
    struct recognition *r = ctx;
    r->calls->words(r->ctx, words);
}

static void on_read(uv_stream_t *stream, ssize_t size, const uv_buf_t *room) {
    struct recognition *r = stream->data;
    if (r->over || !size)
        return;
    if (size < 0) {
        uv_read_stop(stream);
        r->open--;
        check_end(r);
    } else if (stream == (uv_stream_t *)&r->pipes[COMPLAINTS]) {
        take_complaint(r, room->base, (size_t)size);
    } else {
        r->output += (size_t)size;
        if (!heard_lines_take(&r->lines, room->base, (size_t)size, tell_words, r) || r->output > OUTPUT_MOST)
            fail(r, "wrote too much");
    }
}

/* Real pipes, not sockets: a program may open /dev/stdin. */
static int open_pipes(struct recognition *r, int theirs[PIPES]) {
    int result = 0;
    for (int i = 0; i < PIPES; i++) {
        int ends[2];
        theirs[i] = -1;
        if (result || pipe2(ends, O_CLOEXEC)) {
            result = result ? result : -errno;
            continue;
        }
        theirs[i] = ends[i != IN];
        result = uv_pipe_open(&r->pipes[i], ends[i == IN]);
        if (result)
            close(ends[i == IN]);
    }
    return result;
}

static int spawn(struct recognition *r, uv_loop_t *loop, const struct recogniser *recogniser,
                 const char *lang, const char *room) {
    char seconds[16], megabytes[16];
    int theirs[PIPES];
    snprintf(seconds, sizeof seconds, "%u", (unsigned)PROCESSOR_SECONDS);
    snprintf(megabytes, sizeof megabytes, "%u", recogniser->megabytes);
    char *args[] = {
        (char *)recogniser->program, seconds,      megabytes,    recogniser->unconfined ? "off" : "on",
        (char *)recogniser->how,     (char *)lang, (char *)room, NULL};
    uv_stdio_container_t stdio[PIPES];
    int result = open_pipes(r, theirs);
    for (int i = 0; i < PIPES; i++)
        stdio[i] = (uv_stdio_container_t){.flags = UV_INHERIT_FD, .data.fd = theirs[i]};
    const uv_process_options_t options = {.exit_cb = on_exited,
                                          .file = recogniser->program,
                                          .args = args,
                                          .flags = UV_PROCESS_DETACHED, /* killed with its children */
                                          .stdio = stdio,
                                          .stdio_count = PIPES};
    if (!result) {
        r->handles++;
        result = uv_spawn(loop, &r->child, &options);
        r->exited = result < 0;
    }
    for (int i = 0; i < PIPES; i++)
        if (theirs[i] >= 0)
            close(theirs[i]);
    for (int i = OUT; i < PIPES && !result; i++, r->open++)
        result = uv_read_start((uv_stream_t *)&r->pipes[i], on_room, on_read);
    return result;
}

struct recognition *recognition_start(uv_loop_t *loop, const struct recogniser *recogniser, const char *lang,
                                      const char *room, const struct recognition_calls *calls, void *ctx,
                                      struct error *e) {
    if (!recogniser->how || !*recogniser->how)
        return error_plain(e, ERROR_NO_RECOGNISER), NULL;
    struct recognition *r = mem_alloc(sizeof *r);
    *r = (struct recognition){.calls = calls, .ctx = ctx, .seconds = recogniser->seconds};
    for (int i = 0; i < PIPES; i++) {
        uv_pipe_init(loop, &r->pipes[i], 0);
        r->pipes[i].data = r;
    }
    uv_timer_init(loop, &r->timer);
    r->child.data = r->timer.data = r;
    r->handles = PIPES + 1;
    int result = spawn(r, loop, recogniser, lang, room);
    if (!result)
        return r;
    error_set(e, ERROR_RECOGNISER_FAILED, "%.150s cannot be started: %s", recogniser->program,
              uv_strerror(result));
    shut(r);
    return NULL;
}

struct sent {
    uv_write_t write;
    int16_t samples[];
};

static void on_written(uv_write_t *write, int status) {
    (void)status; /* on_exited reports a process that is gone; one need not read everything */
    free(write->data);
}

void recognition_write(struct recognition *r, const int16_t *samples, size_t count) {
    if (r->over || r->ended || !count)
        return;
    struct sent *sent = mem_alloc(sizeof *sent + count * sizeof *samples);
    memcpy(sent->samples, samples, count * sizeof *samples);
    sent->write.data = sent;
    const uv_buf_t bytes = uv_buf_init((char *)sent->samples, (unsigned)(count * sizeof *samples));
    if (uv_write(&sent->write, (uv_stream_t *)&r->pipes[IN], &bytes, 1, on_written))
        free(sent);
}

/* Fails on a pipe, but only after everything has been written. */
static void on_shut(uv_shutdown_t *request, int status) {
    struct recognition *r = request->handle->data;
    (void)status;
    if (!r->over)
        close_handle((uv_handle_t *)&r->pipes[IN]);
    free(request);
}

/* Closes its input once everything is written. */
void recognition_end(struct recognition *r) {
    if (r->over || r->ended)
        return;
    r->ended = true;
    uv_shutdown_t *last = mem_alloc(sizeof *last);
    if (uv_shutdown(last, (uv_stream_t *)&r->pipes[IN], on_shut))
        free(last);
    if (!r->exited)
        uv_timer_start(&r->timer, on_time, (uint64_t)r->seconds * 1000, 0);
}

void recognition_free(struct recognition *r) {
    if (r && !r->over)
        shut(r);
}
