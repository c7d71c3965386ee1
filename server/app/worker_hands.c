/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/app/worker_hands.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/cluster/redis_names.h"
#include "server/cluster/work_pack.h"
#include <jansson.h>
#include <stdlib.h>
#include <string.h>

enum { PLUGINS_MOST = 64 };

/* A plugin's voices, with how many of its sentences are being spoken. */
struct hand {
    size_t plugin; /* the pool's */
    char queue[REDIS_HASH_BYTES];
    char *voices;
    unsigned live, ahead;
};

struct worker_hands {
    struct voice_pool *pool;
    struct work_hands *hands;
    struct hand list[PLUGINS_MOST];
    size_t count;
    struct work_offer offers[PLUGINS_MOST];
    bool ended;
};

struct sentence {
    struct worker_hands *w;
    struct work_item *item;
    struct hand *hand;
    struct voice_job *job;
    struct buf frames;
    bool whole; /* frames are all that was said */
};

/* Without what is this machine's own affair. */
static char *voices_of(const struct voice_plugin *plugin) {
    json_t *root = json_loads(plugin->description, 0, NULL);
    json_object_del(root, "gaps");
    char *text = json_dumps(root, JSON_COMPACT | JSON_SORT_KEYS);
    json_decref(root);
    return text ? text : mem_strdup("");
}

/* The same of all machines on which the same file, told the same, has the same voices. What it was told stays
 * here, as there may be secrets in it. */
static void name_queue(struct hand *hand, const struct voice_plugin *plugin) {
    char form[WORK_FORM_BYTES + 1];
    struct buf key = {0};
    work_form(form);
    buf_printf(&key, "%s\n%s\n%s\n%s\n%s", form, plugin->name, plugin->edition, plugin->config, hand->voices);
    redis_hash_of(&key, hand->queue);
    buf_free(&key);
}

static struct hand *hand_of(struct worker_hands *w, size_t index, const struct voice_plugin *plugin) {
    for (size_t i = 0; i < w->count; i++)
        if (w->list[i].plugin == index)
            return &w->list[i];
    if (w->count == PLUGINS_MOST)
        return NULL;
    struct hand *hand = &w->list[w->count++];
    hand->plugin = index;
    hand->voices = voices_of(plugin);
    name_queue(hand, plugin);
    log_info("speaks for others: the voice %s", plugin->name);
    return hand;
}

static size_t offers(void *ctx, const struct work_offer **out) {
    struct worker_hands *w = ctx;
    struct voice_plugin plugin;
    size_t count = 0;
    *out = w->offers;
    for (size_t i = 0; w->pool && !w->ended && voice_pool_plugin(w->pool, i, &plugin); i++) {
        struct hand *hand = plugin.runs && plugin.description ? hand_of(w, i, &plugin) : NULL;
        if (!hand)
            continue;
        unsigned all = hand->live + hand->ahead;
        w->offers[count++] = (struct work_offer){
            .source = {hand->queue, plugin.name, hand->voices},
            .live = plugin.seats > hand->live ? plugin.seats - hand->live : 0, /* those ahead give way */
            .ahead = plugin.seats > all ? plugin.seats - all : 0,
        };
    }
    return count;
}

static unsigned *count_of(struct sentence *s) {
    return s->item->turn == WORK_AHEAD ? &s->hand->ahead : &s->hand->live;
}

static void forget(struct sentence *s) {
    buf_free(&s->frames);
    free(s);
}

static void on_frames(void *ctx, const struct buf *frames) {
    struct sentence *s = ctx;
    s->whole = true;
    buf_add(&s->frames, frames->data, frames->size);
}

static void end(struct sentence *s, enum work_end how, const char *why) {
    struct worker_hands *w = s->w;
    const struct buf text = {(uint8_t *)why, why ? strlen(why) : 0, 0};
    --*count_of(s);
    work_answer(s->item, how, why ? &text : &s->frames);
    forget(s);
    work_hands_look(w->hands);
}

static void on_done(void *ctx, struct sentence_audio *audio) {
    struct sentence *s = ctx;
    sentence_audio_free(audio);
    if (s->whole)
        end(s, WORK_SPOKEN, NULL);
    else
        end(s, WORK_FAILED, "said more than can be sent");
}

/* It gave way to somebody who is heard, or this worker ends: another speaks it. */
static void on_failed(void *ctx, const struct error *e) {
    struct sentence *s = ctx;
    if (e->code != ERROR_CANCELLED) {
        end(s,
            e->code == ERROR_VOICE_CRASHED   ? WORK_CRASHED
            : e->code == ERROR_VOICE_TIMEOUT ? WORK_TIMEOUT
                                             : WORK_FAILED,
            e->message);
        return;
    }
    --*count_of(s);
    work_give_back(s->item);
    forget(s);
}

static void on_taken(void *ctx, struct work_item *item) {
    static const struct voice_callbacks callbacks = {on_done, on_failed};
    static const enum voice_priority turns[WORK_TURNS] = {VOICE_PRIORITY_URGENT, VOICE_PRIORITY_NORMAL,
                                                          VOICE_PRIORITY_BACKGROUND};
    struct worker_hands *w = ctx;
    struct error e;
    struct sentence *s = mem_alloc(sizeof *s);
    s->w = w;
    s->item = item;
    item->mine = s;
    for (size_t i = 0; i < w->count; i++)
        if (!strcmp(w->list[i].queue, item->queue))
            s->hand = &w->list[i];
    ++*count_of(s);
    s->job = voice_pool_speak_frames(w->pool, s->hand->plugin, &item->sentence, turns[item->turn], on_frames,
                                     &callbacks, s, &e);
    if (s->job)
        return;
    log_warn("cluster: an entry of the queue cannot be spoken: %s", e.message);
    end(s, WORK_FAILED, e.message);
}

static void on_lost(void *ctx, struct work_item *item) {
    struct sentence *s = item->mine;
    (void)ctx;
    log_info("a sentence is another worker's by now, or nobody waits for it");
    voice_job_cancel(s->job);
    --*count_of(s);
    forget(s);
}

const struct work_hands_events worker_hands_events = {offers, on_taken, on_lost};

struct worker_hands *worker_hands_new(void) {
    return mem_alloc(sizeof(struct worker_hands));
}

void worker_hands_free(struct worker_hands *w) {
    for (size_t i = 0; w && i < w->count; i++)
        free(w->list[i].voices);
    free(w);
}

void worker_hands_begin(struct worker_hands *w, struct voice_pool *pool, struct work_hands *hands) {
    w->pool = pool;
    w->hands = hands;
}

void worker_hands_end(struct worker_hands *w) {
    w->ended = true;
}

size_t worker_hands_busy(const struct worker_hands *w) {
    size_t busy = 0;
    for (size_t i = 0; i < w->count; i++)
        busy += w->list[i].live + w->list[i].ahead;
    return busy;
}
