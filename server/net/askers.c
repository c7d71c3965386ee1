/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/net/askers.h"
#include "server/base/mem.h"
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

/* A ninth of a busy processor's time beside threads that have not stepped back. */
#define NICE 10

static struct asker *find(struct askers *askers, const char *key) {
    struct asker *a = askers->first;
    while (a && strcmp(a->key, key) != 0)
        a = a->next;
    if (a)
        return a;
    a = mem_alloc(sizeof *a);
    snprintf(a->key, sizeof a->key, "%s", key);
    a->next = askers->first;
    askers->first = a;
    return a;
}

static void leave(struct askers *askers, struct asker *asker) {
    struct asker **at = &askers->first;
    if (asker->questions)
        return;
    while (*at != asker)
        at = &(*at)->next;
    *at = asker->next;
    free(asker);
}

int askers_ask(struct askers *askers, uv_loop_t *loop, const char *key, struct coder_job *job,
               struct asker **asker, struct error *e) {
    if (!askers->pool)
        askers->pool = coder_pool_open(loop, ASKERS_THREADS);
    const enum error_code full = askers->full ? askers->full : ERROR_TOO_MANY_SEARCHES;
    if (!askers->pool || askers->questions >= ASKERS_MOST)
        return error_set(e, full, "too many wait already");
    struct asker *a = find(askers, key);
    if (a->questions >= (askers->questions < ASKERS_ALL ? ASKERS_EACH : ASKERS_FEW))
        return error_set(e, full, "%u of yours wait already", a->questions);
    a->questions++;
    askers->questions++;
    *asker = a;
    coder_pool_submit(askers->pool, &a->line, job);
    return 0;
}

void askers_answered(struct askers *askers, struct asker *asker) {
    asker->questions--;
    askers->questions--;
    leave(askers, asker);
}

void askers_step_back(void) {
    setpriority(PRIO_PROCESS, 0, NICE); /* of the calling thread alone, on Linux */
}

void askers_close(struct askers *askers) {
    coder_pool_close(askers->pool);
    askers->pool = NULL;
}
