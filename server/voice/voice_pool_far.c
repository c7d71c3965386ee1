/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Voices that workers on other machines speak: as plugins that come when the first worker announces them, and
 * go when the last one has gone. A plugin of the daemon's own of that name comes first, as long as it runs.
 */
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/voice/voice_pool_internal.h"
#include <stdlib.h>
#include <string.h>

/* A seat is no process here: so many sentences of this daemon's may be in the queue, for each plugin. */
enum { SEATS = 64 };

static bool runs_here(const struct voice_pool *pool, const char *name) {
    for (size_t i = 0; i < pool->plugin_count; i++) {
        const struct plugin *plugin = &pool->plugins[i];
        if (!plugin->queue && plugin->listed && plugin_runs(plugin) && !strcmp(plugin->name, name))
            return true;
    }
    return false;
}

static struct plugin *plugin_of_queue(struct voice_pool *pool, const struct work_source *source) {
    for (size_t i = 0; i < pool->plugin_count; i++) {
        struct plugin *plugin = &pool->plugins[i];
        if (plugin->queue && !strcmp(plugin->queue, source->queue) && !strcmp(plugin->name, source->plugin))
            return plugin;
    }
    if (pool->plugin_count == pool->plugin_cap)
        return NULL; /* the list stays where it is: workers point into it */
    struct plugin *plugin = &pool->plugins[pool->plugin_count++];
    *plugin = (struct plugin){.pool = pool,
                              .name = mem_strdup(source->plugin),
                              .queue = mem_strdup(source->queue),
                              .config = mem_strdup(source->queue), /* of the cache's key */
                              .description = mem_strdup(source->voices),
                              .worker_count = SEATS,
                              .seat_count = SEATS,
                              .known = true};
    plugin->workers = mem_alloc(SEATS * sizeof *plugin->workers);
    for (size_t i = 0; i < SEATS; i++)
        worker_open(&plugin->workers[i], plugin);
    return plugin;
}

static void come(struct plugin *plugin) {
    log_info("the voice %s is spoken by workers elsewhere", plugin->name);
    plugin->there = true;
    for (size_t i = 0; i < plugin->seat_count; i++)
        worker_begin(&plugin->workers[i]);
}

static void go(struct plugin *plugin) {
    static const char why[] = "has no worker any more";
    log_warn("the voice %s %s", plugin->name, why);
    plugin->there = plugin->listed = false;
    if (!plugin->aside.count)
        plugin->aside = catalog_aside(&plugin->pool->catalog, plugin->name);
    catalog_drop(&plugin->pool->catalog, plugin->name);
    for (size_t i = 0; i < plugin->seat_count; i++)
        worker_leave(&plugin->workers[i], why);
    queue_fail(&plugin->urgent, ERROR_VOICE_UNAVAILABLE, why);
    queue_fail(&plugin->waiting, ERROR_VOICE_UNAVAILABLE, why);
    queue_fail(&plugin->ahead, ERROR_VOICE_UNAVAILABLE, why);
}

static bool is_among(const struct plugin *plugin, const struct work_source *sources, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!strcmp(sources[i].queue, plugin->queue) && !strcmp(sources[i].plugin, plugin->name))
            return true;
    return false;
}

/* Of two kinds of voices under one name the one that was there first is the one that is heard. */
static bool is_taken(const struct voice_pool *pool, const char *name) {
    for (size_t i = 0; i < pool->plugin_count; i++)
        if (pool->plugins[i].there && !strcmp(pool->plugins[i].name, name))
            return true;
    return runs_here(pool, name);
}

static void on_seen(void *ctx, const struct work_source *sources, size_t count) {
    struct voice_pool *pool = ctx;
    if (pool->closing)
        return;
    for (size_t i = 0; i < pool->plugin_count; i++) {
        struct plugin *plugin = &pool->plugins[i];
        if (plugin->there && !is_among(plugin, sources, count))
            go(plugin);
    }
    for (size_t i = 0; i < count && pool->is_ready; i++) {
        if (is_taken(pool, sources[i].plugin))
            continue;
        struct plugin *plugin = plugin_of_queue(pool, &sources[i]);
        if (plugin)
            come(plugin);
    }
}

void pool_far_open(struct voice_pool *pool) {
    if (pool->work)
        work_watch(pool->work, on_seen, pool);
}

void pool_far_close(struct voice_pool *pool) {
    if (pool->work)
        work_watch(pool->work, NULL, NULL);
}
