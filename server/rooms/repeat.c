/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/rooms/repeat.h"
#include "server/base/mem.h"
#include "server/rooms/question.h"
#include "server/rooms/rooms_internal.h"
#include <math.h>
#include <stdlib.h>

/* Ranges of requests: protocol/messages.json. */
#define RATE_LEAST 40
#define RATE_MOST 500
#define FACTOR_LEAST 0.25
#define FACTOR_MOST 4

static double member(const json_t *message, const char *name) {
    const json_t *value = json_object_get(message, name);
    return value ? json_number_value(value) : 1;
}

void channel_set_manner(struct channel *c, const json_t *message) {
    c->manner =
        (struct manner){member(message, "speed"), member(message, "pitch"), member(message, "volume")};
}

static double scaled(double value, double factor, double least, double most) {
    return fmin(most, fmax(least, value * (factor > 0 ? factor : 1)));
}

static void apply(const struct manner *manner, struct speech_request *request) {
    if (request->rate > 0)
        request->rate = scaled(request->rate, manner->speed, RATE_LEAST, RATE_MOST);
    else if (manner->speed > 0)
        request->speed =
            scaled(request->speed > 0 ? request->speed : 1, manner->speed, FACTOR_LEAST, FACTOR_MOST);
    request->pitch = scaled(request->pitch, manner->pitch, FACTOR_LEAST, FACTOR_MOST);
    request->volume = scaled(request->volume, manner->volume, FACTOR_LEAST, FACTOR_MOST);
}

/* A text that is still being written cannot be repeated. */
static void remember(struct channel *c, const struct speech_request *request, uint32_t utterance) {
    if (!c->room || request->open || request->ahead)
        return;
    channel_forget_speech(c);
    c->said = mem_alloc(sizeof *c->said);
    request_copy(c->said, request);
    c->said->around = NULL;
    c->said_as = utterance;
}

void channel_forget_speech(struct channel *c) {
    if (c->said)
        request_free(c->said);
    free(c->said);
    c->said = NULL;
}

static uint32_t speak(struct channel *c, const struct speech_request *request, struct error *why) {
    struct speech_request own = *request; /* borrows its strings */
    apply(&c->manner, &own);
    return stream_speak(c->stream, &own, why);
}

uint32_t channel_speak(struct channel *c, const struct speech_request *request, struct error *why) {
    uint32_t utterance = speak(c, request, why);
    if (utterance)
        remember(c, request, utterance);
    return utterance;
}

bool channel_repeat(struct channel *c) {
    if (!c->said || c->remote)
        return false;
    struct speech_request again = *c->said;
    again.mode = SPEAK_INTERRUPT;
    again.id = again.topic = NULL; /* those of the first time have ended */
    again.origin = again.command = 0;
    again.again = false;
    uint32_t utterance = speak(c, &again, NULL);
    if (!utterance)
        return false;
    question_repeated(c, c->said_as, utterance);
    c->said_as = utterance;
    return true;
}
