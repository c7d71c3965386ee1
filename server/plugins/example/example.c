/* SPDX-License-Identifier: MIT */
/* A minimal voice plugin to start from: hums an "a" for each word.
 *
 *   cc -shared -fPIC -fvisibility=hidden $(pkg-config --cflags faccia-voice) example.c -o example.so -lm
 *   cp example.so $(pkg-config --variable=plugindir faccia-voice)
 */
#include <faccia-voice.h>
#include <math.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { RATE = 16000, NOTE = RATE / 4 };

struct example {
    atomic_bool cancelled;
};

static int ex_open(const char *config, void **self, char *message, size_t cap) {
    (void)config, (void)message, (void)cap; /* config: the plugin's part of --voice-config, JSON */
    *self = calloc(1, sizeof(struct example));
    return *self ? 0 : -1;
}

static void ex_list(void *self, void (*each)(void *ctx, const struct faccia_voice_info *voice), void *ctx) {
    (void)self;
    each(ctx, &(struct faccia_voice_info){"hum", "Humming", "it", "neutral", "formant", "MIT", RATE, 240});
}

static int ex_speak(void *ctx, const struct faccia_sentence *sentence, const struct faccia_sink *sink,
                    char *message, size_t cap) {
    struct example *self = ctx;
    (void)message, (void)cap; /* for an error message when it returns -1 */
    uint64_t at = 0;
    atomic_store(&self->cancelled, false);
    for (uint32_t i = 0; i < sentence->span_count; i++) {
        const char *text = sentence->spans[i].kind == FACCIA_SPAN_TEXT ? sentence->spans[i].text : "";
        for (size_t start = strspn(text, " \n"), size; text[start];
             start += size, start += strspn(text + start, " \n")) {
            int16_t note[NOTE];
            size = strcspn(text + start, " \n");
            for (int k = 0; k < NOTE; k++)
                note[k] = (int16_t)(6000 * sin(2 * 3.14159265 * 200 * k / RATE));
            const struct faccia_phone phone = {"a", "a", at, at + NOTE, 2};
            const struct faccia_word word = {i, start, size, at, at + NOTE};
            if (atomic_load(&self->cancelled) || sink->phone(sink->ctx, &phone) ||
                sink->word(sink->ctx, &word) || sink->audio(sink->ctx, note, NOTE, RATE))
                return 0; /* asked to stop */
            at += NOTE;
        }
    }
    return 0;
}

static void ex_cancel(void *self) {
    atomic_store(&((struct example *)self)->cancelled, true);
}

static void ex_close(void *self) {
    free(self);
}

const struct faccia_voice faccia_voice = {FACCIA_VOICE_ABI,
                                          sizeof(struct faccia_voice),
                                          "example",
                                          "1",
                                          "MIT",
                                          FACCIA_VOICE_STREAMS, /* no network, programs or files */
                                          ex_open,
                                          ex_list,
                                          ex_speak,
                                          ex_cancel,
                                          ex_close};
