/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The plugin inside a worker process. */
#ifndef FACCIA_VOICE_PLUGIN_LOADER_H
#define FACCIA_VOICE_PLUGIN_LOADER_H

#include "server/voice/faccia-voice.h"
#include "server/voice/sandbox.h"

struct loaded_plugin {
    const char *path; /* of the shared object */
    void *library;
    const struct faccia_voice *api;
    uint32_t capabilities;    /* the plugin's, and for an old one what it could not say */
    struct sandbox_gaps gaps; /* what it could not be confined by */
    void *self;
};

/* Loads the shared object, whose initialisers run, and looks at its table, which may need no more than those
 * capabilities. -1 with a sentence for people in message. */
int loaded_plugin_load(struct loaded_plugin *loaded, const char *path, uint32_t capabilities, char *message,
                       size_t cap);

/* Opens the plugin. With a sentence for people in message: 1 when it has nothing to run here, -1 when it
 * failed. */
int loaded_plugin_open(struct loaded_plugin *loaded, const char *config, char *message, size_t cap);
void loaded_plugin_close(struct loaded_plugin *loaded);

/* The plugin and its voices as JSON:
 * {"name","version","licence","capabilities","voices":[{"id","name","lang","gender","quality",
 * "licence","sample_rate","rate"}],"gaps":{"spaces","files","calls"}}. The caller frees it. */
char *loaded_plugin_describe(const struct loaded_plugin *loaded);

#endif
