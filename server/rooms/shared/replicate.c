/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Passes the output of a room's leader on to the followers of a replica, and keeps the state for late
 * joiners. */
#include "server/rooms/shared/shared_internal.h"
#include <string.h>

static void add(struct recent *r, uint64_t number) {
    r->number[r->count++ % RECENT_MOST] = number;
}

static bool has(const struct recent *r, uint64_t number) {
    for (unsigned i = 0; i < r->count && i < RECENT_MOST; i++)
        if (r->number[i] == number)
            return true;
    return false;
}

uint64_t shared_command(const char *daemon, uint64_t number) {
    return shared_daemon(daemon) | (uint32_t)number;
}

void shared_is_past(struct shared_room *h, uint32_t utterance) {
    if (utterance)
        add(&h->past, shared_daemon(h->holder) | utterance);
}

static bool shared_was_past(const struct shared_room *h, uint32_t utterance) {
    return utterance && has(&h->past, shared_daemon(h->holder) | utterance);
}

void shared_note_done(struct shared_room *h, uint64_t command) {
    add(&h->done, command);
}

bool shared_has_done(const struct shared_room *h, uint64_t command) {
    return has(&h->done, command);
}

void shared_note_heard(struct shared_room *h, const struct channel_item *item) {
    if (!item->media && !item->notice && item->kind == STREAM_END)
        shared_note_ended(h, item->command);
}

void shared_note_ended(struct shared_room *h, uint64_t command) {
    if (command && !has(&h->ended, command))
        add(&h->ended, command);
}

bool shared_has_heard(const struct shared_room *h, uint64_t command) {
    return command && (has(&h->ended, command) || channel_is_ending(h->channel, command));
}

/* Returns -1 when it is not an event of a stream. */
static int kind_of(const char *event) {
    for (int kind = STREAM_BEGIN; kind <= STREAM_END; kind++)
        if (!strcmp(event_name((enum stream_event_kind)kind), event))
            return kind;
    return -1;
}

/* The name of a notice as a static string. */
static const char *notice_name(const char *event) {
    static const char *const names[] = {"choices", "chosen",  "state",   "calibrated", "expressed",
                                        "consent", "lexicon", "asked",   "backdrop",   "head",
                                        "driven",  HEARD,     OVERHEARD, ANSWERED};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (!strcmp(names[i], event))
            return names[i];
    return "notice";
}

/* Applies the mood to the local stream too, in case this daemon becomes the room's next leader. */
static void take_mood(struct channel *c, const json_t *told, struct queued_message *message) {
    struct mood_request mix;
    struct error e;
    if (express_read(told, &mix, &e) || stream_express(c->stream, &mix, &e))
        return;
    notice_board_mood(&c->notices, mix.count ? message : NULL);
}

/* Sets the lexicon of the local stream, in case this daemon becomes the room's next leader. */
static void take_lexicon(struct channel *c, const json_t *told, struct queued_message *message) {
    const json_t *text = json_object_get(told, "lexicon");
    struct error e;
    size_t size = json_string_length(text);
    bool set = !stream_set_lexicon(c->stream, json_string_value(text), size, &e);
    notice_board_lexicon(&c->notices, set && size ? message : NULL);
}

static void keep_notice(struct channel *c, struct queued_message *message) {
    struct notice_board *board = &c->notices;
    const char *event = message->event;
    json_t *told = message_read(message);
    if (!told)
        return;
    if (!strcmp(event, "choices")) {
        bool any = json_array_size(json_object_get(told, "choices"));
        notice_board_choices(board, any ? message : NULL, any ? told : NULL);
    } else if (!strcmp(event, "chosen")) {
        notice_board_choices(board, NULL, NULL);
    } else if (!strcmp(event, "state")) {
        notice_board_state(board, message);
    } else if (!strcmp(event, "calibrated")) {
        notice_board_calibration(board, json_object_get(told, "reset") ? NULL : message);
    } else if (!strcmp(event, "expressed")) {
        take_mood(c, told, message);
    } else if (!strcmp(event, "backdrop")) {
        notice_board_backdrop(&c->notices,
                              json_string_length(json_object_get(told, "source")) ? message : NULL);
    } else if (!strcmp(event, "lexicon")) {
        take_lexicon(c, told, message);
    } else if (!strcmp(event, "head")) {
        const char *head = json_string_value(json_object_get(told, "head"));
        notice_board_head(board, head && *head ? message : NULL);
    } else if (!strcmp(event, "driven")) {
        notice_board_driven(board, json_is_true(json_object_get(told, "on")) ? message : NULL);
    } else if (!strcmp(event, "consent")) {
        const char *word = json_string_value(json_object_get(told, "consent"));
        bool any = word && strcmp(word, "none") != 0;
        notice_board_consent(board, any ? message : NULL, any ? told : NULL);
    }
    json_decref(told);
}

static uint32_t utterance_of(const struct queued_message *message) {
    json_t *told = message_read(message);
    uint32_t utterance = (uint32_t)json_integer_value(json_object_get(told, "utterance"));
    json_decref(told);
    return utterance;
}

/* Returns whether the utterance has already ended here, when this daemon had lost the leader for a while.
 * Its events and media are not passed on. An end without a preceding begin is recognised only by its
 * command. */
static bool is_past(struct shared_room *h, int kind, uint32_t utterance, uint64_t command) {
    if (channel_utterance(h->channel) != utterance && shared_has_heard(h, command))
        shared_is_past(h, utterance);
    bool past = shared_was_past(h, utterance);
    if (kind == STREAM_BEGIN)
        h->suppressed = past ? utterance : 0;
    if (kind == STREAM_END && utterance == h->suppressed)
        h->suppressed = 0;
    if (kind == STREAM_END)
        forwards_ended(h, utterance);
    return past;
}

/* Warns listeners who were following before: part of the utterance is missing. */
static void tell_missed(struct shared_room *h) {
    struct error e;
    error_plain(&e, ERROR_SKIPPED);
    channel_sink.event(
        h->channel,
        &(struct stream_event){.kind = STREAM_WARNING, .utterance = h->joined_mid, .error = &e, .idle = -1});
    h->joined_mid = 0;
}

/* One of the messages that left the leader together. */
struct part {
    const json_t *head;
    const uint8_t *body;
    size_t size;
};

static void replicate_text(struct shared_room *h, const struct part *p) {
    struct channel *c = h->channel;
    const char *event = json_string_value(json_object_get(p->head, "event"));
    json_int_t line_size = json_integer_value(json_object_get(p->head, "line"));
    if (line_size < 0 || (uint64_t)line_size > p->size)
        return;
    size_t line = (size_t)line_size;
    int kind = kind_of(event);
    struct queued_message *message = queued_message_new(WEBSOCKET_TEXT, p->body, p->size - line);
    message->event = kind < 0 ? notice_name(event) : event_name((enum stream_event_kind)kind);
    message->line = queued_message_new(WEBSOCKET_TEXT, p->body + p->size - line, line);
    uint64_t command = (uint64_t)json_integer_value(json_object_get(p->head, "command"));
    bool asks = kind == STREAM_BEGIN || kind == STREAM_END || (kind >= 0 && (command || h->past.count));
    uint32_t utterance = asks ? utterance_of(message) : 0;
    if (kind < 0) {
        keep_notice(c, message);
    } else if (is_past(h, kind, utterance, command)) {
        queued_message_release(message);
        h->joined_mid = kind == STREAM_BEGIN ? 0 : h->joined_mid;
        return;
    }
    channel_replicate(c, &(struct channel_item){.message = message,
                                                .notice = kind < 0,
                                                .kind = kind < 0 ? 0 : (enum stream_event_kind)kind,
                                                .utterance = utterance,
                                                .command = command});
    if (kind == STREAM_BEGIN && h->joined_mid)
        tell_missed(h);
}

static void replicate_media(struct channel *c, const struct part *p) {
    const json_t *as = json_object_get(p->head, "as");
    const struct encoding encoding = {.audio = (uint8_t)json_integer_value(json_array_get(as, 0)),
                                      .fap = (uint8_t)json_integer_value(json_array_get(as, 1)),
                                      .kilobits = (uint8_t)json_integer_value(json_array_get(as, 2)),
                                      .packed = json_is_true(json_array_get(as, 3))};
    struct queued_message *message = queued_message_new(WEBSOCKET_BINARY, p->body, p->size);
    message->born = uv_now(c->rooms->pipeline->loop);
    channel_replicate(c, &(struct channel_item){.message = message,
                                                .media = true,
                                                .encoding = encoding,
                                                .begin = json_is_true(json_object_get(p->head, "begin")),
                                                .idle = json_is_true(json_object_get(p->head, "idle"))});
}

static void replicate_parts(struct shared_room *h, const struct packet *p) {
    const json_t *parts = json_object_get(p->head, "parts");
    size_t at = 0;
    for (size_t i = 0; i < json_array_size(parts); i++) {
        const json_t *head = json_array_get(parts, i);
        json_int_t size = json_integer_value(json_object_get(head, "size"));
        if (size < 0 || (uint64_t)size > p->size - at)
            break;
        const struct part part = {head, p->body + at, (size_t)size};
        at += part.size;
        if (json_is_string(json_object_get(head, "event")))
            replicate_text(h, &part);
        else if (json_object_get(head, "as") && !h->suppressed)
            replicate_media(h->channel, &part);
    }
    channel_say_soon(h->channel);
}

/* Discards the late-join state and notices of the previous leader. */
static void forget(struct channel *c) {
    late_join_free(&c->late_join);
    c->late_join = (struct late_join){0};
    notice_board_free(&c->notices);
    struct error e;
    stream_set_lexicon(c->stream, NULL, 0, &e);
}

void replicate(struct shared_room *h, const struct packet *p) {
    struct channel *c = h->channel;
    if (h->role != ROLE_REPLICA || packet_number(p, "token") != h->token)
        return;
    if (!strcmp(p->kind, "recap") && h->recapped) {
        shared_missed(h);
    } else if (!strcmp(p->kind, "recap")) {
        channel_say(c);
        forget(c);
        h->suppressed = 0;
        uint32_t speaks = (uint32_t)packet_number(p, "speaks");
        shared_is_past(h, (uint32_t)packet_number(p, "past"));
        h->joined_mid = h->knew ? speaks : 0;
        h->recapped = true;
    }
    if (!h->recapped)
        return;
    stream_number_above(c->stream, (uint32_t)packet_number(p, "number"));
    if (!strcmp(p->kind, "said"))
        replicate_parts(h, p);
}
