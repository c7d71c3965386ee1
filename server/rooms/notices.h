/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Notices: the state of a channel other than its speech, each in effect until it is replaced. These are a
 * question with its choices, what the assistant behind the face is doing, whose face it is (calibration),
 * its mood, how words are said (a lexicon), and whether the listener consents to a study. Late joiners are
 * sent the current notices. */
#ifndef FACCIA_ROOMS_NOTICES_H
#define FACCIA_ROOMS_NOTICES_H

#include "server/base/error.h"
#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct channel;
struct follower;
struct mood_request;

enum {
    NOTICE_CHOICES = 8,
    NOTICE_CHOICE_BYTES = 200,
    OBSERVER_NAME_BYTES = 64,
    CALIBRATION_FARTHEST = 1000,          /* mm from the head's origin, along each axis */
    CALIBRATION_TEXTURE_BYTES = 196608,   /* picture in base64 */
    CALIBRATION_TEXTURE_POINTS = 1 << 22, /* pixels of the picture: 2048 x 2048 */
    CALIBRATION_TEXTURE_SIDE = 8192       /* pixels in width or height */
};

/* Each function handles the message of its type and notifies all followers. The message's members have
 * already been validated, except lists and objects. by: the name shown with the notice. Returns -1 with
 * *e. */
int notice_choices(struct channel *channel, const json_t *message, struct error *e);
int notice_choose(struct channel *channel, const json_t *message, const char *by, struct error *e);

/* The choices on offer, a list of texts, or NULL. */
const json_t *notice_offered(const struct channel *channel);

/* Sets the mood of the stream; a room notifies all its followers. by: who set it, or NULL. */
int notice_express(struct channel *channel, const json_t *message, const char *by, struct error *e);

/* Sets the assistant's state. Its `mix` sets a mood with it, as in `express`. */
int notice_state(struct channel *channel, const json_t *message, struct error *e);

/* Sets feature points of the head; `reset` restores the head's own. */
int notice_calibrate(struct channel *channel, const json_t *message, struct error *e);

/* Shows another head; an empty name: each listener's own. The name is checked by the caller. */
void notice_head(struct channel *channel, const char *name);

/* Shows a picture or a film behind the face. */
int notice_backdrop(struct channel *channel, const json_t *message, struct error *e);

/* Sets the lexicon for what is spoken from now on; an empty one removes it. */
int notice_lexicon(struct channel *channel, const json_t *message, struct error *e);

/* Asks for consent, or answers. Asking again with the same text keeps the existing answer. An answer without
 * a question fails with "no-choices". */
int notice_consent(struct channel *channel, const json_t *message, const char *by, struct error *e);

/* Returns whether the `consent` message is an answer (`given`, `declined`) rather than a question
 * (`asked`, `none`). */
bool consent_is_answer(const json_t *message);

/* Tells the observers who may direct the room what a listener said: a `heard` message. */
void notice_heard(struct channel *channel, const json_t *heard);

/* Counts the utterances that are being heard. While there are any, the state is "listening", unless it is
 * changed meanwhile. */
void notice_listening(struct channel *channel, bool on);

/* The session of a study records that an utterance of a listener begins (seconds: negative), or how long it
 * was; and its sound: mono, SESSION_RATE. */
void notice_hearing(struct channel *channel, const char *id, double seconds);
void notice_sound(struct channel *channel, const int16_t *samples, size_t count);

/* Tells observers who want to hear the room a piece of sound, an `overheard` message, if the listener has
 * consented; notice_overhears: whether any would get it. */
bool notice_overhears(const struct channel *channel);
void notice_overheard(struct channel *channel, const json_t *sound);

/* Returns whether the follower is told what listeners say. */
bool follower_hears(const struct follower *follower);

/* Reads the mood of an `express` message. The mix borrows from the message. Returns -1 with *e. */
int express_read(const json_t *message, struct mood_request *mix, struct error *e);

/* Observers are notified of each other by name; listeners are not notified of observers. */

/* Notifies observers of a change: one joined, left, or changed its name or rights. */
void observers_tell(struct channel *channel);

/* Removes a follower from its channel. Remaining observers are notified if they had been told of it. */
void observers_leave(struct follower *follower);

#endif
