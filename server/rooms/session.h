/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Records a study's session in a room: what listeners say, as sound, and everything that is told there. One
 * folder each: room.flac, session.json, and for analysis session.TextGrid (Praat) and session.csv, all on one
 * clock that begins with the session. */
#ifndef FACCIA_ROOMS_SESSION_H
#define FACCIA_ROOMS_SESSION_H

#include "server/base/error.h"
#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <uv.h>

enum {
    SESSION_RATE = 16000,       /* Hz */
    SESSION_SECONDS = 4 * 3600, /* longest session */
    SESSION_EVENTS = 200000,
};

struct session;

/* Creates the folder ROOM-TIME in `folder`. NULL with *e ("cannot-keep"). */
struct session *session_open(uv_loop_t *loop, const char *folder, const char *room, struct error *e);

/* Records a message of the room. Sound and pictures in messages are not recorded. */
void session_event(struct session *session, const json_t *message);

/* Records that an utterance of a listener begins (seconds: negative) or how long it was, and its sound in
 * between: mono, SESSION_RATE. */
void session_hearing(struct session *session, const char *id, double seconds);
void session_sound(struct session *session, const int16_t *samples, size_t count);

/* Ends the recording. Another thread writes what is made of all events; the session can still be deleted. */
void session_end(struct session *session);

/* Frees a session that has ended, also while its files are written. delete: its folder goes, too. */
void session_close(struct session *session, bool delete);

#endif
