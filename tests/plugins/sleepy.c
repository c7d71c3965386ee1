/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Takes its time to start: until the file that its configuration names is there. It speaks French. */
#include "server/voice/faccia-voice.h"
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int sleepy_open(const char *config, void **self, char *message, size_t cap) {
    (void)self, (void)message, (void)cap;
    char path[256] = "";
    const char *start = strstr(config, ":\"");
    if (start)
        strncat(path, start + 2, strcspn(start + 2, "\""));
    while (*path && access(path, F_OK) != 0)
        usleep(10000);
    return 0;
}

static void sleepy_list(void *self, void (*each)(void *ctx, const struct faccia_voice_info *voice),
                        void *ctx) {
    (void)self;
    each(ctx, &(struct faccia_voice_info){.id = "late", .lang = "fr", .sample_rate = 16000});
}

static int sleepy_speak(void *self, const struct faccia_sentence *sentence, const struct faccia_sink *sink,
                        char *message, size_t cap) {
    static const int16_t samples[1600];
    (void)self, (void)sentence, (void)message, (void)cap;
    sink->audio(sink->ctx, samples, 1600, 16000);
    return 0;
}

static void sleepy_close(void *self) {
    (void)self;
}

__attribute__((visibility("default"))) const struct faccia_voice faccia_voice = {
    .abi = FACCIA_VOICE_ABI,
    .size = sizeof(struct faccia_voice),
    .name = "sleepy",
    .version = "1",
    .licence = "GPL-3.0-or-later",
    .open = sleepy_open,
    .list = sleepy_list,
    .speak = sleepy_speak,
    .close = sleepy_close,
};
