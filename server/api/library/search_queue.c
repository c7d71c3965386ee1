/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/api/api_internal.h"
#include "server/base/mem.h"
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

/* Leaves about a ninth of a busy processor beside threads of normal priority. */
#define NICE 10

static struct queue_client *find(struct search_queue *queue, const char *key) {
    struct queue_client *a = queue->first;
    while (a && strcmp(a->key, key) != 0)
        a = a->next;
    if (a)
        return a;
    a = mem_alloc(sizeof *a);
    snprintf(a->key, sizeof a->key, "%s", key);
    a->next = queue->first;
    queue->first = a;
    return a;
}

static void leave(struct search_queue *queue, struct queue_client *client) {
    struct queue_client **at = &queue->first;
    if (client->questions)
        return;
    while (*at != client)
        at = &(*at)->next;
    *at = client->next;
    free(client);
}

int search_queue_add(struct search_queue *queue, uv_loop_t *loop, const char *key, struct coder_job *job,
                     struct queue_client **client, struct error *e) {
    if (!queue->pool)
        queue->pool = coder_pool_open(loop, SEARCHES_THREADS);
    const enum error_code full = queue->full ? queue->full : ERROR_TOO_MANY_SEARCHES;
    if (!queue->pool || queue->questions >= SEARCHES_MOST)
        return error_set(e, full, "the queue is full");
    struct queue_client *a = find(queue, key);
    if (a->questions >= (queue->questions < SEARCHES_ALL ? SEARCHES_EACH : SEARCHES_FEW))
        return error_set(e, full, "%u of your requests are already queued", a->questions);
    a->questions++;
    queue->questions++;
    *client = a;
    coder_pool_submit(queue->pool, &a->line, job);
    return 0;
}

void search_queue_done(struct search_queue *queue, struct queue_client *client) {
    client->questions--;
    queue->questions--;
    leave(queue, client);
}

void search_queue_lower_priority(void) {
    setpriority(PRIO_PROCESS, 0, NICE); /* on Linux, of the calling thread only */
}

void search_queue_close(struct search_queue *queue) {
    coder_pool_close(queue->pool);
    queue->pool = NULL;
}
