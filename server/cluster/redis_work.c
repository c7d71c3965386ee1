/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The requesting side of the work queue: its sentences, the sources known, and its connections to Redis. */
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/cluster/redis_internal.h"
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <utlist.h>

/* ---- helpers of both sides ---- */

enum { WORDS_MOST = 12 };

bool redis_work_run(struct redis_link *link, const char *script, const struct link_text *more, int count,
                    link_answered answered, void *ctx) {
    struct link_text words[WORDS_MOST] = {link_text_of("EVAL"), link_text_of(script), link_text_of("1"),
                                          link_text_of(REDIS_WORK)};
    for (int i = 0; i < count; i++)
        words[4 + i] = more[i];
    return redis_link_send(link, words, 4 + count, answered, ctx);
}

struct redis_link *redis_work_link(uv_loop_t *loop, const char *address, const char *what,
                                   void (*changed)(void *ctx, bool up), void *ctx, struct error *e) {
    struct redis_address read;
    struct buf shown = {0};
    if (redis_address_read(address, &read, e))
        return NULL;
    buf_printf(&shown, "%s (%s)", read.shown, what);
    buf_add(&shown, "", 1);
    free(read.shown);
    read.shown = (char *)shown.data;
    return redis_link_open(loop, &read, changed, ctx);
}

bool redis_work_well(const redisReply *reply) {
    if (reply && reply->type == REDIS_REPLY_ERROR)
        log_warn("cluster: the work queue: %s", reply->str);
    return reply && reply->type != REDIS_REPLY_ERROR;
}

const char *redis_work_text(const redisReply *array, size_t index) {
    const redisReply *one =
        array->type == REDIS_REPLY_ARRAY && index < array->elements ? array->element[index] : NULL;
    return one && one->type == REDIS_REPLY_STRING ? one->str : "";
}

/* ---- the requesting side ---- */

/* The sources in Redis: a list with the length of each queue, and the voices of each source, which are
 * fetched once. */

struct known_voices;

/* All zero at the start. */
struct work_sources {
    struct work_source *list; /* sources whose voices are known */
    size_t count, cap;
    struct known_voices *known;
};

enum { NUMBER_BYTES = 16, TO_BYTES = 64 };

struct work_task {
    struct work *work;
    struct work_task *prev, *next;
    char name[WORK_TASK_BYTES]; /* "KEY ID"; "": Redis has not answered yet */
    work_answered answered;     /* NULL: cancelled */
    void *ctx;
    char attempt[WORK_ATTEMPT_BYTES]; /* attempt whose answer is arriving */
    unsigned pieces, missed;
    struct buf body;
    enum work_end failed; /* WORK_SPOKEN: not failed */
};

struct work {
    uv_loop_t *loop;
    struct redis_link *mouth, *ear; /* for commands; for answers */
    uv_timer_t look, soon;
    struct work_task *tasks;
    struct work_sources sources;
    work_seen seen;
    void *seen_ctx;
    char to[TO_BYTES], most[NUMBER_BYTES];
    unsigned lane;  /* of sentences without a quota key */
    uint64_t heard; /* loop time of the last list of sources */
    struct metrics *metrics;
    double live, ahead; /* last values added to the metrics */
    unsigned handles;
    bool listening; /* a read of answers is in flight */
    bool warned;    /* of a malformed answer, since the last look */
    bool closed;
};

enum { NAME_MOST = 64, VOICES_MOST = 4 << 20, KNOWN_MOST = 256 };

struct known_voices {
    struct known_voices *next;
    char queue[NAME_MOST + 1], plugin[NAME_MOST + 1];
    char *voices; /* NULL: not received yet */
    bool asked;
};

/* Accepts only plain names, since they become part of keys. */
static bool read_names(const char *member, char *queue, char *plugin) {
    int end = 0;
    if (sscanf(member, "%64[0-9a-f] %64[A-Za-z0-9_.-]%n", queue, plugin, &end) != 2 || member[end])
        return false;
    return isalnum((unsigned char)plugin[0]);
}

static void on_voices(void *ctx, const redisReply *reply) {
    struct known_voices *k = ctx;
    k->asked = false;
    if (reply && reply->type == REDIS_REPLY_STRING && (size_t)reply->len < VOICES_MOST &&
        strlen(reply->str) == (size_t)reply->len)
        k->voices = mem_strdup(reply->str);
}

static void ask_for(struct known_voices *k, struct redis_link *link) {
    char name[sizeof REDIS_WORK + 2 * NAME_MOST];
    if (k->asked)
        return;
    snprintf(name, sizeof name, REDIS_WORK ":voices:%s", k->queue);
    k->asked =
        redis_link_send(link, (struct link_text[]){link_text_of("GET"), link_text_of(name)}, 2, on_voices, k);
}

static struct known_voices *known(struct work_sources *s, const char *queue, const char *plugin) {
    struct known_voices *k;
    size_t count = 0;
    LL_FOREACH(s->known, k) {
        count++;
        if (!strcmp(k->queue, queue) && !strcmp(k->plugin, plugin))
            return k;
    }
    if (count >= KNOWN_MOST)
        return NULL;
    if (count == KNOWN_MOST - 1)
        log_warn("cluster: workers have announced %d voice plugins; ignoring the rest", KNOWN_MOST);
    k = mem_alloc(sizeof *k);
    snprintf(k->queue, sizeof k->queue, "%s", queue);
    snprintf(k->plugin, sizeof k->plugin, "%s", plugin);
    LL_APPEND(s->known, k);
    return k;
}

static double number(const redisReply *row, size_t index) {
    return index < row->elements && row->element[index]->type == REDIS_REPLY_INTEGER
               ? (double)row->element[index]->integer
               : 0;
}

/* Reads the first half of the reply to SCRIPT_WORK_LOOK, and fetches missing voices. Adds up the counts of
 * all queues. */
static void work_sources_read(struct work_sources *s, const redisReply *reply, struct redis_link *link,
                              double *live, double *ahead) {
    char queue[NAME_MOST + 1], plugin[NAME_MOST + 1];
    s->count = 0;
    for (size_t i = 0; reply->type == REDIS_REPLY_ARRAY && i < reply->elements; i++) {
        const redisReply *row = reply->element[i];
        if (row->type != REDIS_REPLY_ARRAY || !read_names(redis_work_text(row, 0), queue, plugin))
            continue;
        struct known_voices *k = known(s, queue, plugin);
        if (!k)
            continue;
        *live += number(row, 1);
        *ahead += number(row, 2);
        if (!k->voices) {
            ask_for(k, link);
            continue;
        }
        s->list = mem_grow(s->list, &s->cap, s->count + 1, sizeof *s->list);
        s->list[s->count++] = (struct work_source){k->queue, k->plugin, k->voices};
    }
}

/* Call after the link is closed. */
static void work_sources_free(struct work_sources *s) {
    struct known_voices *k, *next;
    LL_FOREACH_SAFE(s->known, k, next) {
        free(k->voices);
        free(k);
    }
    free(s->list);
    *s = (struct work_sources){0};
}

static const char *const why[WORK_ENDS] = {
    [WORK_UNREACHED] = "is unavailable: its workers cannot be reached",
    [WORK_FULL] = "is unavailable: its queue is full",
    [WORK_FAILED] = "lost the sentence in transit",
};

static void end_task(struct work_task *t, enum work_end end, const struct buf *body) {
    struct work *w = t->work;
    DL_DELETE(w->tasks, t);
    if (t->answered)
        t->answered(t->ctx, end, body);
    buf_free(&t->body);
    free(t);
}

static void fail_task(struct work_task *t, enum work_end end) {
    const struct buf body = {(uint8_t *)why[end], strlen(why[end]), 0};
    end_task(t, end, &body);
}

static void drop(struct work *w, const char *name) {
    const char *space = strchr(name, ' ');
    if (space)
        redis_work_run(w->mouth, SCRIPT_WORK_DROP,
                       (struct link_text[]){{name, (size_t)(space - name)}, link_text_of(space + 1)}, 2, NULL,
                       NULL);
}

/* Reports failures that occurred where no callback may be called, one per turn of the loop: a callback may
 * put another sentence. */
static void redis_tasks_on_soon(uv_timer_t *timer) {
    struct work *w = timer->data;
    struct work_task *due = NULL, *t, *next;
    DL_FOREACH_SAFE(w->tasks, t, next)
    if (t->failed) {
        due = t;
        break;
    }
    if (!due)
        return;
    uv_timer_start(&w->soon, redis_tasks_on_soon, 0, 0);
    fail_task(due, due->failed);
}

static void fail_soon(struct work_task *t, enum work_end end) {
    struct work *w = t->work;
    t->failed = end;
    if (!w->closed)
        uv_timer_start(&w->soon, redis_tasks_on_soon, 0, 0);
}

static void on_put(void *ctx, const redisReply *reply) {
    struct work_task *t = ctx;
    struct work *w = t->work;
    bool full = reply && reply->type == REDIS_REPLY_INTEGER,
         well = reply && reply->type == REDIS_REPLY_STRING && (size_t)reply->len < sizeof t->name;
    if (!full && !well)
        redis_work_well(reply);
    if (!t->answered) {
        if (well)
            drop(w, reply->str);
        free(t); /* it has left the list */
    } else if (well) {
        memcpy(t->name, reply->str, (size_t)reply->len + 1);
    } else {
        fail_soon(t, full ? WORK_FULL : WORK_UNREACHED);
    }
}

struct work_task *work_put(struct work *w, const char *queue, enum work_turn turn, uint32_t quota_key,
                           const struct buf *sentence, work_answered answered, void *ctx) {
    struct work_task *t = mem_alloc(sizeof *t);
    struct buf packed = {0};
    char number[NUMBER_BYTES], lane[NUMBER_BYTES];
    t->work = w;
    t->answered = answered;
    t->ctx = ctx;
    DL_APPEND(w->tasks, t);
    work_pack_sentence(sentence, &packed);
    snprintf(number, sizeof number, "%d", turn);
    snprintf(lane, sizeof lane, "%u", (quota_key ? quota_key : w->lane) % (unsigned)atoi(REDIS_WORK_LANES));
    const struct link_text more[] = {link_text_of(queue),        link_text_of(number), link_text_of(lane),
                                     {packed.data, packed.size}, link_text_of(w->to),  link_text_of(w->most)};
    if (!redis_work_run(w->mouth, SCRIPT_WORK_PUT, more, 6, on_put, t))
        fail_soon(t, WORK_UNREACHED);
    buf_free(&packed);
    return t;
}

void work_cancel(struct work_task *t) {
    if (!t)
        return;
    struct work *w = t->work;
    DL_DELETE(w->tasks, t);
    t->answered = NULL;
    buf_free(&t->body);
    if (!*t->name && !t->failed)
        return; /* on_put will drop it once it knows its name */
    drop(w, t->name);
    free(t);
}

static struct work_task *task_by_name(struct work *w, const char *name) {
    struct work_task *t;
    DL_FOREACH(w->tasks, t)
    if (*t->name && !strcmp(t->name, name))
        return t;
    return NULL;
}

static void redis_task_piece(struct work *w, const void *data, size_t size) {
    struct work_piece piece;
    if (!work_unpack_piece(data, size, &piece)) {
        if (!w->warned)
            log_warn("cluster: ignored an invalid reply");
        w->warned = true;
        return;
    }
    struct work_task *t = task_by_name(w, piece.task);
    if (!t || t->failed)
        return; /* it was cancelled */
    if (piece.index == 0) {
        memcpy(t->attempt, piece.attempt, sizeof t->attempt);
        t->body.size = t->pieces = 0;
    }
    if (strcmp(t->attempt, piece.attempt) != 0 || piece.index != t->pieces ||
        t->body.size + piece.size > WORK_BODY_MOST)
        return; /* from a worker that had lost the sentence; on_looked notices missing pieces */
    t->pieces++;
    t->missed = 0;
    buf_add(&t->body, piece.body, piece.size);
    if (piece.last)
        end_task(t, piece.end, &t->body);
}

/* Fails sentences whose entries were missing in two looks: their answers should have arrived by now. */
static void redis_tasks_miss(struct work *w, const redisReply *gone) {
    for (size_t i = 0; gone->type == REDIS_REPLY_ARRAY && i < gone->elements; i++) {
        struct work_task *t = task_by_name(w, redis_work_text(gone, i));
        if (t && !t->failed && ++t->missed > 1)
            fail_soon(t, WORK_FAILED);
    }
}

static void redis_tasks_fail(struct work *w) {
    struct work_task *t;
    DL_FOREACH(w->tasks, t)
    if (*t->name && !t->failed)
        fail_soon(t, WORK_UNREACHED);
}

static void listen_on(struct work *w);

static void on_heard(void *ctx, const redisReply *reply) {
    struct work *w = ctx;
    w->listening = false;
    if (!reply || w->closed)
        return;
    bool popped = reply->type == REDIS_REPLY_ARRAY && reply->elements == 2 &&
                  reply->element[1]->type == REDIS_REPLY_STRING;
    if (popped)
        redis_task_piece(w, reply->element[1]->str, (size_t)reply->element[1]->len);
    else
        redis_work_well(reply);
    /* after an error wait for the next look, or the loop would spin */
    if (popped || reply->type == REDIS_REPLY_NIL)
        listen_on(w);
}

static void listen_on(struct work *w) {
    char seconds[NUMBER_BYTES];
    snprintf(seconds, sizeof seconds, "0.%03d", WORK_LISTEN_MS);
    w->listening =
        w->listening ||
        redis_link_send(
            w->ear, (struct link_text[]){link_text_of("BLPOP"), link_text_of(w->to), link_text_of(seconds)},
            3, on_heard, w);
}

/* ---- sources ---- */

static void set_metrics(struct work *w, double live, double ahead) {
    metrics_add(w->metrics, METRIC_CLUSTER_QUEUE_LIVE, live - w->live);
    metrics_add(w->metrics, METRIC_CLUSTER_QUEUE_AHEAD, ahead - w->ahead);
    w->live = live;
    w->ahead = ahead;
}

static void tell(struct work *w) {
    if (w->seen)
        w->seen(w->seen_ctx, w->sources.list, w->sources.count);
}

static void on_looked(void *ctx, const redisReply *reply) {
    struct work *w = ctx;
    double live = 0, ahead = 0;
    if (!redis_work_well(reply) || w->closed || reply->type != REDIS_REPLY_ARRAY || reply->elements != 2)
        return;
    w->heard = uv_now(w->loop);
    work_sources_read(&w->sources, reply->element[0], w->mouth, &live, &ahead);
    set_metrics(w, live, ahead);
    redis_tasks_miss(w, reply->element[1]);
    tell(w);
}

static void on_look(uv_timer_t *timer) {
    struct work *w = timer->data;
    struct work_task *t;
    struct buf names = {0};
    w->warned = false;
    listen_on(w);
    DL_FOREACH(w->tasks, t)
    if (*t->name && !t->failed)
        buf_printf(&names, "%s ", t->name);
    /* without a link for answers, report no voices */
    bool sent = redis_link_up(w->ear) &&
                redis_work_run(w->mouth, SCRIPT_WORK_LOOK,
                               (struct link_text[]){{names.data ? names.data : (uint8_t *)"", names.size}}, 1,
                               on_looked, w);
    buf_free(&names);
    if (!sent && w->sources.count && uv_now(w->loop) > w->heard + WORK_ANNOUNCE_MS) {
        w->sources.count = 0;
        set_metrics(w, 0, 0);
        tell(w);
        redis_tasks_fail(w);
    }
}

static void look_now(struct work *w) {
    uv_timer_start(&w->look, on_look, 0, WORK_LOOK_MS);
}

static void on_mouth(void *ctx, bool up) {
    if (up)
        look_now(ctx);
    else
        redis_tasks_fail(ctx);
}

static void on_ear(void *ctx, bool up) {
    if (!up)
        return;
    listen_on(ctx);
    look_now(ctx);
}

void work_watch(struct work *w, work_seen seen, void *ctx) {
    w->seen = seen;
    w->seen_ctx = ctx;
}

static void on_closed(uv_handle_t *handle) {
    struct work *w = handle->data;
    if (--w->handles)
        return;
    work_sources_free(&w->sources);
    free(w);
}

/* The links are closed first, and answer what is still pending. */
void work_close(struct work *w) {
    if (!w)
        return;
    w->closed = true;
    w->seen = NULL;
    redis_link_close(w->mouth);
    redis_link_close(w->ear);
    uv_close((uv_handle_t *)&w->look, on_closed);
    uv_close((uv_handle_t *)&w->soon, on_closed);
}

struct work *work_open(uv_loop_t *loop, const struct work_options *options, struct error *e) {
    struct work *w = mem_alloc(sizeof *w);
    char id[REDIS_ID_BYTES];
    w->loop = loop;
    w->metrics = options->metrics;
    redis_id_make(id);
    snprintf(w->to, sizeof w->to, REDIS_WORK ":to:%s", id);
    w->lane = (unsigned)strtoul(id + REDIS_ID_BYTES - 9, NULL, 16);
    snprintf(w->most, sizeof w->most, "%u", options->most);
    w->mouth = redis_work_link(loop, options->address, "work", on_mouth, w, e);
    w->ear = w->mouth ? redis_work_link(loop, options->address, "answers", on_ear, w, e) : NULL;
    if (!w->ear) {
        free(w);
        return NULL;
    }
    uv_timer_init(loop, &w->look);
    uv_timer_init(loop, &w->soon);
    w->look.data = w->soon.data = w;
    w->handles = 2;
    uv_timer_start(&w->look, on_look, WORK_LOOK_MS, WORK_LOOK_MS);
    return w;
}
