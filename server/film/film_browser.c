/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/film/film_browser.h"
#include "server/access/quota.h"
#include "server/base/mem.h"
#include "server/base/metrics.h"
#include "server/film/film_process.h"
#include "server/http/exchange.h"
#include "server/http/http_server.h"
#include "server/http/static_files.h"
#include "server/http/websocket.h"
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <unistd.h>

enum {
    START_SECONDS = 60,     /* for the browser to open the page */
    PREPARE_SECONDS = 300,  /* for the page to read the head and to draw the first picture */
    PICTURE_SECONDS = 60,   /* for each further picture */
    AHEAD = 6,              /* pictures that may be on their way */
    IMAGE_BYTES = 64 << 20, /* largest background */
    CONTROL_FD = 3,         /* the browser ends when this pipe is closed */
};

struct film_browser {
    uv_timer_t timer;
    const struct film_browser_calls *calls;
    void *ctx;
    struct film_process *process;
    struct http_server *http;
    struct metrics metrics;
    struct quota quota;
    struct http_options options;
    struct static_files files;
    struct websocket *ws;
    char root[34]; /* "/SECRET" */
    size_t picture_bytes;
    unsigned count, drawn, taken;
    bool connected, failed, closed;
};

const char *film_browser_found(void) {
    static const char *const names[] = {"chromium-headless-shell", "chromium", "google-chrome"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (film_process_found(names[i]))
            return names[i];
    return NULL;
}

static void fail(struct film_browser *b, const char *why) {
    struct error e;
    if (b->failed || b->closed)
        return;
    b->failed = true;
    uv_timer_stop(&b->timer);
    const char *said = b->process ? film_process_said(b->process) : "";
    error_set(&e, ERROR_FILM_FAILED, "%s%s%s", why, *said && !b->connected ? ": " : "",
              b->connected ? "" : said);
    b->calls->failed(b->ctx, &e);
}

/* Time limits */

static void on_time(uv_timer_t *timer) {
    struct film_browser *b = timer->data;
    fail(b, !b->connected ? "the browser does not open the page"
            : b->drawn    ? "the browser takes too long for a picture"
                          : "the browser takes too long to prepare the head");
}

/* The page works unless it has to wait for us, or is done. */
static void watch(struct film_browser *b) {
    unsigned seconds = !b->connected ? START_SECONDS : b->drawn ? PICTURE_SECONDS : PREPARE_SECONDS;
    if (b->drawn == b->count || b->drawn - b->taken >= AHEAD)
        uv_timer_stop(&b->timer);
    else
        uv_timer_start(&b->timer, on_time, (uint64_t)seconds * 1000, 0);
}

/* The page */

static void on_message(void *owner, struct buf *message, bool binary, bool too_long) {
    struct film_browser *b = owner;
    if (b->failed || b->closed)
        return;
    if (!binary) {
        json_t *said = json_loadb((char *)message->data, message->size, 0, NULL);
        const char *error = json_string_value(json_object_get(said, "error"));
        fail(b, error ? error : "the page has failed");
        json_decref(said);
        return;
    }
    if (too_long || (message->size != b->picture_bytes && (message->size || !b->drawn)) ||
        b->drawn - b->taken >= AHEAD || b->drawn == b->count) {
        fail(b, "the page has sent something other than a picture");
        return;
    }
    b->drawn++;
    watch(b);
    b->calls->picture(b->ctx, message);
}

static void on_fault(void *owner, const struct error *e) {
    fail(owner, e->message);
}

static bool on_linger(void *owner) {
    (void)owner;
    return false;
}

static void on_drained(void *owner) {
    (void)owner;
}

static void on_gone(void *owner) {
    struct film_browser *b = owner;
    b->ws = NULL;
    if (b->drawn < b->count)
        fail(b, "the browser has closed the page");
}

static const struct websocket_calls page_calls = {on_message, on_fault, on_linger, on_drained, on_gone};

/* Tells the page how many pictures have been taken. */
static void say_taken(struct film_browser *b) {
    char text[16];
    int size = snprintf(text, sizeof text, "%u", b->taken);
    struct queued_message *message = queued_message_new(WEBSOCKET_TEXT, text, (size_t)size);
    websocket_send(b->ws, message);
    queued_message_release(message);
}

static const char *below(const struct film_browser *b, struct exchange *x) {
    const char *path = exchange_request(x)->path;
    size_t length = strlen(b->root);
    return strncmp(path, b->root, length) != 0 ? "" : path + length;
}

static void serve(void *ctx, struct exchange *x) {
    struct film_browser *b = ctx;
    const struct static_file *file = static_files_find(&b->files, below(b, x));
    struct error e;
    if (file && exchange_request(x)->method == HTTP_GET)
        exchange_file(x, file);
    else
        error_plain(&e, ERROR_NOT_FOUND), exchange_error(x, &e);
}

static void upgrade(void *ctx, struct exchange *x) {
    struct film_browser *b = ctx;
    static const char *const protocols[] = {NULL};
    const char *protocol;
    struct error e;
    if (strcmp(below(b, x), "/pictures") != 0 || b->connected) {
        error_plain(&e, ERROR_NOT_FOUND);
        exchange_error(x, &e);
        return;
    }
    b->ws = websocket_accept(x, protocols, &protocol);
    if (!b->ws)
        return;
    b->connected = true;
    websocket_use(b->ws, &page_calls, b, "the page");
    say_taken(b); /* the answer to the handshake leaves with the first message */
    watch(b);
}

static bool allowed(void *ctx, const struct http_request *request) {
    (void)ctx;
    (void)request;
    return true; /* the path is a secret */
}

static void on_tick(void *ctx) {
    (void)ctx;
}

static void on_ended(void *ctx, bool well) {
    (void)well;
    fail(ctx, "the browser has ended");
}

static void add_bytes(struct film_browser *b, const char *path, const void *bytes, size_t size,
                      const char *type) {
    uint8_t *copy = mem_alloc(size + 1);
    memcpy(copy, bytes, size);
    static_files_add_bytes(&b->files, path, type, copy, size);
}

static void add_job(struct film_browser *b, const struct film_scene *s) {
    json_t *job =
        json_pack("{si si ss ss? ss? sb sf sf sf si si sb sb sf}", "width", (int)s->width, "height",
                  (int)s->height, "level", s->level, "view", s->view, "colour", s->colour, "image",
                  s->image != NULL, "rate", s->rate, "fps", s->fps, "start", s->start, "count", (int)s->count,
                  "ahead", AHEAD, "pair", s->partner != NULL, "still", s->still, "life", s->life);
    if (film_shows_any(s->shows))
        json_object_set_new(job, "shows",
                            json_pack("{sb sb si}", "mesh", s->shows.mesh, "points", s->shows.points, "zone",
                                      (int)s->shows.zone));
    char *text = json_dumps(job, JSON_COMPACT);
    add_bytes(b, "/job.json", text, strlen(text), "application/json");
    free(text);
    json_decref(job);
}

/* -1 with *e if a file cannot be read. */
static int add_files(struct film_browser *b, const struct film_scene *s, struct error *e) {
    static const char page[] = "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>Film</title>"
                               "<script type=\"module\" src=\"film.js\"></script></html>";
    static const char binary[] = "application/octet-stream";
    char script[4096];
    struct buf image = {0};
    snprintf(script, sizeof script, "%s/film.js", s->web);
    if (!static_files_add(&b->files, "/film.js", "text/javascript; charset=utf-8", script))
        return error_set(e, ERROR_FILM_FAILED,
                         "%s cannot be read; it is built only where Node.js is installed", script);
    if (!static_files_add(&b->files, "/model.json", "application/json", s->head))
        return error_set(e, ERROR_FILM_FAILED, "%s cannot be read", s->head);
    if (s->partner && !static_files_add(&b->files, "/partner.json", "application/json", s->partner))
        return error_set(e, ERROR_FILM_FAILED, "%s cannot be read", s->partner);
    if (s->partner)
        add_bytes(b, "/words.vtt", s->words->data, s->words->size, "text/vtt; charset=utf-8");
    int why = s->image ? buf_add_file(&image, s->image, IMAGE_BYTES) : 0;
    if (why)
        return error_set(e, ERROR_FILM_FAILED, "%s: %s", s->image, strerror(why));
    if (s->image)
        static_files_add_bytes(&b->files, "/background.bin", binary, image.data, image.size);
    add_bytes(b, "/film.html", page, sizeof page - 1, "text/html; charset=utf-8");
    add_bytes(b, "/faces.bin", s->faces->data, s->faces->size, binary);
    add_job(b, s);
    return 0;
}

int film_secret(char *out, size_t size, struct error *e) {
    uint8_t byte;
    for (size_t i = 0; i + 2 < size; i += 2) {
        if (getrandom(&byte, 1, 0) != 1)
            return error_set(e, ERROR_FILM_FAILED, "no random numbers");
        snprintf(out + i, 3, "%02x", byte);
    }
    return 0;
}

static int open_server(struct film_browser *b, uv_loop_t *loop, struct error *e) {
    static const struct http_calls calls = {serve, upgrade, allowed, on_tick};
    b->root[0] = '/';
    if (film_secret(b->root + 1, sizeof b->root - 1, e))
        return -1;
    b->options = (struct http_options){.host = "127.0.0.1",
                                       .connections = 32,
                                       .message_bytes = (unsigned)b->picture_bytes + 1024,
                                       .send_bytes = 1 << 20,
                                       .send_bytes_max = 1 << 24,
                                       .stall_seconds = PREPARE_SECONDS,
                                       .ping_seconds = 2 * PREPARE_SECONDS};
    b->http = http_server_open(loop, &b->metrics, &b->quota, &b->options, &calls, b, e);
    return b->http ? 0 : -1;
}

/* Writes a page that redirects to ours. Its address holds a secret, and everybody on the machine can read
 * command lines, but not this folder. */
static int write_start(struct film_browser *b, const char *path) {
    struct buf page = {0};
    buf_printf(&page, "<!doctype html><meta http-equiv=\"refresh\" content=\"0;url=");
    http_server_address(b->http, 0, &page);
    buf_printf(&page, "%s/film.html\">", b->root + 1);
    FILE *file = fopen(path, "wb");
    bool well = file && fwrite(page.data, 1, page.size, file) == page.size;
    well = file && !fclose(file) && well;
    buf_free(&page);
    return well ? 0 : -1;
}

static int start_browser(struct film_browser *b, uv_loop_t *loop, const struct film_scene *s,
                         struct error *e) {
    char profile[4096], address[4096];
    snprintf(profile, sizeof profile, "--user-data-dir=%s/profile", s->folder);
    snprintf(address, sizeof address, "file://%s/start.html", s->folder);
    if (write_start(b, address + strlen("file://")))
        return error_set(e, ERROR_FILM_FAILED, "%s: %s", s->folder, strerror(errno));
    /* The feature: else the memory for each picture's triangles is given back, and cleared for the next. */
    const char *args[] = {film_browser_found(),
                          FILM_BROWSER_ALONE,
                          profile,
                          "--use-gl=angle",
                          "--use-angle=gl-egl", /* Mesa, whose llvmpipe draws faster than SwiftShader */
                          "--enable-features=PartitionAllocLargeEmptySlotSpanRing",
                          "--enable-gpu",
                          "--force-device-scale-factor=1",
                          "--force-color-profile=srgb",
                          "--no-proxy-server",
                          geteuid() ? address : "--no-sandbox", /* root has no other choice */
                          geteuid() ? NULL : address,
                          NULL};
    /* Never the graphics card: the same pictures on every machine. */
    static const char *const environment[] = {"LIBGL_ALWAYS_SOFTWARE=1", "EGL_PLATFORM=surfaceless", NULL};
    int nowhere = open("/dev/null", O_RDWR | O_CLOEXEC);
    const struct film_process_options options = {.args = (char **)args,
                                                 .input = CONTROL_FD,
                                                 .given = nowhere,
                                                 .as = CONTROL_FD + 1,
                                                 .folder = s->folder,
                                                 .environment = environment,
                                                 .ended = on_ended,
                                                 .ctx = b};
    b->process = film_process_start(loop, &options, e);
    close(nowhere);
    return b->process ? 0 : -1;
}

struct film_browser *film_browser_new(uv_loop_t *loop, const struct film_browser_calls *calls, void *ctx) {
    struct film_browser *b = mem_alloc(sizeof *b);
    b->calls = calls;
    b->ctx = ctx;
    uv_timer_init(loop, &b->timer);
    b->timer.data = b;
    return b;
}

int film_browser_start(struct film_browser *b, const struct film_scene *scene, struct error *e) {
    uv_loop_t *loop = b->timer.loop;
    b->count = scene->count;
    b->picture_bytes = (size_t)4 * scene->width * scene->height;
    if (add_files(b, scene, e) || open_server(b, loop, e) || start_browser(b, loop, scene, e))
        return -1;
    watch(b);
    return 0;
}

void film_browser_taken(struct film_browser *b) {
    b->taken++;
    if (!b->ws || b->closed)
        return;
    say_taken(b);
    watch(b);
}

void film_browser_close(struct film_browser *b) {
    if (!b)
        return;
    b->closed = true;
    uv_close((uv_handle_t *)&b->timer, NULL);
    film_process_close(b->process);
    http_server_close(b->http);
}

void film_browser_free(struct film_browser *b) {
    if (!b)
        return;
    http_server_free(b->http);
    static_files_free(&b->files);
    quota_free(&b->quota);
    free(b);
}
