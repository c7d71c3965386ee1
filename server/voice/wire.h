/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the daemon and a voice worker say to each other over one socket pair: frames of a header and a
 * payload. Both ends run on the same machine and come from the same build, so numbers are in native order.
 *
 * Daemon to worker: OPEN once, then SPEAK and CANCEL. Worker to daemon: HELLO, FAILED or ABSENT once, then
 * for each SPEAK any number of AUDIO and EVENTS and one DONE, with an ALIVE every WIRE_ALIVE_MS. Neither end
 * trusts the other: every length is checked before it is used. */
#ifndef FACCIA_VOICE_WIRE_H
#define FACCIA_VOICE_WIRE_H

#include "server/base/wire_bytes.h"
#include "server/voice/faccia-voice.h"
#include <stdbool.h>

enum wire_type {
    WIRE_OPEN = 1, /* string: the plugin's configuration, JSON; struct wire_limits */
    WIRE_SPEAK,    /* u32: processor seconds that it may take; a sentence */
    WIRE_CANCEL,   /* nothing; the header's job is to end soon */
    WIRE_HELLO,    /* string: JSON, the plugin and its voices */
    WIRE_FAILED,   /* string: why the plugin cannot be used */
    WIRE_AUDIO,    /* u32 sample rate, then samples */
    WIRE_EVENTS,   /* struct wire_event, one after the other */
    WIRE_DONE,     /* u32: 0 = spoken, else failed; string: why */
    WIRE_ABSENT,   /* string: why the plugin has nothing to run; instead of FAILED */
    WIRE_ALIVE,    /* nothing: the process runs, and works on a sentence */
    WIRE_WAITING,  /* nothing: the same of a worker elsewhere, or the sentence waits there for its turn. No
                      process says this, but what stands for one (far_process.h) */
    WIRE_TYPE_END
};

/* The descriptor on which a worker finds its socket. */
enum { WIRE_FD = 3 };

/* The descriptor on which a plugin that aligns finds the keeper of another worker (worker_keeper.h). */
enum { WIRE_KEEPER_FD = 4 };

/* While a sentence is worked on, ms. */
enum { WIRE_ALIVE_MS = 100 };

enum { WIRE_HEADER_BYTES = 12, WIRE_PAYLOAD_MAX = 16 << 20 };

struct wire_frame {
    enum wire_type type;
    uint32_t job; /* the sentence it is about, 0 = none */
    const uint8_t *data;
    size_t size;
};

/* Adds the header of a frame; wire_end fills in its length. Returns the place for wire_end. */
size_t wire_begin(struct buf *b, enum wire_type type, uint32_t job);
void wire_end(struct buf *b, size_t place);

/* Looks for a whole frame at data[0..size): 1 = found, and *used bytes belong to it; 0 = more bytes are
 * needed; -1 = garbage. */
int wire_next(const uint8_t *data, size_t size, struct wire_frame *frame, size_t *used);

/* A frame's payload. */
struct wire_reader wire_read(const struct wire_frame *frame);

/* What a worker may have. */
struct wire_limits {
    uint32_t megabytes; /* of address space */
    uint32_t seconds;   /* processor time to start and, in WIRE_SPEAK anew, for each sentence */
    bool sandbox;       /* what the plugin does not need is refused */
};

void wire_put_limits(struct buf *b, const struct wire_limits *limits);
struct wire_limits wire_get_limits(struct wire_reader *r);

/* A sentence. Reading allocates the spans (free them); their strings point into the payload. False when it is
 * not a sentence. */
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

/* The next event: false at the end of the payload, or (r->bad) when the payload is broken. */
bool wire_get_event(struct wire_reader *r, struct wire_event *event);

#endif
