/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A stream: turns a queue of utterances into events and media chunks, paced to real time with a small lead.
 * A channel (rooms/channel.h) sends them to its listeners. */
#ifndef FACCIA_STREAM_STREAM_H
#define FACCIA_STREAM_STREAM_H

#include "server/expression/expressions.h"
#include "server/stream/drive_track.h"
#include "server/stream/media.h"
#include "server/synthesis/pipeline.h"
#include "server/synthesis/speech_request.h"
#include "server/synthesis/speech_source.h"

enum {
    STREAM_CHUNK_MS = 200, /* duration of a chunk */
    STREAM_FIRST_MS = 60,  /* duration of an utterance's first chunk, for low latency */
    STREAM_LEAD_MS = 400,  /* maximum lead of sent media over real time */
    STREAM_WAIT_MS = 100,  /* of silence while an open text waits for its writer */
    STREAM_QUEUE = 32,     /* default limit of waiting utterances */
};

/* A mixture of affects, as for mood_set. Strings are borrowed. */
struct mood_request {
    const char *names[MOOD_MIX];
    double intensities[MOOD_MIX]; /* 0..1 */
    size_t count;
    double ease; /* s */
};

/* Idle motion, shown while no utterance plays. */
struct idle_options {
    double life;   /* strength, 0..2 */
    uint64_t seed; /* of the life layer */
    double fps;    /* 1..120 */
    bool still;    /* no motion */
};

enum stream_event_kind {
    STREAM_BEGIN,
    STREAM_SENTENCE,
    STREAM_SPEAKER,
    STREAM_WORD,
    STREAM_MARK,
    STREAM_PHONE,
    STREAM_PAUSED,
    STREAM_RESUMED,
    STREAM_JUMPED,
    STREAM_WARNING,
    STREAM_ERROR,
    STREAM_END,
};

/* Pointers are valid during the call. */
struct stream_event {
    enum stream_event_kind kind;
    uint32_t utterance;                        /* 0 = none (PAUSED, RESUMED) */
    const char *id;                            /* the client's id, or NULL */
    uint64_t command;                          /* of its request (speech_request.h) */
    uint32_t sample_rate, sample, duration;    /* for events with a time; END: total duration, in samples */
    size_t start, end, utf16_start, utf16_end; /* SENTENCE, WORD: range in the text, end exclusive */
    const char *text;          /* WORD: end - start bytes of text; MARK, JUMPED: name; PHONE: IPA;
                                * SPEAKER: id */
    const char *name;          /* SPEAKER */
    const struct error *error; /* WARNING, ERROR */
    const char *reason; /* END: "done", "stopped", "failed"; NULL = continued on another node, not reported */
    bool blocked;       /* END: every listener's browser blocked the sound */
    const char *voice, *lang, *engine, *markup; /* BEGIN */
    double fps;                                 /* BEGIN */
    bool bell;                                  /* BEGIN: one sounds first */
    bool again;                                 /* BEGIN: repeated if it is lost */
    const char *play;                           /* BEGIN of a recording: its name, else NULL */
    bool live;                                  /* BEGIN: a live voice, without text */
    unsigned lookahead;                         /* BEGIN of a live voice: ms */
    double idle; /* BEGIN, RESUMED: its time on the idle clock, s; negative = no idling */
};

struct stream_sink {
    void (*event)(void *ctx, const struct stream_event *event);
    void (*media)(void *ctx, const struct media *media);
    /* Tells whether more media may be sent; while false, the stream polls. */
    bool (*ready)(void *ctx);
};

struct stream;

struct stream *stream_new(const struct pipeline *pipeline, const struct stream_sink *sink, void *ctx,
                          unsigned queue);

/* No callback follows. */
void stream_free(struct stream *stream);

/* Queues the request under the next utterance number; mode, priority and topic decide when it is spoken.
 * Returns the number, or 0 if refused (also "queue-full", "busy"): then its ERROR and END events come at
 * once, *why (may be NULL) says why, and nothing else changes. */
uint32_t stream_speak(struct stream *stream, const struct speech_request *request, struct error *why);

/* Reads a lexicon (PLS) for later requests to speak, which goes before the daemon's; size 0 removes it. -1
 * with *e ("bad-lexicon"), and nothing changes. */
int stream_set_lexicon(struct stream *stream, const char *text, size_t size, struct error *e);

/* Tells whether the utterance exists and its text is still open (synthesis.h). */
bool stream_is_open(const struct stream *stream, uint32_t utterance);

/* Appends to its text, at most `most` bytes in all. Returns -1 with *e like synthesis_write. Ignores
 * utterances that have ended. */
int stream_write(struct stream *stream, uint32_t utterance, const char *text, size_t size, size_t most,
                 struct error *e);
void stream_flush(struct stream *stream, uint32_t utterance);

/* Adds a message with sound to a live utterance. */
void stream_sound(struct stream *stream, uint32_t utterance, const uint8_t *bytes, size_t size);

/* Closes an open text or a live utterance. why: a warning to report, or NULL. */
void stream_close(struct stream *stream, uint32_t utterance, const struct error *why);

/* Queues the source that `open` makes of `what` (speech_source.h), like stream_speak: a live voice
 * (stream_sound and stream_close follow) or a recording. Of the request, id, order, mode, priority and topic
 * are used. If it is refused before it is opened, `what` is left as it was. */
uint32_t stream_play(struct stream *stream, const struct speech_request *request, speech_source_open *open,
                     void *what);

/* Cuts or drops the utterances of that id. Returns how many there were. */
unsigned stream_cancel(struct stream *stream, const char *id);

/* Reports a request that was rejected earlier: assigns a number and sends ERROR and END. command: as in
 * speech_request.h. */
void stream_refuse(struct stream *stream, const char *id, uint64_t command, const struct error *e);

/* Sends idle motion while nothing is spoken, as silent chunks of utterance 0; NULL = off. The life clock
 * runs through idling, utterances and pauses, so the face does not jump between them; only an utterance
 * with its own seed has its own clock. Cuts and clock changes are eased (stream_internal.h). An utterance
 * replaces idle media beyond its beginning. */
void stream_idle(struct stream *stream, const struct idle_options *options);

/* Sets the stream's mood from the next media on. Returns -1 with *e like mood_set. */
int stream_express(struct stream *stream, const struct mood_request *mix, struct error *e);

/* Shows the face of a driver instead of the idle one, and beside the mouth of speech; the mouth too in
 * `voice`, the driver's own live voice (0 = none). Frames are in the order of their times. Recordings, and
 * utterances with their own seed, show as they are. Returns -1 with *e "driven" while another drives. */
int stream_drive(struct stream *stream, uint64_t driver, uint32_t voice, const struct driven_frame *frames,
                 size_t count, struct error *e);

/* Ends the driving, if there is any: the face eases back. */
void stream_undrive(struct stream *stream);

/* Who drives; 0 = nobody. stream_drives_on: the driver has sent a frame within DRIVE_SILENCE_MAX. */
uint64_t stream_driver(const struct stream *stream);
bool stream_drives_on(const struct stream *stream);

/* Get and raise the number of the last utterance. */
uint32_t stream_number(const struct stream *stream);
void stream_number_above(struct stream *stream, uint32_t number);

/* Fails the current and waiting utterances with ERROR and END "failed". Those that another daemon will
 * repeat (`again` in speech_request.h) get a WARNING instead, if they have begun. Ends a pause. */
void stream_fail(struct stream *stream, const struct error *e);

/* Detaches from other daemons that forwarded requests and have reported their end already: drops their
 * waiting utterances and keeps the current one. */
void stream_go_alone(struct stream *stream);

/* The same for utterances forwarded in an earlier session of `origin` (speech_request.h); 0 = by any other
 * daemon. Returns the number of the current utterance if it is one of them, else 0. */
uint32_t stream_forget_earlier(struct stream *stream, uint64_t origin);

/* Tells whether an utterance is playing or waiting. */
bool stream_busy(const struct stream *stream);

/* Cuts the current utterance and drops the waiting ones; each gets its END. Ends a pause. */
void stream_stop(struct stream *stream);

/* Halts utterances and their clock at the sample being heard until stream_resume, also for listeners. Idle
 * media continue; new requests wait. */
void stream_pause(struct stream *stream);
void stream_resume(struct stream *stream);

/* Sets words per minute, 40..500, for all sentences not yet started, in the current and waiting
 * utterances. */
void stream_rate(struct stream *stream, double rate);

/* Continues the current utterance at its first mark of that name. Listeners drop what was sent but not
 * heard: see JUMPED. Returns -1 with *e: "not-speaking", "unknown-mark". */
int stream_jump(struct stream *stream, const char *mark, struct error *e);

#endif
