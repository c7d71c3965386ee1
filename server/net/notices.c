/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/notices.h"
#include "server/net/calibration.h"
#include "server/net/client_message.h"
#include "server/net/net_internal.h"
#include "server/net/notice_message.h"
#include <stdio.h>
#include <string.h>

enum {
    CALIBRATION_MS =
        250, /* so often a channel may be calibrated for long: each listener builds its head anew, */
    CALIBRATION_BURST = 12, /* and so many at once */
};

static int check_choices(const json_t *choices, struct error *e) {
    size_t count = json_array_size(choices);
    if (!json_is_array(choices) || count > NOTICE_CHOICES)
        return error_in_field(e, choices ? ERROR_BAD_FIELD : ERROR_MISSING_FIELD, "choices",
                              "must be a list of up to %d texts; an empty one withdraws them",
                              NOTICE_CHOICES);
    for (size_t i = 0; i < count; i++) {
        const json_t *text = json_array_get(choices, i);
        size_t length = json_string_length(text);
        char field[32];
        snprintf(field, sizeof field, "choices.%zu", i);
        if (!length || length > NOTICE_CHOICE_BYTES || strlen(json_string_value(text)) != length)
            return error_in_field(e, ERROR_BAD_FIELD, field, "must be a text of 1 to %d bytes",
                                  NOTICE_CHOICE_BYTES);
    }
    return 0;
}

int notice_choices(struct channel *c, const json_t *message, struct error *e) {
    json_t *choices = json_object_get(message, "choices"), *told = notice_begin(c, "choices");
    int failed = client_message_check("choices", message, e) || check_choices(choices, e);
    if (!failed) {
        notice_take_member(message, "id", told);
        notice_take_member(message, "question", told);
        json_object_set_new(told, "choices", json_deep_copy(choices));
        struct queued_message *all = notice_tell(c, told, "choices");
        bool any = json_array_size(choices);
        notice_board_choices(&c->notices, any ? all : NULL, any ? told : NULL);
        queued_message_release(all);
    }
    json_decref(told);
    return failed ? -1 : 0;
}

/* The id must be that of the choices that stand there: others may have come while somebody chose. */
static bool is_offered(const json_t *offered, const json_t *message) {
    const char *asked = json_string_value(json_object_get(message, "id"));
    const char *id = json_string_value(json_object_get(offered, "id"));
    return offered && (!asked || !strcmp(asked, id ? id : ""));
}

/* The choice's place in the list, or -1 with *e. */
static json_int_t chosen_of(const json_t *offered, const json_t *message, struct error *e) {
    size_t count = json_array_size(json_object_get(offered, "choices"));
    json_int_t at = (json_int_t)json_number_value(json_object_get(message, "choice"));
    if (!is_offered(offered, message))
        return error_plain(e, ERROR_NO_CHOICES);
    if ((size_t)at >= count)
        return error_in_field(e, ERROR_BAD_FIELD, "choice", "must be a number from 0 to %zu", count - 1);
    return at;
}

int notice_choose(struct channel *c, const json_t *message, const char *by, struct error *e) {
    const json_t *offered = c->notices.offered;
    json_t *told = notice_begin(c, "chosen");
    json_int_t at = client_message_check("choose", message, e) ? -1 : chosen_of(offered, message, e);
    if (at >= 0) {
        if (json_object_get(offered, "id"))
            json_object_set(told, "id", json_object_get(offered, "id"));
        json_object_set_new(told, "choice", json_integer(at));
        json_object_set(told, "text", json_array_get(json_object_get(offered, "choices"), (size_t)at));
        json_object_set_new(told, "by", json_string(by));
        queued_message_release(notice_tell(c, told, "chosen"));
        notice_board_choices(&c->notices, NULL, NULL);
    }
    json_decref(told);
    return at < 0 ? -1 : 0;
}

/* Others in the room see whose mood it is, and that it is another. */
static void tell_mood(struct channel *c, const struct mood_request *mix, const char *by) {
    json_t *told = notice_begin(c, "expressed"), *parts = json_array();
    for (size_t i = 0; i < mix->count; i++)
        json_array_append_new(
            parts, json_pack("{ss sf}", "name", mix->names[i], "intensity", (double)mix->intensities[i]));
    json_object_set_new(told, "mix", parts);
    if (by)
        json_object_set_new(told, "by", json_string(by));
    struct queued_message *all = notice_tell(c, told, "expressed");
    notice_board_mood(&c->notices, mix->count ? all : NULL);
    queued_message_release(all);
    json_decref(told);
}

int notice_express(struct channel *c, const json_t *message, const char *by, struct error *e) {
    struct mood_request mix;
    if (live_express(message, &mix, e) || stream_express(c->stream, &mix, e))
        return -1;
    if (c->room)
        tell_mood(c, &mix, by);
    return 0;
}

int notice_state(struct channel *c, const json_t *message, struct error *e) {
    json_t *told = notice_begin(c, "state");
    int failed = client_message_check("state", message, e) ||
                 (json_object_get(message, "mix") && notice_express(c, message, NULL, e));
    if (!failed) {
        notice_take_member(message, "state", told);
        notice_take_member(message, "text", told);
        struct queued_message *all = notice_tell(c, told, "state");
        notice_board_state(&c->notices, all);
        queued_message_release(all);
    }
    json_decref(told);
    return failed ? -1 : 0;
}

/* Counts one more. -1: each of them goes to every listener, and there were too many. */
static int count_calibration(struct channel *c, struct error *e) {
    uint64_t now = uv_now(c->net->pipeline->loop);
    uint64_t from = c->calibrated > now ? c->calibrated : now;
    if (from + CALIBRATION_MS - now > CALIBRATION_MS * CALIBRATION_BURST)
        return error_set(e, ERROR_TOO_MANY_REQUESTS, "a face takes %d calibrations a second, and %d at once",
                         1000 / CALIBRATION_MS, CALIBRATION_BURST);
    c->calibrated = from + CALIBRATION_MS;
    return 0;
}

/* On a stream of one's own nobody comes later. */
int notice_calibrate(struct channel *c, const json_t *message, struct error *e) {
    const json_t *reset = json_object_get(message, "reset");
    if (client_message_check("calibrate", message, e))
        return -1;
    json_t *told = notice_begin(c, "calibrated");
    int failed = json_is_true(reset) ? json_object_set_new(told, "reset", json_true())
                                     : calibration_take(message, told, e);
    failed = failed || count_calibration(c, e);
    if (!failed) {
        struct queued_message *all = notice_tell(c, told, "calibrated");
        notice_board_calibration(&c->notices, c->room && !json_is_true(reset) ? all : NULL);
        queued_message_release(all);
    }
    json_decref(told);
    return failed ? -1 : 0;
}
