/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/film/film_cast.h"
#include "server/base/buf.h"
#include "server/base/mem.h"
#include "server/film/film_browser.h"
#include "server/film/film_process.h"
#include <errno.h>
#include <fcntl.h>
#include <jansson.h>
#include <openssl/evp.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The browser is told what to do by the Chrome DevTools Protocol over two pipes: JSON, each message ended by
 * a zero byte (https://chromedevtools.github.io/devtools-protocol/). */
enum {
    COMMANDS_FD = 3, /* the browser ends when this pipe is closed */
    EVENTS_FD = 4,
    START_SECONDS = 60, /* until the first picture */
    MESSAGE_MOST = 32 << 20,
    READ_BYTES = 1 << 16,
    QUALITY = 90, /* of a JPEG */
};

/* Numbers of commands; those of acknowledgements follow. */
enum { CREATE = 1, ATTACH, SIZE, EVENTS, NAVIGATE, CAST, ACKNOWLEDGE };

struct film_cast {
    uv_timer_t timer;
    uv_pipe_t events;
    const struct film_cast_calls *calls;
    void *ctx;
    struct film_process *process;
    struct buf said; /* an incomplete message */
    char *url;
    char *session; /* of the page; NULL: not attached yet */
    unsigned width, height;
    int acknowledged;
    bool opened, failed, closed;
    char room[READ_BYTES];
};

static void fail(struct film_cast *c, const char *why, const char *more) {
    struct error e;
    if (c->failed || c->closed)
        return;
    c->failed = true;
    uv_timer_stop(&c->timer);
    error_set(&e, ERROR_FILM_FAILED, "%s%s%.200s", why, *more ? ": " : "", more);
    c->calls->failed(c->ctx, &e);
}

static void on_time(uv_timer_t *timer) {
    fail(timer->data, "the browser shows no page", "");
}

static void on_ended(void *ctx, bool well) {
    struct film_cast *c = ctx;
    (void)well;
    fail(c, "the browser has ended", film_process_said(c->process));
}

static void on_sent(void *ctx, int status) {
    (void)status; /* the end of the browser is told anyway */
    free(ctx);
}

/* Sends a command; takes the parameters. */
static void tell(struct film_cast *c, int id, const char *method, json_t *params) {
    json_t *command = json_pack("{si ss so}", "id", id, "method", method, "params", params);
    if (c->session)
        json_object_set_new(command, "sessionId", json_string(c->session));
    char *text = json_dumps(command, JSON_COMPACT);
    film_process_write(c->process, text, strlen(text) + 1, on_sent, text);
    json_decref(command);
}

static void attach(struct film_cast *c, const json_t *result) {
    tell(c, ATTACH, "Target.attachToTarget",
         json_pack("{sO sb}", "targetId", json_object_get(result, "targetId"), "flatten", 1));
}

static void open_page(struct film_cast *c, const json_t *result) {
    const char *session = json_string_value(json_object_get(result, "sessionId"));
    c->session = session ? mem_strdup(session) : NULL;
    tell(c, SIZE, "Emulation.setDeviceMetricsOverride",
         json_pack("{si si si sb}", "width", (int)c->width, "height", (int)c->height, "deviceScaleFactor", 1,
                   "mobile", 0));
    tell(c, EVENTS, "Page.enable", json_object());
    tell(c, NAVIGATE, "Page.navigate", json_pack("{ss}", "url", c->url));
}

static void check_page(struct film_cast *c, const json_t *result) {
    const char *trouble = json_string_value(json_object_get(result, "errorText"));
    if (trouble)
        fail(c, "the page cannot be opened", trouble);
    c->opened = true;
}

/* The page has loaded: our own, or at first the empty one. */
static void begin_cast(struct film_cast *c) {
    if (!c->opened)
        return;
    tell(c, CAST, "Page.startScreencast",
         json_pack("{ss si si si}", "format", "jpeg", "quality", QUALITY, "maxWidth", (int)c->width,
                   "maxHeight", (int)c->height));
}

static void show(struct film_cast *c, const json_t *params) {
    const json_t *data = json_object_get(params, "data");
    size_t length = json_string_length(data);
    const char *text = json_string_value(data);
    if (!length || length % 4)
        return;
    uint8_t *jpeg = mem_alloc(length);
    int size = EVP_DecodeBlock(jpeg, (const unsigned char *)text, (int)length);
    size -= (text[length - 1] == '=') + (text[length - 2] == '=');
    tell(c, ACKNOWLEDGE + c->acknowledged++ % 1000, "Page.screencastFrameAck",
         json_pack("{sO}", "sessionId", json_object_get(params, "sessionId")));
    uv_timer_stop(&c->timer);
    if (size > 0)
        c->calls->picture(c->ctx, jpeg, (size_t)size);
    free(jpeg);
}

static void take(struct film_cast *c, const char *text, size_t size) {
    json_t *message = json_loadb(text, size, 0, NULL);
    const json_t *result = json_object_get(message, "result");
    const char *error = json_string_value(json_object_get(json_object_get(message, "error"), "message"));
    const char *method = json_string_value(json_object_get(message, "method"));
    int id = (int)json_integer_value(json_object_get(message, "id"));
    if (error && id < ACKNOWLEDGE)
        fail(c, "the browser refuses a command", error);
    else if (id == CREATE)
        attach(c, result);
    else if (id == ATTACH)
        open_page(c, result);
    else if (id == NAVIGATE)
        check_page(c, result);
    else if (method && !strcmp(method, "Page.loadEventFired"))
        begin_cast(c);
    else if (method && !strcmp(method, "Page.screencastFrame"))
        show(c, json_object_get(message, "params"));
    json_decref(message);
}

static void on_room(uv_handle_t *handle, size_t size, uv_buf_t *room) {
    struct film_cast *c = handle->data;
    (void)size;
    *room = uv_buf_init(c->room, sizeof c->room);
}

static void on_bytes(uv_stream_t *stream, ssize_t n, const uv_buf_t *bytes) {
    struct film_cast *c = stream->data;
    if (n < 0) {
        uv_read_stop(stream); /* on_ended follows */
        return;
    }
    size_t from = c->said.size;
    buf_add(&c->said, bytes->base, (size_t)n);
    for (uint8_t *end; !c->failed && (end = memchr(c->said.data + from, '\0', c->said.size - from));) {
        size_t length = (size_t)(end - c->said.data);
        take(c, (const char *)c->said.data, length);
        buf_consume(&c->said, length + 1);
        from = 0;
    }
    if (c->said.size > MESSAGE_MOST)
        fail(c, "the browser says too much", "");
}

struct film_cast *film_cast_new(uv_loop_t *loop, const struct film_cast_calls *calls, void *ctx) {
    struct film_cast *c = mem_alloc(sizeof *c);
    c->calls = calls;
    c->ctx = ctx;
    uv_timer_init(loop, &c->timer);
    uv_pipe_init(loop, &c->events, 0);
    c->timer.data = c->events.data = c;
    return c;
}

static int start_browser(struct film_cast *c, const char *folder, int events, struct error *e) {
    char profile[4096];
    snprintf(profile, sizeof profile, "--user-data-dir=%s/profile", folder);
    const char *args[] = {film_browser_found(),
                          FILM_BROWSER_ALONE,
                          profile,
                          "--autoplay-policy=no-user-gesture-required",
                          geteuid() ? NULL : "--no-sandbox", /* root has no other choice */
                          NULL};
    const struct film_process_options options = {.args = (char **)args,
                                                 .input = COMMANDS_FD,
                                                 .given = events,
                                                 .as = EVENTS_FD,
                                                 .folder = folder,
                                                 .ended = on_ended,
                                                 .ctx = c};
    c->process = film_process_start(c->timer.loop, &options, e);
    return c->process ? 0 : -1;
}

int film_cast_start(struct film_cast *c, const char *url, unsigned width, unsigned height, const char *folder,
                    struct error *e) {
    int pipe[2];
    c->url = mem_strdup(url);
    c->width = width;
    c->height = height;
    if (pipe2(pipe, O_CLOEXEC))
        return error_set(e, ERROR_FILM_FAILED, "%s", strerror(errno));
    int status = start_browser(c, folder, pipe[1], e);
    close(pipe[1]);
    if (status || uv_pipe_open(&c->events, pipe[0])) {
        close(pipe[0]);
        return status ? -1 : error_set(e, ERROR_FILM_FAILED, "the browser cannot be read");
    }
    uv_read_start((uv_stream_t *)&c->events, on_room, on_bytes);
    uv_timer_start(&c->timer, on_time, START_SECONDS * 1000, 0);
    tell(c, CREATE, "Target.createTarget", json_pack("{ss}", "url", "about:blank"));
    return 0;
}

void film_cast_close(struct film_cast *c) {
    c->closed = true;
    film_process_close(c->process);
    c->process = NULL;
    uv_close((uv_handle_t *)&c->timer, NULL);
    uv_close((uv_handle_t *)&c->events, NULL);
}

void film_cast_free(struct film_cast *c) {
    buf_free(&c->said);
    free(c->session);
    free(c->url);
    free(c);
}
