/* SPDX-License-Identifier: GPL-3.0-or-later */
/* POST /v1/coach: compares a recording, the body, with the text that the address names, as a voice speaks it.
 * The voice speaks first, then a thread of low priority decodes (in a process of its own) and compares.
 * Nothing is stored. */
#include "server/api/api_internal.h"
#include "server/api/commands.h"
#include "server/base/mem.h"
#include "server/coach/coach.h"
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    SECOND_BYTES = 48000 * 2 * 4, /* of a recording: 48 kHz, two channels of 32 bits */
    HEADER_BYTES = 64 << 10,
    EACH = 2,  /* recordings of one client, waiting or being compared */
    MOST = 32, /* in total */
};

static const char *const more_members[] = {"text", NULL};
const struct members coach_members = {.speech = true, .more = more_members};

/* One request. Owned by its exchange, and by the thread while the job runs. */
struct coaching {
    struct coder_job job;
    struct coaching *next;       /* of all */
    struct queue_client *client; /* NULL: no job is queued or running */
    struct api *api;
    struct exchange *x;   /* NULL: the client is gone */
    atomic_bool given_up; /* the same, for the thread */
    char key[80];         /* of its client, see struct principal */
    int fd;               /* the recording; -1: none, or the thread has it */
    struct coach_model *model;
    json_t *answer; /* NULL: the comparison failed */
    struct error error;
};

static void free_coaching(struct coaching *c) {
    struct coaching **at = &c->api->coachings;
    while (*at != c)
        at = &(*at)->next;
    *at = c->next;
    if (c->fd >= 0)
        close(c->fd);
    coach_model_free(c->model);
    json_decref(c->answer);
    free(c);
}

static int take_place(struct api *api, const char *key, struct error *e) {
    unsigned all = 0, own = 0;
    for (const struct coaching *c = api->coachings; c; c = c->next) {
        all++;
        own += !strcmp(c->key, key);
    }
    if (all < MOST && own < EACH)
        return 0;
    return error_set(e, ERROR_QUEUE_FULL, "%u recordings%s are being compared", own < EACH ? all : own,
                     own < EACH ? "" : " of yours");
}

/* The comparison */

static void in_thread(struct coder_job *job) {
    struct coaching *c = (struct coaching *)job;
    const struct coach_options options = {.network = c->api->pipeline->hearing,
                                          .reader = c->api->pipeline->reader,
                                          .seconds = c->api->options.coach_seconds,
                                          .given_up = &c->given_up};
    search_queue_lower_priority();
    c->answer = coach_compare(c->model, c->fd, &options, &c->error);
    c->fd = -1;
}

static void done(struct coder_job *job) {
    struct coaching *c = (struct coaching *)job;
    search_queue_done(&c->api->coaches, c->client);
    c->client = NULL;
    if (job->cancelled)
        error_plain(&c->error, ERROR_CANCELLED);
    if (!c->x) {
        free_coaching(c);
    } else if (c->answer) {
        json_t *answer = c->answer;
        c->answer = NULL;
        exchange_json(c->x, 200, answer);
    } else {
        exchange_error(c->x, &c->error);
    }
}

static bool is_left(struct coder_job *job) {
    return !((struct coaching *)job)->x;
}

static void leave(void *self) {
    struct coaching *c = self;
    c->x = NULL;
    atomic_store(&c->given_up, true);
    if (c->client) /* done() frees it */
        coder_pool_cancel(c->api->coaches.pool, &c->client->line, is_left);
    else
        free_coaching(c);
}

static void on_spoken(void *ctx, const struct error *failed) {
    struct coaching *c = ctx;
    struct error e;
    c->job.work = in_thread;
    c->job.done = done;
    c->api->coaches.full = ERROR_QUEUE_FULL;
    if (failed)
        exchange_error(c->x, failed);
    else if (search_queue_add(&c->api->coaches, c->api->pipeline->loop, c->key, &c->job, &c->client, &e))
        exchange_error(c->x, &e);
}

/* The request */

static int read_request(struct coaching *c, struct speech_request *request, struct error *e) {
    const struct http_request *from = exchange_request(c->x);
    const struct buf *body = exchange_body(c->x);
    struct command_call call = {.api = c->api, .request = request};
    size_t i = 0;
    if (request_from_query(request, from, "text", e))
        return -1;
    while (i < from->member_count && strcmp(from->members[i].name, "text") != 0)
        i++;
    if (i < from->member_count) {
        const struct request_value text = {REQUEST_STRING, from->members[i].value, from->members[i].size, 0};
        if (request_set(request, "text", text, e))
            return -1;
    } else if (!request->passage) {
        return error_plain_in_field(e, ERROR_MISSING_FIELD, "text");
    }
    if (command_admit(&call, exchange_principal(c->x), e))
        return -1;
    if (request->open)
        return error_in_field(e, ERROR_BAD_FIELD, "open", "a recording is compared with a whole text");
    c->fd = reader_input(body->data, body->size);
    exchange_drop_body(c->x);
    return c->fd < 0 ? error_set(e, ERROR_BAD_SOUND, "there is no memory for it") : 0;
}

static int on_body_end(void *self) {
    struct coaching *c = self;
    struct speech_request request;
    struct error e;
    request_init(&request);
    if (!read_request(c, &request, &e))
        c->model =
            coach_model_new(c->api->pipeline, &request, c->api->options.coach_seconds, on_spoken, c, &e);
    request_free(&request);
    return c->model ? 0 : exchange_error(c->x, &e);
}

int coach_ask(struct exchange *x) {
    struct api *api = exchange_api(x);
    const char *key = exchange_principal(x)->key;
    struct error e;
    if (!api->options.coach_seconds || !api->pipeline->hearing) {
        error_set(&e, ERROR_NO_COACH,
                  api->options.coach_seconds ? "it has no models/hear/network.bin"
                                             : "it compares none (--coach-seconds 0)");
        return exchange_error(x, &e);
    }
    if (take_place(api, key, &e))
        return exchange_error(x, &e);
    struct coaching *c = mem_alloc(sizeof *c);
    c->api = api;
    c->x = x;
    c->fd = -1;
    snprintf(c->key, sizeof c->key, "%s", key);
    c->next = api->coachings;
    api->coachings = c;
    exchange_set_work(
        x, (struct exchange_work){.body_end = on_body_end, .free = leave, .self = c, .costly = true});
    exchange_expect_body(x, api->options.coach_seconds * (size_t)SECOND_BYTES + HEADER_BYTES,
                         ERROR_MEDIA_TOO_LARGE);
    return 0;
}
