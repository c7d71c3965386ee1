/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inside of the voice pool: plugins with their queues, workers, jobs. */
#ifndef FACCIA_VOICE_VOICE_POOL_INTERNAL_H
#define FACCIA_VOICE_VOICE_POOL_INTERNAL_H

#include "server/base/etag.h"
#include "server/voice/assembly.h"
#include "server/voice/descriptor_reserve.h"
#include "server/voice/plan.h"
#include "server/voice/voice_pool.h"
#include "server/voice/wire.h"

/* Holds jobs in order of arrival. Jobs that wait for a worker, or for their turn from the cache, leave by
 * fair queueing with virtual finish times (Golestani 1994), first between payers and then between one payer's
 * askers. Virtual time counts bytes of text (job_cost): a job finishes its cost after the previous job of the
 * same payer or asker, or after the job that left last, whichever is later; the earliest finish leaves first.
 * Payers are identified by a hash. */
enum { QUEUE_PAYERS = 256, JOB_COST = 64 /* of any job, besides its text */ };
struct job_queue {
    struct voice_job *first, *last;
    uint64_t now;                  /* end of the job that left last, between payers */
    uint64_t served[QUEUE_PAYERS]; /* the same of each payer's last job */
    uint64_t within[QUEUE_PAYERS]; /* end of the payer's last job, between its askers */
};

/* One sentence, from voice_pool_speak to its callback. */
struct voice_job {
    struct voice_job *next;  /* in its queue */
    struct job_queue *queue; /* NULL = it is spoken */
    struct plugin *plugin;
    struct worker *worker; /* that speaks it */
    uint32_t number;       /* on the wire */
    enum voice_turn turn;
    uint32_t payer, asker;
    uint64_t came;  /* what the queue's `now` was then */
    uint64_t ends;  /* between the payer's askers */
    bool gave_way;  /* it was ahead, and somebody came */
    bool cancelled; /* nobody waits for it any more */
    bool too_long;  /* the worker was told to stop: its text makes more sound than a sentence may have */
    bool moved;     /* to another worker, as the first one fell silent */
    const struct voice *voice;
    struct plan plan;
    struct assembly *assembly;
    struct cluster_ask *ask; /* other daemons are asked for it; it stands in `asked` */
    uint64_t claimed;        /* loop time at which they were told last that it is made here; 0 = never */
    struct buf key;          /* of the cache; empty without one */
    struct buf spoken;       /* what the worker has said, for the cache; given up when it grows too large */
    bool uncacheable;
    void (*frames)(void *ctx, const struct buf *frames); /* wants what the worker has said; NULL: nobody */
    struct voice_callbacks callbacks;
    void *ctx;
};

enum worker_state {
    WORKER_STARTING, /* has not said hello */
    WORKER_IDLE,
    WORKER_SPEAKING,
    WORKER_STOPPING, /* was told to stop speaking */
    WORKER_LOST,     /* fell silent, and another one speaks its sentence; it may come back */
    WORKER_RESTING,  /* no process: it will be started again when the timer rings */
    WORKER_OFF,      /* no process: a spare one that is not needed */
};

/* One seat for a process; the process may change. */
struct worker {
    struct plugin *plugin;
    enum worker_state state;
    struct process *process; /* NULL when resting */
    struct voice_job *job;
    bool spare;             /* started only when the others are stuck */
    uv_timer_t timer;       /* start, sentence, stop, rest: what the state says */
    uv_timer_t pulse;       /* looks at it while it speaks: */
    unsigned looks, silent; /* how often, and how often in a row nothing had come from it */
    uint32_t dropped;       /* the sentence that another one speaks */
    uint64_t not_before;    /* loop time: a spare one that did not start rests */
    uint64_t patience;      /* ms that it may be silent while it speaks; */
    uint64_t end;           /* of the loop's time: it must be done */
    unsigned failed_starts; /* in a row */
    bool given_up;          /* too many of them */
    bool absent;            /* it had nothing to run when it was started last */
};

struct plugin {
    struct voice_pool *pool;
    char *name, *path, *config;
    char edition[ETAG_BYTES]; /* changes when the plugin's file does */
    struct worker *workers;
    size_t worker_count, spare_count;
    size_t seat_count; /* the usual ones come first; spare ones after them, and in place of the usual ones */
    struct job_queue urgent, waiting, ahead; /* sentences, oldest first */
    bool urgent_last;                        /* the last one that left was urgent */
    bool known;                              /* its voices are listed, or nobody waits for them any longer */
    bool listed;                             /* they are */
    char *description;                       /* of its voices; NULL: not listed yet */
    char *queue;                             /* of workers elsewhere; NULL: it runs here */
    struct voice_list aside;                 /* its voices, while they are gone */
    bool there;                              /* there are such workers */
    char *absence;                           /* why it had nothing to run at the start; NULL: it had */
};

/* The voices of all plugins. Pointers into it stay valid when it grows: old lists are kept. */
struct catalog {
    struct voice *voices;
    size_t count;
    struct catalog_block *blocks;
};

struct voice_pool {
    uv_loop_t *loop;
    char *worker_path;
    double deadline_base, deadline_per_byte, deadline_most, processor, retry_after;
    unsigned megabytes;
    bool unconfined;
    bool quiet;
    uint64_t short_logged; /* loop time: there was no room for a process */
    bool gaps_told;        /* of the workers' confinement */
    struct plugin *plugins;
    size_t plugin_count, plugin_cap; /* with room for plugins that run elsewhere */
    struct catalog catalog;
    uint32_t last_job;
    struct job_queue refused;                /* sentences that cannot be spoken and wait for the callback, */
    struct job_queue known;                  /* sentences that were found in the cache and wait for theirs, */
    struct job_queue asked;                  /* sentences that other daemons are asked for, */
    uv_timer_t soon;                         /* which may not come inside voice_pool_speak */
    struct voice_cache *cache;               /* NULL = none */
    struct cluster *cluster;                 /* NULL = none */
    struct work *work;                       /* NULL = none */
    const struct boundary_table *boundaries; /* NULL = phones lie where the voices say */
    struct metrics *metrics;
    void (*ready)(void *ctx);
    void *ready_ctx;
    bool is_ready, speaks; /* speaks: there was a voice when `ready` was called last */
    uv_timer_t start;      /* so long is waited for plugins that are slow to start */
    struct voice_wait *waits;
    struct reserve reserve;
    bool closing;
    size_t open_handles; /* that hold up voice_pool_close */
    void (*closed)(void *ctx);
    void *closed_ctx;
};

/* voice_pool.c */
uint32_t pool_number(struct voice_pool *pool);    /* of a sentence on the wire; never 0 */
void pool_handle_closed(struct voice_pool *pool); /* one of open_handles */
void pool_soon(struct voice_pool *pool);          /* what may not happen inside of a call */

/* voice_pool_start.c */
void pool_start_open(struct voice_pool *pool, double seconds);
void pool_start_close(struct voice_pool *pool);
void pool_plugin_known(struct plugin *plugin); /* after known was set */
void pool_call_waits(struct voice_pool *pool); /* those that are due */

/* voice_pool_plugins.c */
int plugins_find(struct voice_pool *pool, const struct voice_pool_options *options, struct error *e);
void plugins_log_absent(const struct voice_pool *pool);
void plugins_free(struct voice_pool *pool);
void plugins_tell_gaps(struct voice_pool *pool, const char *description); /* what a worker's HELLO says */

/* voice_pool_queue.c */
void job_push(struct job_queue *queue, struct voice_job *job); /* at its end */

void job_push_in_turn(struct job_queue *queue, struct voice_job *job); /* to leave it in its turn */
struct job_queue *job_queue_of(const struct voice_job *job);           /* that it waits in */
struct voice_job *job_take_next(struct job_queue *queue); /* whose turn it is, out of it; or NULL */
void job_take_out(struct voice_job *job);                 /* of its queue */
void job_wait(struct voice_job *job);                     /* for a worker, which may be idle */
void job_free(struct voice_job *job);
bool plugin_runs(const struct plugin *plugin);                 /* a worker of it may yet come */
struct sentence_audio *pool_job_finish(struct voice_job *job); /* what its assembly makes of it */
void pool_job_end(struct voice_job *job, struct sentence_audio *u,
                  const struct error *e); /* calls back, frees the job */
struct voice_job *
pool_next_job(struct plugin *plugin);          /* the sentence to be spoken next, taken from the queue */
void pool_fail_waiting(struct plugin *plugin); /* when no worker of it will come */

/* Ends all of them; why follows "the voice NAME". */
void queue_fail(struct job_queue *queue, enum error_code code, const char *why);

/* voice_pool_cache.c */

/* What the worker said about the sentence: kept for the cache, if there is one. */
void pool_job_said(struct voice_job *job, const struct wire_frame *frame);
void pool_job_spoken(struct voice_job *job); /* all of it, and without a failure */
bool job_look_up(struct voice_job *job);     /* true: the cache has it, and job_recall can speak it */
void job_recall(struct voice_job *job);

/* voice_pool_shared.c */
void job_ask(struct voice_job *job);    /* the other daemons, if there are any; then it is begun */
void job_making(struct voice_job *job); /* says so to them, now and then */
void job_share(struct voice_job *job);  /* gives them what was spoken, or nothing: they need not wait */

/* voice_pool.c */
void job_begin(struct voice_job *job); /* it waits for a worker, or for being refused */

/* worker.c */
enum { WORKER_RETIRE_MS = 10000 }; /* after which a spare one with nothing to do goes */
void worker_open(struct worker *worker, struct plugin *plugin);
void worker_close(struct worker *worker);  /* the job fails with "cancelled" */
void worker_start(struct worker *worker);  /* a spare one that is off */
void worker_retire(struct worker *worker); /* a spare one that is idle */

void worker_set_state(struct worker *worker, enum worker_state state,
                      uint64_t ms); /* on_time after ms; 0 = never */
uint32_t worker_processor_seconds(const struct voice_pool *pool, uint64_t ms); /* for what may take ms */
void worker_greeted(struct worker *worker,
                    const struct wire_frame *frame); /* the first that its process says */
void worker_end_job(struct worker *worker, struct sentence_audio *u, const struct error *e);

/* The process is lost; why follows "the voice NAME". That costs the sentence that it spoke, if any, and
 * another process is started: at once if this one was of any use. */
void worker_lose(struct worker *worker, enum error_code code, const char *why, bool hopeless);

/* One whose process runs elsewhere: it is there, and it is not. The sentence that it speaks fails. */
void worker_begin(struct worker *worker);
void worker_leave(struct worker *worker, const char *why);

/* worker_sentence.c */
void worker_said(void *worker, const struct wire_frame *frame);
void worker_wake(struct worker *worker);                     /* speaks the next sentence if it is idle */
void worker_cancel(struct worker *worker);                   /* the sentence that it speaks */
struct voice_job *worker_give_up_job(struct worker *worker); /* so that another one can speak it */

/* voice_pool_far.c */
enum { POOL_FAR_MOST = 64 }; /* kinds of voices from elsewhere, until the pool is closed */
void pool_far_open(struct voice_pool *pool);
void pool_far_close(struct voice_pool *pool);

/* voice_pool_spare.c */
void spare_watch(struct worker *worker); /* it begins to speak */
void spare_heard(struct worker *worker); /* anything from it */
bool spare_is_stuck(const struct worker *worker);
void spare_call(struct plugin *plugin); /* somebody else is to speak */
void spare_rescue(
    struct plugin *plugin); /* another worker can: sentences of workers that fell silent wait again */
bool spare_may_go(const struct plugin *plugin);

/* voice_catalog.c */
struct voice_list catalog_list(const struct catalog *catalog);
int catalog_add(struct catalog *catalog, const char *plugin, const char *description, struct error *e);

/* Voices of a plugin come and go. plugin is the same string as they were added with. */
struct voice_list catalog_aside(struct catalog *catalog, const char *plugin); /* those that it has now */
void catalog_drop(struct catalog *catalog, const char *plugin);
void catalog_put_back(struct catalog *catalog, struct voice_list aside);
void catalog_free(struct catalog *catalog);

#endif
