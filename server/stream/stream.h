/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The stream stage: a queue of speeches becomes events and media chunks, paced to real time with a small
 * lead. One stream for each listener; it knows nothing of how they travel. */
#ifndef FACCIA_STREAM_STREAM_H
#define FACCIA_STREAM_STREAM_H

#include "server/stream/idle_face.h"
#include "server/stream/media.h"
#include "server/synthesis/live_voice.h"
#include "server/synthesis/pipeline.h"
#include "server/synthesis/recording.h"
#include "server/synthesis/speech_request.h"

struct mood_request;

enum {
    STREAM_CHUNK_MS = 200, /* media in one chunk */
    STREAM_FIRST_MS = 60,  /* in the first of an utterance, which somebody waits for */
    STREAM_LEAD_MS = 400,  /* media are sent when those sent before last no longer than this */
    STREAM_WAIT_MS =
        100,           /* of silence, while the text of an utterance is being written: what is heard then */
    STREAM_QUEUE = 32, /* default of utterances that may wait */
};

/* How the face lives while nobody speaks. */
struct idle_options {
    double life;   /* strength, 0..2 */
    uint64_t seed; /* of the life layer */
    double fps;    /* 1..120 */
    bool still;    /* a face that does not move */
};

enum stream_event_kind {
    STREAM_BEGIN,
    STREAM_SENTENCE,
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

/* Pointers are good during the call only. */
struct stream_event {
    enum stream_event_kind kind;
    uint32_t utterance;                        /* 0: of none (PAUSED, RESUMED) */
    const char *id;                            /* the client's, or NULL */
    uint64_t order;                            /* as its request (speech_request.h) */
    uint32_t sample_rate, sample, duration;    /* of all with a time; END: duration of all, samples */
    size_t start, end, utf16_start, utf16_end; /* SENTENCE, WORD: the place in the text; end exclusive */
    const char *text;          /* WORD: end - start bytes that stand there; MARK, JUMPED: its name;
                                  PHONE: its IPA */
    const struct error *error; /* WARNING, ERROR */
    const char *reason;        /* END: "done", "stopped", "failed"; NULL: it is spoken again elsewhere,
                                  nobody is told of an end */
    bool blocked;              /* END: the sound of all who listened was blocked */
    const char *voice, *lang, *engine, *markup; /* BEGIN */
    double fps;                                 /* BEGIN */
    bool again;                                 /* BEGIN: it is spoken again when it is lost */
    const char *play;                           /* BEGIN of a recording: its name, else NULL */
    bool live;                                  /* BEGIN: somebody's own voice, whose words nobody knows */
    unsigned lookahead;                         /* the same: ms */
    double idle; /* BEGIN, RESUMED: when that is on the idle clock, s; negative: nobody idles */
};

struct stream_sink {
    void (*event)(void *ctx, const struct stream_event *event);
    void (*media)(void *ctx, const struct media *media);
    /* May more media come now? While not, the stream waits (and asks again). */
    bool (*ready)(void *ctx);
};

struct stream;

struct stream *stream_new(const struct pipeline *pipeline, const struct stream_sink *sink, void *ctx,
                          unsigned queue);

/* No callback comes after this. */
void stream_free(struct stream *stream);

/* Takes the request under the next utterance number; its mode, priority and topic say when it is spoken. When
 * it is refused (also "queue-full", "busy"), its ERROR and END events come at once, and nothing else changes.
 * Returns the number, or 0 when it is refused. */
uint32_t stream_speak(struct stream *stream, const struct speech_request *request);

/* The utterance of that number, whose text is still being written (synthesis.h): is it there, and open? */
bool stream_is_open(const struct stream *stream, uint32_t utterance);

/* Adds to its text, up to `most` bytes in all; -1 with *e as synthesis_write. What is written to one that has
 * ended is passed over. */
int stream_write(struct stream *stream, uint32_t utterance, const char *text, size_t size, size_t most,
                 struct error *e);
void stream_flush(struct stream *stream, uint32_t utterance);

/* The same of one whose speaker is heard: a message of his with sound (live_audio.h). */
void stream_sound(struct stream *stream, uint32_t utterance, const uint8_t *bytes, size_t size);

/* why: a warning that goes with it, or NULL. */
void stream_close(struct stream *stream, uint32_t utterance, const struct error *why);

/* As stream_speak, of somebody who speaks himself: stream_sound follows, and stream_close. */
uint32_t stream_hear(struct stream *stream, const struct live_request *request);

/* Cuts the utterances of that id, or forgets them when they wait. Returns how many there were. */
unsigned stream_cancel(struct stream *stream, const char *id);

/* The same for a recording, of whose request the id, mode and priority count; it is opened when its turn
 * comes: what is wrong with it is said then. */
uint32_t stream_play(struct stream *stream, struct recording_source *source,
                     const struct speech_request *request);

/* The same for a request that was found bad before it came here: numbers it and gives its ERROR and END.
 * order: as in speech_request.h. */
void stream_refuse(struct stream *stream, const char *id, uint64_t order, const struct error *e);

/* Has the face idle while nothing is spoken: silent chunks of utterance 0. options = NULL: no longer. The
 * life layer's clock runs on through idling, utterances and pauses, so the face does not jump between them;
 * only an utterance with a seed of its own has a clock of its own. Where one is cut, or a clock changes, the
 * face goes over (face_ease.h). An utterance takes the place of the idle media that lie beyond its beginning.
 */
void stream_idle(struct stream *stream, const struct idle_options *options);

/* Sets the stream's mood, from the next media on, until it is set anew. -1 with *e as mood_set. */
int stream_express(struct stream *stream, const struct mood_request *mix, struct error *e);

/* The number of the last utterance; and the next one has a higher number than that. */
uint32_t stream_number(const struct stream *stream);
void stream_number_above(struct stream *stream, uint32_t number);

/* All that speaks and waits gets its ERROR and its END, "failed"; what is spared (speech_request.h) a WARNING
 * if it has begun. Ends a pause. */
void stream_fail(struct stream *stream, const struct error *e);

/* The daemons that asked for something have told its end by now: what waits of it is forgotten, and what
 * speaks is this one's alone. */
void stream_go_alone(struct stream *stream);

/* The same of what that daemon asked for when it followed before (0: of what any has). The number of what
 * speaks, where that is of it; else 0. */
uint32_t stream_forget_earlier(struct stream *stream, uint64_t abroad);

/* Does it speak, or does anything wait? */
bool stream_busy(const struct stream *stream);

/* Cuts the utterance that speaks and forgets those that wait; each gets its END. Ends a pause. */
void stream_stop(struct stream *stream);

/* No media of utterances leave, and their clock stands still where they are heard now, until stream_resume;
 * listeners halt there, too. Idle media go on meanwhile. What is asked for waits. */
void stream_pause(struct stream *stream);
void stream_resume(struct stream *stream);

/* The words per minute of all sentences that have not begun, 40..500, of the utterance that speaks and of
 * those that wait. -1 with *e "bad-field". */
int stream_rate(struct stream *stream, double rate, struct error *e);

/* The utterance that speaks goes on from its first mark of that name. What was sent and has not been heard is
 * to be forgotten: see JUMPED. -1 with *e: "not-speaking", "unknown-mark". */
int stream_jump(struct stream *stream, const char *mark, struct error *e);

#endif
