/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A Wyoming satellite with a face: a room's microphone and face, for the pipeline of an assistant such as
 * Home Assistant (protocol/satellite.md). The assistant connects to the satellite. So does faccia-recogniser,
 * as to a speech recogniser, with each utterance that the daemon hears in the room. */
#ifndef FACCIA_BRIDGES_SATELLITE_SATELLITE_H
#define FACCIA_BRIDGES_SATELLITE_SATELLITE_H

#include "server/bridges/bridge.h"
#include "server/bridges/satellite/wyoming_link.h"
#include <stdbool.h>
#include <stdint.h>

/* ---- the room, over the daemon's WebSocket ---- */

struct room;

struct room_calls {
    /* The last room_say, room_ask or room_sound_begin has ended, for any reason. */
    void (*said)(void *ctx);
    void (*connected)(void *ctx); /* again, after the daemon was away, too */
};

struct room_options {
    const char *name;         /* of the room */
    const char *lang, *voice; /* of what the face says; NULL: the room's */
};

/* NULL after a message. */
struct room *room_new(uv_loop_t *loop, const struct daemon_address *place, const struct room_options *options,
                      const struct room_calls *calls, void *ctx);
void room_close(struct room *room); /* then run the loop, then room_free */
void room_free(struct room *room);  /* NULL is ignored */

/* Shows a state, with a text (NULL: none). */
void room_state(struct room *room, const char *state, const char *text);

/* Has the face say a text. lang: unless an option names one; NULL: the room's. alarm: before all else. */
void room_say(struct room *room, const char *text, const char *lang, bool alarm);

/* Has the face ask: somebody may answer by voice. */
void room_ask(struct room *room, const char *text);

/* Has the face speak with the sound of another voice: 16-bit samples, as fast as they come. */
void room_sound_begin(struct room *room, unsigned rate, unsigned channels);
void room_sound(struct room *room, const void *samples, size_t size);
void room_sound_end(struct room *room);

bool room_speaks(const struct room *room); /* something is being said that was begun here */
bool room_asks(const struct room *room);   /* a question, or a choice of answers, is open in the room */

/* ---- timers of the assistant ---- */

enum { TIMERS = 32 };

struct timers {
    struct timer {
        char *id, *name; /* name: NULL: none */
        int64_t end;     /* seconds since 1970; 0: paused */
    } all[TIMERS];
    unsigned count;
};

/* Takes an event timer-started, -updated, -cancelled or -finished. Returns the sentence to say when one has
 * finished; NULL: none. Free it. lang: of the sentence; NULL: English. */
char *timers_take(struct timers *timers, const char *type, const json_t *data, const char *lang, int64_t now);

/* Writes when the next timers end, by the local clock, for example "⌛ Pasta 18:35". "": none runs. */
void timers_text(const struct timers *timers, char *text, size_t cap);
void timers_free(struct timers *timers);

/* ---- utterances, and the assistant's pipeline ---- */

enum satellite_speech {
    SATELLITE_FACE,  /* the face says the answer's text, with the room's voice */
    SATELLITE_SOUND, /* the face speaks with the assistant's sound */
};

struct satellite {
    uv_loop_t *loop;
    struct room *room;
    const char *room_name, *name, *area; /* area: NULL: none */
    const char *lang;                    /* NULL: none */
    const char *wake, *wake_word;        /* HOST:PORT of a wake service, and its model; NULL: none, any */
    const char *others;                  /* HOST:PORT of a recogniser for other rooms; NULL: none */
    enum satellite_speech speech;
    struct peer *peers; /* connections */
    unsigned peer_count;
    struct peer *assistant; /* NULL: not connected */
    struct peer *current;   /* whose utterance the pipeline recognises; NULL: none */
    bool paused;            /* the assistant has switched the satellite off */
    bool whole;             /* the current pipeline also answers, not only recognises */
    bool talks;             /* the next utterance continues a conversation: it needs no wake word */
    bool face_speaks;       /* the face says the answer's text: its sound is dropped */
    bool sounds;            /* sound of the assistant is coming */
    bool owes_played;       /* tell the assistant when the room has said it */
    bool sound_over, room_over;
    uv_timer_t rest;  /* shows the idle state again */
    uv_timer_t awake; /* runs while no wake word is needed */
    struct timers timers;
};

void satellite_open(struct satellite *satellite, uv_loop_t *loop);
void satellite_accept(struct satellite *satellite, uv_stream_t *listener);
void satellite_close(struct satellite *satellite); /* then run the loop, then satellite_free */
void satellite_free(struct satellite *satellite);

extern const struct room_calls satellite_room_calls; /* their ctx is the satellite */

#endif
