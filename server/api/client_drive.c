/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Frames of a face that a WebSocket client drives in real time. */
#include "server/api/client_internal.h"
#include "server/rooms/driving.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { FRAMES_MOST = 32 }; /* of a message */

/* Reads the number of a FAP, 3 to FAP_COUNT; 0: it is none. */
static int fap_of(const char *key) {
    char *end;
    long n = strtol(key, &end, 10);
    return *end || *key < '1' || *key > '9' || n < 3 || n > FAP_COUNT ? 0 : (int)n;
}

static int read_faps(const json_t *faps, size_t i, struct fap_frame *out, struct error *e) {
    char field[48];
    const char *key;
    json_t *value;
    snprintf(field, sizeof field, "frames.%zu.faps", i);
    if (!json_is_object(faps))
        return error_in_field(e, faps ? ERROR_BAD_FIELD : ERROR_MISSING_FIELD, field,
                              "must be an object of FAPs by number");
    json_object_foreach((json_t *)faps, key, value) {
        int n = fap_of(key);
        double number = json_number_value(value);
        if (!n || !json_is_number(value) || !isfinite(number))
            return error_in_field(e, ERROR_BAD_FIELD, field, "'%.16s' must be a FAP, 3 to %d, with a number",
                                  key, FAP_COUNT);
        fap_frame_set(out, n, fap_clamp(n, (int32_t)fmax(INT32_MIN, fmin(INT32_MAX, rint(number)))));
    }
    return 0;
}

static int read_frame(const json_t *frame, size_t i, struct driven_frame *out, struct error *e) {
    const json_t *time = json_object_get(frame, "time");
    char field[48];
    snprintf(field, sizeof field, "frames.%zu.time", i);
    *out = (struct driven_frame){.time = json_number_value(time)};
    if (!json_is_number(time) || !isfinite(out->time) || out->time < 0)
        return error_in_field(e, time ? ERROR_BAD_FIELD : ERROR_MISSING_FIELD, field,
                              "must be a number of seconds, at least 0");
    return read_faps(json_object_get(frame, "faps"), i, &out->faps, e);
}

static int read_frames(const json_t *frames, struct driven_frame out[FRAMES_MOST], size_t *count,
                       struct error *e) {
    *count = json_array_size(frames);
    if (!json_is_array(frames) || !*count || *count > FRAMES_MOST)
        return error_in_field(e, frames ? ERROR_BAD_FIELD : ERROR_MISSING_FIELD, "frames",
                              "must be a list of 1 to %d frames", FRAMES_MOST);
    for (size_t i = 0; i < *count; i++)
        if (read_frame(json_array_get(frames, i), i, &out[i], e))
            return -1;
    return 0;
}

static int drive(struct client *c, const json_t *message, struct error *e) {
    const json_t *on = json_object_get(message, "on");
    struct driven_frame frames[FRAMES_MOST];
    size_t count;
    if (principal_may(c->api, &c->principal, client_message_right("drive"), client_room(c), e))
        return -1;
    if (on && !json_is_true(on)) {
        client_drive_leave(c);
        return 0;
    }
    if (c->api->draining)
        return error_set(e, ERROR_STOPPING, "the server is shutting down");
    if (read_frames(json_object_get(message, "frames"), frames, &count, e))
        return -1;
    return channel_drive(c->follower.channel, c->number, client_called(c), c->voice, frames, count, e);
}

void client_drive(struct client *c, const json_t *message) {
    struct error e;
    if (drive(c, message, &e))
        client_complain(c, &e);
}

void client_drive_leave(struct client *c) {
    if (c->follower.channel)
        channel_undrive(c->follower.channel, c->number);
}
