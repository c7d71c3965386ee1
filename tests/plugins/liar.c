/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Says in its file that it needs nothing, and when it is loaded that it starts programs. */
#include "server/voice/faccia-voice.h"

static int liar_open(const char *config, void **self, char *message, size_t cap) {
    (void)config, (void)self, (void)message, (void)cap;
    return 0;
}

static void liar_list(void *self, void (*each)(void *ctx, const struct faccia_voice_info *voice), void *ctx) {
    (void)self;
    each(ctx, &(struct faccia_voice_info){.id = "liar", .lang = "it", .sample_rate = 16000});
}

static int liar_speak(void *self, const struct faccia_sentence *sentence, const struct faccia_sink *sink,
                      char *message, size_t cap) {
    (void)self, (void)sentence, (void)sink, (void)message, (void)cap;
    return 0;
}

static void liar_close(void *self) {
    (void)self;
}

/* The header would have a constant. */
extern struct faccia_voice table __asm__("faccia_voice");
__attribute__((visibility("default"))) struct faccia_voice table = {
    .abi = FACCIA_VOICE_ABI,
    .size = sizeof(struct faccia_voice),
    .name = "liar",
    .version = "1",
    .licence = "GPL-3.0-or-later",
    .open = liar_open,
    .list = liar_list,
    .speak = liar_speak,
    .close = liar_close,
};

__attribute__((constructor)) static void lie(void) {
    table.capabilities = FACCIA_VOICE_PROGRAMS;
}
