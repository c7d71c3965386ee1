/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Who asks something of the library, or saves something: each in a line of his own, and the lines take turns,
 * so that nobody waits for all that another has asked. What is asked is answered in threads of lower priority
 * than those that speak. */
#ifndef FACCIA_API_SEARCH_QUEUE_H
#define FACCIA_API_SEARCH_QUEUE_H

#include "server/base/error.h"
#include "server/codec/coder_pool.h"

enum {
    SEARCHES_THREADS = 2, /* answer */
    SEARCHES_EACH = 64,   /* questions of one asker that may wait or be answered */
    SEARCHES_ALL = 512,   /* of all: beyond that, SEARCHES_FEW of one */
    SEARCHES_FEW = 4,
    SEARCHES_MOST = 2048, /* and nobody */
};

/* One of them. */
struct asker {
    struct coder_line line;
    struct asker *next;
    char key[80]; /* see struct principal */
    unsigned questions;
};

/* Zeroed at first. */
struct search_queue {
    struct coder_pool *pool; /* NULL: nobody has asked yet */
    struct asker *first;
    unsigned questions;
    enum error_code full; /* too many wait; ERROR_NONE: of the library */
};

/* Puts the question into the line of who has that key: he is told in *asker, and stays until
 * search_queue_done, which job->done has to call. -1 with *e (full, or "too-many-searches"): too many wait.
 */
int search_queue_add(struct search_queue *queue, uv_loop_t *loop, const char *key, struct coder_job *job,
                     struct asker **asker, struct error *e);
void search_queue_done(struct search_queue *queue, struct asker *asker);

/* For job->work: the thread is one of lower priority from now on. */
void search_queue_lower_priority(void);

/* Waits for what is being answered; the others are done, too, as cancelled. */
void search_queue_close(struct search_queue *queue);

#endif
