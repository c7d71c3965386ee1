/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/cli/room_drive.h"
#include "server/base/mem.h"
#include "server/bridges/live_line.h"
#include "server/cli/cli.h"
#include <curl/curl.h>
#include <stdlib.h>
#include <string.h>

enum {
    INTERVAL_MS = 12,        /* between messages: a room takes 120 a second */
    FRAMES_MOST = 32,        /* of a message */
    UNSENT_MOST = 64 * 1024, /* bytes */
    HEAD_FIRST = 48,         /* FAPs that turn the head */
    HEAD_LAST = 50,
};

struct room_drive {
    uv_loop_t *loop;
    struct live_line *line;
    struct daemon_address place;
    uv_timer_t timer;
    json_t *frames;
    const char *room;
    bool driving, failed;
};

static void send_frames(struct room_drive *d) {
    if (!json_array_size(d->frames) || d->failed)
        return;
    if (live_line_unsent(d->line) < UNSENT_MOST)
        live_line_tell(d->line, json_pack("{ss sO}", "type", "drive", "frames", d->frames));
    json_array_clear(d->frames);
}

static void on_interval(uv_timer_t *timer) {
    send_frames(timer->data);
}

void room_drive_face(void *drive, const struct puppet_face *face, double time) {
    struct room_drive *d = drive;
    struct fap_frame frame = {0};
    char name[12];
    arkit_faps(face->weights, &face->head, &frame);
    json_t *faps = json_object();
    for (int n = 3; n <= FAP_COUNT; n++) {
        if (!fap_frame_has(&frame, n) || (!face->turned && n >= HEAD_FIRST && n <= HEAD_LAST))
            continue;
        snprintf(name, sizeof name, "%d", n);
        json_object_set_new(faps, name, json_integer(frame.value[n]));
    }
    if (json_array_size(d->frames) == FRAMES_MOST)
        json_array_remove(d->frames, 0);
    json_array_append_new(d->frames, json_pack("{sf so}", "time", time, "faps", faps));
    if (uv_is_active((uv_handle_t *)&d->timer))
        return;
    send_frames(d);
    uv_timer_start(&d->timer, on_interval, INTERVAL_MS, 0);
}

static void fail(struct room_drive *d, const char *why) {
    if (!d->failed)
        cli_complain("%.200s: %s", d->room, why);
    d->failed = true;
    uv_stop(d->loop);
}

static void on_message(void *ctx, const json_t *message) {
    struct room_drive *d = ctx;
    const char *type = json_string_value(json_object_get(message, "type"));
    const char *text = json_string_value(json_object_get(message, "message"));
    if (type && !strcmp(type, "error"))
        fail(d, text ? text : "an unknown error");
    else if (type && !strcmp(type, "driven") && !d->driving && json_is_true(json_object_get(message, "on"))) {
        d->driving = true;
        cli_complain("the face of the room %.200s is driven", d->room);
    }
}

static void on_lost(void *ctx, const char *why) {
    fail(ctx, why);
}

struct room_drive *room_drive_open(uv_loop_t *loop, const char *room, const char *url,
                                   const char *token_file) {
    static const struct live_line_calls calls = {on_message, on_lost};
    const struct remote_member members[] = {
        {"room", room}, {"watch", "1"}, {"audio", "none"}, {"fap", "none"}, {NULL, NULL}};
    struct room_drive *d = mem_alloc(sizeof *d);
    *d = (struct room_drive){.loop = loop, .room = room, .frames = json_array()};
    curl_global_init(CURL_GLOBAL_DEFAULT);
    daemon_address_open(&d->place);
    if (url)
        d->place.url = url;
    uv_timer_init(loop, &d->timer);
    d->timer.data = d;
    if ((!token_file || !daemon_address_read_token(&d->place, token_file)) &&
        (d->line = live_line_open(loop, "faccia", &d->place, members, &calls, d)) && !d->failed)
        return d;
    room_drive_close(d);
    return NULL;
}

bool room_drive_close(struct room_drive *d) {
    bool well = !d->failed;
    if (d->line) {
        send_frames(d);
        live_line_close(d->line);
    }
    uv_close((uv_handle_t *)&d->timer, NULL);
    uv_run(d->loop, UV_RUN_DEFAULT);
    if (d->line)
        live_line_free(d->line);
    daemon_address_close(&d->place);
    json_decref(d->frames);
    curl_global_cleanup();
    free(d);
    return well;
}
