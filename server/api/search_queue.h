/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Queues jobs that search the library or save documents. Each client has its own line, and the lines take
 * turns, so that no client waits for all the jobs of another. The jobs run in threads of lower priority
 * than speech. */
#ifndef FACCIA_API_SEARCH_QUEUE_H
#define FACCIA_API_SEARCH_QUEUE_H

#include "server/base/error.h"
#include "server/codec/coder_pool.h"

enum {
    SEARCHES_THREADS = 2, /* worker threads */
    SEARCHES_EACH = 64,   /* jobs of one client, waiting or running */
    SEARCHES_ALL = 512,   /* jobs in total, above which a client may have only SEARCHES_FEW */
    SEARCHES_FEW = 4,
    SEARCHES_MOST = 2048, /* jobs in total, above which all are refused */
};

/* A client with jobs in the queue. */
struct queue_client {
    struct coder_line line;
    struct queue_client *next;
    char key[80]; /* see struct principal */
    unsigned questions;
};

/* Initialise with zeros. */
struct search_queue {
    struct coder_pool *pool; /* NULL until the first job */
    struct queue_client *first;
    unsigned questions;
    enum error_code full; /* error when the queue is full; ERROR_NONE: "too-many-searches" */
};

/* Queues the job under the client with that key. *client is the client, valid until search_queue_done,
 * which job->done must call. -1 with *e (full, or "too-many-searches") if too many jobs wait. */
int search_queue_add(struct search_queue *queue, uv_loop_t *loop, const char *key, struct coder_job *job,
                     struct queue_client **client, struct error *e);
void search_queue_done(struct search_queue *queue, struct queue_client *client);

/* Lowers the priority of the calling thread for good. Call it from job->work. */
void search_queue_lower_priority(void);

/* Waits for the running jobs; the waiting ones are completed as cancelled. */
void search_queue_close(struct search_queue *queue);

#endif
