/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A pool of worker processes that run voice plugins, with queues of sentences. It lives on one libuv loop;
 * all functions and callbacks belong to that loop's thread. */
#ifndef FACCIA_VOICE_VOICE_POOL_H
#define FACCIA_VOICE_VOICE_POOL_H

#include "server/base/error.h"
#include "server/base/metrics.h"
#include "server/cluster/cluster.h"
#include "server/markup/score.h"
#include "server/voice/assembly.h"
#include "server/voice/sentence_audio.h"
#include "server/voice/voice_cache.h"
#include "server/voice/voice_request.h"
#include <stdbool.h>
#include <uv.h>

struct reader;
struct work_gate;
struct voice_pool;
struct voice_job;

struct voice_pool_options {
    const char *worker;     /* path of the faccia-voice program */
    const char *plugin_dir; /* every *.so in it is a plugin */
    unsigned workers;       /* processes per plugin, default 1 */
    unsigned
        spare_workers; /* extra processes, started while a worker is stuck or busy with a long sentence */
    /* A sentence fails and its worker is killed after a silence of deadline_base + deadline_per_byte *
     * bytes of text (seconds; four times that for FACCIA_VOICE_SLOW), and in any case after deadline_most
     * times as long. Defaults 10, 0.05 and 10. */
    double deadline_base, deadline_per_byte, deadline_most;
    /* Limits of a worker: processor time for a sentence over all cores, in multiples of the same deadline
     * (default 20), and address space in MB (default 4096). Exceeding the first kills the worker, the
     * second makes allocations fail. */
    double processor;
    unsigned megabytes;
    unsigned unconfined;  /* not 0: run plugins without the sandbox (sandbox.h) */
    double start_seconds; /* the pool is ready without slower plugins, default 30 */
    double retry_after;   /* seconds between attempts to start a failed plugin, default 60 */
    const char *config;   /* JSON object: plugin name -> its configuration; NULL = {} */
    /* Corrections of phone boundaries, borrowed; NULL = none. own_boundaries not 0 disables them (a
     * setting). */
    const struct boundary_table *boundaries;
    unsigned own_boundaries;
    bool quiet;                 /* do not log plugins that have nothing to run here */
    struct cache_options cache; /* cache of finished sentences; all 0 = none */
    struct cluster *cluster;    /* borrowed until voice_pool_close: sentences of other daemons; NULL = none */
    struct work *work;          /* likewise: remote workers, whose voices come and go; NULL = none */
    struct metrics *metrics;    /* NULL = no metrics */
};

/* A voice as clients see it. Strings live as long as the pool. */
struct voice {
    const char *id; /* "espeak:it+f2" */
    const char *plugin, *name, *lang, *gender, *quality, *licence;
    uint32_t sample_rate;
    uint32_t rate;         /* default words per minute */
    uint32_t capabilities; /* of its plugin: FACCIA_VOICE_... */
};

/* Starts the workers. Calls ready once when every plugin has listed its voices, failed, or taken longer
 * than start_seconds, and once more if there was no voice then and one appears later. A plugin that fails
 * is skipped with a log line. The process must ignore SIGPIPE (program_begin), which a write to a dead
 * worker raises. Unless plugins run unconfined, other processes cannot read this one's memory (mem.h).
 * Returns NULL with *e ("voice-unavailable") when there is no plugin or no worker program. */
struct voice_pool *voice_pool_open(uv_loop_t *loop, const struct voice_pool_options *options,
                                   void (*ready)(void *ctx), void *ctx, struct error *e);

/* Fails all jobs with "cancelled" at once, ends the workers (idle ones get 2 s to close their plugin),
 * frees the pool, then calls closed. */
void voice_pool_close(struct voice_pool *pool, void (*closed)(void *ctx), void *ctx);

/* A new plugin makes a new list; older lists stay valid until the pool is closed. */
const struct voice *voice_pool_voices(const struct voice_pool *pool, size_t *count);

/* The list for another thread to read. Between voice_pool_retain and voice_pool_release, both called on
 * the loop's thread, the list and its voices stay valid even if the pool is closed. */
struct voice_list {
    const struct voice *voices;
    size_t count;
};
struct voice_list voice_pool_retain(struct voice_pool *pool);
void voice_pool_release(struct voice_pool *pool);
/* Finds a voice by its full id, else by its id within a plugin; NULL if there is none. */
const struct voice *voice_by_name(struct voice_list list, const char *name);

/* Sets *e ("unknown-voice", field "voice") with a suggestion of the most similar name. */
void voice_unknown(struct voice_list list, const char *name, struct error *e);

/* Finds a voice by id ("espeak:it") or by id within any plugin ("it+f2"); if name is NULL, the best for
 * lang. preferred is a NULL-terminated list of ids to try first for a language (from the language pack),
 * or NULL. Returns NULL with *e ("unknown-voice", "unknown-language", field "voice" or "lang";
 * "voice-unavailable" when there are no voices at all). */
const struct voice *voice_pool_find(const struct voice_pool *pool, const char *name, const char *lang,
                                    const char *const *preferred, struct error *e);

/* Tells whether voice_pool_find would return the same voice once all plugins have started. Without a name
 * only a preferred voice is certain. */
bool voice_pool_settled(const struct voice_pool *pool, const char *name, const char *const *preferred);

/* Calls changed from the loop whenever a plugin has started or is given up, until voice_wait_end, which
 * accepts NULL and must come before the pool is closed. */
struct voice_wait;
struct voice_wait *voice_pool_wait(struct voice_pool *pool, void (*changed)(void *ctx), void *ctx);
void voice_wait_end(struct voice_wait *wait);

/* Order in which jobs get a worker. */
enum voice_priority {
    VOICE_PRIORITY_NORMAL,     /* spoken a little ahead of playback */
    VOICE_PRIORITY_URGENT,     /* a listener waits: served before NORMAL, every other time */
    VOICE_PRIORITY_BACKGROUND, /* prerendering: runs when nothing else is queued; cancelled with "cancelled"
                                  when another job arrives */
};

/* One sentence of a score to speak. Copied by voice_pool_speak. */
struct sentence_request {
    const struct voice *voice;
    const struct score *score;
    size_t sentence;      /* index */
    double rate;          /* words per minute, 0 = the voice's own; multiplied by the styles' factors */
    double pitch, volume; /* factors, 1 = the voice's own */
    enum voice_priority priority;
    uint32_t quota_key;  /* quota key: keys share the workers fairly, here and on remote workers; 0 = none */
    uint32_t connection; /* connection within the quota key, scheduled fairly too; 0 = none */
    const struct reader *reader; /* decodes sound files (sentence.h); NULL = none */
    struct work_gate *gate;      /* limits how many sounds are read at a time; NULL = no limit */
};

/* The request's prosody for one voice. */
struct voice_prosody sentence_prosody(const struct sentence_request *request, const struct voice *voice);

struct voice_callbacks {
    void (*done)(void *ctx, struct sentence_audio *audio); /* the receiver owns the audio */
    void (*failed)(void *ctx, const struct error *e); /* "voice-failed", "voice-timeout", "voice-crashed" */
};

/* Queues a sentence. Exactly one callback follows, later, unless the job is cancelled. */
struct voice_job *voice_pool_speak(struct voice_pool *pool, const struct sentence_request *sentence,
                                   const struct voice_callbacks *callbacks, void *ctx);

/* Queues a request for a voice and takes ownership of it. Of `sentence` only priority, quota_key and
 * connection are used. */
struct voice_job *voice_pool_speak_request(struct voice_pool *pool, const struct voice *voice,
                                           struct voice_request request,
                                           const struct sentence_request *sentence,
                                           const struct voice_callbacks *callbacks, void *ctx);

/* Describes a plugin to a worker that serves other daemons. Returns false when index is out of range.
 * Strings belong to the pool; description (as in WIRE_HELLO) is NULL until the voices are listed. */
struct voice_plugin {
    const char *name, *edition, *config, *description;
    bool runs;      /* its voices are listed and can be used */
    unsigned seats; /* sentences that it speaks at a time */
};
bool voice_pool_plugin(const struct voice_pool *pool, size_t index, struct voice_plugin *out);

/* Speaks a sentence, encoded as in WIRE_SPEAK after the processor time, for another daemon. Before done,
 * frames receives all AUDIO and EVENTS frames, unless they exceed WORK_BODY_MOST. Returns NULL with *e,
 * and makes no callback, if the sentence is invalid or its voice unknown. */
struct voice_job *voice_pool_speak_frames(struct voice_pool *pool, size_t index, const struct buf *sentence,
                                          enum voice_priority priority,
                                          void (*frames)(void *ctx, const struct buf *),
                                          const struct voice_callbacks *callbacks, void *ctx,
                                          struct error *e);

/* Cancels the job and stops the worker that speaks it. No callback follows. */
void voice_job_cancel(struct voice_job *job);

#endif
