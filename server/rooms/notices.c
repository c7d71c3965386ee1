/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/rooms/notices.h"
#include "server/base/json/error_json.h"
#include "server/base/log.h"
#include "server/rooms/events.h"
#include "server/rooms/question.h"
#include "server/rooms/rooms_internal.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Copies a member, if present. */
static void take_member(const json_t *message, const char *name, json_t *into) {
    json_object_set(into, name, json_object_get(message, name));
}

/* The word of a `consent` message. */
static const char *word_of(const json_t *message) {
    const char *word = json_string_value(json_object_get(message, "consent"));
    return word ? word : "";
}

/* Creates a message; the caller adds its members. */
static json_t *notice_begin(const struct channel *c, const char *type) {
    return json_pack("{ss ss}", "type", type, "stream", c->name);
}

struct queued_message *notice_message(const json_t *object, const char *event) {
    struct buf text = {0}, line = {0};
    json_write(&text, json_incref((json_t *)object));
    text_line(object, &line);
    struct queued_message *message = queued_message_new(WEBSOCKET_TEXT, text.data, text.size);
    message->event = event;
    message->line = queued_message_new(WEBSOCKET_TEXT, line.data, line.size);
    buf_free(&text);
    buf_free(&line);
    return message;
}

struct queued_message *notice_tell(struct channel *c, const json_t *told, const char *event) {
    struct queued_message *message = notice_message(told, event);
    if (c->session)
        session_event(c->session, told);
    channel_notice(c, message);
    return message;
}

#define EASE_DEFAULT 0.3 /* s */
#define EASE_MOST 10
static int take_part(const json_t *part, size_t i, struct mood_request *mix, struct error *e) {
    const json_t *intensity = json_object_get(part, "intensity");
    char field[32];
    mix->names[i] = json_string_value(json_object_get(part, "name"));
    mix->intensities[i] = intensity ? json_number_value(intensity) : 1;
    if (!mix->names[i]) {
        snprintf(field, sizeof field, "mix.%zu.name", i);
        return error_in_field(e, json_object_get(part, "name") ? ERROR_BAD_FIELD : ERROR_MISSING_FIELD, field,
                              "must be the name of an affect");
    }
    if ((intensity && !json_is_number(intensity)) || mix->intensities[i] < 0 || mix->intensities[i] > 1) {
        snprintf(field, sizeof field, "mix.%zu.intensity", i);
        return error_in_field(e, ERROR_BAD_FIELD, field, "must be a number from 0 to 1");
    }
    return 0;
}

int express_read(const json_t *message, struct mood_request *mix, struct error *e) {
    const json_t *parts = json_object_get(message, "mix"), *ease = json_object_get(message, "ease");
    *mix = (struct mood_request){.count = json_array_size(parts), .ease = EASE_DEFAULT};
    if (!json_is_array(parts) || mix->count > MOOD_MIX)
        return error_in_field(e, parts ? ERROR_BAD_FIELD : ERROR_MISSING_FIELD, "mix",
                              "must be a list of up to %d affects with their intensities", MOOD_MIX);
    if (ease)
        mix->ease = json_number_value(ease);
    if ((ease && !json_is_number(ease)) || mix->ease < 0 || mix->ease > EASE_MOST)
        return error_in_field(e, ERROR_BAD_FIELD, "ease", "must be a number from 0 to %d", EASE_MOST);
    for (size_t i = 0; i < mix->count; i++)
        if (take_part(json_array_get(parts, i), i, mix, e))
            return -1;
    return 0;
}

enum {
    CALIBRATION_MS = 250,   /* average interval: each listener rebuilds its head for one */
    CALIBRATION_BURST = 12, /* most calibrations at once */
};

int notice_check_choices(const json_t *choices, struct error *e) {
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
    int failed = notice_check_choices(choices, e);
    if (!failed) {
        question_offered(c);
        take_member(message, "id", told);
        take_member(message, "question", told);
        json_object_set_new(told, "choices", json_deep_copy(choices));
        struct queued_message *all = notice_tell(c, told, "choices");
        bool any = json_array_size(choices);
        notice_board_choices(&c->notices, any ? all : NULL, any ? told : NULL);
        queued_message_release(all);
    }
    json_decref(told);
    return failed ? -1 : 0;
}

/* The id must match the current choices: they may have been replaced while the user chose. */
static bool is_offered(const json_t *offered, const json_t *message) {
    const char *asked = json_string_value(json_object_get(message, "id"));
    const char *id = json_string_value(json_object_get(offered, "id"));
    return offered && (!asked || !strcmp(asked, id ? id : ""));
}

/* Returns the index of the choice, or -1 with *e. */
static json_int_t chosen_of(const json_t *offered, const json_t *message, struct error *e) {
    size_t count = json_array_size(json_object_get(offered, "choices"));
    json_int_t at = (json_int_t)json_number_value(json_object_get(message, "choice"));
    if (!is_offered(offered, message))
        return error_plain(e, ERROR_NO_CHOICES);
    if (at < 0 || (size_t)at >= count)
        return error_in_field(e, ERROR_BAD_FIELD, "choice", "must be a number from 0 to %zu", count - 1);
    return at;
}

int notice_choose(struct channel *c, const json_t *message, const char *by, struct error *e) {
    const json_t *offered = c->notices.offered;
    json_t *told = notice_begin(c, "chosen");
    json_int_t at = chosen_of(offered, message, e);
    if (at >= 0) {
        if (json_object_get(offered, "id"))
            json_object_set(told, "id", json_object_get(offered, "id"));
        json_object_set_new(told, "choice", json_integer(at));
        json_object_set(told, "text", json_array_get(json_object_get(offered, "choices"), (size_t)at));
        json_object_set_new(told, "by", json_string(by));
        queued_message_release(notice_tell(c, told, "chosen"));
        notice_board_choices(&c->notices, NULL, NULL);
        question_chosen(c, told);
    }
    json_decref(told);
    return at < 0 ? -1 : 0;
}

const json_t *notice_offered(const struct channel *c) {
    return json_object_get(c->notices.offered, "choices");
}

/* Notifies the room of its new mood, and of who set it. */
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
    if (express_read(message, &mix, e) || stream_express(c->stream, &mix, e))
        return -1;
    if (c->room)
        tell_mood(c, &mix, by);
    return 0;
}

int notice_state(struct channel *c, const json_t *message, struct error *e) {
    json_t *told = notice_begin(c, "state");
    int failed = json_object_get(message, "mix") && notice_express(c, message, NULL, e);
    if (!failed) {
        take_member(message, "state", told);
        take_member(message, "text", told);
        struct queued_message *all = notice_tell(c, told, "state");
        notice_board_state(&c->notices, all);
        queued_message_release(all);
    }
    json_decref(told);
    return failed ? -1 : 0;
}

/* The person in the room has agreed to what a study does. */
static bool is_agreed(const struct channel *c) {
    return c->notices.asked && !strcmp(word_of(c->notices.asked), "given");
}

static bool is_overheard(const struct channel *c) {
    for (const struct follower *f = c->followers; f; f = f->next)
        if (f->remote || (f->overhears && follower_hears(f)))
            return true;
    return false;
}

bool notice_overhears(const struct channel *c) {
    return c->room && !c->remote && is_agreed(c) && is_overheard(c);
}

void notice_overheard(struct channel *c, const json_t *sound) {
    queued_message_release(notice_tell(c, sound, OVERHEARD));
}

void notice_hearing(struct channel *c, const char *id, double seconds) {
    if (c->session)
        session_hearing(c->session, id, seconds);
}

void notice_sound(struct channel *c, const int16_t *samples, size_t count) {
    if (c->session)
        session_sound(c->session, samples, count);
}

void notice_heard(struct channel *c, const json_t *heard) {
    queued_message_release(notice_tell(c, heard, HEARD));
}

bool follower_hears(const struct follower *f) {
    return f->watches && f->directs;
}

static struct queued_message *tell_state(struct channel *c, const char *state) {
    json_t *told = notice_begin(c, "state");
    json_object_set_new(told, "state", json_string(state));
    struct queued_message *all = notice_tell(c, told, "state");
    notice_board_state(&c->notices, all);
    json_decref(told);
    return all;
}

void notice_listening(struct channel *c, bool on) {
    c->listening += on ? 1 : -1u;
    if (on && c->listening == 1) {
        c->listens = tell_state(c, "listening");
    } else if (!c->listening) {
        if (c->listens == c->notices.state)
            queued_message_release(tell_state(c, "idle"));
        queued_message_release(c->listens);
        c->listens = NULL;
    }
}

/* Counts a calibration or a lexicon. Returns -1 with *e when there were too many: each goes to every
 * listener. */
static int count_large(struct channel *c, const char *what, struct error *e) {
    uint64_t now = uv_now(c->rooms->pipeline->loop);
    uint64_t from = c->calibrated > now ? c->calibrated : now;
    if (from + CALIBRATION_MS - now > CALIBRATION_MS * CALIBRATION_BURST)
        return error_set(e, ERROR_TOO_MANY_REQUESTS,
                         "the limit for a face is %d %s per second, and %d at once", 1000 / CALIBRATION_MS,
                         what, CALIBRATION_BURST);
    c->calibrated = from + CALIBRATION_MS;
    return 0;
}

/* A client's own stream has no late joiners, so only a room keeps the calibration. */
int notice_calibrate(struct channel *c, const json_t *message, struct error *e) {
    const json_t *reset = json_object_get(message, "reset");
    json_t *told = notice_begin(c, "calibrated");
    int failed = json_is_true(reset) ? json_object_set_new(told, "reset", json_true())
                                     : calibration_read(message, told, e);
    failed = failed || count_large(c, "calibrations", e);
    if (!failed) {
        struct queued_message *all = notice_tell(c, told, "calibrated");
        notice_board_calibration(&c->notices, c->room && !json_is_true(reset) ? all : NULL);
        queued_message_release(all);
    }
    json_decref(told);
    return failed ? -1 : 0;
}

void notice_head(struct channel *c, const char *name) {
    json_t *told = notice_begin(c, "head");
    json_object_set_new(told, "head", json_string(name));
    struct queued_message *all = notice_tell(c, told, "head");
    notice_board_head(&c->notices, c->room && *name ? all : NULL);
    queued_message_release(all);
    json_decref(told);
}

int notice_backdrop(struct channel *c, const json_t *message, struct error *e) {
    json_t *told = notice_begin(c, "backdrop");
    (void)e;
    take_member(message, "source", told);
    struct queued_message *all = notice_tell(c, told, "backdrop");
    notice_board_backdrop(&c->notices, json_string_length(json_object_get(told, "source")) ? all : NULL);
    queued_message_release(all);
    json_decref(told);
    return 0;
}

/* Only a room keeps the lexicon for late joiners, which include replicas of the room. */
int notice_lexicon(struct channel *c, const json_t *message, struct error *e) {
    const json_t *document = json_object_get(message, "lexicon");
    size_t size = json_string_length(document);
    if (count_large(c, "lexicons", e) || stream_set_lexicon(c->stream, json_string_value(document), size, e))
        return -1;
    json_t *told = notice_begin(c, "lexicon");
    take_member(message, "lexicon", told);
    struct queued_message *all = notice_tell(c, told, "lexicon");
    notice_board_lexicon(&c->notices, c->room && size ? all : NULL);
    queued_message_release(all);
    json_decref(told);
    return 0;
}

bool consent_is_answer(const json_t *message) {
    const char *word = word_of(message);
    return !strcmp(word, "given") || !strcmp(word, "declined");
}

/* Forgets the last session; delete: and its folder. */
static void close_recorded(struct channel *c, bool delete) {
    if (c->recorded)
        session_close(c->recorded, delete);
    c->recorded = NULL;
}

/* Ends the recording of the session; it can still be deleted. */
static void end_session(struct channel *c) {
    if (!c->session)
        return;
    close_recorded(c, false);
    session_end(c->session);
    c->recorded = c->session;
    c->session = NULL;
}

void channel_end_session(struct channel *c) {
    end_session(c);
    close_recorded(c, false);
}

/* A session is recorded while there is consent. Withdrawn consent deletes it. */
static void record(struct channel *c, const char *consent) {
    const char *folder = c->rooms->sessions;
    struct error e;
    if (!strcmp(consent, "declined")) {
        end_session(c);
        close_recorded(c, true);
    } else if (strcmp(consent, "given") != 0) {
        end_session(c);
    } else if (!c->session && c->room && folder &&
               !(c->session = session_open(c->rooms->pipeline->loop, folder, c->name, &e))) {
        log_warn("%s", e.message);
    }
}

static void tell(struct channel *c, json_t *told) {
    record(c, word_of(told));
    json_object_set_new(told, "recorded", json_boolean(c->session || c->recorded));
    struct queued_message *all = notice_tell(c, told, "consent");
    bool any = strcmp(word_of(told), "none") != 0;
    notice_board_consent(&c->notices, any ? all : NULL, any ? told : NULL);
    queued_message_release(all);
}

/* Returns whether the same text is being asked already. */
static bool is_same(const json_t *asked, const json_t *told) {
    const json_t *before = json_object_get(asked, "text"), *text = json_object_get(told, "text");
    return asked && (before == text || json_equal(before, text));
}

int notice_consent(struct channel *c, const json_t *message, const char *by, struct error *e) {
    json_t *asked = c->notices.asked, *told = notice_begin(c, "consent");
    bool answer = consent_is_answer(message);
    const bool late = c->recorded && !strcmp(word_of(message), "declined"); /* after the end of the study */
    int failed = answer && !asked && !late ? error_plain(e, ERROR_NO_CHOICES) : 0;
    if (!failed)
        take_member(answer ? asked : message, "text", told);
    if (!failed && !strcmp(word_of(message), "asked") && is_same(asked, told)) {
        queued_message_release(notice_tell(c, asked, "consent"));
    } else if (!failed) {
        json_object_set(told, "consent", json_object_get(message, "consent"));
        json_object_set_new(told, "by", json_string(by));
        tell(c, told);
    }
    json_decref(told);
    return failed ? -1 : 0;
}

/* The list of followers has the latest first. */
enum { OBSERVERS_TOLD = 32 }; /* most observers listed, the earliest first */

static json_t *list(const struct channel *c, size_t *count) {
    json_t *observers = json_array();
    *count = 0;
    for (const struct follower *f = c->followers; f; f = f->next) {
        if (!f->watches || !f->observer)
            continue;
        json_array_insert_new(observers, 0, json_pack("{ss sb}", "name", f->observer, "speaks", f->directs));
        if (++*count > OBSERVERS_TOLD)
            json_array_remove(observers, OBSERVERS_TOLD);
    }
    return observers;
}

void observers_tell(struct channel *c) {
    size_t count;
    if (!c->room)
        return;
    json_t *told = notice_begin(c, "observers");
    json_object_set_new(told, "observers", list(c, &count));
    json_object_set_new(told, "count", json_integer((json_int_t)count));
    struct queued_message *message = notice_message(told, "observers");
    for (struct follower *f = c->followers; f; f = f->next)
        if (f->watches)
            f->deliver(f, &message, 1);
    queued_message_release(message);
    json_decref(told);
}

void observers_leave(struct follower *f) {
    struct channel *c = f->channel;
    bool known = c && f->watches && c->follower_count > 1;
    channel_leave(f);
    if (known)
        observers_tell(c);
}
