/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/notices.h"
#include "server/net/channel_internal.h"
#include "server/net/net_internal.h"
#include <stdio.h>
#include <string.h>

enum { ID_BYTES = 64 };

/* Passes over a member that is not there. */
static int take_text(const json_t *message, const char *name, size_t most, json_t *into, struct error *e) {
    json_t *value = json_object_get(message, name);
    size_t length = json_string_length(value);
    if (!value || json_is_null(value))
        return 0;
    if (!json_is_string(value) || length > most || strlen(json_string_value(value)) != length)
        return error_in_field(e, ERROR_BAD_FIELD, name, "must be a string of at most %zu bytes", most);
    json_object_set(into, name, value);
    return 0;
}

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

/* The message so far, to which its members are added. */
static json_t *begin(const struct channel *c, const char *type) {
    return json_pack("{ss ss}", "type", type, "stream", c->name);
}

static struct queued_message *message_of(const json_t *object, const char *event) {
    struct buf text = {0}, line = {0};
    message_write(&text, json_incref((json_t *)object));
    text_line(object, &line);
    struct queued_message *message = queued_message_new(WEBSOCKET_TEXT, text.data, text.size);
    message->event = event;
    message->line = queued_message_new(WEBSOCKET_TEXT, line.data, line.size);
    buf_free(&text);
    buf_free(&line);
    return message;
}

/* Takes the reference. */
static void replace(struct queued_message **place, struct queued_message *message) {
    queued_message_release(*place);
    *place = message;
}

static void withdraw(struct notices *n) {
    replace(&n->choices, NULL);
    json_decref(n->offered);
    n->offered = NULL;
}

int notice_choices(struct channel *c, const json_t *message, struct error *e) {
    json_t *choices = json_object_get(message, "choices"), *told = begin(c, "choices");
    if (take_text(message, "id", ID_BYTES, told, e) ||
        take_text(message, "question", NOTICE_TEXT_BYTES, told, e) || check_choices(choices, e)) {
        json_decref(told);
        return -1;
    }
    json_object_set_new(told, "choices", json_deep_copy(choices));
    struct queued_message *all = message_of(told, "choices");
    channel_notice(c, all);
    withdraw(&c->notices);
    if (!json_array_size(choices)) {
        queued_message_release(all);
        json_decref(told);
        return 0;
    }
    replace(&c->notices.choices, all);
    c->notices.offered = told;
    return 0;
}

/* The id must be that of the choices that stand there: others may have come while somebody chose. */
static bool is_offered(const struct notices *n, const json_t *message) {
    const char *asked = json_string_value(json_object_get(message, "id"));
    const char *id = json_string_value(json_object_get(n->offered, "id"));
    return n->offered && (!asked || !strcmp(asked, id ? id : ""));
}

int notice_choose(struct channel *c, const json_t *message, const char *by, struct error *e) {
    const json_t *choice = json_object_get(message, "choice");
    struct notices *n = &c->notices;
    json_t *told = begin(c, "chosen");
    if (take_text(message, "id", ID_BYTES, told, e)) {
        json_decref(told);
        return -1;
    }
    json_int_t at = json_integer_value(choice);
    json_t *choices = json_object_get(n->offered, "choices");
    bool offered = is_offered(n, message);
    if (!offered || !json_is_integer(choice) || at < 0 || (size_t)at >= json_array_size(choices)) {
        json_decref(told);
        return !offered ? error_plain(e, ERROR_NO_CHOICES)
                        : error_in_field(e, choice ? ERROR_BAD_FIELD : ERROR_MISSING_FIELD, "choice",
                                         "must be a number from 0 to %zu", json_array_size(choices) - 1);
    }
    if (json_object_get(n->offered, "id"))
        json_object_set(told, "id", json_object_get(n->offered, "id"));
    json_object_set_new(told, "choice", json_integer(at));
    json_object_set(told, "text", json_array_get(choices, (size_t)at));
    json_object_set_new(told, "by", json_string(by));
    struct queued_message *all = message_of(told, "chosen");
    channel_notice(c, all);
    queued_message_release(all);
    json_decref(told);
    withdraw(n);
    return 0;
}

int notice_state(struct channel *c, const json_t *message, struct error *e) {
    static const char *const states[] = {"idle", "listening", "thinking", "muted"};
    const json_t *value = json_object_get(message, "state");
    const char *state = json_string_value(value);
    size_t i = 0;
    while (i < sizeof states / sizeof *states && (!state || strcmp(states[i], state)))
        i++;
    if (i == sizeof states / sizeof *states)
        return error_in_field(e, value ? ERROR_BAD_FIELD : ERROR_MISSING_FIELD, "state",
                              "must be idle, listening, thinking, or muted");
    json_t *told = begin(c, "state");
    struct mood_request mix;
    json_object_set_new(told, "state", json_string(states[i]));
    int failed = take_text(message, "text", NOTICE_TEXT_BYTES, told, e) ||
                 (json_object_get(message, "mix") &&
                  (live_express(message, &mix, e) || stream_express(c->stream, &mix, e)));
    if (!failed) {
        struct queued_message *all = message_of(told, "state");
        channel_notice(c, all);
        replace(&c->notices.state, all);
    }
    json_decref(told);
    return failed ? -1 : 0;
}

void notices_tell(const struct notices *n, void (*tell)(void *ctx, struct queued_message *message),
                  void *ctx) {
    if (n->state)
        tell(ctx, n->state);
    if (n->choices)
        tell(ctx, n->choices);
}

void notices_free(struct notices *n) {
    withdraw(n);
    replace(&n->state, NULL);
}
