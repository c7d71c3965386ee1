/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The protocol between the daemon and a voice worker over a socket pair: frames of a header and a payload.
 * Both ends run on the same machine from the same build, so numbers are in native byte order. Daemon to
 * worker: OPEN once, then SPEAK and CANCEL. Worker to daemon: HELLO, FAILED or ABSENT once, then for each
 * SPEAK any number of AUDIO and EVENTS and one DONE, with an ALIVE every WIRE_ALIVE_MS. Neither end trusts
 * the other: every length is checked before it is used. */
#ifndef FACCIA_VOICE_WIRE_H
#define FACCIA_VOICE_WIRE_H

#include "server/base/buf.h"
#include "server/voice/faccia-voice.h"
#include <stdbool.h>

enum wire_type {
    WIRE_OPEN = 1, /* string: the plugin's configuration, JSON; struct wire_limits */
    WIRE_SPEAK,    /* u32: processor seconds allowed; a sentence */
    WIRE_CANCEL,   /* empty; stop the header's job soon */
    WIRE_HELLO,    /* string: JSON, the plugin and its voices */
    WIRE_FAILED,   /* string: why the plugin cannot be used */
    WIRE_AUDIO,    /* u32 sample rate, then samples */
    WIRE_EVENTS,   /* a sequence of struct wire_event */
    WIRE_DONE,     /* u32: 0 = spoken, else failed; string: why */
    WIRE_ABSENT,   /* string: why the plugin has nothing to run; sent instead of FAILED */
    WIRE_ALIVE,    /* empty: the process is working on a sentence */
    WIRE_WAITING,  /* empty: the same for a remote worker, or the sentence is queued there; sent only by the
                      proxy in remote_voice.c */
    WIRE_TYPE_END
};

/* The descriptor of a worker's socket. */
enum { WIRE_FD = 3 };

/* The descriptor of the process that spawns a second worker, for a plugin that aligns (below). */
enum { WIRE_SPAWNER_FD = 4 };

/* Interval of ALIVE while a sentence is worked on, in ms. */
enum { WIRE_ALIVE_MS = 100 };

enum { WIRE_HEADER_BYTES = 12, WIRE_PAYLOAD_MAX = 16 << 20 };

struct wire_frame {
    enum wire_type type;
    uint32_t job; /* the sentence it belongs to, 0 = none */
    const uint8_t *data;
    size_t size;
};

/* Adds a frame's header. Pass the result to wire_end, which fills in the length. */
size_t wire_begin(struct buf *b, enum wire_type type, uint32_t job);
void wire_end(struct buf *b, size_t place);

/* Parses a frame at data[0..size): 1 = complete, *used bytes long; 0 = more bytes are needed; -1 =
 * invalid. */
int wire_next(const uint8_t *data, size_t size, struct wire_frame *frame, size_t *used);

struct wire_reader wire_read(const struct wire_frame *frame);

/* Limits of a worker. */
struct wire_limits {
    uint32_t megabytes; /* of address space */
    uint32_t seconds;   /* processor time to start; each WIRE_SPEAK sets it anew */
    bool sandbox;       /* refuse what the plugin does not declare */
};

void wire_put_limits(struct buf *b, const struct wire_limits *limits);
struct wire_limits wire_get_limits(struct wire_reader *r);

/* A sentence. Reading allocates the spans, which the caller frees; their strings point into the payload.
 * Returns false if the payload is not a sentence. */
void wire_put_sentence(struct buf *b, const struct faccia_sentence *sentence);
bool wire_get_sentence(struct wire_reader *r, struct faccia_sentence *sentence, struct faccia_span **spans);

enum wire_event_kind { WIRE_PHONE = 1, WIRE_WORD, WIRE_MARK, WIRE_WARNING };

struct wire_event {
    enum wire_event_kind kind;
    struct faccia_phone phone;
    struct faccia_word word;
    const char *text; /* MARK: its name; WARNING: the message */
    uint64_t at;      /* MARK */
};

void wire_put_event(struct buf *b, const struct wire_event *event);

/* Reads the next event. Returns false at the end of the payload, or with r->bad set if it is broken. */
bool wire_get_event(struct wire_reader *r, struct wire_event *event);

/* A plugin that aligns sound to a second voice (server/library/align/reference.h) needs a worker of that
 * voice, with its own plugin and a narrower sandbox. Once confined it cannot start one, so it first forks a
 * spawner that does nothing else. Only faccia's own plugins may set this capability, because the protocol
 * is private. */

#define WORKER_SPAWNER_WANTED (1u << 31)

#endif
