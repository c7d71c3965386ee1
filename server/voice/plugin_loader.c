/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "server/voice/plugin_loader.h"
#include "server/base/mem.h"
#include "server/voice/plugin_needs.h"
#include <dlfcn.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int fail(char *message, size_t cap, const char *path, const char *why) {
    snprintf(message, cap, "%s: %s", path, why);
    return -1;
}

/* Is the table one that this host can use? A newer plugin's table may be longer. */
static const char *complaint(const struct faccia_voice *api, char *out, size_t cap) {
    if (api->abi < FACCIA_VOICE_ABI_OLDEST || api->abi > FACCIA_VOICE_ABI) {
        snprintf(out, cap,
                 "the plugin is built for version %u of the voice interface, this program has version %u",
                 api->abi, FACCIA_VOICE_ABI);
        return out;
    }
    if (api->size < sizeof *api) {
        snprintf(out, cap, "the plugin's table has %u bytes, %zu are needed", api->size, sizeof *api);
        return out;
    }
    if (!api->name || !api->version || !api->licence || !api->open || !api->list || !api->speak ||
        !api->close)
        return "the plugin's table has gaps";
    return NULL;
}

int loaded_plugin_load(struct loaded_plugin *loaded, const char *path, uint32_t capabilities, char *message,
                       size_t cap) {
    enum { NEEDS = FACCIA_VOICE_NETWORK | FACCIA_VOICE_PROGRAMS | FACCIA_VOICE_FILES };
    char why[160];
    loaded->path = path;
    loaded->library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!loaded->library) {
        const char *error = dlerror();
        snprintf(message, cap, "%s", error ? error : path);
        return -1;
    }
    loaded->api = dlsym(loaded->library, FACCIA_VOICE_SYMBOL);
    if (!loaded->api)
        return fail(message, cap, path, "no voice plugin: it does not export \"" FACCIA_VOICE_SYMBOL "\"");
    const char *bad = complaint(loaded->api, why, sizeof why);
    if (bad)
        return fail(message, cap, path, bad);
    loaded->capabilities = needs_stated(loaded->api->abi, loaded->api->capabilities);
    if (loaded->capabilities & NEEDS & ~capabilities)
        return fail(message, cap, path,
                    "the plugin's table is not what its file says: it must be a constant");
    return 0;
}

int loaded_plugin_open(struct loaded_plugin *loaded, const char *config, char *message, size_t cap) {
    *message = '\0';
    int result = loaded->api->open(config, &loaded->self, message, cap);
    message[cap - 1] = '\0';
    if (result && !*message)
        return fail(message, cap, loaded->path, "the plugin did not start");
    return result > 0 ? 1 : result ? -1 : 0;
}

void loaded_plugin_close(struct loaded_plugin *loaded) {
    loaded->api->close(loaded->self);
    /* the library stays: the process is about to end, and a leak report can still name it */
    *loaded = (struct loaded_plugin){0};
}

static json_t *text(const char *s) {
    json_t *string = json_string(s ? s : "");
    return string ? string : json_string(""); /* not UTF-8 */
}

static void add_voice(void *ctx, const struct faccia_voice_info *voice) {
    if (!voice || !voice->id || !*voice->id)
        return;
    json_array_append_new(ctx, json_pack("{so so so so so so sI sI}", "id", text(voice->id), "name",
                                         text(voice->name), "lang", text(voice->lang), "gender",
                                         text(voice->gender), "quality", text(voice->quality), "licence",
                                         text(voice->licence), "sample_rate", (json_int_t)voice->sample_rate,
                                         "rate", (json_int_t)voice->rate));
}

char *loaded_plugin_describe(const struct loaded_plugin *loaded) {
    json_t *voices = json_array();
    loaded->api->list(loaded->self, add_voice, voices);
    json_t *root = json_pack("{so so so sI so s{so so so}}", "name", text(loaded->api->name), "version",
                             text(loaded->api->version), "licence", text(loaded->api->licence),
                             "capabilities", (json_int_t)loaded->capabilities, "voices", voices, "gaps",
                             "spaces", text(loaded->gaps.spaces), "files", text(loaded->gaps.files), "calls",
                             text(loaded->gaps.calls));
    char *dump = json_dumps(root, JSON_COMPACT);
    json_decref(root);
    return dump ? dump : mem_strdup("{}");
}
