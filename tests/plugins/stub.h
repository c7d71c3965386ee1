/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Table entries for plugins that do not speak. */
#ifndef FACCIA_TESTS_PLUGINS_STUB_H
#define FACCIA_TESTS_PLUGINS_STUB_H

#include "server/voice/faccia-voice.h"

static int stub_open(const char *config, void **self, char *message, size_t cap);

static void stub_list(void *self, void (*each)(void *ctx, const struct faccia_voice_info *voice), void *ctx) {
    (void)self;
    each(ctx, &(struct faccia_voice_info){.id = "never", .lang = "it", .sample_rate = 16000});
}

static int stub_speak(void *self, const struct faccia_sentence *sentence, const struct faccia_sink *sink,
                      char *message, size_t cap) {
    (void)self, (void)sentence, (void)sink, (void)message, (void)cap;
    return 0;
}

static void stub_close(void *self) {
    (void)self;
}

#define STUB_TABLE(ABI)                                                                                      \
    __attribute__((visibility("default"))) const struct faccia_voice faccia_voice = {                        \
        .abi = ABI,                                                                                          \
        .size = sizeof(struct faccia_voice),                                                                 \
        .name = "stub",                                                                                      \
        .version = "1",                                                                                      \
        .licence = "GPL-3.0-or-later",                                                                       \
        .open = stub_open,                                                                                   \
        .list = stub_list,                                                                                   \
        .speak = stub_speak,                                                                                 \
        .close = stub_close,                                                                                 \
    }

#endif
