/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The time until all plugins have started: what they will have decides which voice a request gets, so one
 * that comes meanwhile waits, but not for ever. */
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/voice/voice_pool_internal.h"
#include <stdlib.h>
#include <string.h>

enum { START_SECONDS = 30 };

struct voice_wait {
    struct voice_wait *next;
    struct voice_pool *pool;
    void (*changed)(void *ctx);
    void *ctx;
    bool due;
};

static void become_ready(struct voice_pool *pool) {
    bool speaks = catalog_list(&pool->catalog).count;
    if ((pool->is_ready && pool->speaks >= speaks) || pool->closing)
        return;
    pool->is_ready = true;
    pool->speaks = speaks;
    uv_timer_stop(&pool->start);
    plugins_log_absent(pool);
    if (pool->ready)
        pool->ready(pool->ready_ctx);
}

void pool_plugin_known(struct plugin *plugin) {
    struct voice_pool *pool = plugin->pool;
    bool all = true;
    for (struct voice_wait *w = pool->waits; w; w = w->next)
        w->due = true;
    if (pool->waits)
        pool_soon(pool);
    for (size_t i = 0; i < pool->plugin_count; i++)
        all = all && pool->plugins[i].known;
    if (all)
        become_ready(pool);
}

static void on_late(uv_timer_t *timer) {
    struct voice_pool *pool = timer->data;
    for (size_t i = 0; i < pool->plugin_count && !pool->closing; i++) {
        struct plugin *plugin = &pool->plugins[i];
        if (plugin->known)
            continue;
        log_warn("the voice %s takes long to start; it is done without until it comes", plugin->name);
        plugin->known = true;
        pool_plugin_known(plugin);
    }
}

void pool_start_open(struct voice_pool *pool, double seconds) {
    uv_timer_init(pool->loop, &pool->start);
    pool->start.data = pool;
    pool->open_handles++;
    uv_update_time(pool->loop); /* reading the models took a while */
    uv_timer_start(&pool->start, on_late, (uint64_t)((seconds > 0 ? seconds : START_SECONDS) * 1000) + 1, 0);
}

static void on_start_closed(uv_handle_t *handle) {
    pool_handle_closed(handle->data);
}

void pool_start_close(struct voice_pool *pool) {
    uv_close((uv_handle_t *)&pool->start, on_start_closed);
}

static bool is_known(const struct voice_pool *pool, const char *name, size_t length) {
    for (size_t i = 0; i < pool->plugin_count; i++)
        if (strlen(pool->plugins[i].name) == length && !strncmp(pool->plugins[i].name, name, length))
            return pool->plugins[i].known;
    return true; /* there is none */
}

/* Voices are in the order of their plugins: one that comes later is behind those whose plugins come before
 * it. */
static bool is_settled_name(const struct voice_pool *pool, const char *name) {
    const struct voice *voice = voice_by_name(catalog_list(&pool->catalog), name);
    const char *colon = strchr(name, ':');
    if (colon)
        return voice || is_known(pool, name, (size_t)(colon - name));
    bool all = true;
    for (size_t i = 0; i < pool->plugin_count && (!voice || strcmp(pool->plugins[i].name, voice->plugin) < 0);
         i++)
        all = all && pool->plugins[i].known;
    return all;
}

bool voice_pool_settled(const struct voice_pool *pool, const char *name, const char *const *preferred) {
    if (pool->is_ready)
        return true;
    if (name)
        return is_settled_name(pool, name);
    for (; preferred && *preferred; preferred++) {
        if (!is_settled_name(pool, *preferred))
            return false;
        if (voice_by_name(catalog_list(&pool->catalog), *preferred))
            return true;
    }
    return false;
}

struct voice_wait *voice_pool_wait(struct voice_pool *pool, void (*changed)(void *ctx), void *ctx) {
    struct voice_wait *wait = mem_alloc(sizeof *wait);
    *wait = (struct voice_wait){.next = pool->waits, .pool = pool, .changed = changed, .ctx = ctx};
    pool->waits = wait;
    return wait;
}

void voice_wait_end(struct voice_wait *wait) {
    if (!wait)
        return;
    struct voice_wait **at = &wait->pool->waits;
    while (*at != wait)
        at = &(*at)->next;
    *at = wait->next;
    free(wait);
}

/* A call may end any of them. */
void pool_call_waits(struct voice_pool *pool) {
    struct voice_wait *wait = pool->waits;
    while (wait && !pool->closing) {
        bool due = wait->due;
        wait->due = false;
        if (due)
            wait->changed(wait->ctx);
        wait = due ? pool->waits : wait->next;
    }
}
