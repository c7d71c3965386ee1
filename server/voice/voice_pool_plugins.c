/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The plugins that lie in a folder, and what they are confined by. */
#include "server/base/buf.h"
#include "server/base/etag.h"
#include "server/base/log.h"
#include "server/base/mem.h"
#include "server/voice/voice_pool_internal.h"
#include <dirent.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The plugin's own part of the configuration, as text. */
static char *config_of(const json_t *config, const char *name) {
    const json_t *own = json_object_get(config, name);
    char *text = json_is_object(own) ? json_dumps(own, JSON_COMPACT) : NULL;
    return text ? text : mem_strdup("{}");
}

static int by_name(const void *a, const void *b) {
    return strcmp(((const struct plugin *)a)->name, ((const struct plugin *)b)->name);
}

/* The same file has the same one on every machine. */
static void edition_of(const char *path, char edition[ETAG_BYTES]) {
    struct buf text = {0};
    FILE *file = fopen(path, "rb");
    size_t got = file != NULL;
    while (got) {
        got = fread(buf_reserve(&text, 65536), 1, 65536, file);
        text.size += got;
    }
    if (file)
        fclose(file);
    etag_of(text.data, text.size, edition);
    buf_free(&text);
}

int plugins_find(struct voice_pool *pool, const struct voice_pool_options *options, struct error *e) {
    DIR *folder = opendir(options->plugin_dir);
    json_t *config = json_loads(options->config ? options->config : "{}", 0, NULL);
    for (struct dirent *entry; folder && (entry = readdir(folder)) != NULL;) {
        const char *dot = strrchr(entry->d_name, '.');
        if (!dot || dot == entry->d_name || strcmp(dot, ".so") != 0)
            continue;
        pool->plugins =
            mem_grow(pool->plugins, &pool->plugin_cap, pool->plugin_count + 1, sizeof *pool->plugins);
        struct plugin *plugin = &pool->plugins[pool->plugin_count++];
        *plugin =
            (struct plugin){.pool = pool, .name = mem_strndup(entry->d_name, (size_t)(dot - entry->d_name))};
        plugin->config = config_of(config, plugin->name);
        plugin->path = mem_alloc(strlen(options->plugin_dir) + strlen(entry->d_name) + 2);
        sprintf(plugin->path, "%s/%s", options->plugin_dir, entry->d_name);
        edition_of(plugin->path, plugin->edition);
    }
    if (folder)
        closedir(folder);
    json_decref(config);
    if (!pool->plugin_count)
        return error_set(e, ERROR_VOICE_UNAVAILABLE, "no voice plugin in \"%s\"", options->plugin_dir);
    pool->plugins =
        mem_grow(pool->plugins, &pool->plugin_cap, pool->plugin_count + POOL_FAR_MOST, sizeof *pool->plugins);
    pool->plugin_cap = pool->plugin_count + POOL_FAR_MOST;
    qsort(pool->plugins, pool->plugin_count, sizeof *pool->plugins, by_name);
    return 0;
}

/* One line for all of them. */
void plugins_log_absent(const struct voice_pool *pool) {
    struct buf text = {0};
    for (size_t i = 0; i < pool->plugin_count; i++)
        if (pool->plugins[i].absence)
            buf_printf(&text, "%s%s: %s", text.size ? "; " : "", pool->plugins[i].name,
                       pool->plugins[i].absence);
    if (text.size && !pool->quiet)
        log_info("voices that are not there: %.*s", (int)text.size, (const char *)text.data);
    buf_free(&text);
}

/* The same for all workers, and told once. */
void plugins_tell_gaps(struct voice_pool *pool, const char *description) {
    if (pool->gaps_told || pool->unconfined || pool->quiet)
        return;
    json_t *root = json_loads(description, 0, NULL);
    const char *spaces = "", *files = "", *calls = "";
    json_unpack(root, "{s{ssssss}}", "gaps", "spaces", &spaces, "files", &files, "calls", &calls);
    pool->gaps_told = true;
    if (*calls || *files)
        log_warn("voice plugins are confined less than they could be: %s%s%s", calls,
                 *calls && *files ? ", " : "", files);
    if (*spaces)
        log_info("voice plugins run with %s", spaces);
    json_decref(root);
}

void plugins_free(struct voice_pool *pool) {
    for (size_t i = 0; i < pool->plugin_count; i++) {
        free(pool->plugins[i].name);
        free(pool->plugins[i].path);
        free(pool->plugins[i].config);
        free(pool->plugins[i].absence);
        free(pool->plugins[i].description);
        free(pool->plugins[i].queue);
        free(pool->plugins[i].workers);
    }
    free(pool->plugins);
}
