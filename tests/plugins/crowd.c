/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Has more voices than any plugin may have. */
#include "server/voice/faccia-voice.h"
#include <stdio.h>

static int crowd_open(const char *config, void **self, char *message, size_t cap) {
    (void)config, (void)self, (void)message, (void)cap;
    return 0;
}

static void crowd_list(void *self, void (*each)(void *ctx, const struct faccia_voice_info *voice),
                       void *ctx) {
    (void)self;
    for (int i = 0; i < 100000; i++) {
        char id[32];
        snprintf(id, sizeof id, "voice%d", i);
        each(ctx, &(struct faccia_voice_info){.id = id, .lang = "it", .sample_rate = 16000});
    }
}

static int crowd_speak(void *self, const struct faccia_sentence *sentence, const struct faccia_sink *sink,
                       char *message, size_t cap) {
    (void)self, (void)sentence, (void)sink, (void)message, (void)cap;
    return 0;
}

static void crowd_close(void *self) {
    (void)self;
}

__attribute__((visibility("default"))) const struct faccia_voice faccia_voice = {
    .abi = FACCIA_VOICE_ABI,
    .size = sizeof(struct faccia_voice),
    .name = "crowd",
    .version = "1",
    .licence = "GPL-3.0-or-later",
    .open = crowd_open,
    .list = crowd_list,
    .speak = crowd_speak,
    .close = crowd_close,
};
