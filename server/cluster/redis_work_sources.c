/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/cluster/redis_work_sources.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/cluster/redis_work_link.h"
#include "server/cluster/redis_work_scripts.h"
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <utlist.h>

enum { NAME_MOST = 64, VOICES_MOST = 4 << 20, KNOWN_MOST = 256 };

struct known_voices {
    struct known_voices *next;
    char queue[NAME_MOST + 1], plugin[NAME_MOST + 1];
    char *voices; /* NULL: asked for */
    bool asked;
};

/* Both are names, and no more: they become part of others. */
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
        log_warn("cluster: workers have announced %d kinds of voices; further ones are left out", KNOWN_MOST);
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

void work_sources_read(struct work_sources *s, const redisReply *reply, struct redis_link *link, double *live,
                       double *ahead) {
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

void work_sources_free(struct work_sources *s) {
    struct known_voices *k, *next;
    LL_FOREACH_SAFE(s->known, k, next) {
        free(k->voices);
        free(k);
    }
    free(s->list);
    *s = (struct work_sources){0};
}
