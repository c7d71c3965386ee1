/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What stands in a channel beside what is said, until it is replaced: a question with its choices, what the
 * assistant behind the face is doing, whose face it is, its mood, and whether the listener consents to a
 * study. Who comes later is told of it. */
#ifndef FACCIA_ROOMS_NOTICES_H
#define FACCIA_ROOMS_NOTICES_H

#include "server/base/error.h"
#include <jansson.h>
#include <stdbool.h>

struct channel;
struct follower;
struct mood_request;

enum {
    NOTICE_CHOICES = 8,
    NOTICE_CHOICE_BYTES = 200,
    OBSERVER_NAME_BYTES = 64,
    CALIBRATION_FARTHEST = 1000,          /* mm from the head's origin, along each axis */
    CALIBRATION_TEXTURE_BYTES = 196608,   /* of a picture in base64 */
    CALIBRATION_TEXTURE_POINTS = 1 << 22, /* that it may have: 2048 x 2048 */
    CALIBRATION_TEXTURE_SIDE = 8192       /* each way */
};

/* Each does what the message of that type asks for, whose members have been checked (but for lists and
 * objects), and tells all who follow. by: whose name goes with it. -1 with *e. */
int notice_choices(struct channel *channel, const json_t *message, struct error *e);
int notice_choose(struct channel *channel, const json_t *message, const char *by, struct error *e);

/* The mood of the stream; in a room all are told of it. by: who set it, or NULL. */
int notice_express(struct channel *channel, const json_t *message, const char *by, struct error *e);

/* A `mix` of the state is the mood that goes with it, as that of `express`. */
int notice_state(struct channel *channel, const json_t *message, struct error *e);

/* Feature points that the head takes; `reset`: its own again. */
int notice_calibrate(struct channel *channel, const json_t *message, struct error *e);

/* Asked again in the same words, the answer that there is holds. "no-choices": nothing is asked. */
int notice_consent(struct channel *channel, const json_t *message, const char *by, struct error *e);

/* Is the `consent` message an answer (`given`, `declined`), or does it ask (`asked`, `none`)? */
bool consent_is_answer(const json_t *message);

/* The mood that an `express` message asks for. -1 with *e. The mix borrows from the message. */
int express_read(const json_t *message, struct mood_request *mix, struct error *e);

/* Observers are told of each other, by name; who listens is not told of them. */

/* An observer has come, gone, or got another name or other rights. */
void observers_tell(struct channel *channel);

/* Leaves the channel; observers that are left are told, where they knew of it. */
void observers_leave(struct follower *follower);

#endif
