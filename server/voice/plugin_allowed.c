/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/plugin_allowed.h"
#include "server/base/mem.h"
#include "server/base/paths.h"
#include <jansson.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static void add(struct allowed *a, char *path, bool write) {
    a->paths = mem_grow(a->paths, &a->cap, a->count + 1, sizeof *a->paths);
    a->paths[a->count++] = (struct sandbox_path){path, write};
}

/* Folders in which files of all kinds lie. */
static bool is_common(const char *folder) {
    static const char *const common[] = {"", "/etc", "/tmp", "/var/tmp", "/run"};
    const char *home = getenv("HOME");
    for (size_t i = 0; i < sizeof common / sizeof *common; i++)
        if (!strcmp(folder, common[i]))
            return true;
    return home && !strcmp(folder, home);
}

static void add_named(struct allowed *a, const char *path) {
    struct stat file;
    if (*path != '/' || stat(path, &file))
        return;
    add(a, mem_strdup(path), S_ISDIR(file.st_mode));
    char *folder = mem_strndup(path, (size_t)(strrchr(path, '/') - path));
    if (S_ISDIR(file.st_mode) || is_common(folder))
        free(folder);
    else
        add(a, folder, false);
}

static void add_all_named(struct allowed *a, const json_t *value) {
    const char *key;
    json_t *part;
    size_t i;
    if (json_is_string(value))
        add_named(a, json_string_value(value));
    json_object_foreach((json_t *)value, key, part) add_all_named(a, part);
    json_array_foreach(value, i, part) add_all_named(a, part);
}

static int add_listed(struct allowed *a, const json_t *config, const char *member, bool write, char *message,
                      size_t cap) {
    const json_t *list = json_object_get(config, member);
    json_t *path;
    size_t i;
    if (list && !json_is_array(list)) {
        snprintf(message, cap, "%s: wanted is a list of absolute paths", member);
        return -1;
    }
    json_array_foreach(list, i, path) {
        const char *text = json_string_value(path);
        if (!text || *text != '/') {
            snprintf(message, cap, "%s[%zu]: wanted is an absolute path", member, i);
            return -1;
        }
        add(a, mem_strdup(text), write);
    }
    return 0;
}

int allowed_read(struct allowed *allowed, const char *config, char *message, size_t cap) {
    json_t *root = json_loads(config, 0, NULL);
    *allowed = (struct allowed){0};
    int result = add_listed(allowed, root, "may_read", false, message, cap);
    if (!result)
        result = add_listed(allowed, root, "may_write", true, message, cap);
    json_object_del(root, "may_read");
    json_object_del(root, "may_write");
    add_all_named(allowed, root);
    char *rest = json_dumps(root, JSON_COMPACT);
    allowed->config = rest ? rest : mem_strdup("{}");
    json_decref(root);
    return result;
}

void allowed_add_packs(struct allowed *allowed) {
    struct paths paths;
    char folder[PATH_MAX];
    paths_find(&paths);
    if (*paths.models && (size_t)snprintf(folder, sizeof folder, "%s/speech", paths.models) < sizeof folder)
        add(allowed, mem_strdup(folder), false);
    paths_free(&paths);
}

void allowed_free(struct allowed *allowed) {
    for (size_t i = 0; i < allowed->count; i++)
        free((char *)allowed->paths[i].path);
    free(allowed->paths);
    free(allowed->config);
    *allowed = (struct allowed){0};
}
