/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The voice pool: worker processes that run voice plugins, and the queue of sentences before them. Lives on
 * one libuv loop; all functions and callbacks belong to that loop's thread. */
#ifndef FACCIA_VOICE_VOICE_POOL_H
#define FACCIA_VOICE_VOICE_POOL_H

#include "server/base/error.h"
#include "server/base/metrics.h"
#include "server/cluster/cluster.h"
#include "server/cluster/work_queue.h"
#include "server/markup/score.h"
#include "server/voice/boundary_table.h"
#include "server/voice/plan.h"
#include "server/voice/sentence_audio.h"
#include "server/voice/voice_cache.h"
#include <stdbool.h>
#include <uv.h>

struct reader;
struct work_gate;
struct voice_pool;
struct voice_job;

struct voice_pool_options {
    const char *worker;     /* path of the faccia-voice program */
    const char *plugin_dir; /* every *.so in it is a plugin */
    unsigned workers;       /* processes for each plugin, default 1 */
    unsigned
        spare_workers; /* and as many more while one of them has fallen silent or is held up by a sentence */
    /* A sentence is given up, and its worker killed, when nothing has come of it for deadline_base +
     * deadline_per_byte * bytes of text (seconds; four times that for a FACCIA_VOICE_SLOW one), and whatever
     * comes when deadline_most times that have passed. Defaults 10, 0.05 and 10. */
    double deadline_base, deadline_per_byte, deadline_most;
    /* What a worker may have: processor time for a sentence, on all cores, in multiples of the same (default
     * 20), and address space (default 4096). Too much of the one ends it, more of the other is refused. */
    double processor;
    unsigned megabytes;
    unsigned unconfined;  /* not 0: plugins may do what they did not say that they need (sandbox.h) */
    double start_seconds; /* plugins that take longer to start are not waited for, default 30 */
    double retry_after;   /* a plugin that does not start is tried again after so many seconds, default 60 */
    const char *config;   /* JSON object: plugin name -> its own configuration object; NULL = {} */
    /* Where the voices' phones are heard; borrowed; NULL: where the voices say. own_boundaries not 0: that is
     * not asked (a setting). */
    const struct boundary_table *boundaries;
    unsigned own_boundaries;
    bool quiet;                 /* plugins that have nothing to run here are not named in the log */
    struct cache_options cache; /* what is kept of finished sentences; all 0 = nothing */
    struct cluster *cluster;    /* borrowed, until voice_pool_close: what other daemons speak; NULL = none */
    struct work *work;          /* likewise: workers elsewhere, whose voices come and go; NULL = none */
    struct metrics *metrics;    /* NULL = nobody counts */
};

/* A voice as the world sees it. Strings live as long as the pool. */
struct voice {
    const char *id; /* "espeak:it+f2" */
    const char *plugin, *name, *lang, *gender, *quality, *licence;
    uint32_t sample_rate;
    uint32_t rate;         /* its own words per minute */
    uint32_t capabilities; /* of its plugin: FACCIA_VOICE_... */
};

/* Starts the workers. ready is called once, when every plugin has listed its voices, has failed to start, or
 * takes longer than start_seconds, and once more when there was no voice then and one comes after all; a
 * plugin that failed is skipped with a log line. The process must ignore SIGPIPE (program_begin): a write to
 * a worker that has just died raises it. Unless plugins are unconfined nobody reads its memory (mem.h).
 * Returns NULL with *e ("voice-unavailable") when no plugin or no worker program is found. */
struct voice_pool *voice_pool_open(uv_loop_t *loop, const struct voice_pool_options *options,
                                   void (*ready)(void *ctx), void *ctx, struct error *e);

/* Ends the workers (idle ones may close their plugin, for at most 2 s), fails the jobs with code "cancelled"
 * at once, frees everything; closed is called at last. */
void voice_pool_close(struct voice_pool *pool, void (*closed)(void *ctx), void *ctx);

/* A plugin that comes later makes a new list; the one before stays as it is until the pool is closed. */
const struct voice *voice_pool_voices(const struct voice_pool *pool, size_t *count);

/* The same for another thread to read: between voice_pool_hold and voice_pool_let_go, both called on the
 * loop's thread, the list and its voices stay, even when the pool is closed meanwhile. */
struct voice_list {
    const struct voice *voices;
    size_t count;
};
struct voice_list voice_pool_hold(struct voice_pool *pool);
void voice_pool_let_go(struct voice_pool *pool);
/* By its whole id, or else by its id inside a plugin. NULL when there is none. */
const struct voice *voice_by_name(struct voice_list list, const char *name);

/* *e ("unknown-voice", field "voice") says that there is none of that name, and what may have been meant. */
void voice_unknown(struct voice_list list, const char *name, struct error *e);

/* Finds a voice: by id ("espeak:it"), by id inside any plugin ("it+f2"), or, when name is NULL, the best for
 * lang. preferred is a NULL-terminated list of ids to be tried first for a lang (from the language pack), or
 * NULL. NULL with *e
 * ("unknown-voice", "unknown-language", field "voice" or "lang"; "voice-unavailable" when there are no voices
 * at all). */
const struct voice *voice_pool_find(const struct voice_pool *pool, const char *name, const char *lang,
                                    const char *const *preferred, struct error *e);

/* Until all plugins have started, or nobody waits for them any longer: would voice_pool_find find the same
 * then? Without a name, only one of the preferred is sure. */
bool voice_pool_settled(const struct voice_pool *pool, const char *name, const char *const *preferred);

/* Calls changed, from the loop, whenever a plugin has started or is given up, until voice_wait_end (NULL is
 * fine), which must come before the pool is closed. */
struct voice_wait;
struct voice_wait *voice_pool_wait(struct voice_pool *pool, void (*changed)(void *ctx), void *ctx);
void voice_wait_end(struct voice_wait *wait);

/* Whose turn it is, where several wait for a worker. */
enum voice_turn {
    VOICE_TURN_USUAL,  /* made a little ahead of who hears it */
    VOICE_TURN_URGENT, /* somebody waits to hear it: it comes before those, every other time */
    VOICE_TURN_AHEAD,  /* nobody waits, it is to be kept: it comes when there is nothing else; and when there
                          is,  while it is spoken, it is broken off and fails with "cancelled" */
};

/* What to speak: one sentence of a score. Copied by voice_pool_speak. */
struct voice_request {
    const struct voice *voice;
    const struct score *score;
    size_t sentence;      /* index */
    double rate;          /* words per minute, 0 = the voice's own; the styles' factors multiply it */
    double pitch, volume; /* factors, 1 = the voice's own */
    enum voice_turn turn;
    uint32_t
        payer; /* whose it is: payers come by turns, here and where workers elsewhere speak; 0 = nobody's */
    uint32_t asker; /* which of the payer's connections asks: those come by turns, too; 0 = none */
    const struct reader *reader; /* decodes the sounds in it (sentence.h); NULL = nobody else does */
    struct work_gate *gate;      /* so many sounds are read at a time; NULL = any number */
};

/* How well a voice's language fits the wanted one (BCP 47): 3 the same tag, 2 a variety of what is wanted
 * ("en" finds "en-GB"), 1 the same language, 0 another. Tags count as what lang_usual says. */
int voice_lang_fit(const char *lang, const char *wanted);

/* What the request says of the prosody, for one voice. */
struct plan_prosody voice_request_prosody(const struct voice_request *request, const struct voice *voice);

struct voice_callbacks {
    void (*done)(void *ctx, struct sentence_audio *audio); /* the receiver owns it */
    void (*failed)(void *ctx, const struct error *e); /* "voice-failed", "voice-timeout", "voice-crashed" */
};

/* Queues the sentence; exactly one callback follows, later, unless the job is cancelled. */
struct voice_job *voice_pool_speak(struct voice_pool *pool, const struct voice_request *request,
                                   const struct voice_callbacks *callbacks, void *ctx);

/* The same for a plan, which the job takes over, and a voice; of the request, only turn, payer and asker
 * count. */
struct voice_job *voice_pool_speak_plan(struct voice_pool *pool, const struct voice *voice, struct plan plan,
                                        const struct voice_request *request,
                                        const struct voice_callbacks *callbacks, void *ctx);

/* What the pool runs, for a worker that speaks for other daemons. False: there is no such plugin. Texts
 * belong to the pool; description, as WIRE_HELLO has it, is NULL until its voices are listed. */
struct voice_plugin {
    const char *name, *edition, *config, *description;
    bool runs;      /* its voices are listed, and can be asked */
    unsigned seats; /* how many sentences it speaks at a time */
};
bool voice_pool_plugin(const struct voice_pool *pool, size_t index, struct voice_plugin *out);

/* Speaks a sentence of one of its voices, as WIRE_SPEAK has it behind the processor time, from elsewhere:
 * frames is called before done with all that the voice said, as AUDIO and EVENTS frames, unless that is more
 * than can be kept (WORK_BODY_MOST). NULL with *e, and no callback, when it is no sentence, or none of its
 * voices. */
struct voice_job *voice_pool_speak_frames(struct voice_pool *pool, size_t index, const struct buf *sentence,
                                          enum voice_turn turn, void (*frames)(void *ctx, const struct buf *),
                                          const struct voice_callbacks *callbacks, void *ctx,
                                          struct error *e);

/* Forgets the job: no callback will come. A running worker is told to stop. */
void voice_job_cancel(struct voice_job *job);

#endif
