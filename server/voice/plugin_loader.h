/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loads the plugin of a worker process, and reads from its configuration which files the operator lets it
 * use. */
#ifndef FACCIA_VOICE_PLUGIN_LOADER_H
#define FACCIA_VOICE_PLUGIN_LOADER_H

#include "server/voice/faccia-voice.h"
#include "server/voice/sandbox.h"

struct allowed_paths {
    struct sandbox_path *paths;
    size_t count, cap;
    char *config; /* the configuration without "may_read" and "may_write" */
};

/* Allows every absolute path in the configuration. A folder is allowed with its contents, also for
 * writing. A file allows its folder, because programs and models have other files beside them; but in /,
 * /etc, /tmp, /var/tmp, /run and the home folder only the file itself. The members "may_read" and
 * "may_write" list further paths and are removed. Returns -1 with a message. */
int allowed_paths_read(struct allowed_paths *allowed, const char *config, char *message, size_t cap);

/* Allows reading the language packs, wherever they are installed. */
void allowed_paths_add_packs(struct allowed_paths *allowed);

void allowed_paths_free(struct allowed_paths *allowed);

struct loaded_plugin {
    const char *path; /* of the shared object */
    void *library;
    const struct faccia_voice *api;
    uint32_t capabilities;    /* the plugin's, including what an old version could not declare */
    struct sandbox_gaps gaps; /* sandbox layers that could not be set up */
    void *self;
};

/* Loads the shared object, which runs its initialisers, and checks its table, which must not need more
 * than the given capabilities. Returns -1 with a message for users. */
int loaded_plugin_load(struct loaded_plugin *loaded, const char *path, uint32_t capabilities, char *message,
                       size_t cap);

/* Opens the plugin. Returns 1 when it has nothing to run here, -1 when it failed, both with a message for
 * users. */
int loaded_plugin_open(struct loaded_plugin *loaded, const char *config, char *message, size_t cap);
void loaded_plugin_close(struct loaded_plugin *loaded);

/* The plugin and its voices as JSON:
 * {"name","version","licence","capabilities","voices":[{"id","name","lang","gender","quality",
 * "licence","sample_rate","rate"}],"gaps":{"spaces","files","calls"}}. The caller frees it. */
char *loaded_plugin_describe(const struct loaded_plugin *loaded);

#endif
