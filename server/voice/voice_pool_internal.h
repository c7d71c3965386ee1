/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Private to the voice pool: processes, workers, plugins with their queues, jobs. */
#ifndef FACCIA_VOICE_VOICE_POOL_INTERNAL_H
#define FACCIA_VOICE_VOICE_POOL_INTERNAL_H

#include "server/base/buf.h"
#include "server/base/error.h"
#include "server/base/etag.h"
#include "server/cluster/cluster.h"
#include "server/voice/assembly.h"
#include "server/voice/voice_pool.h"
#include "server/voice/voice_request.h"
#include "server/voice/wire.h"
#include <uv.h>

struct process;

struct process_ops {
    void (*send)(struct process *p, struct buf *b);
    void (*stop)(struct process *p, bool politely);
};

/* A worker process and its socket on a libuv loop, or its proxy for a remote worker (remote_voice.c).
 * First member of both. Frees itself once it is stopped and closed. */
struct process {
    const struct process_ops *ops;
};

struct process_callbacks {
    void (*on_frame)(void *ctx, const struct wire_frame *frame); /* may stop the process */
    void (*on_died)(void *ctx,
                    const char *how); /* "exited with status 1", "was killed by signal 11", "sent garbage" */
    void (*on_closed)(void *ctx);     /* the last call, also after process_stop */
};

/* Code of a temporary error: the system is out of descriptors, memory or processes. */
#define PROCESS_RETRY ERROR_VOICE_UNAVAILABLE

/* Starts `program plugin`. Returns NULL with *e; on_closed is still called later. The caller must ignore
 * SIGPIPE. */
struct process *process_start(uv_loop_t *loop, const char *program, const char *plugin,
                              const struct process_callbacks *callbacks, void *ctx, struct error *e);

/* Sends the frames in b and empties it. */
void process_send(struct process *p, struct buf *b);

/* Stops it, at once or after a short grace period. on_frame and on_died are not called afterwards. */
void process_stop(struct process *p, bool politely);

/* Spare descriptors, released to start a worker when the process has run out. */

/* Enough for a socket pair, a pipe and those used during the start. */
enum { RESERVE = 8 };

struct reserve {
    int fds[RESERVE]; /* descriptor + 1; 0 = none */
};

void reserve_fill(struct reserve *reserve); /* opens as many as it can */
void reserve_release(struct reserve *reserve);

/* Starts a proxy that behaves like a worker process but sends its sentences to the cluster's work queue.
 * Its DONE carries an enum error_code, or 0, and the complete message. description is the content of
 * HELLO; queue and description are borrowed until it is closed. */

struct process *remote_process_start(uv_loop_t *loop, struct work *work, const char *queue,
                                     const char *description, const struct process_callbacks *callbacks,
                                     void *ctx);

/* Sets the priority and the quota key of the next sentence. */
void remote_process_schedule(struct process *p, enum voice_priority priority, uint32_t quota_key);

/* Jobs in order of arrival. Jobs that wait for a worker or for replay from the cache leave by fair
 * queueing with virtual finish times (Golestani 1994), first between quota keys, then between the
 * connections of one. Virtual time counts bytes of text (job_cost): a job finishes its cost after
 * the previous job of its quota key or connection, or after the job that left last, whichever is later. The
 * earliest finish leaves first. Keys are hashed into QUEUE_KEYS slots. */
enum { QUEUE_KEYS = 256, JOB_COST = 64 /* of every job, besides its text */ };
struct job_queue {
    struct voice_job *first, *last;
    uint64_t now;                /* virtual time between quota keys: finish of the job that left last */
    uint64_t served[QUEUE_KEYS]; /* finish of each quota key's last job */
    uint64_t within[QUEUE_KEYS]; /* the same between the connections of each quota key */
};

/* One sentence, from voice_pool_speak to its callback. */
struct voice_job {
    struct voice_job *next;  /* in its queue */
    struct job_queue *queue; /* NULL while a worker speaks it */
    struct plugin *plugin;
    struct worker *worker; /* NULL unless it speaks the job */
    uint32_t number;       /* id on the wire */
    enum voice_priority priority;
    uint32_t quota_key, connection;
    uint64_t arrived; /* the queue's `now` on arrival */
    uint64_t finish;  /* virtual finish between the quota key's connections */
    bool preempted;   /* a background job that made way for another */
    bool cancelled;   /* the caller has cancelled it */
    bool too_long;    /* the worker is stopping because the sentence exceeds its limit */
    bool requeued;    /* to another worker, because the first is stuck */
    const struct voice *voice;
    struct voice_request request;
    struct assembly *assembly;
    struct cluster_ask *ask; /* pending query to other daemons; the job is in `querying` */
    uint64_t claimed;        /* loop time of the last claim announced to other daemons; 0 = never */
    struct buf key;          /* cache key; empty without a cache */
    struct buf spoken;       /* frames received, for the cache; dropped when too large */
    bool uncacheable;
    void (*frames)(void *ctx, const struct buf *frames); /* receives the frames; may be NULL */
    struct voice_callbacks callbacks;
    void *ctx;
};

enum worker_state {
    WORKER_STARTING, /* waiting for HELLO */
    WORKER_IDLE,
    WORKER_SPEAKING,
    WORKER_STOPPING, /* told to stop speaking */
    WORKER_STUCK,    /* silent; its sentence was given to another worker, but it may recover */
    WORKER_BACKOFF,  /* no process until the timer fires */
    WORKER_OFF,      /* no process: an idle spare */
};

/* A slot for a worker process, which may be replaced. */
struct worker {
    struct plugin *plugin;
    enum worker_state state;
    struct process *process; /* NULL in BACKOFF and OFF */
    struct voice_job *job;
    bool spare;              /* runs only while others are stuck or busy */
    uv_timer_t timer;        /* deadline of the current state */
    uv_timer_t pulse;        /* checks progress while it speaks */
    unsigned checks, silent; /* checks so far, and those in a row without a sign of life */
    uint32_t dropped;        /* number of the sentence that was requeued */
    uint64_t not_before;     /* loop time before which a failed spare is not restarted */
    uint64_t silence_max;    /* ms without output before the sentence fails */
    uint64_t end;            /* loop time by which the sentence must be done */
    unsigned failed_starts;  /* in a row */
    bool given_up;           /* too many failed starts */
    bool absent;             /* the plugin had nothing to run at the last start */
};

struct plugin {
    struct voice_pool *pool;
    char *name, *path, *config;
    char edition[ETAG_BYTES]; /* changes with the plugin's file */
    struct worker *workers;
    size_t worker_count, spare_count;
    size_t seat_count; /* regular workers first, then spares, including replacements for the regular ones */
    struct job_queue urgent, normal, background; /* oldest first */
    bool urgent_last;                            /* the last job taken was urgent */
    bool settled;              /* its voices are listed, or startup no longer waits for them */
    bool listed;               /* its voices are in the catalog */
    char *description;         /* of its voices, as JSON; NULL: not listed yet */
    char *queue;               /* work queue of a remote plugin; NULL: local */
    struct voice_list removed; /* its voices while it is unavailable */
    bool available;            /* a remote worker serves it */
    char *absence;             /* why it had nothing to run at the start; NULL if it had */
};

/* The voices of all plugins. Old lists are kept, so pointers stay valid. */
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
    uint64_t no_room_logged; /* loop time of the last message about missing resources */
    bool gaps_logged;        /* about missing sandbox layers */
    struct plugin *plugins;
    size_t plugin_count, plugin_cap; /* with room for remote plugins */
    struct catalog catalog;
    uint32_t last_job;
    struct job_queue rejected; /* jobs that fail, awaiting their callback */
    struct job_queue cached;   /* jobs found in the cache, awaiting replay */
    struct job_queue querying; /* jobs waiting for an answer from other daemons */
    uv_timer_t callback_timer; /* defers callbacks out of voice_pool_speak */
    struct voice_cache *cache;
    struct cluster *cluster;
    struct work *work;
    const struct boundary_table *boundaries; /* NULL = no corrections */
    struct metrics *metrics;
    void (*ready)(void *ctx);
    void *ready_ctx;
    bool is_ready, speaks; /* speaks: there were voices at the last call of ready */
    uv_timer_t start;      /* limits the wait for slow plugins */
    struct voice_wait *waits;
    struct reserve reserve;
    bool closing;
    size_t open_handles; /* that delay voice_pool_close */
    void (*closed)(void *ctx);
    void *closed_ctx;
};

/* voice_pool.c */
uint32_t pool_number(struct voice_pool *pool);    /* id of a sentence on the wire; never 0 */
void pool_handle_closed(struct voice_pool *pool); /* one of open_handles */

void plugin_settled(struct plugin *plugin); /* call after setting `settled` */

void plugins_log_gaps(struct voice_pool *pool,
                      const char *description); /* logs missing sandbox layers from HELLO, once */

/* voice_dispatch.c */
void queue_push(struct job_queue *queue, struct voice_job *job); /* at the end */

void queue_push_fair(struct job_queue *queue, struct voice_job *job); /* for queue_pop_fair */
struct job_queue *job_queue_of(const struct voice_job *job);          /* the queue for its priority */
struct voice_job *queue_pop_fair(struct job_queue *queue); /* removes the next job in fair order, or NULL */
void queue_remove(struct voice_job *job);                  /* from its queue */
void job_enqueue(struct voice_job *job); /* wakes an idle worker, or preempts background work */
void job_free(struct voice_job *job);
bool plugin_runs(const struct plugin *plugin);              /* at least one worker is not given up */
struct sentence_audio *job_assemble(struct voice_job *job); /* turns the received frames into audio */
void job_finish(struct voice_job *job, struct sentence_audio *u,
                const struct error *e);                   /* runs the callback and frees the job */
struct voice_job *plugin_next_job(struct plugin *plugin); /* removed from the queues */
void plugin_fail_waiting(struct plugin *plugin);          /* no worker will come */

/* Fails all jobs of the queue; why follows "the voice NAME". */
void queue_fail(struct job_queue *queue, enum error_code code, const char *why);

/* Records a frame for the cache, if there is one. */
void job_record(struct voice_job *job, const struct wire_frame *frame);
void job_store(struct voice_job *job);       /* caches the complete sentence */
bool job_find_cached(struct voice_job *job); /* true: job->spoken holds the cached frames for job_replay */
void job_replay(struct voice_job *job);

void job_query_cluster(struct voice_job *job); /* asks other daemons first, if any, then begins the job */
void job_renew_claim(struct voice_job *job);   /* repeats the claim to them, rate limited */

void job_begin(struct voice_job *job); /* queues it for a worker, or rejects it */

/* worker.c */
enum { WORKER_RETIRE_MS = 10000 }; /* idle spares stop after this */
void worker_open(struct worker *worker, struct plugin *plugin);
void worker_close(struct worker *worker); /* its job fails with "cancelled" */

/* A remote worker appears or disappears; in the latter case its sentence fails. */
void worker_remote_up(struct worker *worker);
void worker_remote_down(struct worker *worker, const char *why);

void worker_take_next(struct worker *worker); /* starts the next sentence if it is idle */
void worker_cancel(struct worker *worker);    /* stops the current sentence */

/* remote_voice.c */
enum { REMOTE_PLUGINS_MAX = 64 }; /* until the pool is closed */
void remote_voices_open(struct voice_pool *pool);
void remote_voices_close(struct voice_pool *pool);

/* worker.c */
bool worker_is_stuck(const struct worker *worker);
void plugin_start_spare(struct plugin *plugin); /* unless another worker is idle or starting */

/* voice_catalog.c */
struct voice_list catalog_list(const struct catalog *catalog);
int catalog_add(struct catalog *catalog, const char *plugin, const char *description, struct error *e);

/* Voices of a plugin come and go; plugin is the pointer they were added with. */
struct voice_list catalog_of_plugin(struct catalog *catalog,
                                    const char *plugin); /* a copy of its current voices */
void catalog_drop(struct catalog *catalog, const char *plugin);
void catalog_restore(struct catalog *catalog, struct voice_list removed);
void catalog_free(struct catalog *catalog);

#endif
